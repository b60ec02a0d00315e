#include "memory.hpp"

#include <algorithm>
#include <array>
#include <boost/math/quadrature/exp_sinh.hpp>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/special_functions/bessel.hpp>
#include <boost/math/special_functions/sinc.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <complex>
#include <cstdint>
#include <initializer_list>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "encounter.hpp"

namespace dpd::theory {
namespace {

using Complex = std::complex<double>;

double square(double x) { return x * x; }

// -----------------------------------------------------------------------------------------------------------
// Collective part; lengths in rc, velocities in (kT/m)^(1/2)

/// Something for currents across the wave vector and for those along it.
template <class Number>
struct Parts {
    Number transverse, longitudinal;
};

/// s_k: the friction tensor w r^ r^ at the wave number k over that at 0.
// [sharing]
Parts<double> sharing(int d, Weight weight, double k) {
    // averages over directions of exp(i k.r) times the squares of the components of r^
    auto const across = [=](double x) {
        if (x < 1e-2) return (1.0 - x * x / (2.0 * (d + 2.0)) * (1.0 - x * x / (4.0 * (d + 4.0)))) / d;
        return d == 2 ? boost::math::cyl_bessel_j(1, x) / x : boost::math::sph_bessel(1, x) / x;
    };
    auto const all = [=](double x) {
        return d == 2 ? boost::math::cyl_bessel_j(0, x) : boost::math::sinc_pi(x);
    };
    auto const w = [=](double r) { return weight_at(weight, r); };
    double const transverse = volume_integral(d, 1.0, [&](double r) { return w(r) * across(k * r); });
    double const both = volume_integral(d, 1.0, [&](double r) { return w(r) * all(k * r); });
    double const at_zero = volume_integral(d, 1.0, w) / d;
    return {transverse / at_zero, (both - (d - 1) * transverse) / at_zero};
}
// [sharing]

/// Laplace transforms at z of what a particle of friction zeta keeps for itself: E, the correlation of exp(i
/// k.r), and Phi_s, that of its current. Brinkman's continued fraction.
struct SingleParticle {
    Complex density;
    Parts<Complex> current;
};
// [single particle]
SingleParticle single_particle(double zeta, double k, Complex z) {
    constexpr int depth = 60;
    double const k2 = square(k);
    struct Fraction {
        Complex density, along;
    };
    auto const fraction = [&](Complex at) {
        // below the last level kept, the fraction repeats itself
        Complex const last = at + depth * zeta;
        Complex level = 2.0 / (last + std::sqrt(last * last + 4.0 * (depth + 1.0) * k2));
        for (int j = depth - 1; j >= 1; --j)
            level = 1.0 / (at + static_cast<double>(j) * zeta + (j + 1.0) * k2 * level);
        return Fraction{1.0 / (at + k2 * level), level};
    };
    Fraction const here = fraction(z);
    return {here.density, {fraction(z + zeta).density, z * here.along * here.density}};
}
// [single particle]

/// What one wave of the fluid does, as integrals over time that Parseval's theorem takes to frequencies.
class Wave {
public:
    Wave(int d, Weight weight, double zeta, double k)
        : d_(d), zeta_(zeta), k_(k), share_(sharing(d, weight, k)) {}

    // [returned]
    /// Momentum that comes back to a particle, as a share of what it has lost.
    double friction() const {
        return returned() * over_time([&](SingleParticle const& single) {
                   return product(others(single).transverse, single.density);
               });
    }
    /// The same while the particle still has the other factor of v_x v_y.
    double own_stress() const {
        return returned() * over_time([&](SingleParticle const& single) {
                   return product(others(single).transverse, single.current.transverse);
               });
    }
    /// v_x v_y of the others, beyond what each gets straight from the particle.
    double others_stress() const {
        return 2.0 * zeta_ * over_time([&](SingleParticle const& single) {
                   return stress(others(single)) - stress(straight(single));
               });
    }
    // [returned]

private:
    static double product(Complex a, Complex b) { return std::real(a * std::conj(b)); }

    // [current]
    /// Current of the others for one of the particle: handed over once ...
    Parts<Complex> straight(SingleParticle const& single) const {
        auto const [across, along] = single.current;
        return {zeta_ * share_.transverse * across * across, zeta_ * share_.longitudinal * along * along};
    }
    /// ... or any number of times, Phi - Phi_s.
    Parts<Complex> others(SingleParticle const& single) const {
        auto const once = straight(single);
        auto const [across, along] = single.current;
        return {once.transverse / (1.0 - zeta_ * share_.transverse * across),
                once.longitudinal / (1.0 - zeta_ * share_.longitudinal * along)};
    }
    // [current]

    /// \f$\langle\Phi_{xx}\Phi_{yy}+\Phi_{xy}\Phi_{yx}\rangle\f$ over the directions of the wave.
    double stress(Parts<Complex> const& phi) const {
        Complex const a = phi.transverse, c = phi.longitudinal - a;
        return product(a, a) + 2.0 / d_ * product(a, c) + 2.0 / (d_ * (d_ + 2.0)) * product(c, c);
    }

    double returned() const { return zeta_ * square(share_.transverse) * (d_ - 1.0) / d_; }

    template <class Integrand>
    double over_time(Integrand const& integrand) const {
        thread_local boost::math::quadrature::exp_sinh<double> integrator(9);
        constexpr double tolerance = 1e-7;
        // the frequencies that count fall with k^2, as diffusion has it
        double const scale = zeta_ * std::min(1.0, square(k_));
        auto const at = [&](double x) {
            return integrand(single_particle(zeta_, k_, Complex(0.0, scale * x)));
        };
        return scale / std::numbers::pi * integrator.integrate(at, tolerance);
    }

    int d_;
    double zeta_, k_;
    Parts<double> share_;
};

/// Beyond, nothing is shared: s_k^3 is below 1e-6 for every weight.
constexpr double largest_k = 24.0;

/// The integral of a function of the wave number over all wave vectors, or the sum over those of a periodic
/// square or cube but 0, per volume. The function falls as k^-2 from k = 0 and is smooth otherwise.
template <class Function>
double over_waves(int d, double box, Function const& function) {
    using Gauss = boost::math::quadrature::gauss<double, 10>;  // holds the nodes >= 0 only
    // A smooth step at few wave numbers of the box: below, the vectors are summed; above, the sum is an
    // integral (Poisson; the error is exp(-(1.5 pi)^2)). Of that the wave 0 is taken away again.
    double const k1 = std::isfinite(box) ? 2.0 * std::numbers::pi / box : 0.0;
    double const step = 1.5 * k1;
    auto const below = [=](double k) { return step > 0.0 ? std::exp(-square(k / step)) : 0.0; };
    std::vector<double> ends{0.0, step > 0.0 ? 2.0 * step : 2.0};
    while (ends.back() < largest_k) ends.push_back(std::min(2.3 * ends.back(), largest_k));
    double sum = 0.0;
    for (std::size_t part = 0; part + 1 < ends.size(); ++part)
        for (std::size_t g = 0; g < Gauss::abscissa().size(); ++g)
            for (double const sign : {-1.0, 1.0}) {
                double const half = 0.5 * (ends[part + 1] - ends[part]);
                double const k = ends[part] + half * (1.0 + sign * Gauss::abscissa()[g]);
                double const density =
                    unit_sphere_surface(d) * std::pow(k, d - 1) / std::pow(2.0 * std::numbers::pi, d);
                sum += half * Gauss::weights()[g] * density * (1.0 - below(k)) * function(k);
            }
    if (step == 0.0) return sum;
    double const volume = std::pow(box, d), first = 0.2 * k1;
    sum -= square(first) * function(first) / (square(step) * volume);
    constexpr int largest = 8;                         // exp(-(8/1.5)^2) = 4e-13
    std::array<int, largest * largest + 1> vectors{};  // of each squared length
    int const depth = d == 2 ? 0 : largest;
    for (int x = -largest; x <= largest; ++x)
        for (int y = -largest; y <= largest; ++y)
            for (int z = -depth; z <= depth; ++z)
                if (int const squared = x * x + y * y + z * z; squared > 0 && squared <= largest * largest)
                    ++vectors[static_cast<std::size_t>(squared)];
    for (std::size_t squared = 1; squared < vectors.size(); ++squared)
        if (vectors[squared] > 0) {
            double const k = k1 * std::sqrt(static_cast<double>(squared));
            sum += vectors[squared] * below(k) * function(k) / volume;
        }
    return sum;
}

void check_box(int d, double box) {
    if (d == 2 && !std::isfinite(box))
        throw std::domain_error(
            "in two dimensions the coefficients of an infinite fluid diverge; give the side of a periodic "
            "box");
}

double returned_friction(int d, double n, Weight weight, double zeta, double box) {
    return over_waves(d, box, [=](double k) { return Wave(d, weight, zeta, k).friction(); }) / n;
}
double returned_own_stress(int d, double n, Weight weight, double zeta, double box) {
    return over_waves(d, box, [=](double k) { return Wave(d, weight, zeta, k).own_stress(); }) / n;
}
double returned_others_stress(int d, double n, Weight weight, double zeta, double box) {
    return over_waves(d, box, [=](double k) { return Wave(d, weight, zeta, k).others_stress(); }) / n;
}

// -----------------------------------------------------------------------------------------------------------
// Closure; m = kT = rc = 1

/// A number that gets better with the degree of the polynomials.
class Sequence {
public:
    void add(double value) { values_.push_back(value); }
    /// What the last three tend to, if they close in like a geometric series (Aitken); otherwise the last.
    double limit() const { return limit(values_.size()); }
    /// By how much the last one has changed it.
    double change() const { return std::abs(limit() - limit(values_.size() - 1)); }

private:
    double limit(std::size_t count) const {
        double const last = values_[count - 1];
        if (count < 3) return last;
        double const step = last - values_[count - 2], before = values_[count - 2] - values_[count - 3];
        constexpr double slowest = 0.7;
        bool const closes_in = before != 0.0 && step / before > 0.0 && step / before < slowest;
        return closes_in ? last + step * step / (before - step) : last;
    }
    std::vector<double> values_;
};

struct Converged {
    double value, error;
};

constexpr int lowest_degree = 6, degree_step = 4, highest_degree = 18;
constexpr double wanted = 3e-5;  ///< relative change at which a refinement is the last

/// The gas in units of its own.
struct Reduced {
    int d;
    double n;
    Weight weight;
    double friction, box;

    double friction_at_once() const {
        return n / d * friction * volume_integral(d, 1.0, [this](double r) { return weight_at(weight, r); });
    }
    double collision_viscosity_at_once() const {
        return square(n) / (2.0 * d * (d + 2.0)) * friction *
               volume_integral(d, 1.0, [this](double r) { return weight_at(weight, r) * r * r; });
    }
    Encounter pair(double zeta) const { return {d, weight, friction, zeta}; }
    double returned_friction(double zeta) const { return theory::returned_friction(d, n, weight, zeta, box); }
};

/// Friction that a particle feels from partners, each of whom it meets as in an encounter. @eq{NG2007,17}
/// less what one partner hands back.
// [pair friction]
double pair_friction(Reduced const& gas, double zeta, int degree) {
    return gas.friction_at_once() - gas.n / gas.d * force_memory(gas.pair(zeta), degree).mean();
}
// [pair friction]

/// The friction zeta that a particle feels, in a medium of particles that feel the same.
// [self-consistency]
Converged self_consistent_friction(Reduced const& gas) {
    double const at_once = gas.friction_at_once();
    auto const excess = [&](double zeta, int degree) {
        return pair_friction(gas, zeta, degree) - zeta * (1.0 + gas.returned_friction(zeta));
    };
    // with few polynomials between bounds ...
    constexpr double smallest = 0.02;
    constexpr int bits = 14;
    std::uintmax_t evaluations = 50;
    auto const coarse = [&](double zeta) { return excess(zeta, lowest_degree); };
    auto const [low, high] = boost::math::tools::toms748_solve(
        coarse, smallest * at_once, at_once, boost::math::tools::eps_tolerance<double>(bits), evaluations);
    double zeta = 0.5 * (low + high);
    // ... then with more, which changes little, along the slope of the coarse one
    constexpr double interval = 0.01;
    double const slope =
        (coarse(zeta * (1.0 + interval)) - coarse(zeta * (1.0 - interval))) / (2.0 * interval * zeta);
    Sequence sequence;
    sequence.add(zeta);
    for (int degree = lowest_degree + degree_step; degree <= highest_degree; degree += degree_step) {
        zeta -= excess(zeta, degree) / slope;
        sequence.add(zeta);
        if (sequence.change() < wanted * zeta) break;
    }
    return {sequence.limit(), sequence.change()};
}
// [self-consistency]

/// The integrals of stress_memory at the friction zeta.
struct ConvergedStressMemory {
    Converged collision, relaxation, cross;
};
ConvergedStressMemory converged_stress_memory(Reduced const& gas, double zeta) {
    Sequence collision, relaxation, cross;
    for (int degree = lowest_degree; degree <= highest_degree; degree += degree_step) {
        auto const memory = stress_memory(gas.pair(zeta), degree);
        collision.add(memory.collision.mean());
        relaxation.add(memory.relaxation.mean());
        cross.add(memory.cross.mean());
        if (degree > lowest_degree &&
            0.5 * gas.n * relaxation.change() < wanted * 2.0 * gas.friction_at_once() &&
            0.5 * square(gas.n) * collision.change() < wanted * gas.collision_viscosity_at_once())
            break;
    }
    return {{collision.limit(), collision.change()},
            {relaxation.limit(), relaxation.change()},
            {cross.limit(), cross.change()}};
}

CoefficientWithMemory in_units(CoefficientWithMemory const& c, double unit) {
    return {unit * c.at_once, unit * c.pair, unit * c.collective, unit * c.cross, unit * c.error};
}

void require_positive(std::initializer_list<std::pair<char const*, double>> quantities) {
    for (auto const& [name, value] : quantities)
        if (!(value > 0.0)) throw std::invalid_argument(std::string(name) + " must be positive");
}

}  // namespace

CollectiveMemory collective_memory(Gas const& gas, Weight weight, double zeta, double box) {
    unit_sphere_surface(gas.d);  // checks d
    require_positive(
        {{"n", gas.n}, {"m", gas.m}, {"kT", gas.kT}, {"rc", gas.rc}, {"zeta", zeta}, {"box", box}});
    check_box(gas.d, box);
    double const n = gas.n * std::pow(gas.rc, gas.d), rate = zeta * gas.rc * std::sqrt(gas.m / gas.kT);
    return {returned_friction(gas.d, n, weight, rate, box / gas.rc),
            returned_own_stress(gas.d, n, weight, rate, box / gas.rc),
            returned_others_stress(gas.d, n, weight, rate, box / gas.rc)};
}

TransportWithMemory transport_with_memory(Gas const& gas, Shardlow const& thermostat, double box) {
    int const d = gas.d;
    unit_sphere_surface(d);  // checks d
    require_positive({{"n", gas.n},
                      {"m", gas.m},
                      {"kT", gas.kT},
                      {"rc", gas.rc},
                      {"gamma", thermostat.gamma},
                      {"box", box}});
    check_box(d, box);
    double const speed = std::sqrt(gas.kT / gas.m), n = gas.n * std::pow(gas.rc, d);
    Reduced const reduced{d, n, thermostat.weight, thermostat.gamma * gas.rc / (gas.m * speed), box / gas.rc};

    auto const zeta = self_consistent_friction(reduced);
    double const of_pairs = zeta.value * (1.0 + reduced.returned_friction(zeta.value));
    CoefficientWithMemory diffusion{.at_once = 1.0 / reduced.friction_at_once(),
                                    .error = zeta.error / square(zeta.value)};
    diffusion.pair = 1.0 / of_pairs - diffusion.at_once;
    diffusion.collective = 1.0 / zeta.value - 1.0 / of_pairs;

    // [viscosities]
    auto const memory = converged_stress_memory(reduced, zeta.value);
    double const rate_at_once = 2.0 * reduced.friction_at_once();
    double const rate = rate_at_once - 0.5 * n * memory.relaxation.value;
    double const life = (1.0 + returned_own_stress(d, n, reduced.weight, zeta.value, reduced.box) +
                         returned_others_stress(d, n, reduced.weight, zeta.value, reduced.box)) /
                        rate;
    // kinetic stress that the collision stress becomes, over n kT
    double const cross = 0.5 * n * memory.cross.value;
    CoefficientWithMemory kinetic{.at_once = n / rate_at_once,
                                  .pair = n / rate - n / rate_at_once,
                                  .collective = n * life - n / rate,
                                  .cross = n * life * cross};
    CoefficientWithMemory collision{.at_once = reduced.collision_viscosity_at_once(),
                                    .pair = -0.5 * square(n) * memory.collision.value,
                                    .cross = n * life * cross * (1.0 + cross)};
    // [viscosities]
    double const of_cross = 0.5 * square(n) * life * memory.cross.error;
    kinetic.error =
        kinetic.value() * (0.5 * n * memory.relaxation.error / rate + zeta.error / zeta.value) + of_cross;
    collision.error = 0.5 * square(n) * memory.collision.error + of_cross;

    double const viscosity_unit = gas.m * speed * std::pow(gas.rc, 1 - d);
    return {in_units(diffusion, gas.rc * speed), in_units(kinetic, viscosity_unit),
            in_units(collision, viscosity_unit)};
}

}  // namespace dpd::theory
