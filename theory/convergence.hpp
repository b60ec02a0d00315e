/// @file
/// Numbers that get better with the degree of the polynomials, and zeros of their functions. Not installed.
#pragma once

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace dpd::theory {

/// Degrees of the polynomials of an encounter's velocities, tried one after the other.
inline constexpr int lowest_degree = 6, degree_step = 2, highest_degree = 18;

/// Of a function.
struct ZeroAndSlope {
    double zero;   ///< where it is zero
    double slope;  ///< its slope there
};

/// The zero of a function between two bounds, to 14 bits, and its slope there: with the slope of a coarse
/// function a step of Newton's finds the zero of a finer one.
template <class Function>
ZeroAndSlope zero_and_slope(Function const& function, double lowest, double highest) {
    constexpr int bits = 14;
    std::uintmax_t evaluations = 50;
    auto const [low, high] = boost::math::tools::toms748_solve(
        function, lowest, highest, boost::math::tools::eps_tolerance<double>(bits), evaluations);
    double const zero = 0.5 * (low + high);
    constexpr double interval = 0.01;
    double const slope =
        (function(zero * (1.0 + interval)) - function(zero * (1.0 - interval))) / (2.0 * interval * zero);
    return {zero, slope};
}

/// A number that gets better with the degree of the polynomials.
class Sequence {
public:
    /// Of the next degree.
    void add(double value) { values_.push_back(value); }
    /// What the last five tend to, or three, if they close in like a sum of geometric series.
    double limit() const { return limit(values_.size()); }
    /// How far off it may be: what the last value has changed in it.
    double change() const { return std::abs(limit() - limit(values_.size() - 1)); }
    /// The larger of what each of the last two has changed, since one change may be small by chance; infinite
    /// for less than three values.
    double steady_change() const {
        std::size_t const count = values_.size();
        if (count < 3) return std::numeric_limits<double>::infinity();
        return std::max(change(), std::abs(limit(count - 1) - limit(count - 2)));
    }

private:
    /// Of the first `count` values. Wynn's epsilon algorithm, of three values Aitken's.
    double limit(std::size_t count) const {
        std::size_t const used = count < 3 ? 1 : count < 5 ? 3 : 5;
        double const last = values_[count - 1];
        std::vector<double> before(used + 1, 0.0),
            now(values_.begin() + static_cast<std::ptrdiff_t>(count - used),
                values_.begin() + static_cast<std::ptrdiff_t>(count));
        double best = last;
        for (std::size_t column = 1; column < used; ++column) {
            std::vector<double> next;
            for (std::size_t i = 0; i + 1 < now.size(); ++i) {
                double const step = now[i + 1] - now[i];
                if (step == 0.0) return best;
                next.push_back(before[i + 1] + 1.0 / step);
            }
            before = std::exchange(now, next);
            if (column % 2 == 0) best = now.back();
        }
        // a series that does not close in has no limit to be trusted
        constexpr double farthest = 20.0;
        return used > 1 && std::abs(best - last) > farthest * std::abs(last - values_[count - 2]) ? last
                                                                                                  : best;
    }

    std::vector<double> values_;
};

/// The limit of a Sequence, and its change.
struct Converged {
    double value;  ///< the limit
    double error;  ///< how far off it may be
};

}  // namespace dpd::theory
