// Collision viscosity with memory and a potential: the encounter of two particles that repel each other, and
// the sum of all parts.
#define BOOST_TEST_MODULE memory_soft
#include "theory/memory_soft.hpp"

#include <array>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "theory/encounter.hpp"
#include "theory/memory.hpp"

using namespace dpd;
using namespace dpd::theory;

namespace {

using Vector = std::array<double, 3>;
double dot(Vector const& a, Vector const& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Of the force on a partner only a share is the other's own: the rest is what all around add.
constexpr double mean = 8.0, own = 12.0;
Structure repelling() {
    return {[](double r) { return r < 1.0 ? std::exp(-0.5 * mean * (1.0 - r) * (1.0 - r)) : 1.0; },
            [](double r) { return r < 1.0 ? mean * (1.0 - r) : 0.0; },
            [](double r) { return r < 1.0 ? own * (1.0 - r) : 0.0; }};
}

constexpr int quantities = 9;
using Values = std::array<double, quantities>;
std::array<char const*, quantities> const labels{
    "force, friction", "force, potential", "force, cross",          "collision", "relaxation", "cross",
    "potential",       "kinetic",          "kinetic by mean stress"};

Values solved(Encounter const& pair, int degree) {
    auto const force = soft_force_memory(pair, degree);
    auto const stress = soft_stress_memory(pair, degree);
    return {force.friction,   force.potential,   force.cross,
            stress.collision, stress.relaxation, stress.cross,
            stress.potential, stress.kinetic,    stress.kinetic_by_mean_stress};
}

struct Followed {
    Values mean{}, error{};
};

// The same integrals by following pairs: Euclidean vectors and the Langevin equation as it is written down.
Followed follow(Encounter const& pair, int trajectories, double step, double longest) {
    std::mt19937_64 random(2007);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    auto const& thermostat = std::get<Shardlow>(pair.thermostat);
    double const volume = 4.0 * std::numbers::pi / 3.0;
    struct Signals {
        Vector f{}, F_mean{}, F_own{};
        double s = 0.0, B = 0.0, B_mean = 0.0, B_own = 0.0, Phi_mean = 0.0, Phi_own = 0.0;
    };
    auto const signals = [&](Vector const& x, Vector const& g) {
        double const r = std::sqrt(dot(x, x));
        if (r >= 1.0) return Signals{};
        double const w = thermostat.gamma * weight_at(thermostat.weight, r);
        double const F = pair.structure.mean_force(r), F_own = pair.structure.force(r);
        Vector e{};
        for (std::size_t c = 0; c < 3; ++c) e[c] = x[c] / r;
        double const u = dot(e, g), xy = e[0] * e[1], turned = e[0] * g[1] + e[1] * g[0];
        Signals now{.s = w * r * xy * u,
                    .B = -w * u * turned + 4.0 * w * xy,
                    .B_mean = F * turned,
                    .B_own = F_own * turned,
                    .Phi_mean = r * F * xy,
                    .Phi_own = r * F_own * xy};
        for (std::size_t c = 0; c < 3; ++c) {
            now.f[c] = w * u * e[c];
            now.F_mean[c] = F * e[c];
            now.F_own[c] = F_own * e[c];
        }
        return now;
    };
    double const kept = std::exp(-0.5 * pair.medium * step);
    Values sum{}, squares{};
    for (int t = 0; t < trajectories; ++t) {
        Vector x{}, g{};
        do
            for (auto& c : x) c = uniform(random);
        while (dot(x, x) >= 1.0);
        for (auto& c : g) c = std::numbers::sqrt2 * normal(random);
        double const often = volume * pair.structure.g(std::sqrt(dot(x, x)));
        Signals const first = signals(x, g);
        Values integral{};
        auto const relax = [&] {
            for (auto& c : g) c = kept * c + std::sqrt(2.0 * (1.0 - kept * kept)) * normal(random);
        };
        auto const push = [&] {
            double const r = std::sqrt(dot(x, x));
            for (std::size_t c = 0; c < 3; ++c)
                g[c] += step * pair.structure.mean_force(r) * x[c] / r;  // half a step of 2 F
        };
        for (double time = 0.0; time < longest; time += step) {
            double const share = often * (time == 0.0 ? 0.5 * step : step);
            Signals const now = signals(x, g);
            Values const products{
                dot(first.f, now.f),
                dot(first.F_own, now.F_mean),
                dot(first.f, now.F_mean),
                first.s * now.s,
                (first.B - first.B_mean) * (now.B + now.B_mean) - (first.B_own - first.B_mean) * now.B_mean,
                first.s * (now.B + now.B_mean),
                first.Phi_mean * now.s,
                first.Phi_mean * now.B + first.Phi_own * now.B_mean,
                first.Phi_mean * (now.B + now.B_own)};
            for (std::size_t q = 0; q < quantities; ++q) integral[q] += share * products[q];
            push();
            for (std::size_t c = 0; c < 3; ++c) x[c] += 0.5 * step * g[c];
            relax();
            if (double const r = std::sqrt(dot(x, x)); r < 1.0) {
                double const left =
                    std::exp(-2.0 * thermostat.gamma * weight_at(thermostat.weight, r) * step);
                double const change =
                    (left - 1.0) * dot(x, g) / r + std::sqrt(2.0 * (1.0 - left * left)) * normal(random);
                for (std::size_t c = 0; c < 3; ++c) g[c] += change * x[c] / r;
            }
            relax();
            for (std::size_t c = 0; c < 3; ++c) x[c] += 0.5 * step * g[c];
            push();
        }
        for (std::size_t q = 0; q < quantities; ++q) {
            sum[q] += integral[q];
            squares[q] += integral[q] * integral[q];
        }
    }
    Followed result;
    for (std::size_t q = 0; q < quantities; ++q) {
        result.mean[q] = sum[q] / trajectories;
        result.error[q] =
            std::sqrt((squares[q] / trajectories - result.mean[q] * result.mean[q]) / trajectories);
    }
    return result;
}

// As `dpdref run --csv` writes it, g = exp(-u/kT) in bins.
PairTable tabulated(double a) {
    PairTable table;
    for (int bin = 0; bin < 200; ++bin) {
        double const r = 0.01 * (bin + 0.5);
        table.r.push_back(r);
        table.g.push_back(r < 1.0 ? std::exp(-0.5 * a * (1.0 - r) * (1.0 - r)) : 1.0);
    }
    return table;
}

}  // namespace

// Nine comparisons, each a normal variable: one in 1800 runs of other seeds exceeds 4 (two-sided 6.3e-5
// each). The step's own error, of second order, is below a tenth of the statistical one.
BOOST_AUTO_TEST_CASE(agrees_with_pairs_that_are_followed) {
    Encounter const pair{3, Shardlow{4.5}, 2.0, 0.0, repelling()};
    constexpr int degree = 12;
    Values const expected = solved(pair, degree);
    auto const followed = follow(pair, 80000, 0.02, 3.5);
    for (std::size_t q = 0; q < quantities; ++q)
        BOOST_TEST(std::abs(followed.mean[q] - expected[q]) < 4.0 * followed.error[q],
                   labels[q] << ": followed " << followed.mean[q] << " +- " << followed.error[q]
                             << ", solved " << expected[q]);
}

// Without a potential nothing is left but the theory of the ideal gas, and the waves that it leaves out.
BOOST_AUTO_TEST_CASE(without_potential_it_is_the_gas) {
    Gas const gas{.n = 3.0};
    Shardlow const thermostat{.gamma = 6.0};
    auto const ideal = transport_with_memory(gas, thermostat).collision_viscosity;
    auto const soft = collision_viscosity_with_memory(gas, thermostat, {.a = 0.0});
    BOOST_TEST(soft.at_once == ideal.at_once, boost::test_tools::tolerance(1e-12));
    auto const same = boost::test_tools::tolerance(2e-4);  // both state 1e-4
    BOOST_TEST(soft.pair == ideal.pair, same);
    BOOST_TEST(soft.collective == ideal.collective, same);
    BOOST_TEST(soft.kinetic == ideal.cross, same);
    BOOST_TEST(soft.potential == 0.0);
    BOOST_TEST(soft.closure == 0.0);
    BOOST_TEST(soft.waves > 0.0);
    BOOST_TEST(soft.value() - soft.waves == ideal.value(), same);
}

// The kinetic stress of a thin gas is as large as it is rare, and pairs are n^2: the cross term is of first
// order in n and rules, all else of second.
BOOST_AUTO_TEST_CASE(low_density_is_ruled_by_the_kinetic_stress) {
    auto const at = [](double n) {
        return collision_viscosity_with_memory({.n = n}, {.gamma = 2.0}, {.a = 10.0});
    };
    auto const thin = at(0.01), twice = at(0.02);
    BOOST_TEST(twice.kinetic == 2.0 * thin.kinetic, boost::test_tools::tolerance(0.02));
    BOOST_TEST(thin.kinetic > 5.0 * thin.at_once);
    BOOST_TEST(twice.at_once == 4.0 * thin.at_once, boost::test_tools::tolerance(1e-12));
    BOOST_TEST(twice.potential == 4.0 * thin.potential, boost::test_tools::tolerance(0.02));
}

// Both cross terms are of first order in the friction, as eq. 12 is, so that its deviation does not vanish;
// what partners remember of the friction is of second.
BOOST_AUTO_TEST_CASE(weak_friction_keeps_the_cross_terms) {
    auto const at = [](double gamma) {
        return collision_viscosity_with_memory({.n = 1.0}, {.gamma = gamma}, {.a = 10.0});
    };
    auto const weak = at(0.02), twice = at(0.04);
    BOOST_TEST(twice.kinetic == 2.0 * weak.kinetic, boost::test_tools::tolerance(0.02));
    BOOST_TEST(twice.potential == 2.0 * weak.potential, boost::test_tools::tolerance(0.02));
    BOOST_TEST(twice.pair == 4.0 * weak.pair, boost::test_tools::tolerance(0.03));
    BOOST_TEST(weak.kinetic > 0.1 * weak.at_once);
    BOOST_TEST(weak.potential < -0.1 * weak.at_once);
    BOOST_TEST(std::abs(weak.pair) < 0.01 * weak.at_once);
}

// One state in two systems of units, with exp(-u/kT) from the formula and from a table.
BOOST_AUTO_TEST_CASE(units_scale_and_tables_are_read) {
    constexpr double a = 10.0, gamma = 4.5;
    auto const plain = collision_viscosity_with_memory({.n = 1.0}, {.gamma = gamma}, {.a = a});
    BOOST_TEST(plain.error < 1e-4 * plain.value());
    constexpr double m = 2.5, kT = 0.7, rc = 1.6;
    double const speed = std::sqrt(kT / m);
    auto table = tabulated(a);
    auto const file = (std::filesystem::temp_directory_path() / "memory_soft_test.csv").string();
    {
        std::ofstream out(file);
        out.precision(15);
        out << "curve,x,value,error,blocks\nvelocity,0.5,1,0,8\n";
        for (std::size_t i = 0; i < table.r.size(); ++i)
            out << "radial_distribution," << rc * table.r[i] << ',' << table.g[i] << ",0,8\n";
    }
    auto const scaled =
        collision_viscosity_with_memory({.n = 1.0 / (rc * rc * rc), .m = m, .kT = kT, .rc = rc},
                                        {.gamma = gamma * m * speed / rc}, {.a = a}, pair_table(file));
    std::filesystem::remove(file);
    double const unit = m * speed / (rc * rc);
    BOOST_TEST(scaled.value() == unit * plain.value(), boost::test_tools::tolerance(1e-4));
    BOOST_TEST(scaled.closure == unit * plain.closure, boost::test_tools::tolerance(1e-3));
}

BOOST_AUTO_TEST_CASE(refuses_what_has_no_answer) {
    Gas const gas{.n = 1.0};
    Shardlow const thermostat{.gamma = 4.5};
    BOOST_CHECK_THROW(collision_viscosity_with_memory(gas, thermostat, {.a = -1.0}), std::invalid_argument);
    BOOST_CHECK_THROW(collision_viscosity_with_memory({.d = 2, .n = 1.0}, thermostat, {.a = 1.0}),
                      std::domain_error);
    BOOST_CHECK_THROW(collision_viscosity_with_memory(gas, thermostat, {.a = 1.0}, {{0.5}, {1.0}}),
                      std::invalid_argument);
    auto short_of_the_cutoff = tabulated(1.0);
    short_of_the_cutoff.r.resize(90);
    short_of_the_cutoff.g.resize(90);
    BOOST_CHECK_THROW(collision_viscosity_with_memory(gas, thermostat, {.a = 1.0}, short_of_the_cutoff),
                      std::invalid_argument);
    BOOST_CHECK_THROW(pair_table("no such file"), std::invalid_argument);
    BOOST_CHECK_THROW(soft_stress_memory({3, Shardlow{1.0}, 1.0, 0.1, repelling()}, 6),
                      std::invalid_argument);
    BOOST_CHECK_THROW(soft_force_memory({3, Shardlow{1.0}, 1.0}, 6), std::invalid_argument);
}
