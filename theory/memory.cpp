#include "memory.hpp"

#include <algorithm>
#include <array>
#include <boost/math/quadrature/exp_sinh.hpp>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/special_functions/bessel.hpp>
#include <boost/math/special_functions/sinc.hpp>
#include <cmath>
#include <complex>
#include <functional>
#include <map>
#include <numbers>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "convergence.hpp"
#include "encounter.hpp"
#include "integrals.hpp"
#include "memory_soft.hpp"
#include "rows.hpp"

namespace dpd::theory {
namespace {

using Complex = std::complex<double>;

/// 1/z without the care for infinities that the language's division takes, which costs a multiple.
Complex inverse(Complex z) { return std::conj(z) / std::norm(z); }

// -----------------------------------------------------------------------------------------------------------
// Collective part; lengths in rc, velocities in (kT/m)^(1/2)

/// Something for currents across the wave vector and for those along it.
template <class Number>
struct Parts {
    Number transverse, longitudinal;
};

/// Friction of a pair at the distance r, in any unit: w, or what a collision takes.
using Profile = std::function<double(double)>;

/// How a wave of number k feels the friction of a pair, over what a particle feels: s_k, of the tensor w r^
/// r^, and of the friction stress w r r^ r^ r^, t_k.
struct Sharing {
    Parts<double> current, stress;
};
// [sharing]
Sharing sharing(int d, Profile const& profile, double k) {
    // averages of exp(i k.r) over directions, x = kr: of all, of one squared component of r^ across k, and
    // minus the slope of that
    auto const all = [=](double x) {
        return d == 2 ? boost::math::cyl_bessel_j(0, x) : boost::math::sinc_pi(x);
    };
    auto const across = [=](double x) {
        if (x < 1e-2) return (1.0 - x * x / (2.0 * (d + 2.0)) * (1.0 - x * x / (4.0 * (d + 4.0)))) / d;
        return d == 2 ? boost::math::cyl_bessel_j(1, x) / x : boost::math::sph_bessel(1, x) / x;
    };
    auto const slope = [=](double x) {
        if (x < 1e-2) return x / (d * (d + 2.0)) * (1.0 - x * x / (2.0 * (d + 4.0)));
        return d == 2 ? boost::math::cyl_bessel_j(2, x) / x : boost::math::sph_bessel(2, x) / x;
    };
    // the same of all
    auto const slope_of_all = [=](double x) {
        return d == 2 ? boost::math::cyl_bessel_j(1, x) : boost::math::sph_bessel(1, x);
    };
    auto const weighted = [=](auto const& f) {
        return volume_integral(d, 1.0, [&](double r) { return profile(r) * f(r); });
    };
    double const at_zero = weighted([](double) { return 1.0; }) / d;
    double const transverse = weighted([&](double r) { return across(k * r); });
    double const both = weighted([&](double r) { return all(k * r); });
    double const stress = weighted([&](double r) { return r * slope(k * r); });
    double const stress_of_all = weighted([&](double r) { return r * slope_of_all(k * r); });
    return {{transverse / at_zero, (both - (d - 1) * transverse) / at_zero},
            {stress / at_zero, (stress_of_all - d * stress) / at_zero}};
}
// [sharing]

/// A medium of friction zeta in steps: exp(-zeta step) is left of a velocity after a collision, of the n-th
/// power exp(-n zeta step). step = 0 is continuous time.
struct Medium {
    static constexpr int levels = 61;  ///< of Brinkman's fraction

    Medium(double friction, double of_step) : zeta(friction), step(of_step) {
        for (int n = 0; n < levels; ++n) rates[static_cast<std::size_t>(n)] = step_rate(n * zeta);
    }

    double zeta, step;
    std::array<double, levels> rates{};  ///< step_rate of n zeta

    /// (2/step) (1 - c)/(1 + c) of what keeps exp(-rate step) = c; the step times the sum over steps of that,
    /// the first half, is the inverse.
    // [step rate]
    double step_rate(double rate) const {
        return step == 0.0 ? rate : 2.0 / step * std::tanh(0.5 * rate * step);
    }
    // [step rate]
};

/// What a particle keeps for itself, step times sums over j >= 1 of exp(-i omega j) times: E, the correlation
/// of exp(i k.r), Phi_s, that of its current, and -dE/dt, the divergence of the current that spreads from
/// where it was. Brinkman's continued fraction. z is (2 i/step) tan(omega step/2), or i omega in continuous
/// time.
struct SingleParticle {
    Complex density;
    Parts<Complex> current;
    Complex spreading;
};
// [single particle]
SingleParticle single_particle(Medium const& medium, double k, Complex z) {
    double const k2 = square(k), h = 0.5 * medium.step;
    auto const level = [&](int n) {
        double const t = medium.rates[static_cast<std::size_t>(n)];
        return (z + t) * inverse(1.0 + square(h) * z * t);
    };
    // 1/(level(1) + factor k^2/(level(2) + (factor + 1) k^2/(...))); below the last it repeats itself
    auto const fraction = [&](int factor) {
        constexpr int depth = Medium::levels - 1;
        Complex const last = level(depth);
        Complex below =
            2.0 * inverse(last + std::sqrt(last * last + 4.0 * static_cast<double>(factor + depth - 1) * k2));
        for (int n = depth - 1; n > 0; --n)
            below = inverse(level(n) + static_cast<double>(factor + n - 1) * k2 * below);
        return below;
    };
    double const kept = std::exp(-medium.zeta * medium.step);
    double const t = medium.rates[1];
    // from the resolvent in z to the sum over steps, of what is kept whole and of a velocity
    auto const of_density = [&](Complex resolvent) {
        return (1.0 - square(h) * z * z) * resolvent - h * (1.0 - h * z);
    };
    auto const of_velocity = [&](Complex resolvent) {
        Complex const share = 2.0 / (1.0 + kept) * inverse(1.0 + square(h) * t * z);
        return kept * share * (1.0 - h * z) * (share * (1.0 + h * z) * resolvent - h);
    };
    // from a place to a velocity, one end each of the above
    auto const of_both = [&](Complex resolvent) {
        return std::sqrt(kept) * 2.0 / (1.0 + kept) * inverse(1.0 + square(h) * t * z) *
               (1.0 - square(h) * z * z) * resolvent;
    };
    Complex const first = fraction(2), density = inverse(level(0) + k2 * first);
    Complex const across = fraction(1), along = level(0) * first * density;
    return {of_density(density), {of_velocity(across), of_velocity(along)}, of_both(k2 * first * density)};
}
// [single particle]

/// The same sums with the flights of the steps exact, as far as E is not negligible.
class SingleParticleInSteps {
public:
    SingleParticleInSteps(Medium const& medium, double k) : step_(medium.step) {
        constexpr double negligible = 1e-7;
        double const kept = std::exp(-medium.zeta * step_), k2 = square(k);
        // of the displacement in j steps: its variance, its covariance with the next flight, and with the
        // velocity at either end
        double variance = 0.0, with_next = 0.0, with_end = 0.0, power = 1.0;
        for (double density = 1.0; density > negligible;) {
            variance += square(step_) + 2.0 * step_ * with_next;
            with_next = kept * (with_next + step_);
            with_end += step_ * power * std::sqrt(kept);
            power *= kept;
            density = std::exp(-0.5 * k2 * variance);
            terms_.push_back({density, power * density, (power - k2 * square(with_end)) * density,
                              k2 * with_end * density});
        }
    }
    std::size_t length() const { return terms_.size(); }
    /// At the angle omega step.
    SingleParticle at(double angle) const {
        SingleParticle sum{};
        Complex const turn = std::polar(step_, -angle) / step_;
        Complex phase = step_;
        for (auto const& term : terms_) {
            phase *= turn;
            sum.density += term.density * phase;
            sum.current.transverse += term.transverse * phase;
            sum.current.longitudinal += term.longitudinal * phase;
            sum.spreading += term.spreading * phase;
        }
        return sum;
    }

private:
    struct Term {
        double density, transverse, longitudinal, spreading;
    };
    double step_;
    std::vector<Term> terms_;
};

/// What one wave of the fluid does, as sums over steps (integrals over time) that Parseval's theorem takes to
/// frequencies.
class Wave {
public:
    Wave(int d, Medium const& medium, double k, Sharing const& share)
        : d_(d), medium_(medium), k_(k), share_(share) {}

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
        return medium_.step_rate(2.0 * medium_.zeta) * over_time([&](SingleParticle const& single) {
                   return stress(others(single)) - stress(straight(single));
               });
    }
    /// Memory of the friction stress of a pair that others take over.
    double collision_stress() const {
        return square(medium_.zeta * share_.stress.transverse) * (2.0 / d_ - 4.0 / (d_ * (d_ + 2.0))) *
               over_time([&](SingleParticle const& single) {
                   return product(others(single).transverse, single.density);
               });
    }
    // [returned]

    // [cross stress]
    /// Kinetic stress that the friction stress of a pair becomes beyond the encounter of the two: the current
    /// that the velocity of one starts, times the one that spreads from where the other is.
    double cross_stress() const {
        return medium_.zeta * share_.stress.transverse / k_ * (2.0 / d_ - 4.0 / (d_ * (d_ + 2.0))) *
               over_time([&](SingleParticle const& single) {
                   Complex const spread = spread_once(single);
                   Complex const spread_on = spread * inverse(1.0 - handed(share_.current.longitudinal) *
                                                                        single.current.longitudinal);
                   Complex const once = straight(single).transverse, others = this->others(single).transverse;
                   return product(single.current.transverse, spread_on - spread) +
                          product(others - once, single.spreading) + product(others, spread_on);
               });
    }
    // [cross stress]

private:
    static double product(Complex a, Complex b) { return std::real(a * std::conj(b)); }

    // [current]
    /// What the others get in a collision of what the particle is left with, per time.
    double handed(double share) const {
        double const rate = medium_.zeta * share;
        return medium_.step == 0.0 ? rate : std::expm1(rate * medium_.step) / medium_.step;
    }
    /// Current of the others for one of the particle: handed over once ...
    Parts<Complex> straight(SingleParticle const& single) const {
        auto const once = [&](double share, Complex self) {
            return handed(share) * self * (medium_.step + self);
        };
        return {once(share_.current.transverse, single.current.transverse),
                once(share_.current.longitudinal, single.current.longitudinal)};
    }
    /// ... or any number of times, Phi - Phi_s.
    Parts<Complex> others(SingleParticle const& single) const {
        auto const once = straight(single);
        return {
            once.transverse * inverse(1.0 - handed(share_.current.transverse) * single.current.transverse),
            once.longitudinal *
                inverse(1.0 - handed(share_.current.longitudinal) * single.current.longitudinal)};
    }
    /// Spreading current of the others, handed over once. It is zero at first; at its other end the half of a
    /// collision counts.
    Complex spread_once(SingleParticle const& single) const {
        return handed(share_.current.longitudinal) * single.spreading *
               (0.5 * medium_.step + single.current.longitudinal);
    }
    // [current]

    /// \f$\langle\Phi_{xx}\Phi_{yy}+\Phi_{xy}\Phi_{yx}\rangle\f$ over the directions of the wave.
    double stress(Parts<Complex> const& phi) const {
        Complex const a = phi.transverse, c = phi.longitudinal - a;
        return product(a, a) + 2.0 / d_ * product(a, c) + 2.0 / (d_ * (d_ + 2.0)) * product(c, c);
    }

    double returned() const { return medium_.zeta * square(share_.current.transverse) * (d_ - 1.0) / d_; }

    template <class Integrand>
    double over_time(Integrand const& integrand) const {
        // beyond, the flight of a step is not short
        constexpr double short_flight = 0.25;
        return k_ * medium_.step < short_flight ? over_frequencies(integrand) : over_angles(integrand);
    }

    template <class Integrand>
    double over_frequencies(Integrand const& integrand) const {
        thread_local boost::math::quadrature::exp_sinh<double> integrator(9);
        constexpr double tolerance = 1e-7;
        // the frequencies that count fall with k^2, as diffusion has it
        double const scale = medium_.zeta * std::min(1.0, square(k_));
        auto const at = [&](double x) {
            double const frequency = scale * x;
            return integrand(single_particle(medium_, k_, Complex(0.0, frequency))) /
                   (1.0 + square(0.5 * medium_.step * frequency));
        };
        return scale / std::numbers::pi * integrator.integrate(at, tolerance);
    }

    /// Steps have a period of frequencies, over which equal distances are exact for sums that are shorter
    /// than their number. Waves of the fluid live up to twice as long as a particle's density.
    template <class Integrand>
    double over_angles(Integrand const& integrand) const {
        SingleParticleInSteps const single(medium_, k_);
        auto const half = static_cast<int>(single.length()) + 8;
        double sum = 0.0;
        for (int m = 0; m <= half; ++m)
            sum += (m == 0 || m == half ? 0.5 : 1.0) * integrand(single.at(std::numbers::pi * m / half));
        return sum / (half * medium_.step);
    }

    int d_;
    Medium const& medium_;
    double k_;
    Sharing const& share_;
};

/// Beyond, nothing is shared: s_k^3 is below 1e-6 for every weight.
constexpr double largest_k = 24.0;

/// All waves of a fluid, whatever the medium: for the integral of a function of the wave number over all wave
/// vectors, or the sum over those of a periodic square or cube but 0, per volume. The function falls as k^-2
/// from k = 0 and is smooth otherwise.
class Waves {
public:
    Waves(int d, Profile const& profile, double box) : d_(d), profile_(profile) {
        using Gauss = boost::math::quadrature::gauss<double, 10>;  // holds the nodes >= 0 only
        // A smooth step at few wave numbers of the box: below, the vectors are summed; above, the sum is an
        // integral (Poisson; the error is exp(-(1.5 pi)^2)). Of that the wave 0 is taken away again.
        double const k1 = std::isfinite(box) ? 2.0 * std::numbers::pi / box : 0.0;
        double const step = 1.5 * k1;
        auto const below = [=](double k) { return step > 0.0 ? std::exp(-square(k / step)) : 0.0; };
        std::vector<double> ends{0.0, step > 0.0 ? 2.0 * step : 2.0};
        while (ends.back() < largest_k) ends.push_back(std::min(2.3 * ends.back(), largest_k));
        for (std::size_t part = 0; part + 1 < ends.size(); ++part)
            for (std::size_t g = 0; g < Gauss::abscissa().size(); ++g)
                for (double const sign : {-1.0, 1.0}) {
                    double const half = 0.5 * (ends[part + 1] - ends[part]);
                    double const k = ends[part] + half * (1.0 + sign * Gauss::abscissa()[g]);
                    double const density =
                        unit_sphere_surface(d) * std::pow(k, d - 1) / std::pow(2.0 * std::numbers::pi, d);
                    add(k, half * Gauss::weights()[g] * density * (1.0 - below(k)));
                }
        if (step == 0.0) return;
        double const volume = std::pow(box, d), first = 0.2 * k1;
        add(first, -square(first) / (square(step) * volume));
        constexpr int largest = 8;                         // exp(-(8/1.5)^2) = 4e-13
        std::array<int, largest * largest + 1> vectors{};  // of each squared length
        int const depth = d == 2 ? 0 : largest;
        for (int x = -largest; x <= largest; ++x)
            for (int y = -largest; y <= largest; ++y)
                for (int z = -depth; z <= depth; ++z)
                    if (int const squared = x * x + y * y + z * z;
                        squared > 0 && squared <= largest * largest)
                        ++vectors[static_cast<std::size_t>(squared)];
        for (std::size_t squared = 1; squared < vectors.size(); ++squared)
            if (vectors[squared] > 0) {
                double const k = k1 * std::sqrt(static_cast<double>(squared));
                add(k, vectors[squared] * below(k) / volume);
            }
    }

    int d() const { return d_; }

    /// Of a function of what a wave shares.
    double sum_of_shares(std::function<double(Sharing const&)> const& function) const {
        double sum = 0.0;
        for (auto const& wave : waves_) sum += wave.weight * function(wave.share);
        return sum;
    }
    /// Of what a wave does in a medium.
    double sum(Medium const& medium, double (Wave::*what)() const) const {
        double sum = 0.0;
        for (auto const& wave : waves_) sum += wave.weight * (Wave(d_, medium, wave.k, wave.share).*what)();
        return sum;
    }

private:
    struct Weighted {
        double k, weight;
        Sharing share;
    };
    void add(double k, double weight) { waves_.push_back({k, weight, sharing(d_, profile_, k)}); }

    int d_;
    Profile profile_;
    std::vector<Weighted> waves_;
};

void check_step_and_box(int d, double dt, double box) {
    if (!(dt >= 0.0) || !std::isfinite(dt))
        throw std::invalid_argument("dt must be zero or positive and finite");
    if (!(box > 0.0)) throw std::invalid_argument("box must be positive");
    if (d == 2 && !std::isfinite(box))
        throw std::domain_error(
            "in two dimensions the coefficients of an infinite fluid diverge; give the side of a periodic "
            "box");
}

/// What comes back within a sweep, while nobody moves: in it the wave s_k keeps exp(-decay (1 - s_k)), a
/// particle by itself exp(-decay). Once there and back needs the same pair twice and does not happen.
struct Sweep {
    double velocity;   ///< relative change of what is kept of a velocity
    double stress;     ///< of v_x v_y, what goes over to the others
    double collision;  ///< what it takes from the collision viscosity, times the step
};
// [within a sweep]
Sweep within_sweep(Waves const& waves, double n, double decay) {
    int const d = waves.d();
    auto const beyond_second = [](double x) {  // exp(x) - 1 - x - x^2/2
        return std::abs(x) < 1e-2 ? x * x * x / 6.0 * (1.0 + 0.25 * x) : std::expm1(x) - x - 0.5 * x * x;
    };
    auto const velocity = [&](Sharing const& share) {
        auto const& s = share.current;
        return ((d - 1) * beyond_second(decay * s.transverse) + beyond_second(decay * s.longitudinal)) / d;
    };
    auto const product = [&](double a, double b) {  // averaged over directions as in Wave
        double const c = b - a;
        return a * a + 2.0 / d * a * c + 2.0 / (d * (d + 2.0)) * c * c;
    };
    auto const stress = [&](Sharing const& share) {
        auto const& s = share.current;
        double const a = decay * s.transverse, b = decay * s.longitudinal;
        return std::exp(-2.0 * decay) * (product(std::expm1(a), std::expm1(b)) - product(a, b));
    };
    // int_0^1 (1 - t) exp(-decay t) (exp(decay s t) - 1) dt: two of the times in the sweep of three
    // collisions
    auto const passed_on = [&](double s) {
        auto const twice = [](double x) {  // int_0^1 (1 - t) exp(-x t) dt
            return std::abs(x) < 1e-3 ? 0.5 - x / 6.0 + x * x / 24.0 : (x + std::expm1(-x)) / (x * x);
        };
        return twice(decay * (1.0 - s)) - twice(decay);
    };
    auto const collision = [&](Sharing const& share) {
        auto const& [s, t] = share;
        double const transverse = 2.0 / d - 4.0 / (d * (d + 2.0)), longitudinal = 1.0 / (d * (d + 2.0));
        return square(decay) * (transverse * square(t.transverse) * passed_on(s.transverse) +
                                longitudinal * square(t.longitudinal) * passed_on(s.longitudinal));
    };
    return {waves.sum_of_shares(velocity) / n, waves.sum_of_shares(stress) / n,
            waves.sum_of_shares(collision)};
}
// [within a sweep]

// -----------------------------------------------------------------------------------------------------------
// Closure; m = kT = rc = 1

/// Friction that chaos gives a velocity in continuous time, and the collision viscosity.
double friction_limit(Gas const& gas, auto const& thermostat) {
    return gas.kT / (gas.m * diffusion_constant_limit(gas, thermostat));
}
double viscosity_at_once(Gas const& gas, Shardlow const& thermostat, double step) {
    return step == 0.0 ? collision_viscosity_limit(gas, thermostat)
                       : collision_viscosity(gas, thermostat, step);
}
double viscosity_at_once(Gas const& gas, Lowe const& thermostat, double) {
    return collision_viscosity(gas, thermostat);
}

/// The gas and the step in units of the gas.
struct Reduced {
    int d;
    double n;
    Thermostat thermostat;
    double step, box;
    double wanted;  ///< relative change at which a refinement is the last

    Gas gas() const { return {.d = d, .n = n}; }
    Profile profile() const {
        return [pair = Encounter{d, thermostat, 1.0, step}](double r) { return loss(pair, 1, r); };
    }
    /// Rates of chaos, of a velocity and of v_x v_y.
    double friction_at_once() const {
        return std::visit(
            [&](auto const& t) {
                return step == 0.0 ? friction_limit(gas(), t)
                                   : -std::log(velocity_retention(gas(), t, step)) / step;
            },
            thermostat);
    }
    double stress_rate_at_once() const {
        return std::visit(
            [&](auto const& t) {
                return step == 0.0 ? n / kinetic_viscosity_limit(gas(), t)
                                   : -std::log(stress_retention(gas(), t, step)) / step;
            },
            thermostat);
    }
    double collision_viscosity_at_once() const {
        return std::visit([&](auto const& t) { return viscosity_at_once(gas(), t, step); }, thermostat);
    }
    Sweep within_sweep(Waves const& waves) const {
        if (step == 0.0) return {};
        return theory::within_sweep(waves, n, friction_at_once() * step);
    }
    Medium medium(double zeta) const { return {zeta, step}; }
};

/// The integrals of stress_memory.
struct ConvergedStressMemory {
    Converged collision, relaxation, cross;
};

/// What pairs remember in any medium. It gets better with the degree of the polynomials.
class Pairs {
public:
    explicit Pairs(Reduced const& gas)
        : gas_(gas), force_(pair(gas), of_force), stress_(pair(gas), of_stress) {}

    /// Memory of the force, `refined` times better than at first.
    double force(double zeta, int refined) { return force_.force_memory(zeta, degree(refined)); }

    ConvergedStressMemory stress(double zeta) {
        Sequence collision, relaxation, cross;
        for (int refined = 0; refined <= refinements; ++refined) {
            auto const memory = stress_.stress_memory(zeta, degree(refined));
            collision.add(memory.collision);
            relaxation.add(memory.relaxation);
            cross.add(memory.cross);
            double const rate = gas_.stress_rate_at_once() - 0.5 * gas_.n * relaxation.limit();
            double const of_cross = 0.5 * square(gas_.n) * cross.steady_change() / rate;
            // of the kinetic viscosity, n/rate, and of the other
            if (0.5 * gas_.n * relaxation.steady_change() / rate + of_cross * rate / gas_.n < gas_.wanted &&
                0.5 * square(gas_.n) * collision.steady_change() + of_cross <
                    gas_.wanted * gas_.collision_viscosity_at_once())
                break;
        }
        auto const converged = [](Sequence const& s) { return Converged{s.limit(), s.steady_change()}; };
        return {converged(collision), converged(relaxation), converged(cross)};
    }

    static constexpr int refinements = 9;

private:
    static constexpr int of_force = 1, of_stress = 2;  ///< ranks
    static int degree(int refined) { return 2 + 2 * refined; }
    static Encounter pair(Reduced const& gas) { return {gas.d, gas.thermostat, 1.0, gas.step}; }

    Reduced gas_;
    FlyingPair force_, stress_;
};

/// Friction that a particle feels from partners, each of whom it meets as in an encounter. @eq{NG2007,17}
/// less what one partner hands back.
// [pair friction]
double pair_friction(Reduced const& gas, Pairs& pairs, double zeta, int refined) {
    return gas.friction_at_once() - gas.n / gas.d * pairs.force(zeta, refined);
}
/// Friction that comes back within a sweep.
double sweep_friction(Reduced const& gas, Sweep const& sweep) {
    return gas.step == 0.0 ? 0.0 : std::log1p(sweep.velocity) / gas.step;
}
// [pair friction]

/// The friction zeta that a particle feels, in a medium of particles that feel the same.
// [self-consistency]
Converged self_consistent_friction(Reduced const& gas, Pairs& pairs, Waves const& waves, Sweep const& sweep) {
    double const at_once = gas.friction_at_once(), in_sweep = sweep_friction(gas, sweep);
    auto const excess = [&](double zeta, int refined) {
        return pair_friction(gas, pairs, zeta, refined) - in_sweep -
               zeta * (1.0 + waves.sum(gas.medium(zeta), &Wave::friction) / gas.n);
    };
    // with few polynomials between bounds, then with more, which changes little
    constexpr double smallest = 0.02;
    auto [zeta, slope] = zero_and_slope([&](double x) { return excess(x, 0); }, smallest * at_once, at_once);
    Sequence sequence;
    sequence.add(zeta);
    for (int refined = 1; refined <= Pairs::refinements; ++refined) {
        zeta -= excess(zeta, refined) / slope;
        sequence.add(zeta);
        if (sequence.steady_change() < gas.wanted * zeta) break;
    }
    return {sequence.limit(), sequence.steady_change()};
}
// [self-consistency]

/// Rate of the kinetic stress with what comes back to it, and goes over to others, within a sweep.
// [stress in a sweep]
double stress_rate_in_sweep(Reduced const& gas, Sweep const& sweep, double pair_rate) {
    if (gas.step == 0.0) return pair_rate;
    double const kept = std::exp(-pair_rate * gas.step);
    return -std::log(kept * square(1.0 + sweep.velocity) + sweep.stress) / gas.step;
}
// [stress in a sweep]

CoefficientWithMemory in_units(CoefficientWithMemory const& c, double unit) {
    return {unit * c.at_once, unit * c.pair, unit * c.collective, unit * c.cross, unit * c.error};
}

}  // namespace

CollectiveMemory collective_memory(Gas const& gas, Weight weight, double zeta, double dt, double box,
                                   PairDistribution const& g) {
    unit_sphere_surface(gas.d);  // checks d
    require_positive({{"n", gas.n}, {"m", gas.m}, {"kT", gas.kT}, {"rc", gas.rc}, {"zeta", zeta}});
    check_step_and_box(gas.d, dt, box);
    double const n = gas.n * std::pow(gas.rc, gas.d), time = gas.rc * std::sqrt(gas.m / gas.kT);
    Medium const medium{zeta * time, dt / time};
    Waves const waves(
        gas.d, [&](double r) { return weight_at(weight, r) * (g ? g(r * gas.rc) : 1.0); }, box / gas.rc);
    double const viscosity = std::sqrt(gas.m * gas.kT) * std::pow(gas.rc, 1 - gas.d);
    return {waves.sum(medium, &Wave::friction) / n, waves.sum(medium, &Wave::own_stress) / n,
            waves.sum(medium, &Wave::others_stress) / n,
            waves.sum(medium, &Wave::collision_stress) * viscosity,
            waves.sum(medium, &Wave::cross_stress) * viscosity};
}

namespace {

TransportWithMemory transport(Gas const& gas, Thermostat const& reduced_thermostat, double dt, double box,
                              double wanted) {
    int const d = gas.d;
    double const speed = std::sqrt(gas.kT / gas.m), n = gas.n * std::pow(gas.rc, d);
    Reduced const reduced{d, n, reduced_thermostat, dt * speed / gas.rc, box / gas.rc, wanted};
    Pairs pairs(reduced);
    Waves const waves(d, reduced.profile(), reduced.box);

    // [diffusion with memory]
    Sweep const sweep = reduced.within_sweep(waves);
    auto const zeta = self_consistent_friction(reduced, pairs, waves, sweep);
    auto const medium = reduced.medium(zeta.value);
    auto const diffusion_at = [&](double rate) { return 1.0 / medium.step_rate(rate); };
    double const of_pairs =
        zeta.value * (1.0 + waves.sum(medium, &Wave::friction) / n) + sweep_friction(reduced, sweep);
    CoefficientWithMemory diffusion{.at_once = diffusion_at(reduced.friction_at_once()),
                                    .error = zeta.error / zeta.value * diffusion_at(zeta.value)};
    diffusion.pair = diffusion_at(of_pairs) - diffusion.at_once;
    diffusion.collective = diffusion_at(zeta.value) - diffusion_at(of_pairs);
    // [diffusion with memory]

    // [viscosities]
    auto const memory = pairs.stress(zeta.value);
    double const pair_rate = reduced.stress_rate_at_once() - 0.5 * n * memory.relaxation.value;
    double const rate = stress_rate_in_sweep(reduced, sweep, pair_rate);
    // of the chaotic gas, by what its stress loses; step/(1 - s) - step/2
    double const of_pairs_life = 1.0 / medium.step_rate(pair_rate);
    // of the waves, by what they lose, 2 zeta
    double const decay = 2.0 * zeta.value * medium.step;
    double const of_rate = decay == 0.0 ? 1.0 : decay / std::sinh(decay);  // d ln(life)/d ln(1/rate)
    double const of_waves_life =
        (of_rate * waves.sum(medium, &Wave::own_stress) + waves.sum(medium, &Wave::others_stress)) /
        (n * medium.step_rate(2.0 * zeta.value));
    double const life = 1.0 / medium.step_rate(rate) + of_waves_life;
    // kinetic stress that the collision stress becomes, over n kT
    double const cross = 0.5 * n * memory.cross.value / std::cosh(0.5 * rate * medium.step);
    CoefficientWithMemory kinetic{.at_once = n / medium.step_rate(reduced.stress_rate_at_once())};
    kinetic.pair = n * of_pairs_life - kinetic.at_once;
    kinetic.collective = n * (life - of_pairs_life);
    kinetic.cross = n * life * cross;
    CoefficientWithMemory collision{.at_once = reduced.collision_viscosity_at_once(),
                                    .pair = -0.5 * square(n) * memory.collision.value,
                                    .cross = n * life * cross * (1.0 + cross)};
    collision.collective = -waves.sum(medium, &Wave::collision_stress) -
                           (medium.step == 0.0 ? 0.0 : sweep.collision / medium.step);
    // [viscosities]
    double const of_cross = 0.5 * square(n) * life * memory.cross.error;
    kinetic.error =
        kinetic.value() * (0.5 * n * memory.relaxation.error / rate + zeta.error / zeta.value) + of_cross;
    collision.error = 0.5 * square(n) * memory.collision.error + of_cross;

    double const viscosity_unit = gas.m * speed * std::pow(gas.rc, 1 - d);
    return {in_units(diffusion, gas.rc * speed), in_units(kinetic, viscosity_unit),
            in_units(collision, viscosity_unit)};
}

void check_gas(Gas const& gas, char const* strength, double value, double dt, double box) {
    unit_sphere_surface(gas.d);  // checks d
    require_positive({{"n", gas.n}, {"m", gas.m}, {"kT", gas.kT}, {"rc", gas.rc}, {strength, value}});
    check_step_and_box(gas.d, dt, box);
}

}  // namespace

TransportWithMemory transport_with_memory(Gas const& gas, Shardlow const& thermostat, double dt, double box,
                                          double wanted) {
    check_gas(gas, "gamma", thermostat.gamma, dt, box);
    Shardlow reduced = thermostat;
    reduced.gamma *= gas.rc / std::sqrt(gas.m * gas.kT);
    return transport(gas, reduced, dt, box, wanted);
}

TransportWithMemory transport_with_memory(Gas const& gas, Lowe const& thermostat, double dt, double box,
                                          double wanted) {
    check_gas(gas, "Gamma", thermostat.Gamma, dt, box);
    return transport(gas, Lowe{thermostat.Gamma * gas.rc * std::sqrt(gas.m / gas.kT)}, dt, box, wanted);
}

// [temperature with memory]
TemperatureWithMemory temperature_with_memory(ExplicitDpd const& fluid, double dt) {
    if (fluid.random_weight && *fluid.random_weight != fluid.weight)
        throw std::domain_error("the temperature with memory is known for matched weights only");
    double const chaos = temperature_at_finite_step(fluid, dt);  // checks the fluid and the step
    double const bath = square(fluid.sigma) / (2.0 * fluid.gamma);
    double const n = fluid.n * std::pow(fluid.rc, fluid.d), decay = fluid.n * A1(fluid) * dt;
    // theta = bath/T balances the energy where theta = bath/chaos - n M/(d kappa)
    auto const excess = [&](double theta, int degree) {
        double const speed = std::sqrt(bath / theta / fluid.m), step = dt * speed / fluid.rc;
        Encounter const pair{fluid.d, Shardlow{fluid.gamma * dt / (fluid.m * step), fluid.weight}, 1.0, step};
        double const memory = heat_memory(pair, decay, theta - 1.0 + decay, degree);
        return theta - bath / chaos + n * memory / (fluid.d * decay);
    };
    auto const coarse = [&](double theta) { return excess(theta, lowest_degree); };
    double const lowest = bath / chaos, highest = 1.0 + decay;
    if (!(coarse(lowest) < 0.0 && coarse(highest) > 0.0))
        throw std::domain_error("no temperature balances the energy of a pair with memory at this step");
    auto [theta, slope] = zero_and_slope(coarse, lowest, highest);
    Sequence sequence;
    sequence.add(theta);
    for (int degree = lowest_degree + degree_step; degree <= highest_degree; degree += degree_step) {
        constexpr double wanted = 3e-5;  // relative change at which a refinement is the last
        theta -= excess(theta, degree) / slope;
        if (!(theta > 0.0)) break;
        sequence.add(theta);
        if (sequence.change() < wanted * theta) break;
    }
    constexpr double believed = 0.01;
    if (!(theta > 0.0 && sequence.change() < believed * theta))
        throw std::domain_error(
            "the temperature with memory is not known to 1 % at this step, which leaves close pairs "
            "with more velocity than they had");
    double const value = bath / sequence.limit();
    return {chaos, value - chaos, value * sequence.change() / sequence.limit()};
}
// [temperature with memory]

// --- the rows of the registry ------------------------------------------------------------------------------

namespace {

template <class Kind>
TransportWithMemory transport_for(Gas const& fluid, Arguments const& a) {
    double const box = a["box"] > 0.0 ? a["box"] : std::numeric_limits<double>::infinity();
    if constexpr (std::is_same_v<Kind, Lowe>)
        return transport_with_memory(fluid, Lowe{a["Gamma"]}, a["dt"], box);
    else
        return transport_with_memory(
            fluid, Shardlow{.gamma = a["gamma"], .weight = a.weight(), .scheme = a.scheme()}, a["dt"], box);
}

/// One state gives three coefficients, of which a caller asks one after the other: states are remembered.
template <class Kind>
TransportWithMemory transport_of(Arguments const& a) {
    constexpr bool lowe = std::is_same_v<Kind, Lowe>;
    using State = std::tuple<int, double, double, double, double, double, double, double, Weight, Scheme>;
    thread_local std::map<State, TransportWithMemory> known;
    Gas const fluid = gas(a, a["n"], a["m"], a["kT"]);
    State const state{fluid.d, fluid.n,  fluid.m,    fluid.kT,  fluid.rc, a[lowe ? "Gamma" : "gamma"],
                      a["dt"], a["box"], a.weight(), a.scheme()};
    auto found = known.find(state);
    if (found == known.end()) found = known.emplace(state, transport_for<Kind>(fluid, a)).first;
    return found->second;
}

template <class Kind, CoefficientWithMemory TransportWithMemory::*coefficient>
ClosedForm row(std::string_view id, std::string_view quantity, std::string_view formula) {
    std::vector<std::string_view> parameters{"d", "n", "m", "kT", "rc", "dt", "box"};
    if constexpr (std::is_same_v<Kind, Lowe>)
        parameters.push_back("Gamma");
    else
        parameters.insert(parameters.end(), {"gamma", "weight", "exponent", "scheme"});
    return {.id = id,
            .paper = "ours",
            .equation = "theory/memory.md",
            .quantity = quantity,
            .formula = formula,
            .parameters = parameters,
            .without_effect = {},
            .value = [](Arguments const& a) { return (transport_of<Kind>(a).*coefficient).value(); },
            .defaults = {{"dt", "0"}},
            .parts = [](Arguments const& a) -> std::vector<std::pair<std::string_view, double>> {
                auto const c = transport_of<Kind>(a).*coefficient;
                return {{"value", c.value()},         {"at_once", c.at_once}, {"pair", c.pair},
                        {"collective", c.collective}, {"cross", c.cross},     {"numerical_error", c.error}};
            },
            .costly = true};
}

template <class Kind>
std::vector<ClosedForm> rows_of(std::array<std::string_view, 3> const& ids) {
    using With = TransportWithMemory;
    return {row<Kind, &With::diffusion_constant>(ids[0], "self-diffusion constant with memory",
                                                 "eq. 17 + pair + waves of the fluid"),
            row<Kind, &With::kinetic_viscosity>(ids[1], "kinetic viscosity with memory",
                                                "eq. 8 + pair + waves of the fluid + cross term"),
            row<Kind, &With::collision_viscosity>(ids[2], "collision viscosity with memory",
                                                  "eq. 12 + pair + waves of the fluid + cross term")};
}

}  // namespace

namespace {

TemperatureWithMemory temperature_of(Arguments const& a) {
    return temperature_with_memory({.d = a.d(),
                                    .n = a["n"],
                                    .m = a["m"],
                                    .gamma = a["gamma"],
                                    .sigma = a["sigma"],
                                    .rc = a["rc"],
                                    .weight = a.weight()},
                                   a["dt"]);
}

ClosedForm temperature_row() {
    return {
        .id = "memory-kT",
        .paper = "ours",
        .equation = "theory/memory.md",
        .quantity = "temperature of explicit DPD with memory",
        .formula = "eq. 22 + pair",
        .parameters = {"d", "n", "m", "gamma", "sigma", "rc", "dt", "weight", "exponent"},
        .without_effect = {},
        .value = [](Arguments const& a) { return temperature_of(a).value(); },
        .defaults = {},
        .parts = [](Arguments const& a) -> std::vector<std::pair<std::string_view, double>> {
            auto const t = temperature_of(a);
            return {
                {"value", t.value()}, {"at_once", t.at_once}, {"pair", t.pair}, {"numerical_error", t.error}};
        },
        .costly = true};
}

ClosedForm soft_row() {
    return {.id = "memory-collision-soft",
            .paper = "ours",
            .equation = "theory/memory.md",
            .quantity = "collision viscosity with memory and potential",
            .formula = "eq. 12 + pair + waves of the fluid + cross terms",
            .parameters = {"d", "n", "m", "kT", "gamma", "rc", "box", "a", "weight", "exponent"},
            .without_effect = {},
            .value = [](Arguments const& a) { return soft_parts(a, {}).front().second; },
            .defaults = {{"a", "0"}},
            .parts = [](Arguments const& a) { return soft_parts(a, {}); },
            .costly = true};
}

}  // namespace

std::vector<ClosedForm> memory_rows() {
    return joined({rows_of<Shardlow>({"memory-D", "memory-kinetic", "memory-collision"}),
                   rows_of<Lowe>({"memory-D-lowe", "memory-kinetic-lowe", "memory-collision-lowe"}),
                   {temperature_row(), soft_row()}});
}

}  // namespace dpd::theory
