// The Lennard-Jones potential of the engine against values published by others: energy and virial of the NIST
// reference configurations, to every printed digit. Nothing is random here.
#define BOOST_TEST_MODULE lj
#include <algorithm>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include "forces.hpp"
#include "simulation.hpp"
#include "theory/closed_forms.hpp"

using namespace dpd;
namespace data = boost::unit_test::data;

namespace {

// A number as printed. It stands for whatever rounds to it, so the tolerance is half a unit of its last
// digit.
struct Printed {
    std::string digits;
    double value() const { return std::stod(digits); }
    double unit() const {
        auto const point = digits.find('.');
        auto const decimals = point == std::string::npos ? 0 : digits.size() - point - 1;
        return std::pow(10.0, -double(decimals));
    }
};

void check_printed(double computed, Printed const& printed, std::string const& what) {
    double const off = (computed - printed.value()) / printed.unit();
    BOOST_TEST_MESSAGE(what << ": printed " << printed.digits << ", off by " << off << " of the last digit");
    BOOST_TEST(std::abs(off) <= 0.5, what << ": " << computed << " is not " << printed.digits);
}

// NIST, "Lennard-Jones fluid reference calculations: cuboid cell", reduced units. Energy and virial with the
// potential cut at 3 and at 4, and with the linear force shift at 3. See data/nist_lj/README.md.
struct Reference {
    int number;
    Eigen::Index particles;
    double side;
    Printed energy_3, virial_3, energy_4, virial_4, energy_shift_3, virial_shift_3;
};

std::ostream& operator<<(std::ostream& stream, Reference const& reference) {
    return stream << "configuration " << reference.number;
}

std::vector<Reference> const references{
    {1, 800, 10, {"-4351.5"}, {"-568.67"}, {"-4467.5"}, {"-1263.9"}, {"-3870.9"}, {"317.54"}},
    {2, 200, 8, {"-690.00"}, {"-568.46"}, {"-704.60"}, {"-655.99"}, {"-620.12"}, {"-445.33"}},
    {3, 400, 10, {"-1146.7"}, {"-1164.9"}, {"-1175.4"}, {"-1337.1"}, {"-1021.0"}, {"-935.78"}},
    {4, 30, 8, {"-16.790"}, {"-46.249"}, {"-17.060"}, {"-47.869"}, {"-15.001"}, {"-43.096"}}};

std::string const& text(Search search) {
    static std::string const cell = "cell search", brute = "brute force";
    return search == Search::cell ? cell : brute;
}

// The configuration as a simulation. The files centre the box on 0; the engine's begins there.
Simulation<3> configuration(Reference const& reference, double cutoff, Search search) {
    auto const path = std::filesystem::path(DPDREF_TEST_DATA) / "nist_lj" /
                      ("lj_sample_config_periodic" + std::to_string(reference.number) + ".txt");
    std::ifstream file(path);
    Simulation<3> simulation;
    auto& length = simulation.box.length;
    Eigen::Index n = 0;
    file >> length[0] >> length[1] >> length[2] >> n;
    BOOST_REQUIRE_MESSAGE(file, "cannot read " << path);
    BOOST_TEST_REQUIRE(n == reference.particles);
    BOOST_TEST_REQUIRE((length.array() == reference.side).all());
    simulation.particles.resize(n);
    auto& position = simulation.particles.position;
    for (Eigen::Index p = 0; p < n; ++p) {
        Eigen::Index number = 0;
        file >> number >> position(p, 0) >> position(p, 1) >> position(p, 2);
        BOOST_REQUIRE_MESSAGE(file && number == p + 1, path << ": row of particle " << p + 1);
    }
    BOOST_TEST_REQUIRE(position.abs().maxCoeff() <= 0.5 * reference.side);
    simulation.box.wrap(simulation.particles, 0.0);
    simulation.pair_search.search = search;
    simulation.pair_search.cutoff = cutoff;
    simulation.pair_search.check(simulation.box);
    return simulation;
}

}  // namespace

// --- the published values --------------------------------------------------------------------------------

// A side of 8 is just two cut-offs of 4: the smallest box that the minimum image allows.
BOOST_DATA_TEST_CASE(nist_energy_and_virial, data::make(references), reference) {
    for (Search const search : {Search::cell, Search::brute})
        for (double const cutoff : {3.0, 4.0}) {
            auto simulation = configuration(reference, cutoff, search);
            auto const sums = potential_sums(simulation, LennardJones{.cutoff = cutoff});
            bool const at_3 = cutoff == 3.0;
            std::string const where = " at " + std::to_string(int(cutoff)) + ", " + text(search);
            check_printed(sums.energy, at_3 ? reference.energy_3 : reference.energy_4, "energy" + where);
            check_printed(sums.virial, at_3 ? reference.virial_3 : reference.virial_4, "virial" + where);
        }
}

// The engine has no force-shifted potential: its pairs, with the closed forms.
BOOST_DATA_TEST_CASE(nist_linear_force_shift, data::make(references), reference) {
    theory::LennardJones const lj{.rc = 3.0, .truncation = theory::Truncation::linear_force};
    for (Search const search : {Search::cell, Search::brute}) {
        auto simulation = configuration(reference, lj.rc, search);
        auto const& pairs = simulation.pairs();
        double energy = 0.0, virial = 0.0;
        for (std::size_t k = 0; k < pairs.count; ++k) {
            double const r = pairs.distance[k];
            energy += lennard_jones_energy(lj, r);
            virial += lennard_jones_force(lj, r) * r;
        }
        check_printed(energy, reference.energy_shift_3, "energy, force shifted, " + text(search));
        check_printed(virial, reference.virial_shift_3, "virial, force shifted, " + text(search));
    }
}

// --- engine, closed forms and derivatives ----------------------------------------------------------------

// Written twice, from the same formula: what differs is rounding. With u = 2^-53, (sigma/r)^6 is right to 11
// u in either, so its square to 22 u; the few operations that follow make it 32 u of the terms' magnitudes,
// and the difference of the two less than 64 u, plus that of the energy at the cut-off.
BOOST_AUTO_TEST_CASE(engine_and_closed_forms_are_the_same_to_rounding) {
    double const rounding = 32.0 * std::numeric_limits<double>::epsilon();  // 64 u
    for (bool const shifted : {false, true}) {
        LennardJones const engine{.epsilon = 0.7, .sigma = 1.3, .cutoff = 3.1, .shifted = shifted};
        theory::LennardJones const closed{
            .epsilon = 0.7,
            .sigma = 1.3,
            .rc = 3.1,
            .truncation = shifted ? theory::Truncation::energy_shift : theory::Truncation::none};
        auto const s6 = [&](double r) { return std::pow(engine.sigma / r, 6); };
        auto const scale = [&](double r) { return 4.0 * engine.epsilon * (s6(r) * s6(r) + s6(r)); };
        double energy = 0.0, force = 0.0, curvature = 0.0;  // largest differences, over what rounding allows
        for (int k = 0; k < 2600; ++k) {
            double const r = 0.5 + 0.001 * k;
            double const s = s6(r);
            double const at_cutoff = shifted ? scale(engine.cutoff) : 0.0;
            energy = std::max(energy, std::abs(engine.energy(r) - lennard_jones_energy(closed, r)) /
                                          (rounding * (scale(r) + at_cutoff)));
            force = std::max(force, std::abs(engine.force(r) - lennard_jones_force(closed, r)) /
                                        (rounding * 24.0 * engine.epsilon * (2.0 * s * s + s) / r));
            curvature = std::max(curvature,
                                 std::abs(engine.curvature(r) - lennard_jones_curvature(closed, r)) /
                                     (rounding * 24.0 * engine.epsilon * (26.0 * s * s + 7.0 * s) / (r * r)));
        }
        BOOST_TEST_MESSAGE("of the rounding allowed: energy " << energy << ", force " << force
                                                              << ", curvature " << curvature);
        BOOST_TEST(energy <= 1.0);
        BOOST_TEST(force <= 1.0);
        BOOST_TEST(curvature <= 1.0);
    }
}

// Every force is minus the derivative of the total energy by its particle's position, for some 30 particles
// of each configuration. The energy is the shifted one, which is continuous at the cut-off; its slope is not,
// so particles with a partner that may cross the cut-off within the displacements are left out.
//
// The formula of five points leaves h^4/30 of the fifth derivative, below 10^8 per pair: under 10^-9. The
// energy, a sum over 4 10^4 pairs that reaches 4 10^3, is rounded to some 10^-11; divided by h that is 10^-7.
BOOST_DATA_TEST_CASE(forces_are_minus_the_gradient_of_the_energy, data::make(references), reference) {
    double const h = 1e-4, accuracy = 1e-6;
    LennardJones const potential{.cutoff = 3.0, .shifted = true};
    auto simulation = configuration(reference, potential.cutoff + 0.1, Search::cell);
    Field<3> const force = forces(simulation, potential);
    auto const& pairs = simulation.pairs();
    std::vector<bool> crosses(std::size_t(reference.particles), false);
    for (std::size_t k = 0; k < pairs.count; ++k)
        if (std::abs(pairs.distance[k] - potential.cutoff) < 2.1 * h)
            crosses[pairs.i[k]] = crosses[pairs.j[k]] = true;
    auto const energy_with = [&](Eigen::Index p, int axis, double displacement) {
        auto moved = simulation;
        moved.particles.position(p, axis) += displacement;
        moved.box.wrap(moved.particles, 0.0);
        moved.positions_changed();
        return potential_sums(moved, potential).energy;
    };
    double largest = 0.0;
    int compared = 0;
    for (Eigen::Index p = 0; p < reference.particles;
         p += std::max<Eigen::Index>(1, reference.particles / 30)) {
        if (crosses[std::size_t(p)]) continue;
        ++compared;
        for (int axis = 0; axis < 3; ++axis) {
            double const gradient = (8.0 * (energy_with(p, axis, h) - energy_with(p, axis, -h)) -
                                     (energy_with(p, axis, 2.0 * h) - energy_with(p, axis, -2.0 * h))) /
                                    (12.0 * h);
            largest = std::max(largest, std::abs(force(p, axis) + gradient));
        }
    }
    BOOST_TEST_MESSAGE(compared << " particles, largest difference " << largest << ", largest force "
                                << force.abs().maxCoeff());
    BOOST_TEST(largest < accuracy);
    BOOST_TEST(compared >= 20);
    BOOST_TEST(force.abs().maxCoeff() > 1.0);  // there is something to compare
}
