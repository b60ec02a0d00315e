#include "records.hpp"

namespace dpd {

std::vector<std::vector<double>> series_of(std::vector<Record> const& records, std::string const& name) {
    std::vector<std::vector<double>> runs;
    for (auto const& record : records)
        if (auto const found = record.series.find(name); found != record.series.end())
            runs.push_back(found->second);
    return runs;
}

std::vector<Curve const*> curves_of(std::vector<Record> const& records, std::string const& name) {
    std::vector<Curve const*> curves;
    for (auto const& record : records)
        if (auto const found = record.curves.find(name); found != record.curves.end())
            curves.push_back(&found->second);
    return curves;
}

Estimate ratio_of(std::vector<std::vector<double>> numerator,
                  std::vector<std::vector<double>> const& denominator) {
    double above = 0.0, below = 0.0, count = 0.0;
    for (std::size_t r = 0; r < numerator.size(); ++r)
        for (std::size_t k = 0; k < numerator[r].size(); ++k) {
            above += numerator[r][k];
            below += denominator[r][k];
            count += 1.0;
        }
    if (below == 0.0) return {};
    double const ratio = above / below, mean = below / count;
    for (std::size_t r = 0; r < numerator.size(); ++r)
        for (std::size_t k = 0; k < numerator[r].size(); ++k)
            numerator[r][k] = ratio + (numerator[r][k] - ratio * denominator[r][k]) / mean;
    return combine(numerator);
}

}  // namespace dpd
