/// @file
/// Bond-orientational order: ideal lattices, against sums of Legendre polynomials over pairs of bonds
/// (addition theorem: sum over m of |q_lm|^2 needs no spherical harmonic), random gases, and what a run keeps
/// of it.
#define BOOST_TEST_MODULE crystal
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <ostream>
#include <string>
#include <tuple>
#include <vector>

#include "analysis.hpp"
#include "run.hpp"
#include "sample.hpp"
#include "scene.hpp"

using namespace dpd;
namespace data = boost::unit_test::data;
using boost::test_tools::tolerance;

namespace {

double legendre(int l, double x) {
    double const x2 = x * x;
    return l == 4 ? (35.0 * x2 * x2 - 30.0 * x2 + 3.0) / 8.0
                  : (231.0 * x2 * x2 * x2 - 315.0 * x2 * x2 + 105.0 * x2 - 5.0) / 16.0;
}

/// One end of a bond, with its share in an average.
struct Bond {
    Vec<3> direction;
    double weight;
};

/// sqrt(4 pi/(2l+1) sum_m |sum_b weight_b Y_lm(b)|^2), which is sqrt(sum_bc weight_b weight_c P_l(cos bc)).
double order_of(std::vector<Bond> const& bonds, int l) {
    double sum = 0.0;
    for (auto const& b : bonds)
        for (auto const& c : bonds) sum += b.weight * c.weight * legendre(l, b.direction.dot(c.direction));
    return std::sqrt(std::max(0.0, sum));
}

/// Every pair closer than 1, by brute force and minimum image: `bonds[p]` are those of particle p.
struct Neighbours {
    std::vector<std::vector<Bond>> bonds;
    std::vector<std::vector<Eigen::Index>> partners;
    Neighbours(Particles<3> const& p, Box<3> const& box) {
        auto const n = static_cast<std::size_t>(p.size());
        bonds.resize(n);
        partners.resize(n);
        for (Eigen::Index i = 0; i < p.size(); ++i)
            for (Eigen::Index j = 0; j < p.size(); ++j) {
                Vec<3> s = (p.position.row(i) - p.position.row(j)).matrix().transpose();
                for (int axis = 0; axis < 3; ++axis)
                    s[axis] -= box.length[axis] * std::round(s[axis] / box.length[axis]);
                if (i == j || s.norm() >= 1.0) continue;
                bonds[std::size_t(i)].push_back({s.normalized(), 1.0});
                partners[std::size_t(i)].push_back(j);
            }
    }
};

double global_by_hand(Particles<3> const& p, Box<3> const& box, int l) {
    Neighbours const found(p, box);
    std::vector<Bond> all;
    for (Eigen::Index i = 0; i < p.size(); ++i)
        for (std::size_t b = 0; b < found.bonds[std::size_t(i)].size(); ++b)
            if (i < found.partners[std::size_t(i)][b] && !p.frozen(i) &&
                !p.frozen(found.partners[std::size_t(i)][b]))
                all.push_back(found.bonds[std::size_t(i)][b]);
    for (auto& bond : all) bond.weight = 1.0 / double(all.size());
    return order_of(all, l);
}

double local_by_hand(Particles<3> const& p, Box<3> const& box, int l) {
    Neighbours const found(p, box);
    double sum = 0.0;
    for (Eigen::Index i = 0; i < p.size(); ++i) {
        if (p.frozen(i)) continue;
        auto around = found.partners[std::size_t(i)];
        around.push_back(i);
        std::vector<Bond> all;
        for (Eigen::Index const k : around) {
            auto const& bonds = found.bonds[std::size_t(k)];
            for (auto const& bond : bonds)
                all.push_back({bond.direction, 1.0 / (double(bonds.size()) * double(around.size()))});
        }
        sum += order_of(all, l);
    }
    return sum / double(p.fluid);
}

struct Lattice {
    char const* name;
    Vec<3> cell;                ///< sides of a cell, in any unit: the density scales them
    std::vector<Vec<3>> sites;  ///< in it, in units of its sides
    std::array<int, 3> cells;
    std::size_t bonds;  ///< of a particle, closer than 1 at density 3
    double q4, q6;
};

std::ostream& operator<<(std::ostream& stream, Lattice const& lattice) { return stream << lattice.name; }

std::vector<Lattice> lattices() {
    double const half = 0.5, third = 1.0 / 3.0;
    Vec<3> const hexagonal(1.0, std::sqrt(3.0), std::sqrt(8.0 / 3.0));
    return {
        {"simple cubic", {1, 1, 1}, {{0, 0, 0}}, {4, 3, 4}, 18, 0.127294, 0.265165},
        {"body-centred", {1, 1, 1}, {{0, 0, 0}, {half, half, half}}, {3, 3, 3}, 14, 0.0363696, 0.510688},
        {"face-centred",
         {1, 1, 1},
         {{0, 0, 0}, {half, half, 0}, {half, 0, half}, {0, half, half}},
         {3, 2, 2},
         12,
         0.190941,
         0.574524},
        {"hexagonal",
         hexagonal,
         {{0, 0, 0}, {half, half, 0}, {half, half + third, half}, {0, third, half}},
         {3, 2, 2},
         12,
         0.0972222,
         0.484762},
    };
}

/// The lattice at density 3; no particle lies on a face of the box.
Simulation<3> crystal(Lattice const& lattice) {
    Simulation<3> simulation;
    double const scale = std::cbrt(double(lattice.sites.size()) / (3.0 * lattice.cell.prod()));
    Vec<3> const cell = lattice.cell * scale;
    for (int axis = 0; axis < 3; ++axis)
        simulation.box.length[axis] = cell[axis] * lattice.cells[std::size_t(axis)];
    Eigen::Index row = 0;
    simulation.particles.resize(static_cast<Eigen::Index>(lattice.sites.size()) * lattice.cells[0] *
                                lattice.cells[1] * lattice.cells[2]);
    for (int x = 0; x < lattice.cells[0]; ++x)
        for (int y = 0; y < lattice.cells[1]; ++y)
            for (int z = 0; z < lattice.cells[2]; ++z)
                for (auto const& site : lattice.sites)
                    simulation.particles.position.row(row++) =
                        (cell.array() * (Vec<3>(x, y, z) + site).array() + 0.01).transpose();
    return simulation;
}

Simulation<3> random_gas(Eigen::Index n, double side, std::uint64_t seed) {
    Simulation<3> simulation;
    simulation.box.length.setConstant(side);
    simulation.particles.resize(n);
    randomize(simulation.particles, simulation.box, 1.0, seed);
    return simulation;
}

}  // namespace

BOOST_DATA_TEST_CASE(ideal_lattices, data::make(lattices()), lattice) {
    auto simulation = crystal(lattice);
    auto const& [p, box] = std::tie(simulation.particles, simulation.box);
    BOOST_TEST(double(p.size()) == 3.0 * box.volume(), tolerance(1e-13));
    for (auto const& bonds : Neighbours(p, box).bonds) BOOST_REQUIRE_EQUAL(bonds.size(), lattice.bonds);
    auto const& pairs = simulation.pairs();
    BOOST_TEST(pairs.count == std::size_t(p.size()) * lattice.bonds / 2);
    for (int const l : {4, 6}) BOOST_TEST_CONTEXT("l = " << l) {
            BondOrder const order = bond_order(p, pairs, l);
            double const expected = l == 4 ? lattice.q4 : lattice.q6;
            BOOST_TEST(order.global == expected, tolerance(5e-6));  // as many digits as are given
            // every particle sees the same: for even l the two kinds of hexagonal sites, too
            BOOST_TEST(order.local == order.global, tolerance(1e-12));
            BOOST_TEST(order.global == global_by_hand(p, box, l), tolerance(1e-11));
            BOOST_TEST(order.local == local_by_hand(p, box, l), tolerance(1e-11));
        }
}

// Numbers of bonds that differ, particles without any, and frozen ones: they are neighbours only.
BOOST_DATA_TEST_CASE(disordered_particles_against_legendre_sums, data::make({0.5, 1.5}) * data::make({0, 25}),
                     density, frozen) {
    auto simulation = random_gas(70, std::cbrt(70.0 / density), 3);
    simulation.particles.fluid = std::uint32_t(70 - frozen);
    auto const& [p, box] = std::tie(simulation.particles, simulation.box);
    auto const& pairs = simulation.pairs();
    std::size_t alone = 0, most = 0;
    for (auto const& bonds : Neighbours(p, box).bonds) {
        alone += bonds.empty();
        most = std::max(most, bonds.size());
    }
    BOOST_TEST((alone > 0) == (density < 1.0));
    BOOST_TEST(most > 4u);
    for (int const l : {4, 6}) BOOST_TEST_CONTEXT("l = " << l) {
            BondOrder const order = bond_order(p, pairs, l);
            BOOST_TEST(order.global == global_by_hand(p, box, l), tolerance(1e-11));
            BOOST_TEST(order.local == local_by_hand(p, box, l), tolerance(1e-11));
            BOOST_TEST(std::abs(order.global - order.local) > 0.03);
        }
}

BOOST_AUTO_TEST_CASE(order_does_not_depend_on_directions_or_their_sign) {
    for (bool const ordered : {true, false}) {
        auto simulation = ordered ? crystal(lattices()[3]) : random_gas(60, 3.0, 5);
        auto& pairs = simulation.pairs();
        for (int const l : {4, 6}) {
            BondOrder const before = bond_order(simulation.particles, pairs, l);
            auto turned = pairs;
            Eigen::Matrix3d const rotation =
                Eigen::AngleAxisd(0.7, Vec<3>(1.0, -2.0, 0.5).normalized()).toRotationMatrix();
            for (std::size_t k = 0; k < turned.count; ++k) {
                double const sign = k % 3 == 0 ? -1.0 : 1.0;
                Vec<3> const e =
                    sign * rotation * Vec<3>(pairs.unit[0][k], pairs.unit[1][k], pairs.unit[2][k]);
                for (int axis = 0; axis < 3; ++axis) turned.unit[std::size_t(axis)][k] = e[axis];
            }
            BondOrder const after = bond_order(simulation.particles, turned, l);
            BOOST_TEST(after.global == before.global, tolerance(1e-12));
            BOOST_TEST(after.local == before.local, tolerance(1e-12));
        }
    }
    // a single bond has the largest order of all, and no bond none
    auto two = random_gas(2, 3.0, 1);
    two.particles.position << 1.0, 1.0, 1.0, 1.3, 0.6, 1.5;
    BondOrder const one_bond = bond_order(two.particles, two.pairs(), 6);
    BOOST_TEST(one_bond.global == 1.0, tolerance(1e-13));
    BOOST_TEST(one_bond.local == 1.0, tolerance(1e-13));
    two.particles.position.row(1) << 2.5, 2.5, 2.5;
    two.positions_changed();
    BondOrder const none = bond_order(two.particles, two.pairs(), 6);
    BOOST_TEST(none.global == 0.0);
    BOOST_TEST(none.local == 0.0);
}

// Two half crystals, turned against each other: the local order hardly sees it, the global one falls.
BOOST_AUTO_TEST_CASE(crystallites_are_seen_locally) {
    auto simulation = crystal(lattices()[2]);
    auto& pairs = simulation.pairs();
    BondOrder const whole = bond_order(simulation.particles, pairs, 6);
    Particles<3> two = simulation.particles;
    auto const n = two.size();
    two.resize(2 * n);
    PairList<3> both = pairs;
    Eigen::Matrix3d const rotation =
        Eigen::AngleAxisd(0.6, Vec<3>(1.0, 1.0, 0.2).normalized()).toRotationMatrix();
    both.i.resize(pairs.count);
    both.j.resize(pairs.count);
    for (auto& unit : both.unit) unit.resize(pairs.count);
    for (std::size_t k = 0; k < pairs.count; ++k) {
        both.i.push_back(pairs.i[k] + std::uint32_t(n));
        both.j.push_back(pairs.j[k] + std::uint32_t(n));
        Vec<3> const e = rotation * Vec<3>(pairs.unit[0][k], pairs.unit[1][k], pairs.unit[2][k]);
        for (int axis = 0; axis < 3; ++axis) both.unit[std::size_t(axis)].push_back(e[axis]);
    }
    both.count = 2 * pairs.count;
    BondOrder const order = bond_order(two, both, 6);
    BOOST_TEST(order.local == whole.local, tolerance(1e-12));
    BOOST_TEST(order.global < 0.9 * whole.global);
}

// Bonds of a random gas point anywhere and independently of each other, in pairs: the mean square of the
// global order is one over their number. It has 2l+1 degrees of freedom; the bound is 4.5 standard errors.
BOOST_AUTO_TEST_CASE(a_random_gas_has_no_global_order) {
    constexpr int samples = 25;
    double sum4 = 0.0, sum6 = 0.0;
    for (std::uint64_t seed = 1; seed <= samples; ++seed) {
        auto simulation = random_gas(200, std::cbrt(200.0 / 3.0), seed);
        auto const& pairs = simulation.pairs();
        double const q4 = bond_order(simulation.particles, pairs, 4).global,
                     q6 = bond_order(simulation.particles, pairs, 6).global;
        sum4 += q4 * q4 * double(pairs.count) / samples;
        sum6 += q6 * q6 * double(pairs.count) / samples;
    }
    BOOST_TEST(std::abs(sum4 - 1.0) < 4.5 * std::sqrt(2.0 / (9.0 * samples)));
    BOOST_TEST(std::abs(sum6 - 1.0) < 4.5 * std::sqrt(2.0 / (13.0 * samples)));
}

// --- what a run keeps ------------------------------------------------------------------------------------

namespace {

Scene scene(std::vector<std::string> const& assignments) {
    std::vector<std::string> all{
        "dimension=3",        "box.length=[4, 4, 4]",   "particles.density=1",       "time.step=0.05",
        "time.duration=0.55", "time.equilibration=0.1", "stages=['sample', 'drift']"};
    all.insert(all.end(), assignments.begin(), assignments.end());
    return parse_scene("[time]\n", "crystal_test", all);
}

}  // namespace

BOOST_AUTO_TEST_CASE(a_run_samples_the_order_within_the_range_asked_for) {
    // particles that stay on a simple cubic lattice of spacing 1: six bonds, or eighteen
    for (auto const& [range, q4, q6] : {std::tuple(1.2, std::sqrt(7.0 / 12.0), std::sqrt(1.0 / 8.0)),
                                        std::tuple(1.5, 0.127294, 0.265165)}) {
        Scene const lattice =
            scene({"particles.start=lattice", "particles.kT=0",
                   fmt::format("sample.bond_order.range={}", range), "sample.bond_order.interval=4"});
        Record const record = run(lattice).record;
        BOOST_TEST(record.series.size() == 4u);
        BOOST_TEST(record.configuration.size() == 0);
        for (std::string const where : {"global", "local"}) {
            auto const &four = record.series.at(where + "_q4"), &six = record.series.at(where + "_q6");
            BOOST_REQUIRE_EQUAL(four.size(), 3u);  // of eleven steps after two of equilibration
            BOOST_REQUIRE_EQUAL(six.size(), 3u);
            for (std::size_t k = 0; k < 3; ++k) {
                BOOST_TEST(four[k] == q4, tolerance(5e-6));
                BOOST_TEST(six[k] == q6, tolerance(5e-6));
            }
            auto const quantities = analyze(lattice, {record, record});
            BOOST_REQUIRE(find_quantity(quantities, where + "_q6"));
            BOOST_TEST(find_quantity(quantities, where + "_q6")->estimate.value == q6, tolerance(5e-6));
            BOOST_TEST(find_quantity(quantities, where + "_q4")->estimate.value == q4, tolerance(5e-6));
        }
    }
}

BOOST_AUTO_TEST_CASE(a_run_samples_what_moves) {
    Scene const gas = scene({"sample.bond_order.range=1.3", "sample.bond_order.interval=5",
                             "sample.interval=3", "sample.configuration=true"});
    std::vector<double> q4, q6;
    Field<3> last;
    auto simulation = build<3>(gas, [&](Simulation<3>& s) {
        if (s.step >= 2 && (s.step - 2) % 5 == 0) {
            PairSearch<3> search;
            PairList<3> pairs;
            search.cutoff = 1.3;
            search.find(s.particles, s.box, s.time, {}, pairs);
            q4.push_back(bond_order(s.particles, pairs, 4).local);
            q6.push_back(bond_order(s.particles, pairs, 6).global);
        }
        if (s.step == 11) {  // 2 + 3 * 3, the last sample of thirteen steps
            last.resize(s.particles.size(), 3);
            for (Eigen::Index p = 0; p < s.particles.size(); ++p)
                last.row(s.particles.id[p]) = s.particles.position.row(p);
        }
    });
    for (std::uint64_t step = 0; step < gas.steps(); ++step) simulation.advance();
    Record const record = run(gas).record;
    BOOST_TEST(q4.size() == 3u);
    BOOST_TEST(q4.front() != q4.back());
    BOOST_TEST(record.series.at("local_q4") == q4, boost::test_tools::per_element());
    BOOST_TEST(record.series.at("global_q6") == q6, boost::test_tools::per_element());
    BOOST_REQUIRE_EQUAL(record.configuration.rows(), 64);
    BOOST_REQUIRE_EQUAL(record.configuration.cols(), 3);
    BOOST_TEST((record.configuration == last).all());
    BOOST_TEST((last >= 0.0 && last < 4.0).all());
}

// Particles of the wall are not in the configuration, but are neighbours.
BOOST_AUTO_TEST_CASE(walls_and_the_configuration) {
    Scene const channel =
        scene({"stages=['modified_verlet', 'sample']", "modified_verlet.gamma=0", "modified_verlet.sigma=0",
               "modified_verlet.soft.strength=0", "box.length=[4, 6, 4]", "walls.thickness=1",
               "particles.start=lattice", "sample.bond_order.range=1.2", "sample.bond_order.interval=1",
               "sample.configuration=true", "particles.kT=0"});
    Record const record = run(channel).record;
    BOOST_TEST(channel.particles == 64u);
    BOOST_TEST(channel.wall_particles == 32u);
    BOOST_REQUIRE_EQUAL(record.configuration.rows(), 64);
    BOOST_TEST((record.configuration.col(1) > 1.0 && record.configuration.col(1) < 5.0).all());
    // the walls go on with the fluid's lattice
    BOOST_TEST(record.series.at("local_q6").back() == std::sqrt(1.0 / 8.0), tolerance(1e-12));
    // without the bonds into the walls 64 each are left along x and z, 48 along y
    double const x = 64.0 / 176.0, y = 48.0 / 176.0;
    double const q4 = std::sqrt(x * x + x * x + y * y + 2.0 * (x * x + 2.0 * x * y) * 3.0 / 8.0);
    BOOST_TEST(record.series.at("global_q4").back() == q4, tolerance(1e-12));
}
