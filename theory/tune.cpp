#include "tune.hpp"

#include <algorithm>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace dpd::theory {
namespace {

constexpr double accuracy = 1e-3;  ///< of coefficients, relative

std::string digits(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.4g", value);
    return text.data();
}

/// A place and what is left there of a function that rises and is wanted to be zero.
struct Trial {
    double x, off;
};

/// Between two trials of different signs: of the places tried the one at which least is left, which is at
/// most `closest`, or where an interval of ln x became too small to matter.
double zero(std::function<double(double)> const& f, Trial low, Trial high) {
    constexpr double closest = 3e-4, smallest = 1e-5;
    std::uintmax_t most = 60;
    auto const near = [](double off) { return std::abs(off) < closest ? 0.0 : off; };
    Trial best = -low.off < high.off ? low : high;
    boost::math::tools::toms748_solve(
        [&](double log_x) {
            Trial const next{std::exp(log_x), f(std::exp(log_x))};
            if (std::abs(next.off) < std::abs(best.off)) best = next;
            return near(next.off);
        },
        std::log(low.x), std::log(high.x), near(low.off), near(high.off),
        [](double a, double b) { return b - a < smallest; }, most);
    return best.x;
}

class Tuner {
public:
    Tuner(Gas const& gas, Weight weight, Scheme scheme, double box)
        : gas_(gas), weight_(weight), scheme_(scheme), box_(box) {}

    /// States are kept: a search ends at one that it has tried.
    Tuned const& at(double gamma, double dt) const {
        auto found = known_.find({gamma, dt});
        if (found == known_.end()) {
            Shardlow const thermostat{.gamma = gamma, .weight = weight_, .scheme = scheme_};
            found =
                known_
                    .emplace(std::pair{gamma, dt},
                             Tuned{gamma, dt, transport_with_memory(gas_, thermostat, dt, box_, accuracy)})
                    .first;
        }
        return found->second;
    }

    /// The largest friction at which a coefficient is `value`. At strong friction it is above (`grows`) or
    /// below that. With a guess the nearest.
    Tuned const& friction(std::function<double(Tuned const&)> const& coefficient, bool grows,
                          char const* name, double value, double dt,
                          std::optional<double> guess = std::nullopt) const {
        double const factor = guess ? 1.3 : 3.0;
        constexpr int widest = 7;
        auto const off = [&](double gamma) {
            double const ratio = std::log(coefficient(at(gamma, dt)) / value);
            return grows ? ratio : -ratio;
        };
        auto const tried = [&](double gamma) { return Trial{gamma, off(gamma)}; };
        Trial high = tried(guess.value_or(20.0 * std::sqrt(gas_.m * gas_.kT) / gas_.rc)), low = high;
        for (int k = 0; k < widest && high.off < 0.0; ++k) {
            if (guess) low = high;
            high = tried(high.x * factor);
        }
        if (low.off > 0.0) low = high;
        double nearest = high.off;
        for (int k = 0; k < widest && low.off > 0.0; ++k) {
            high = low;
            low = tried(low.x / factor);
            nearest = std::min(nearest, low.off);
        }
        if (high.off < 0.0 || low.off > 0.0)
            throw std::domain_error(std::string("no friction gives ") + name + " = " + digits(value) +
                                    " at dt = " + digits(dt) +
                                    "; nearest: " + digits(value * std::exp(grows ? nearest : -nearest)));
        return at(zero(off, low, high), dt);
    }

    Gas const& gas() const { return gas_; }

private:
    Gas gas_;
    Weight weight_;
    Scheme scheme_;
    double box_;
    mutable std::map<std::pair<double, double>, Tuned> known_;
};

double viscosity_of(Tuned const& tuned) { return tuned.viscosity(); }
double diffusion_of(Tuned const& tuned) { return tuned.transport.diffusion_constant.value(); }

}  // namespace

Tuned tune(Gas const& gas, Wanted const& wanted, Weight weight, Scheme scheme, double box) {
    int given = 0;
    for (auto const& value :
         {wanted.viscosity, wanted.diffusion_constant, wanted.schmidt_number, wanted.dt}) {
        if (value && !(*value > 0.0 && std::isfinite(*value)))
            throw std::invalid_argument("what is wanted must be positive and finite");
        given += value.has_value();
    }
    if (given != 2)
        throw std::invalid_argument(
            "two numbers determine friction and step; allowed: two of eta, D and Sc, or one of them and dt");
    Tuner const tuner(gas, weight, scheme, box);
    if (wanted.dt) {
        if (wanted.viscosity) return tuner.friction(viscosity_of, true, "eta", *wanted.viscosity, *wanted.dt);
        if (wanted.diffusion_constant)
            return tuner.friction(diffusion_of, false, "D", *wanted.diffusion_constant, *wanted.dt);
        auto const schmidt = [&](Tuned const& tuned) { return tuned.schmidt_number(gas); };
        return tuner.friction(schmidt, true, "Sc", *wanted.schmidt_number, *wanted.dt);
    }
    // of the two coefficients the friction settles one, the step the other: long steps make D larger
    double const eta = wanted.viscosity.value_or(wanted.schmidt_number.value_or(0.0) * gas.n * gas.m *
                                                 wanted.diffusion_constant.value_or(0.0));
    double const D =
        wanted.diffusion_constant.value_or(eta / (gas.n * gas.m * wanted.schmidt_number.value_or(1.0)));
    double const unit = gas.rc * std::sqrt(gas.m / gas.kT), shortest = 0.01 * unit;
    // from step to step the friction that gives eta changes little
    std::map<double, Tuned> found;
    auto const off = [&](double dt) {
        auto const near = std::min_element(found.begin(), found.end(), [&](auto const& a, auto const& b) {
            return std::abs(std::log(a.first / dt)) < std::abs(std::log(b.first / dt));
        });
        auto const guess = near == found.end() ? std::nullopt : std::optional(near->second.gamma);
        found[dt] = tuner.friction(viscosity_of, true, "eta", eta, dt, guess);
        return std::log(diffusion_of(found[dt]) / D);
    };
    Trial low{shortest, off(shortest)}, high = low;
    // n kT dt/2 is the least kinetic viscosity of a step: from some step on no friction gives eta
    constexpr double factor = 1.7;
    for (double next = 0.05 * unit; high.off < 0.0 && next < std::min(unit, 2.0 * eta / (gas.n * gas.kT));
         next *= factor) {
        low = high;
        try {
            high = {next, off(next)};
        } catch (std::domain_error const&) {
            break;
        }
    }
    if (low.off > 0.0 || high.off < 0.0) {
        auto const schmidt = [&](double f) { return digits(eta / (gas.n * gas.m * D * std::exp(f))); };
        throw std::domain_error("with eta = " + digits(eta) + " this gas has Sc from " + schmidt(high.off) +
                                " (dt = " + digits(high.x) + ") to " + schmidt(low.off) +
                                " (dt = " + digits(low.x) + "), not " + digits(eta / (gas.n * gas.m * D)) +
                                "; another density has others");
    }
    return found.at(zero(off, low, high));
}

}  // namespace dpd::theory
