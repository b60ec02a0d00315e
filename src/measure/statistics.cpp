#include "statistics.hpp"

#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <numeric>

#include "elementary.hpp"

namespace dpd {
namespace {

// Probability of taking runs of one ensemble for different ones.
constexpr double run_scatter_significance = 1e-3;

double mean_of(std::span<double const> values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

// Variance of the mean of independent values.
double variance_of_mean(std::span<double const> values, double mean) {
    double sum = 0.0;
    for (double const value : values) sum += (value - mean) * (value - mean);
    auto const n = double(values.size());
    return sum / (n * (n - 1.0));
}

// Means of consecutive blocks; a remainder shorter than a block is left out.
std::vector<double> block_means(std::span<double const> series, std::size_t length) {
    std::vector<double> means;
    for (std::size_t begin = 0; begin + length <= series.size(); begin += length)
        means.push_back(mean_of(series.subspan(begin, length)));
    return means;
}

// [block length]
std::size_t block_length(std::span<double const> series) {
    auto const n = double(series.size());
    if (series.size() < 4) return 1;
    double const naive = variance_of_mean(series, mean_of(series));
    if (!(naive > 0.0)) return 1;
    std::size_t length = 1;
    while (series.size() / (2 * length) >= 4) {
        auto const means = block_means(series, length);
        double const inefficiency = variance_of_mean(means, mean_of(means)) / naive;
        if (std::pow(double(length), 3) > 2.0 * n * inefficiency * inefficiency) break;
        length *= 2;
    }
    return length;
}
// [block length]

}  // namespace

std::vector<double> equal_blocks(std::span<double const> series, std::size_t blocks) {
    std::size_t const length = series.size() / blocks;
    return length > 0 ? block_means(series.first(blocks * length), length) : std::vector<double>{};
}

Estimate independent(std::span<double const> values) {
    Estimate estimate;
    estimate.blocks = values.size();
    estimate.value = values.empty() ? std::numeric_limits<double>::quiet_NaN() : mean_of(values);
    estimate.error = values.size() < 2 ? std::numeric_limits<double>::quiet_NaN()
                                       : std::sqrt(variance_of_mean(values, estimate.value));
    return estimate;
}

Estimate pool(std::span<std::vector<double> const> runs) {
    std::vector<double> pooled, run_means;
    double within = 0.0;  // sum of squared deviations of the blocks from their run's mean
    for (auto const& run : runs) {
        if (run.empty()) continue;
        run_means.push_back(mean_of(run));
        for (double const block : run) within += std::pow(block - run_means.back(), 2);
        pooled.insert(pooled.end(), run.begin(), run.end());
    }
    // [runs]
    if (run_means.size() >= 2 && pooled.size() > run_means.size()) {
        // Do whole runs differ by more than their blocks let expect? Then each run counts as one value.
        auto const r = double(run_means.size()), n = double(pooled.size());
        double const by_runs = variance_of_mean(run_means, mean_of(run_means));
        double const by_blocks = within / ((n - r) * n);
        boost::math::fisher_f const distribution(r - 1.0, n - r);
        if (by_runs > boost::math::quantile(boost::math::complement(distribution, run_scatter_significance)) *
                          by_blocks)
            return independent(run_means);
    }
    return independent(pooled);
    // [runs]
}

Estimate combine(std::span<std::vector<double> const> runs) {
    std::size_t length = 1;
    std::vector<double> all;
    for (auto const& run : runs) {
        length = std::max(length, block_length(run));
        all.insert(all.end(), run.begin(), run.end());
    }
    std::vector<std::vector<double>> blocks;
    for (auto const& run : runs)
        if (!run.empty()) blocks.push_back(block_means(run, std::min(length, run.size())));
    Estimate estimate = pool(blocks);
    if (estimate.blocks >= 2) {
        double const naive = variance_of_mean(all, mean_of(all));
        if (naive > 0.0) estimate.inefficiency = estimate.error * estimate.error / naive;
    }
    return estimate;
}

Estimate blocking(std::span<double const> series) {
    std::vector<std::vector<double>> const runs{{series.begin(), series.end()}};
    return combine(runs);
}

// [slow mode]
Estimate of_slow_mode(Estimate const& of_blocks, std::size_t runs, double x) {
    if (of_blocks.blocks < 2 || runs == 0 || of_blocks.blocks % runs != 0) return of_blocks;
    std::size_t const in_run = of_blocks.blocks / runs;
    // covariances of two blocks some blocks apart, over the variance of an instant
    x = std::max(x, 1e-4);
    double const decay = one_minus_exponential(x) / x;
    auto const covariance = [&](std::size_t apart) {
        return apart == 0 ? 2.0 * (1.0 - decay) / x
                          : decay * decay * exponential(-std::min(x * double(apart - 1), 600.0));
    };
    // of all blocks, with P the projection on deviations from their mean: 1^T C 1, trace C, trace C^2, 1^T
    // C^2 1
    double all = 0.0, squares = 0.0, rows = 0.0;
    for (std::size_t i = 0; i < in_run; ++i) {
        double row = 0.0;
        for (std::size_t j = 0; j < in_run; ++j) {
            double const c = covariance(std::max(i, j) - std::min(i, j));
            row += c;
            squares += c * c;
        }
        all += row;
        rows += row * row;
    }
    double const r = double(runs), n = double(of_blocks.blocks), of_mean = r * all / (n * n),
                 trace = n * covariance(0) - n * of_mean,
                 trace_of_square = r * squares - 2.0 * r * rows / n + of_mean * of_mean * n * n;
    Estimate result = of_blocks;
    result.slow_mode = true;
    result.error *= std::sqrt(of_mean * n * (n - 1.0) / trace);
    result.blocks = 1 + std::max<std::size_t>(1, std::size_t(trace * trace / trace_of_square + 1e-9));
    return result;
}
// [slow mode]

Estimate difference(Estimate const& a, Estimate const& b) {
    Estimate result{.value = a.value - b.value, .error = std::hypot(a.error, b.error)};
    double sum = 0.0;  // of squared variances over their degrees of freedom
    for (Estimate const* const e : {&a, &b})
        if (e->error > 0.0) sum += std::pow(e->error, 4) / (double(e->blocks) - 1.0);
    result.blocks = sum > 0.0 ? 1 + static_cast<std::size_t>(std::pow(result.error, 4) / sum)
                              : std::min(a.blocks, b.blocks);
    return result;
}

std::string_view name_of(Verdict verdict) {
    switch (verdict) {
        case Verdict::agrees:
            return "agrees";
        case Verdict::disagrees:
            return "disagrees";
        default:
            return "undecided";
    }
}

// [critical value]
double critical_z(double false_alarm, std::size_t blocks) {
    if (blocks < 2) return std::numeric_limits<double>::infinity();
    boost::math::students_t const distribution(double(blocks - 1));
    return boost::math::quantile(boost::math::complement(distribution, false_alarm / 2.0));
}
// [critical value]

Verdict judge(Estimate const& estimate, double theory, double tolerance, double resolution,
              double false_alarm) {
    // [judge]
    double const half_width = critical_z(false_alarm, estimate.blocks) * estimate.error;
    double const distance = std::abs(estimate.value - theory);
    if (!std::isfinite(half_width) || !std::isfinite(distance)) return Verdict::undecided;
    double const band = tolerance * std::abs(theory);
    if (distance - half_width > band) return Verdict::disagrees;
    bool const sharp =
        tolerance > 0.0 ? distance + half_width <= band : estimate.error <= resolution * std::abs(theory);
    return sharp ? Verdict::agrees : Verdict::undecided;
    // [judge]
}

double time_factor_to_decide(Estimate const& estimate, double theory, double tolerance, double resolution,
                             double false_alarm) {
    if (judge(estimate, theory, tolerance, resolution, false_alarm) != Verdict::undecided) return 1.0;
    double const wanted = tolerance > 0.0
                              ? std::abs(std::abs(estimate.value - theory) - tolerance * std::abs(theory)) /
                                    critical_z(false_alarm, estimate.blocks)
                              : resolution * std::abs(theory);
    double const factor = std::pow(estimate.error / wanted, 2);
    return std::isfinite(factor) ? std::max(1.0, factor) : std::numeric_limits<double>::infinity();
}

}  // namespace dpd
