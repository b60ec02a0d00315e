#include "closed_forms.hpp"

#include <array>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/quadrature/tanh_sinh.hpp>
#include <boost/math/special_functions/bessel.hpp>
#include <boost/math/special_functions/sinc.hpp>
#include <boost/math/tools/minima.hpp>
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
// [correlation sum]
double correlation_sum(double rate) { return -1.0 / std::expm1(-rate) - 0.5; }
// [correlation sum]

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
// [pair loss]
double stress_loss(int d, double A) { return 2.0 * A / d - 4.0 * A * A / (d * (d + 2)); }
/// ... and from <v(t).v(0)>.
double velocity_loss(int d, double A) { return A / d; }
// [pair loss]

/// A of Lowe-Andersen: the relative velocity is replaced, 1 - 2A = 0.
constexpr double lowe_A = 0.5;

double sphere_volume(Gas const& gas) { return unit_sphere_surface(gas.d) / gas.d * std::pow(gas.rc, gas.d); }

/// -ln s of one step.
// [stress decay]
double stress_decay(Gas const& gas, Shardlow const& thermostat, double dt) {
    require_positive({{"n", gas.n}});
    auto const A = A_of_distance(gas, thermostat, dt);
    return gas.n * volume_integral(gas.d, gas.rc, [&](double r) { return stress_loss(gas.d, A(r)); });
}
// [stress decay]
double stress_decay(Gas const& gas, Lowe const& thermostat, double dt) {
    require_positive({{"n", gas.n}, {"rc", gas.rc}, {"Gamma", thermostat.Gamma}, {"dt", dt}});
    return gas.n * thermostat.Gamma * dt * sphere_volume(gas) * stress_loss(gas.d, lowe_A);
}

/// -ln of the velocity correlation over one step.
// [velocity decay]
double velocity_decay(Gas const& gas, Shardlow const& thermostat, double dt) {
    require_positive({{"n", gas.n}});
    auto const A = A_of_distance(gas, thermostat, dt);
    return gas.n * volume_integral(gas.d, gas.rc, [&](double r) { return velocity_loss(gas.d, A(r)); });
}
// [velocity decay]
double velocity_decay(Gas const& gas, Lowe const& thermostat, double dt) {
    require_positive({{"n", gas.n}, {"rc", gas.rc}, {"Gamma", thermostat.Gamma}, {"dt", dt}});
    return gas.n * thermostat.Gamma * dt * sphere_volume(gas) * velocity_loss(gas.d, lowe_A);
}

/// eta_pot/phi_pot of NG2007 eq. 16.
// [friction as potential]
double viscosity_per_relaxation_rate(Gas const& gas, Soft const& potential, PairDistribution const& g) {
    require_positive({{"n", gas.n}, {"m", gas.m}, {"a", potential.a}});
    // a kT/rc, the factor that all forces have in common, cancels
    auto const f = [rc = gas.rc](double r) { return 1.0 - r / rc; };
    double const force = integral_over_pairs(gas, g, f);
    if (!(force > 0.0)) throw std::domain_error("no potential viscosity: g(r) has no pair within the range");
    double const force_r2 = integral_over_pairs(gas, g, [&](double r) { return f(r) * r * r; });
    return gas.n * gas.m * force_r2 / (2.0 * (gas.d + 2) * force);
}
// [friction as potential]

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

/// F r of the force a (1 - r/rc), integrated over the pairs.
double integral_of_force_times_distance(Gas const& gas, double a, PairDistribution const& g) {
    require_positive({{"a", a}});
    return integral_over_pairs(gas, g, [=, rc = gas.rc](double r) { return a * (1.0 - r / rc) * r; });
}

/// alpha a rc^4 n of Groot & Warren: what the repulsion adds to kT in p/n, and half of what it adds in dp/dn.
double groot_warren_energy(Gas const& gas, double a, double alpha) {
    require_positive({{"n", gas.n}, {"kT", gas.kT}, {"rc", gas.rc}, {"a", a}, {"alpha", alpha}});
    if (gas.d != 3) throw std::domain_error("Groot and Warren's alpha was fitted for d = 3 only");
    return alpha * a * square(square(gas.rc)) * gas.n;
}

void require_inside(double L, double z) {
    require_positive({{"L", L}});
    if (!(z >= 0.0 && z <= L)) throw std::invalid_argument("z must be between 0 and L");
}

/// (sigma/r)^6.
double inverse_sixth(LennardJones const& lj, double r) {
    double const square_ratio = square(lj.sigma / r);
    return square_ratio * square_ratio * square_ratio;
}
double full_energy(LennardJones const& lj, double r) {
    double const s6 = inverse_sixth(lj, r);
    return 4.0 * lj.epsilon * s6 * (s6 - 1.0);
}
double full_force(LennardJones const& lj, double r) {
    double const s6 = inverse_sixth(lj, r);
    return 24.0 * lj.epsilon * s6 * (2.0 * s6 - 1.0) / r;
}

/// Whether r is inside the cut-off, after a check of the arguments.
bool inside(LennardJones const& lj, double r) {
    require_positive({{"epsilon", lj.epsilon}, {"sigma", lj.sigma}, {"r", r}});
    if (!(lj.rc > 0.0)) throw std::invalid_argument("rc must be positive");
    return r < lj.rc;
}

/// 8 pi epsilon sigma^3/3 and (sigma/rc)^3, which the corrections for the cut-off share.
struct TailFactors {
    double scale, s3;
};
// [tail factors]
TailFactors tail_factors(LennardJones const& lj, double n) {
    require_positive({{"epsilon", lj.epsilon}, {"sigma", lj.sigma}, {"rc", lj.rc}, {"n", n}});
    double const sigma3 = lj.sigma * lj.sigma * lj.sigma;
    return {8.0 * std::numbers::pi / 3.0 * lj.epsilon * sigma3, sigma3 / (lj.rc * lj.rc * lj.rc)};
}
// [tail factors]

/// The equation of state of Kolafa & Nezbeda 1994: hard spheres of a diameter that depends on the
/// temperature, a term that makes the second virial coefficient right, and a fitted polynomial.
namespace kolafa_nezbeda {

/// factor T^(half_power/2) n^density_power
struct Term {
    int half_power, density_power;
    double factor;
};

constexpr double gamma = 1.92907278;

constexpr std::array<Term, 4> diameter_terms{
    {{-2, 0, 0.011117524}, {-1, 0, -0.076383859}, {0, 0, 1.080142248}, {1, 0, 0.000693129}}};
constexpr double diameter_logarithm = -0.063920968;

/// Second virial coefficient less that of the hard spheres.
constexpr std::array<Term, 7> virial_terms{{{-7, 0, -0.58544978},
                                            {-6, 0, 0.43102052},
                                            {-5, 0, 0.87361369},
                                            {-4, 0, -4.13749995},
                                            {-3, 0, 2.90616279},
                                            {-2, 0, -7.02181962},
                                            {0, 0, 0.02459877}}};

/// Helmholtz energy per particle.
constexpr std::array<Term, 19> polynomial{{{0, 2, 2.01546797},
                                           {0, 3, -28.17881636},
                                           {0, 4, 28.28313847},
                                           {0, 5, -10.42402873},
                                           {-1, 2, -19.58371655},
                                           {-1, 3, 75.62340289},
                                           {-1, 4, -120.70586598},
                                           {-1, 5, 93.92740328},
                                           {-1, 6, -27.37737354},
                                           {-2, 2, 29.34470520},
                                           {-2, 3, -112.35356937},
                                           {-2, 4, 170.64908980},
                                           {-2, 5, -123.06669187},
                                           {-2, 6, 34.42288969},
                                           {-4, 2, -13.37031968},
                                           {-4, 3, 65.38059570},
                                           {-4, 4, -115.09233113},
                                           {-4, 5, 88.91973082},
                                           {-4, 6, -25.62099890}}};

/// A sum of powers of T and T times its derivative.
struct Value {
    double value = 0.0, T_derivative = 0.0;
};
template <std::size_t size>
Value sum_of_powers(std::array<Term, size> const& terms, double kT) {
    Value sum;
    for (auto const& term : terms) {
        double const part = term.factor * std::pow(kT, 0.5 * term.half_power);
        sum.value += part;
        sum.T_derivative += 0.5 * term.half_power * part;
    }
    return sum;
}

Value diameter(double kT) {
    auto sum = sum_of_powers(diameter_terms, kT);
    sum.value += diameter_logarithm * std::log(kT);
    sum.T_derivative += diameter_logarithm;
    return sum;
}

/// Packing fraction of the hard spheres, after a check of the arguments.
double packing(double n, double kT) {
    require_positive({{"n", n}, {"kT", kT}});
    double const d = diameter(kT).value;
    double const eta = std::numbers::pi / 6.0 * n * d * d * d;
    if (!(d > 0.0 && eta < 1.0))
        throw std::domain_error("no fluid: the packing fraction of the hard spheres is outside (0, 1)");
    return eta;
}

/// p/(n kT) of the hard spheres, and its derivative with respect to eta.
double hard_spheres(double eta) {
    double const free = 1.0 - eta;
    return (1.0 + eta * (1.0 + eta * (1.0 - 2.0 / 3.0 * eta * (1.0 + eta)))) / (free * free * free);
}
double hard_spheres_slope(double eta) {
    double const free = 1.0 - eta;
    return (1.0 + eta * (2.0 - eta * (2.0 + 8.0 / 3.0 * eta))) / (free * free * free) +
           3.0 * hard_spheres(eta) / free;
}

}  // namespace kolafa_nezbeda

}  // namespace

double unit_sphere_surface(int d) {
    if (d == 2) return 2.0 * std::numbers::pi;
    if (d == 3) return 4.0 * std::numbers::pi;
    throw std::invalid_argument("d must be 2 or 3");
}

// [volume integral]
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
// [volume integral]

// [explicit integrals]
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
// [explicit integrals]

// [explicit temperature]
double temperature_at_finite_step(ExplicitDpd const& fluid, double dt) {
    require_positive({{"n", fluid.n}, {"dt", dt}});
    double const a1 = A1(fluid);
    double const damping = a1 * (2.0 - a1 * fluid.n * dt) - A2(fluid) * dt;
    if (!(damping > 0.0))
        throw std::domain_error("no temperature: the step dt is at or beyond the critical step " +
                                std::to_string(critical_step(fluid)) + " (my25)");
    return A3(fluid) / (fluid.m * damping);
}
// [explicit temperature]

// [frozen neighbours]
double temperature_with_frozen_neighbours(ExplicitDpd const& fluid, double dt) {
    require_positive({{"n", fluid.n}, {"dt", dt}});
    if (fluid.random_weight)
        throw std::domain_error(
            "frozen neighbours have one temperature for matched weights only, w_R^2 = w_D");
    double const a1 = A1(fluid);
    return A3(fluid) / (2.0 * fluid.m * a1) * (1.0 + 0.5 * fluid.n * a1 * dt);
}
// [frozen neighbours]

// [critical]
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
// [critical]

double stress_retention(Gas const& gas, Shardlow const& thermostat, double dt) {
    return std::exp(-stress_decay(gas, thermostat, dt));
}
double stress_retention(Gas const& gas, Lowe const& thermostat, double dt) {
    return std::exp(-stress_decay(gas, thermostat, dt));
}

// [kinetic viscosity]
double kinetic_viscosity(Gas const& gas, Shardlow const& thermostat, double dt) {
    require_positive({{"kT", gas.kT}});
    return gas.n * gas.kT * dt * correlation_sum(stress_decay(gas, thermostat, dt));
}
// [kinetic viscosity]
double kinetic_viscosity(Gas const& gas, Lowe const& thermostat, double dt) {
    require_positive({{"kT", gas.kT}});
    return gas.n * gas.kT * dt * correlation_sum(stress_decay(gas, thermostat, dt));
}

// [kinetic limit]
double kinetic_viscosity_limit(Gas const& gas, Shardlow const& thermostat) {
    require_positive({{"m", gas.m}, {"kT", gas.kT}, {"gamma", thermostat.gamma}});
    return gas.d * gas.m * gas.kT /
           (2.0 * thermostat.gamma * integral_of_weight(gas.d, gas.rc, thermostat.weight));
}
// [kinetic limit]
double kinetic_viscosity_limit(Gas const& gas, Lowe const& thermostat) {
    require_positive({{"kT", gas.kT}, {"rc", gas.rc}, {"Gamma", thermostat.Gamma}});
    return gas.kT / (thermostat.Gamma * sphere_volume(gas) * stress_loss(gas.d, lowe_A));
}

// [collision viscosity]
double collision_viscosity(Gas const& gas, Shardlow const& thermostat, double dt, PairDistribution const& g) {
    require_positive({{"n", gas.n}});
    auto const A = A_of_distance(gas, thermostat, dt);
    return square(gas.n) * gas.m / (2.0 * dt * gas.d * (gas.d + 2)) *
           integral_over_pairs(gas, g, [&](double r) { return A(r) * r * r; });
}
// [collision viscosity]
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

// [correlation]
double velocity_autocorrelation(Gas const& gas, Shardlow const& thermostat, double dt, double t) {
    require_positive({{"kT", gas.kT}});
    if (!(t >= 0.0) || !std::isfinite(t)) throw std::invalid_argument("t must be finite and not negative");
    return gas.kT / gas.m * std::exp(-velocity_decay(gas, thermostat, dt) * t / dt);
}
// [correlation]

// [diffusion]
double diffusion_constant(Gas const& gas, Shardlow const& thermostat, double dt) {
    require_positive({{"kT", gas.kT}});
    return gas.kT * dt / gas.m * correlation_sum(velocity_decay(gas, thermostat, dt));
}
// [diffusion]
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

// [schmidt]
double schmidt_number(Gas const& gas, Shardlow const& thermostat, double dt) {
    double const eta = kinetic_viscosity(gas, thermostat, dt) + collision_viscosity(gas, thermostat, dt);
    return eta / (gas.n * gas.m * diffusion_constant(gas, thermostat, dt));
}
// [schmidt]
double schmidt_number(Gas const& gas, Lowe const& thermostat, double dt) {
    double const eta = kinetic_viscosity(gas, thermostat, dt) + collision_viscosity(gas, thermostat);
    return eta / (gas.n * gas.m * diffusion_constant(gas, thermostat, dt));
}

// [relaxation rate]
double relaxation_rate(Gas const& gas, Shardlow const& thermostat, PairDistribution const& g) {
    require_positive({{"n", gas.n}, {"m", gas.m}, {"gamma", thermostat.gamma}});
    return gas.n / (gas.d * gas.m) * integral_over_pairs(gas, g, friction_of_distance(gas, thermostat));
}
// [relaxation rate]

// [two rates]
double kinetic_viscosity(double n, double kT, double phi_pot, double phi_dpd) {
    require_positive({{"n", n}, {"kT", kT}});
    require_finite({{"phi_pot", phi_pot}, {"phi_dpd", phi_dpd}});
    double const rate = phi_pot + phi_dpd;
    if (!(rate > 0.0)) throw std::domain_error("no kinetic viscosity: phi_pot + phi_dpd is not positive");
    return n * kT / (2.0 * rate);
}
// [two rates]

double potential_viscosity(Gas const& gas, Soft const& potential, double phi_pot, PairDistribution const& g) {
    require_finite({{"phi_pot", phi_pot}});
    return phi_pot * viscosity_per_relaxation_rate(gas, potential, g);
}

double potential_relaxation_rate(Gas const& gas, Soft const& potential, double eta_pot,
                                 PairDistribution const& g) {
    require_finite({{"eta_pot", eta_pot}});
    return eta_pot / viscosity_per_relaxation_rate(gas, potential, g);
}

// [random phase]
double random_phase_frequency(Gas const& gas, double a, double k) {
    require_positive({{"n", gas.n}, {"m", gas.m}, {"rc", gas.rc}, {"a", a}, {"k", k}});
    double const q = k * gas.rc;
    // U_k in units of a rc^(d+1); the average of a plane wave over directions is J_0 or sin(x)/x
    double const transform = volume_integral(gas.d, 1.0, [&](double x) {
        double const wave = gas.d == 2 ? boost::math::cyl_bessel_j(0, q * x) : boost::math::sinc_pi(q * x);
        return 0.5 * square(1.0 - x) * wave;
    });
    return std::sqrt(gas.n * std::pow(gas.rc, gas.d - 1) * a / gas.m * square(q) * transform);
}

double harmonic_limit(Gas const& gas, double a) {
    constexpr double lowest = 1.0, highest = 12.0, spacing = 0.5;  // in k rc; the maximum is near 4
    constexpr int bits = 30;
    auto const minus_frequency = [&](double q) { return -random_phase_frequency(gas, a, q / gas.rc); };
    double at = lowest;
    for (double q = lowest; q <= highest; q += spacing)
        if (minus_frequency(q) < minus_frequency(at)) at = q;
    return -2.0 /
           boost::math::tools::brent_find_minima(minus_frequency, at - spacing, at + spacing, bits).second;
}
// [random phase]

double diffusion_finite_size_correction(double kT, double eta, double L) {
    require_positive({{"kT", kT}, {"eta", eta}, {"L", L}});
    // The Madelung constant of a cubic lattice of point charges in a neutralising background.
    constexpr double cube_constant = 2.837297;
    return cube_constant * kT / (6.0 * std::numbers::pi * eta * L);
}

// [tail]
double velocity_autocorrelation_tail(Gas const& gas, double eta, double D, double t) {
    require_positive({{"t", t}});
    unit_sphere_surface(gas.d);  // checks d
    double const spread = 4.0 * std::numbers::pi * mode_diffusivity(gas, eta, D) * t;
    return (gas.d - 1.0) / gas.d * gas.kT / (gas.n * gas.m) * std::pow(spread, -0.5 * gas.d);
}
// [tail]

double velocity_autocorrelation_tail_in_box(Gas const& gas, double eta, double D, double L, double t) {
    require_positive({{"L", L}, {"t", t}});
    unit_sphere_surface(gas.d);  // checks d
    double const k1 = 2.0 * std::numbers::pi / L;
    // the sum over vectors is a product of sums over components; without the term k = 0 it is (1 + x)^d - 1
    double const modes =
        std::expm1(gas.d * std::log1p(lattice_sum(mode_diffusivity(gas, eta, D) * square(k1) * t)));
    return (gas.d - 1.0) / gas.d * gas.kT / (gas.n * gas.m * std::pow(L, gas.d)) * modes;
}

// [units]
double particle_mass(CoarseGraining const& map, double m) {
    require_positive({{"Nm", map.Nm}, {"m", m}});
    return m * map.Nm;
}

double cutoff_radius(CoarseGraining const& map) {
    require_positive({{"Nm", map.Nm}, {"n", map.n}, {"n_md", map.n_md}});
    return std::cbrt(map.Nm * map.n / map.n_md);
}
// [units]

double length_in_dpd_units(CoarseGraining const& map, double length) {
    require_positive({{"length", length}});
    return length / cutoff_radius(map);
}

// [conservative coefficient]
double conservative_coefficient(CoarseGraining const& map, double kT) {
    require_positive({{"Nm", map.Nm},
                      {"n", map.n},
                      {"inverse_compressibility", map.inverse_compressibility},
                      {"alpha", map.alpha},
                      {"kT", kT}});
    double const excess = map.inverse_compressibility * map.Nm - 1.0;
    if (excess < 0.0)
        throw std::domain_error(
            "no repulsion: the fluid of the atoms is more compressible than an ideal gas of the particles");
    return kT * excess / (2.0 * map.alpha * map.n);
}
// [conservative coefficient]

double atoms_per_particle(CoarseGraining const& map, double a, double kT) {
    require_positive({{"inverse_compressibility", map.inverse_compressibility}});
    return groot_warren_inverse_compressibility({.n = map.n, .kT = kT}, a, map.alpha) /
           map.inverse_compressibility;
}

// [time unit]
double time_unit(CoarseGraining const& map, double eta) {
    require_positive({{"eta", eta}, {"eta_md", map.eta_md}});
    double const rc = cutoff_radius(map);  // checks the densities
    return (eta / map.n) / (map.eta_md / map.n_md) * rc * rc;
}

double force_in_dpd_units(CoarseGraining const& map, double eta, double force) {
    require_positive({{"force", force}});
    // Nm atoms feel it and the unit of mass is Nm atoms: Nm cancels
    return force * square(time_unit(map, eta)) / cutoff_radius(map);
}

double temperature_in_md_units(CoarseGraining const& map, double eta, double kT) {
    require_positive({{"kT", kT}});
    return kT * map.Nm * square(cutoff_radius(map) / time_unit(map, eta));
}
// [time unit]

// [mach number]
double mach_number(CoarseGraining const& map, double eta, double kT, double force, double L) {
    double const u_max = poiseuille_maximum_velocity(map.n, force_in_dpd_units(map, eta, force), eta,
                                                     length_in_dpd_units(map, L));
    double const a = conservative_coefficient(map, kT);
    return u_max / groot_warren_sound_speed({.n = map.n, .kT = kT}, a, map.alpha);
}
// [mach number]

// [speed up]
double speed_up(double Nm) {
    require_positive({{"Nm", Nm}});
    constexpr double soft_potentials = 1000.0;  // PK2006, after Groot & Rabone
    return soft_potentials * std::pow(Nm, 8.0 / 3.0);
}
// [speed up]

// [matched friction]
double matched_friction(double sigma, double kT) {
    require_positive({{"sigma", sigma}, {"kT", kT}});
    return square(sigma) / (2.0 * kT);
}
// [matched friction]

double repulsion_constant(Gas const& gas, PairDistribution const& g) {
    return integral_of_force_times_distance(gas, 1.0, g) / (2.0 * gas.d * std::pow(gas.rc, gas.d + 1));
}

// [pressure]
double virial_pressure(Gas const& gas, double a, PairDistribution const& g) {
    require_positive({{"n", gas.n}, {"kT", gas.kT}});
    return gas.n * gas.kT + square(gas.n) / (2.0 * gas.d) * integral_of_force_times_distance(gas, a, g);
}

double virial_sound_speed(Gas const& gas, double a, PairDistribution const& g) {
    require_positive({{"n", gas.n}, {"m", gas.m}, {"kT", gas.kT}});
    return std::sqrt((gas.kT + gas.n / gas.d * integral_of_force_times_distance(gas, a, g)) / gas.m);
}
// [pressure]

double groot_warren_pressure(Gas const& gas, double a, double alpha) {
    return gas.n * (gas.kT + groot_warren_energy(gas, a, alpha));
}

double groot_warren_inverse_compressibility(Gas const& gas, double a, double alpha) {
    return 1.0 + 2.0 * groot_warren_energy(gas, a, alpha) / gas.kT;
}

double groot_warren_sound_speed(Gas const& gas, double a, double alpha) {
    require_positive({{"m", gas.m}});
    return std::sqrt(gas.kT / gas.m * groot_warren_inverse_compressibility(gas, a, alpha));
}

// [displacement]
double diffusion_from_displacement(int d, double msd, double t) {
    require_positive({{"msd", msd}, {"t", t}});
    unit_sphere_surface(d);  // checks d
    return msd / (2.0 * d * t);
}

double pair_distribution_in_shell(int d, double n, double neighbours, double r_min, double r_max) {
    require_positive({{"n", n}, {"neighbours", neighbours}, {"r_max", r_max}});
    if (!(r_min >= 0.0 && r_min < r_max)) throw std::invalid_argument("r_min must be in [0, r_max)");
    return neighbours / (n * unit_sphere_surface(d) / d * (std::pow(r_max, d) - std::pow(r_min, d)));
}
// [displacement]

// [poiseuille]
double poiseuille_velocity(double n, double force, double eta, double L, double z) {
    require_positive({{"n", n}, {"force", force}, {"eta", eta}});
    require_inside(L, z);
    return n * force / (2.0 * eta) * z * (L - z);
}
// [poiseuille]

double poiseuille_maximum_velocity(double n, double force, double eta, double L) {
    return poiseuille_velocity(n, force, eta, L, 0.5 * L);
}

// [power law]
double power_law_velocity(double u_max, double index, double L, double z) {
    require_positive({{"u_max", u_max}, {"index", index}});
    require_inside(L, z);
    return u_max * (1.0 - std::pow(std::abs(1.0 - 2.0 * z / L), 1.0 / index + 1.0));
}
// [power law]

double schmidt_number(double eta, double n, double m, double D) {
    require_positive({{"eta", eta}, {"n", n}, {"m", m}, {"D", D}});
    return eta / (n * m * D);
}

double lennard_jones_energy(LennardJones const& lj, double r) {
    if (!inside(lj, r)) return 0.0;
    double energy = full_energy(lj, r);
    if (!std::isfinite(lj.rc) || lj.truncation == Truncation::none) return energy;
    energy -= full_energy(lj, lj.rc);
    if (lj.truncation == Truncation::linear_force) energy += (r - lj.rc) * full_force(lj, lj.rc);
    return energy;
}

double lennard_jones_force(LennardJones const& lj, double r) {
    if (!inside(lj, r)) return 0.0;
    double const force = full_force(lj, r);
    bool const shifted = std::isfinite(lj.rc) && lj.truncation == Truncation::linear_force;
    return shifted ? force - full_force(lj, lj.rc) : force;
}

double lennard_jones_curvature(LennardJones const& lj, double r) {
    if (!inside(lj, r)) return 0.0;
    double const s6 = inverse_sixth(lj, r);
    return 24.0 * lj.epsilon * s6 * (26.0 * s6 - 7.0) / square(r);
}

// [tails]
double lennard_jones_tail_energy(LennardJones const& lj, double n) {
    auto const [scale, s3] = tail_factors(lj, n);
    return scale * n * s3 * (square(s3) / 3.0 - 1.0);
}

double lennard_jones_tail_pressure(LennardJones const& lj, double n) {
    auto const [scale, s3] = tail_factors(lj, n);
    return 2.0 * scale * square(n) * s3 * (2.0 / 3.0 * square(s3) - 1.0);
}

double lennard_jones_jump_pressure(LennardJones const& lj, double n) {
    auto const [scale, s3] = tail_factors(lj, n);
    return scale * square(n) * s3 * (square(s3) - 1.0);
}
// [tails]

// [equation of state]
double lennard_jones_pressure(double n, double kT) {
    using namespace kolafa_nezbeda;
    double sum = n * kT * hard_spheres(packing(n, kT));
    double const n2 = square(n);
    sum += kT * sum_of_powers(virial_terms, kT).value * n2 * (1.0 - 2.0 * gamma * n2) * std::exp(-gamma * n2);
    for (auto const& [half_power, k, factor] : polynomial)
        sum += k * factor * std::pow(kT, 0.5 * half_power) * std::pow(n, k + 1);
    return sum;
}
// [equation of state]

double lennard_jones_internal_energy(double n, double kT) {
    using namespace kolafa_nezbeda;
    // a - T da/dT = -T^2 d(a/T)/dT for each part of the Helmholtz energy a
    auto const d = diameter(kT);
    double sum = -3.0 * kT * (hard_spheres(packing(n, kT)) - 1.0) * d.T_derivative / d.value;
    sum -= kT * sum_of_powers(virial_terms, kT).T_derivative * n * std::exp(-gamma * square(n));
    for (auto const& [half_power, k, factor] : polynomial)
        sum += (1.0 - 0.5 * half_power) * factor * std::pow(kT, 0.5 * half_power) * std::pow(n, k);
    return sum;
}

double lennard_jones_inverse_compressibility(double n, double kT) {
    using namespace kolafa_nezbeda;
    double const eta = packing(n, kT), n2 = square(n);
    double sum = hard_spheres(eta) + eta * hard_spheres_slope(eta);
    sum += 2.0 * n * sum_of_powers(virial_terms, kT).value * std::exp(-gamma * n2) *
           (1.0 - gamma * n2 * (5.0 - 2.0 * gamma * n2));
    for (auto const& [half_power, k, factor] : polynomial)
        sum += k * (k + 1) * factor * std::pow(kT, 0.5 * half_power - 1.0) * std::pow(n, k);
    return sum;
}

}  // namespace dpd::theory
