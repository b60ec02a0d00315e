#include "closed_forms.hpp"

#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/quadrature/tanh_sinh.hpp>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <stdexcept>
#include <string>

namespace dpd::theory {
namespace {

struct Quantity {
    char const* name;
    double value;
};

void require_positive(std::initializer_list<Quantity> quantities) {
    for (auto const& [name, value] : quantities)
        if (!(value > 0.0) || !std::isfinite(value))
            throw std::invalid_argument(std::string(name) + " must be positive and finite");
}

void require_finite(std::initializer_list<Quantity> quantities) {
    for (auto const& [name, value] : quantities)
        if (!std::isfinite(value)) throw std::invalid_argument(std::string(name) + " must be finite");
}

double square(double x) { return x * x; }

/// 1/(1 - exp(-rate)) - 1/2, the sum over steps of a correlation that each step multiplies by exp(-rate), the
/// first step counting half. Written with expm1 so that a small step loses no digits.
double correlation_sum(double rate) { return -1.0 / std::expm1(-rate) - 0.5; }

/// [w], [w^2] and [w r^2] of a weight of height 1 and range rc.
double integral_of_weight(int d, double rc, Weight weight) {
    return volume_integral(d, rc, [=](double r) { return weight_at(weight, r / rc); });
}
double integral_of_squared_weight(int d, double rc, Weight weight) {
    return volume_integral(d, rc, [=](double r) { return square(weight_at(weight, r / rc)); });
}
double integral_of_weight_r2(int d, double rc, Weight weight) {
    return volume_integral(d, rc, [=](double r) { return weight_at(weight, r / rc) * r * r; });
}

/// [f g], the integral of f weighted with the pair distribution.
template <class F>
double integral_over_pairs(Gas const& gas, PairDistribution const& g, F const& f) {
    if (!g) return volume_integral(gas.d, gas.rc, f);
    require_positive({{"rc", gas.rc}});
    using Gauss = boost::math::quadrature::gauss<double, 7>;  // holds the nodes >= 0 only
    constexpr int parts = 1000;
    double sum = 0.0;
    auto const add = [&](double x, double share) {
        double const r = gas.rc * x, at_r = g(r);
        if (!(at_r >= 0.0) || !std::isfinite(at_r))
            throw std::invalid_argument("g(r) must be finite and not negative, also at r = " +
                                        std::to_string(r));
        sum += share * std::pow(x, gas.d - 1) * f(r) * at_r;
    };
    for (int part = 0; part < parts; ++part) {
        double const centre = part + 0.5;
        add(centre / parts, Gauss::weights()[0]);
        for (std::size_t k = 1; k < Gauss::abscissa().size(); ++k)
            for (double sign : {-1.0, 1.0})
                add((centre + 0.5 * sign * Gauss::abscissa()[k]) / parts, Gauss::weights()[k]);
    }
    return unit_sphere_surface(gas.d) * std::pow(gas.rc, gas.d) * sum / (2.0 * parts);
}

/// w(r).
auto friction_of_distance(Gas const& gas, Shardlow const& thermostat) {
    return [=](double r) { return thermostat.gamma * weight_at(thermostat.weight, r / gas.rc); };
}

/// A(r), NG2007 eq. 5, after a check of what it depends on.
auto A_of_distance(Gas const& gas, Shardlow const& thermostat, double dt) {
    require_positive({{"m", gas.m}, {"gamma", thermostat.gamma}, {"dt", dt}});
    // no weight exceeds 1
    if (thermostat.scheme == Scheme::linear && thermostat.gamma * dt / gas.m > 1.0)
        throw std::domain_error("the linear scheme needs gamma dt/m <= 1: beyond, no noise keeps kT");
    auto const w = friction_of_distance(gas, thermostat);
    return [=, scheme = thermostat.scheme, m = gas.m](double r) { return update_a(scheme, w(r) * dt / m); };
}

/// What one pair at A takes away from <v_x v_y> (1 - s_ij averaged over directions) ...
double stress_loss(int d, double A) { return 2.0 * A / d - 4.0 * A * A / (d * (d + 2)); }
/// ... and from <v(t).v(0)>.
double velocity_loss(int d, double A) { return A / d; }

/// A of Lowe-Andersen: the relative velocity is replaced, 1 - 2A = 0.
constexpr double lowe_A = 0.5;

double sphere_volume(Gas const& gas) { return unit_sphere_surface(gas.d) / gas.d * std::pow(gas.rc, gas.d); }

/// -ln s of one step.
double stress_decay(Gas const& gas, Shardlow const& thermostat, double dt) {
    require_positive({{"n", gas.n}});
    auto const A = A_of_distance(gas, thermostat, dt);
    return gas.n * volume_integral(gas.d, gas.rc, [&](double r) { return stress_loss(gas.d, A(r)); });
}
double stress_decay(Gas const& gas, Lowe const& thermostat, double dt) {
    require_positive({{"n", gas.n}, {"rc", gas.rc}, {"Gamma", thermostat.Gamma}, {"dt", dt}});
    return gas.n * thermostat.Gamma * dt * sphere_volume(gas) * stress_loss(gas.d, lowe_A);
}

/// -ln of the velocity correlation over one step.
double velocity_decay(Gas const& gas, Shardlow const& thermostat, double dt) {
    require_positive({{"n", gas.n}});
    auto const A = A_of_distance(gas, thermostat, dt);
    return gas.n * volume_integral(gas.d, gas.rc, [&](double r) { return velocity_loss(gas.d, A(r)); });
}
double velocity_decay(Gas const& gas, Lowe const& thermostat, double dt) {
    require_positive({{"n", gas.n}, {"rc", gas.rc}, {"Gamma", thermostat.Gamma}, {"dt", dt}});
    return gas.n * thermostat.Gamma * dt * sphere_volume(gas) * velocity_loss(gas.d, lowe_A);
}

/// eta_pot/phi_pot of NG2007 eq. 16.
double viscosity_per_relaxation_rate(Gas const& gas, Soft const& potential, PairDistribution const& g) {
    require_positive({{"n", gas.n}, {"m", gas.m}, {"a", potential.a}});
    // a kT/rc, the factor that all forces have in common, cancels
    auto const f = [rc = gas.rc](double r) { return 1.0 - r / rc; };
    double const force = integral_over_pairs(gas, g, f);
    if (!(force > 0.0)) throw std::domain_error("no potential viscosity: g(r) has no pair within the range");
    double const force_r2 = integral_over_pairs(gas, g, [&](double r) { return f(r) * r * r; });
    return gas.n * gas.m * force_r2 / (2.0 * (gas.d + 2) * force);
}

/// nu + D, the rate per k^2 at which a tagged particle and a shear wave at k lose each other.
double mode_diffusivity(Gas const& gas, double eta, double D) {
    require_positive({{"n", gas.n}, {"m", gas.m}, {"kT", gas.kT}, {"eta", eta}, {"D", D}});
    return eta / (gas.n * gas.m) + D;
}

/// The sum over all integers j but 0 of exp(-s j^2).
double lattice_sum(double s) {
    constexpr double pi = std::numbers::pi;
    constexpr int terms = 6;  // the first left out is exp(-49 pi)
    auto const from_one = [](double rate) {
        double sum = 0.0;
        for (int j = terms; j > 0; --j) sum += 2.0 * std::exp(-rate * j * j);
        return sum;
    };
    // Poisson: the sum over all j equals sqrt(pi/s) times that at pi^2/s
    return s > pi ? from_one(s) : std::sqrt(pi / s) * (1.0 + from_one(pi * pi / s)) - 1.0;
}

}  // namespace

double unit_sphere_surface(int d) {
    if (d == 2) return 2.0 * std::numbers::pi;
    if (d == 3) return 4.0 * std::numbers::pi;
    throw std::invalid_argument("d must be 2 or 3");
}

double volume_integral(int d, double rc, std::function<double(double)> const& f) {
    require_positive({{"rc", rc}});
    // Double-exponential quadrature, because (1 - x)^(1/2) has no finite slope at the cutoff and because S1
    // at a large gamma dt/m has a boundary layer there.
    static boost::math::quadrature::tanh_sinh<double> quadrature;  // its lazily grown table is locked
    constexpr double tolerance = 1e-12;
    double const radial =
        quadrature.integrate([&](double x) { return std::pow(x, d - 1) * f(rc * x); }, 0.0, 1.0, tolerance);
    return unit_sphere_surface(d) * std::pow(rc, d) * radial;
}

double A1(ExplicitDpd const& fluid) {
    require_positive({{"m", fluid.m}, {"gamma", fluid.gamma}});
    return fluid.gamma * integral_of_weight(fluid.d, fluid.rc, fluid.weight) / (fluid.m * fluid.d);
}

double A2(ExplicitDpd const& fluid) {
    require_positive({{"m", fluid.m}, {"gamma", fluid.gamma}});
    return 2.0 * square(fluid.gamma / fluid.m) * integral_of_squared_weight(fluid.d, fluid.rc, fluid.weight) /
           fluid.d;
}

double A3(ExplicitDpd const& fluid) {
    require_positive({{"sigma", fluid.sigma}});
    double const w_R2 = fluid.random_weight
                            ? integral_of_squared_weight(fluid.d, fluid.rc, *fluid.random_weight)
                            : integral_of_weight(fluid.d, fluid.rc, fluid.weight);
    return square(fluid.sigma) * w_R2 / fluid.d;
}

double temperature_at_finite_step(ExplicitDpd const& fluid, double dt) {
    require_positive({{"n", fluid.n}, {"dt", dt}});
    double const a1 = A1(fluid);
    double const damping = a1 * (2.0 - a1 * fluid.n * dt) - A2(fluid) * dt;
    if (!(damping > 0.0))
        throw std::domain_error("no temperature: the step dt is at or beyond the critical step " +
                                std::to_string(critical_step(fluid)) + " (my25)");
    return A3(fluid) / (fluid.m * damping);
}

double temperature_with_frozen_neighbours(ExplicitDpd const& fluid, double dt) {
    require_positive({{"n", fluid.n}, {"dt", dt}});
    if (fluid.random_weight)
        throw std::domain_error(
            "frozen neighbours have one temperature for matched weights only, w_R^2 = w_D");
    double const a1 = A1(fluid);
    return A3(fluid) / (2.0 * fluid.m * a1) * (1.0 + 0.5 * fluid.n * a1 * dt);
}

double critical_step(ExplicitDpd const& fluid) {
    require_positive({{"n", fluid.n}});
    double const a1 = A1(fluid);
    return 2.0 * a1 / (fluid.n * a1 * a1 + A2(fluid));
}

double critical_density(ExplicitDpd const& fluid, double dt) {
    require_positive({{"dt", dt}});
    double const a1 = A1(fluid);
    double const a2 = A2(fluid);
    double const density = (2.0 * a1 - a2 * dt) / (a1 * a1 * dt);
    if (!(density > 0.0))
        throw std::domain_error("no critical density: at or beyond the step 2 A1/A2 = " +
                                std::to_string(2.0 * a1 / a2) + " no density is stable");
    return density;
}

double stress_retention(Gas const& gas, Shardlow const& thermostat, double dt) {
    return std::exp(-stress_decay(gas, thermostat, dt));
}
double stress_retention(Gas const& gas, Lowe const& thermostat, double dt) {
    return std::exp(-stress_decay(gas, thermostat, dt));
}

double kinetic_viscosity(Gas const& gas, Shardlow const& thermostat, double dt) {
    require_positive({{"kT", gas.kT}});
    return gas.n * gas.kT * dt * correlation_sum(stress_decay(gas, thermostat, dt));
}
double kinetic_viscosity(Gas const& gas, Lowe const& thermostat, double dt) {
    require_positive({{"kT", gas.kT}});
    return gas.n * gas.kT * dt * correlation_sum(stress_decay(gas, thermostat, dt));
}

double kinetic_viscosity_limit(Gas const& gas, Shardlow const& thermostat) {
    require_positive({{"m", gas.m}, {"kT", gas.kT}, {"gamma", thermostat.gamma}});
    return gas.d * gas.m * gas.kT /
           (2.0 * thermostat.gamma * integral_of_weight(gas.d, gas.rc, thermostat.weight));
}
double kinetic_viscosity_limit(Gas const& gas, Lowe const& thermostat) {
    require_positive({{"kT", gas.kT}, {"rc", gas.rc}, {"Gamma", thermostat.Gamma}});
    return gas.kT / (thermostat.Gamma * sphere_volume(gas) * stress_loss(gas.d, lowe_A));
}

double collision_viscosity(Gas const& gas, Shardlow const& thermostat, double dt, PairDistribution const& g) {
    require_positive({{"n", gas.n}});
    auto const A = A_of_distance(gas, thermostat, dt);
    return square(gas.n) * gas.m / (2.0 * dt * gas.d * (gas.d + 2)) *
           integral_over_pairs(gas, g, [&](double r) { return A(r) * r * r; });
}
double collision_viscosity(Gas const& gas, Lowe const& thermostat) {
    require_positive({{"n", gas.n}, {"m", gas.m}, {"rc", gas.rc}, {"Gamma", thermostat.Gamma}});
    double const integral_of_r2 = unit_sphere_surface(gas.d) * std::pow(gas.rc, gas.d + 2) / (gas.d + 2);
    return square(gas.n) * gas.m * thermostat.Gamma * lowe_A / (2.0 * gas.d * (gas.d + 2)) * integral_of_r2;
}

double collision_viscosity_limit(Gas const& gas, Shardlow const& thermostat) {
    require_positive({{"n", gas.n}, {"gamma", thermostat.gamma}});
    return square(gas.n) * thermostat.gamma / (2.0 * gas.d * (gas.d + 2)) *
           integral_of_weight_r2(gas.d, gas.rc, thermostat.weight);
}

double velocity_retention(Gas const& gas, Shardlow const& thermostat, double dt) {
    return std::exp(-velocity_decay(gas, thermostat, dt));
}
double velocity_retention(Gas const& gas, Lowe const& thermostat, double dt) {
    return std::exp(-velocity_decay(gas, thermostat, dt));
}

double velocity_autocorrelation(Gas const& gas, Shardlow const& thermostat, double dt, double t) {
    require_positive({{"kT", gas.kT}});
    if (!(t >= 0.0) || !std::isfinite(t)) throw std::invalid_argument("t must be finite and not negative");
    return gas.kT / gas.m * std::exp(-velocity_decay(gas, thermostat, dt) * t / dt);
}

double diffusion_constant(Gas const& gas, Shardlow const& thermostat, double dt) {
    require_positive({{"kT", gas.kT}});
    return gas.kT * dt / gas.m * correlation_sum(velocity_decay(gas, thermostat, dt));
}
double diffusion_constant(Gas const& gas, Lowe const& thermostat, double dt) {
    require_positive({{"m", gas.m}, {"kT", gas.kT}});
    return gas.kT * dt / gas.m * correlation_sum(velocity_decay(gas, thermostat, dt));
}

double diffusion_constant_limit(Gas const& gas, Shardlow const& thermostat) {
    require_positive({{"n", gas.n}, {"kT", gas.kT}, {"gamma", thermostat.gamma}});
    return gas.d * gas.kT / (gas.n * thermostat.gamma * integral_of_weight(gas.d, gas.rc, thermostat.weight));
}
double diffusion_constant_limit(Gas const& gas, Lowe const& thermostat) {
    require_positive(
        {{"n", gas.n}, {"m", gas.m}, {"kT", gas.kT}, {"rc", gas.rc}, {"Gamma", thermostat.Gamma}});
    return gas.kT / (gas.m * gas.n * thermostat.Gamma * sphere_volume(gas) * velocity_loss(gas.d, lowe_A));
}

double schmidt_number(Gas const& gas, Shardlow const& thermostat, double dt) {
    double const eta = kinetic_viscosity(gas, thermostat, dt) + collision_viscosity(gas, thermostat, dt);
    return eta / (gas.n * gas.m * diffusion_constant(gas, thermostat, dt));
}
double schmidt_number(Gas const& gas, Lowe const& thermostat, double dt) {
    double const eta = kinetic_viscosity(gas, thermostat, dt) + collision_viscosity(gas, thermostat);
    return eta / (gas.n * gas.m * diffusion_constant(gas, thermostat, dt));
}

double relaxation_rate(Gas const& gas, Shardlow const& thermostat, PairDistribution const& g) {
    require_positive({{"n", gas.n}, {"m", gas.m}, {"gamma", thermostat.gamma}});
    return gas.n / (gas.d * gas.m) * integral_over_pairs(gas, g, friction_of_distance(gas, thermostat));
}

double kinetic_viscosity(double n, double kT, double phi_pot, double phi_dpd) {
    require_positive({{"n", n}, {"kT", kT}});
    require_finite({{"phi_pot", phi_pot}, {"phi_dpd", phi_dpd}});
    double const rate = phi_pot + phi_dpd;
    if (!(rate > 0.0)) throw std::domain_error("no kinetic viscosity: phi_pot + phi_dpd is not positive");
    return n * kT / (2.0 * rate);
}

double potential_viscosity(Gas const& gas, Soft const& potential, double phi_pot, PairDistribution const& g) {
    require_finite({{"phi_pot", phi_pot}});
    return phi_pot * viscosity_per_relaxation_rate(gas, potential, g);
}

double potential_relaxation_rate(Gas const& gas, Soft const& potential, double eta_pot,
                                 PairDistribution const& g) {
    require_finite({{"eta_pot", eta_pot}});
    return eta_pot / viscosity_per_relaxation_rate(gas, potential, g);
}

double diffusion_finite_size_correction(double kT, double eta, double L) {
    require_positive({{"kT", kT}, {"eta", eta}, {"L", L}});
    // The Madelung constant of a cubic lattice of point charges in a neutralising background.
    constexpr double cube_constant = 2.837297;
    return cube_constant * kT / (6.0 * std::numbers::pi * eta * L);
}

double velocity_autocorrelation_tail(Gas const& gas, double eta, double D, double t) {
    require_positive({{"t", t}});
    unit_sphere_surface(gas.d);  // checks d
    double const spread = 4.0 * std::numbers::pi * mode_diffusivity(gas, eta, D) * t;
    return (gas.d - 1.0) / gas.d * gas.kT / (gas.n * gas.m) * std::pow(spread, -0.5 * gas.d);
}

double velocity_autocorrelation_tail_in_box(Gas const& gas, double eta, double D, double L, double t) {
    require_positive({{"L", L}, {"t", t}});
    unit_sphere_surface(gas.d);  // checks d
    double const k1 = 2.0 * std::numbers::pi / L;
    // the sum over vectors is a product of sums over components; without the term k = 0 it is (1 + x)^d - 1
    double const modes =
        std::expm1(gas.d * std::log1p(lattice_sum(mode_diffusivity(gas, eta, D) * square(k1) * t)));
    return (gas.d - 1.0) / gas.d * gas.kT / (gas.n * gas.m * std::pow(L, gas.d)) * modes;
}

}  // namespace dpd::theory
