#include "memory_soft.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "convergence.hpp"
#include "encounter.hpp"
#include "integrals.hpp"
#include "memory.hpp"

namespace dpd::theory {
namespace {

/// ln g + u/kT, which stays smooth where g falls by orders of magnitude: a polynomial through the measured
/// points, each weighted as its count of pairs has it; zero beyond the last, level below the first that is
/// seen often enough.
// [cavity]
class Cavity {
public:
    Cavity() = default;
    /// Lengths in rc, energies in kT.
    Cavity(int d, double a, PairTable const& measured) {
        constexpr double seen = 3e-3;  // below, a bin of a usual run has a handful of pairs
        constexpr int degree = 12;
        std::size_t first = 0;
        for (std::size_t i = 0; i < measured.r.size() && measured.r[i] < 1.0; ++i)
            if (measured.g[i] < seen) first = i + 1;
        auto const points = static_cast<Eigen::Index>(measured.r.size() - first);
        if (points <= 2 * degree)
            throw std::invalid_argument(
                "the pair distribution needs more than 24 distances at which it is seen");
        start_ = measured.r[first];
        end_ = measured.r.back();
        if (end_ < 1.0) throw std::invalid_argument("the pair distribution must reach the cutoff");
        Eigen::MatrixXd powers(points, degree);
        Eigen::VectorXd values(points);
        for (Eigen::Index i = 0; i < points; ++i) {
            double const r = measured.r[first + i], g = measured.g[first + i];
            double const weight = std::sqrt(std::pow(r, d - 1) * g), x = position(r);
            for (int k = 0; k < degree; ++k) powers(i, k) = weight * (std::pow(x, k + 1) - 1.0);
            values[i] = weight * (std::log(g) + energy(a, r));
        }
        coefficients_ = powers.colPivHouseholderQr().solve(values);
    }

    /// Of an r in units of rc.
    double value(double r) const {
        if (r >= end_) return 0.0;
        double const x = position(std::max(r, start_));
        double sum = 0.0, level = 0.0;
        for (auto k = coefficients_.size(); k-- > 0;) {
            sum = (sum + coefficients_[k]) * x;
            level += coefficients_[k];
        }
        return sum - level;
    }
    double slope(double r) const {
        if (r >= end_ || r <= start_) return 0.0;
        double const x = position(r);
        double sum = 0.0;
        for (auto k = coefficients_.size(); k-- > 0;)
            sum = sum * x + static_cast<double>(k + 1) * coefficients_[k];
        return sum * 2.0 / (end_ - start_);
    }

    static double energy(double a, double r) { return r < 1.0 ? 0.5 * a * square(1.0 - r) : 0.0; }

private:
    /// From the first to the last point -1 to 1.
    double position(double r) const { return 2.0 * (r - start_) / (end_ - start_) - 1.0; }

    double start_ = 0.0, end_ = 0.0;
    Eigen::VectorXd coefficients_;
};
// [cavity]

Structure structure_of(int d, double a, PairTable const& measured) {
    Cavity const cavity = measured.r.empty() ? Cavity() : Cavity(d, a, measured);
    auto const force = [a](double r) { return r < 1.0 ? a * (1.0 - r) : 0.0; };
    return {[=](double r) { return std::exp(cavity.value(r) - Cavity::energy(a, r)); },
            [=](double r) { return cavity.slope(r) + force(r); }, force};
}

/// The fluid in units of m, kT and rc.
struct SoftFluid {
    int d;
    double n;
    Shardlow thermostat;
    Structure structure;
    double box;

    Gas gas() const { return {.d = d, .n = n}; }
    Encounter pair(double zeta) const { return {d, thermostat, zeta, 0.0, structure}; }
    /// [w r^power g]
    double moment(int power) const {
        return volume_integral(d, 1.0, [&](double r) {
            return thermostat.gamma * weight_at(thermostat.weight, r) * std::pow(r, power) * structure.g(r);
        });
    }
    CollectiveMemory waves(double zeta) const {
        return collective_memory(gas(), thermostat.weight, zeta, 0.0, box, structure.g);
    }
};

/// Change at which a refinement is the last, over the friction and over the largest parts.
constexpr double wanted = 1e-4;

/// Friction from partners, each met as in an encounter, and of it what the thermostat does.
struct PairFriction {
    double all, thermostat;
};
// [soft pair friction]
PairFriction pair_friction(SoftFluid const& fluid, double zeta, int degree) {
    auto const memory = soft_force_memory(fluid.pair(zeta), degree);
    double const of_thermostat = fluid.n / fluid.d * (fluid.moment(0) - memory.friction + memory.cross);
    return {of_thermostat + fluid.n / fluid.d * (memory.potential + memory.cross), of_thermostat};
}
// [soft pair friction]

/// The friction that a particle feels in a medium of particles that feel the same.
// [soft self-consistency]
double self_consistent_friction(SoftFluid const& fluid) {
    auto const excess = [&](double zeta, int degree) {
        return pair_friction(fluid, zeta, degree).all - zeta * (1.0 + fluid.waves(zeta).friction);
    };
    auto const coarse = [&](double zeta) { return excess(zeta, lowest_degree); };
    double const at_once = fluid.n / fluid.d * fluid.moment(0);
    double highest = at_once;
    constexpr int most_doublings = 20;  // weak friction is a small share of what the potential does
    for (int doubled = 0; coarse(highest) > 0.0; ++doubled) {
        if (doubled == most_doublings)
            throw std::domain_error("the friction of a particle has no self-consistent value there");
        highest *= 2.0;
    }
    constexpr double smallest = 0.02;
    auto [zeta, slope] =
        zero_and_slope(coarse, highest == at_once ? smallest * at_once : 0.5 * highest, highest);
    Sequence sequence;
    sequence.add(zeta);
    for (int degree = lowest_degree + degree_step; degree <= highest_degree; degree += degree_step) {
        zeta -= excess(zeta, degree) / slope;
        sequence.add(zeta);
        if (sequence.change() < wanted * zeta) break;
    }
    return sequence.limit();
}
// [soft self-consistency]

}  // namespace

PairTable pair_table(std::string const& file) {
    std::ifstream in(file);
    if (!in) throw std::invalid_argument(file + ": cannot be read");
    PairTable table;
    constexpr std::string_view name = "radial_distribution,";
    for (std::string line; std::getline(in, line);) {
        if (!line.starts_with(name)) continue;
        std::istringstream numbers(line.substr(name.size()));
        double r = 0.0, g = 0.0;
        char comma = 0;
        if (!(numbers >> r >> comma >> g) || comma != ',')
            throw std::invalid_argument(file + ": '" + line + "'; allowed: radial_distribution,r,g,...");
        table.r.push_back(r);
        table.g.push_back(g);
    }
    if (table.r.empty())
        throw std::invalid_argument(file +
                                    ": no lines radial_distribution,r,g,... in it; allowed: a file of "
                                    "dpdref run --csv");
    return table;
}

SoftCollisionViscosity collision_viscosity_with_memory(Gas const& gas, Shardlow const& thermostat,
                                                       Soft const& potential, PairTable const& measured,
                                                       double box) {
    int const d = gas.d;
    unit_sphere_surface(d);  // checks d
    require_positive(
        {{"n", gas.n}, {"m", gas.m}, {"kT", gas.kT}, {"rc", gas.rc}, {"gamma", thermostat.gamma}});
    if (!(potential.a >= 0.0) || !std::isfinite(potential.a))
        throw std::invalid_argument("a must be zero or positive and finite");
    if (measured.r.size() != measured.g.size())
        throw std::invalid_argument("the pair distribution needs as many values as distances");
    PairTable reduced = measured;
    for (auto& r : reduced.r) r /= gas.rc;
    double const n = gas.n * std::pow(gas.rc, d);
    SoftFluid fluid{d, n, thermostat, structure_of(d, potential.a, reduced), box / gas.rc};
    fluid.thermostat.gamma *= gas.rc / std::sqrt(gas.m * gas.kT);

    double const zeta = self_consistent_friction(fluid);
    auto const waves = fluid.waves(zeta);
    auto const friction = pair_friction(fluid, zeta, 12);
    // what the thermostat hands on to the waves, of what a particle gives away
    double const share = friction.thermostat / friction.all;

    // [collision viscosity with a potential]
    SoftCollisionViscosity eta{.at_once = square(n) * fluid.moment(2) / (2.0 * d * (d + 2.0)),
                               .collective = -square(share) * waves.collision_stress,
                               .waves = share * waves.cross_stress};
    Sequence pair, potential_part, kinetic, other_kinetic;
    for (int degree = lowest_degree; degree <= highest_degree; degree += degree_step) {
        auto const memory = soft_stress_memory(fluid.pair(zeta), degree);
        double const rate = n * (2.0 * fluid.moment(0) / d - 0.5 * memory.relaxation);
        double const life = 1.0 / rate + (waves.own_stress + waves.others_stress) / (2.0 * zeta);
        double const xi = 0.5 * n * memory.cross;
        auto const with = [&](double xi_potential) { return n * life * xi * (1.0 + xi + xi_potential); };
        pair.add(-0.5 * square(n) * memory.collision);
        potential_part.add(-0.5 * square(n) * memory.potential);
        kinetic.add(with(0.5 * n * memory.kinetic));
        other_kinetic.add(with(0.5 * n * memory.kinetic_by_mean_stress));
        eta.pair = pair.limit();
        eta.potential = potential_part.limit();
        eta.kinetic = 0.5 * (kinetic.limit() + other_kinetic.limit());
        eta.closure = 0.5 * std::abs(other_kinetic.limit() - kinetic.limit());
        eta.error =
            pair.change() + potential_part.change() + 0.5 * (kinetic.change() + other_kinetic.change());
        if (degree > lowest_degree && eta.error < wanted * (eta.at_once + eta.kinetic)) break;
    }
    // [collision viscosity with a potential]
    double const unit = std::sqrt(gas.m * gas.kT) * std::pow(gas.rc, 1 - d);
    for (double* part : {&eta.at_once, &eta.pair, &eta.collective, &eta.kinetic, &eta.waves, &eta.potential,
                         &eta.closure, &eta.error})
        *part *= unit;
    return eta;
}

std::vector<std::pair<std::string_view, double>> soft_parts(Arguments const& a, PairTable const& measured) {
    double const box = a["box"] > 0.0 ? a["box"] : std::numeric_limits<double>::infinity();
    auto const eta = collision_viscosity_with_memory(
        {.d = a.d(), .n = a["n"], .m = a["m"], .kT = a["kT"], .rc = a["rc"]},
        {.gamma = a["gamma"], .weight = a.weight()}, {.a = a["a"] * a["rc"] / a["kT"]}, measured, box);
    return {{"value", eta.value()},         {"at_once", eta.at_once}, {"pair", eta.pair},
            {"collective", eta.collective}, {"kinetic", eta.kinetic}, {"waves", eta.waves},
            {"potential", eta.potential},   {"closure", eta.closure}, {"numerical_error", eta.error}};
}

}  // namespace dpd::theory
