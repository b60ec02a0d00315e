#include "tune.hpp"

#include <algorithm>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <stdexcept>
#include <string>

namespace dpd::theory {
namespace {

constexpr double accuracy = 1e-3;  ///< of coefficients and of what is solved for, relative

std::string digits(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.4g", value);
    return text.data();
}

/// Where a function of ln x that rises or falls is zero, between bounds that the caller has checked.
double zero(std::function<double(double)> const& f, double low, double f_low, double high, double f_high) {
    std::uintmax_t evaluations = 20;
    auto const close = [](double a, double b) { return std::abs(b - a) < accuracy; };
    auto const [a, b] =
        boost::math::tools::toms748_solve([&](double ln_x) { return f(std::exp(ln_x)); }, std::log(low),
                                          std::log(high), f_low, f_high, close, evaluations);
    return std::exp(0.5 * (a + b));
}

class Tuner {
public:
    Tuner(Gas const& gas, Weight weight, Scheme scheme, double box)
        : gas_(gas), weight_(weight), scheme_(scheme), box_(box) {}

    Tuned at(double gamma, double dt) const {
        return {gamma, dt,
                transport_with_memory(gas_, Shardlow{.gamma = gamma, .weight = weight_, .scheme = scheme_},
                                      dt, box_, accuracy)};
    }

    /// The largest friction at which a coefficient is `value`. At strong friction it is above (`grows`) or
    /// below that.
    double friction(std::function<double(Tuned const&)> const& coefficient, bool grows, char const* name,
                    double value, double dt) const {
        constexpr double factor = 3.0;
        constexpr int widest = 7;
        auto const off = [&](double gamma) {
            double const ratio = std::log(coefficient(at(gamma, dt)) / value);
            return grows ? ratio : -ratio;
        };
        double high = 20.0 * std::sqrt(gas_.m * gas_.kT) / gas_.rc, f_high = off(high);
        for (int k = 0; k < widest && f_high < 0.0; ++k) f_high = off(high *= factor);
        double low = high, f_low = f_high, nearest = f_high;
        for (int k = 0; k < widest && f_low > 0.0; ++k) {
            high = low, f_high = f_low;
            f_low = off(low /= factor);
            nearest = std::min(nearest, f_low);
        }
        if (f_high < 0.0 || f_low > 0.0)
            throw std::domain_error(std::string("no friction gives ") + name + " = " + digits(value) +
                                    " at dt = " + digits(dt) +
                                    "; nearest: " + digits(value * std::exp(grows ? nearest : -nearest)));
        return zero(off, low, f_low, high, f_high);
    }

    Gas const& gas() const { return gas_; }

private:
    Gas gas_;
    Weight weight_;
    Scheme scheme_;
    double box_;
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
        if (wanted.viscosity)
            return tuner.at(tuner.friction(viscosity_of, true, "eta", *wanted.viscosity, *wanted.dt),
                            *wanted.dt);
        if (wanted.diffusion_constant)
            return tuner.at(tuner.friction(diffusion_of, false, "D", *wanted.diffusion_constant, *wanted.dt),
                            *wanted.dt);
        auto const schmidt = [&](Tuned const& tuned) { return tuned.schmidt_number(gas); };
        return tuner.at(tuner.friction(schmidt, true, "Sc", *wanted.schmidt_number, *wanted.dt), *wanted.dt);
    }
    // of the two coefficients the friction settles one, the step the other: long steps make D larger
    double const eta = wanted.viscosity.value_or(wanted.schmidt_number.value_or(0.0) * gas.n * gas.m *
                                                 wanted.diffusion_constant.value_or(0.0));
    double const D =
        wanted.diffusion_constant.value_or(eta / (gas.n * gas.m * wanted.schmidt_number.value_or(1.0)));
    double const unit = gas.rc * std::sqrt(gas.m / gas.kT), shortest = 0.01 * unit;
    auto const off = [&](double dt) {
        double const gamma = tuner.friction(viscosity_of, true, "eta", eta, dt);
        return std::log(diffusion_of(tuner.at(gamma, dt)) / D);
    };
    double low = shortest, f_low = off(low), high = low, f_high = f_low;
    // n kT dt/2 is the least kinetic viscosity of a step: from some step on no friction gives eta
    constexpr double factor = 1.7;
    for (double next = 0.05 * unit; f_high < 0.0 && next < std::min(unit, 2.0 * eta / (gas.n * gas.kT));
         next *= factor) {
        low = high, f_low = f_high;
        try {
            f_high = off(next);
        } catch (std::domain_error const&) {
            break;
        }
        high = next;
    }
    if (f_low > 0.0 || f_high < 0.0) {
        auto const schmidt = [&](double f) { return digits(eta / (gas.n * gas.m * D * std::exp(f))); };
        throw std::domain_error("with eta = " + digits(eta) + " this gas has Sc from " + schmidt(f_high) +
                                " (dt = " + digits(high) + ") to " + schmidt(f_low) +
                                " (dt = " + digits(low) + "), not " + digits(eta / (gas.n * gas.m * D)) +
                                "; another density has others");
    }
    double const dt = zero(off, low, f_low, high, f_high);
    return tuner.at(tuner.friction(viscosity_of, true, "eta", eta, dt), dt);
}

}  // namespace dpd::theory
