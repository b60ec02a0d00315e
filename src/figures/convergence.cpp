#include "convergence.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "errors.hpp"
#include "judge_figure.hpp"
#include "theory/registry.hpp"

namespace dpd {
namespace {

// Powers of two: each part doubles the time.
constexpr std::array parts{1.0 / 64, 1.0 / 32, 1.0 / 16, 1.0 / 8, 1.0 / 4, 1.0 / 2, 1.0};

// A difference has no deviation that should vanish. A closed form that is a bound has: what is left of it is
// the floor of its approximation.
bool converges(Criterion const& criterion) {
    if (criterion.theory == "previous" || criterion.relation == Relation::differs) return false;
    return criterion.relation == Relation::equal || theory::find(criterion.theory) != nullptr;
}

}  // namespace

Record first_part(Record const& record, double fraction) {
    Record part = record;
    for (auto& [name, values] : part.series)
        values.resize(static_cast<std::size_t>(fraction * double(values.size())));
    for (auto& [name, curve] : part.curves) {
        // a correlation belongs to the block of its origin, and ends up to one longest lag later
        Eigen::Index const blocks = curve.sum.cols();
        auto const later = blocks - static_cast<Eigen::Index>(fraction * double(blocks));
        curve.sum.rightCols(later).setZero();
        curve.weight.rightCols(later).setZero();
    }
    return part;
}

// [floor]
Convergence convergence_of(std::vector<Comparison> const& comparisons, double seconds) {
    Convergence result;
    double error_squared = 0.0, deviation_squared = 0.0;  // sums over the points
    double variance = 0.0, variance_without_floor = 0.0;  // of the difference of these sums
    std::size_t points = 0;
    for (auto const& c : comparisons) {
        double const scale = c.theory != 0.0 ? 1.0 / c.theory : 1.0;
        double const error = std::pow(std::hypot(c.estimate.error, c.theory_error) * scale, 2),
                     deviation = std::pow((c.estimate.value - c.theory) * scale, 2);
        if (c.estimate.blocks < 2 || !std::isfinite(error) || !std::isfinite(deviation)) continue;
        ++points;
        error_squared += error;
        deviation_squared += deviation;
        // (b + noise)^2 and the error's own square, which is known to 2/(blocks-1)
        double const chance = 2.0 * error * error * (1.0 + 1.0 / double(c.estimate.blocks - 1));
        variance_without_floor += chance;
        variance += 4.0 * std::max(0.0, deviation - error) * error + chance;
    }
    if (points == 0) return result;
    auto const n = double(points);
    result.states.push_back({.seconds = seconds,
                             .error = std::sqrt(error_squared / n),
                             .deviation = std::sqrt(deviation_squared / n),
                             .points = points});
    double const excess = (deviation_squared - error_squared) / n, excess_error = std::sqrt(variance) / n;
    result.floor = std::sqrt(std::max(0.0, excess));
    // a floor within the noise could be as large as the root of the noise
    result.floor_error =
        excess > excess_error ? excess_error / (2.0 * result.floor) : std::sqrt(excess_error);
    result.floor_resolved = excess > std::max(excess_error, 2.0 * std::sqrt(variance_without_floor) / n);
    return result;
}
// [floor]

std::vector<Convergence> converge(Figure const& planned, Results const& results) {
    std::vector<Convergence> all;
    for (std::size_t c = 0; c < planned.curves.size(); ++c)
        for (auto const& criterion : planned.curves[c].criteria)
            if (converges(criterion)) {
                all.emplace_back();
                all.back().curve = c;
                all.back().criterion = criterion;
            }
    if (all.empty()) return all;
    for (double const fraction : parts) {
        Figure const part = measured(planned, results, fraction);
        for (auto& convergence : all) {
            std::vector<Comparison> comparisons;
            for (std::size_t p = 0; p < part.points.size(); ++p) {
                if (part.points[p].curve != convergence.curve) continue;
                try {
                    if (auto comparison = compare_point(part, p, convergence.criterion))
                        comparisons.push_back(std::move(*comparison));
                } catch (InputError const&) {
                    // not measured yet; `compare` complains if it never is
                }
            }
            Convergence const now = convergence_of(comparisons, part.curves[convergence.curve].seconds);
            convergence.states.insert(convergence.states.end(), now.states.begin(), now.states.end());
            convergence.floor = now.floor;
            convergence.floor_error = now.floor_error;
            convergence.floor_resolved = now.floor_resolved;
        }
    }
    return all;
}

}  // namespace dpd
