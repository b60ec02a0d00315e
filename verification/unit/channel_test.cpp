/// @file
/// Poiseuille flow and the map from atoms to DPD: what is read from profiles, from g(r), from pressures and
/// from viscosities, by made-up records with known answers; which components of displacements count in a
/// flow.
#define BOOST_TEST_MODULE channel
#include <fmt/format.h>

#include <algorithm>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <memory>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

#include "analysis.hpp"
#include "derived.hpp"
#include "errors.hpp"
#include "run.hpp"
#include "scene.hpp"
#include "theory/closed_forms.hpp"

using namespace dpd;
namespace data = boost::unit_test::data;
using boost::test_tools::tolerance;

namespace {

Scene scene(std::vector<std::string> const& assignments) {
    std::vector<std::string> all{"dimension=3", "time.step=0.1", "time.duration=20", "particles.density=3"};
    all.insert(all.end(), assignments.begin(), assignments.end());
    return parse_scene("[time]\n", "channel_test", all);
}

/// Two opposed flows, each 6 wide, or one between walls: n = 3, m = 2, g = 0.3.
Scene opposed(std::vector<std::string> const& more = {}) {
    std::vector<std::string> all{"stages=['shardlow', 'body_force', 'sample', 'drift']",
                                 "box.length=[5, 12, 5]",
                                 "shardlow.friction=4.5",
                                 "body_force.acceleration=0.3",
                                 "body_force.opposed=true",
                                 "particles.mass=2"};
    all.insert(all.end(), more.begin(), more.end());
    return scene(all);
}

Scene walls(std::vector<std::string> const& more = {}) {
    std::vector<std::string> all{"stages=['modified_verlet', 'body_force', 'sample']",
                                 "box.length=[5, 8, 5]",
                                 "walls.thickness=1",
                                 "modified_verlet.gamma=45",
                                 "modified_verlet.sigma=3",
                                 "modified_verlet.soft.strength=25",
                                 "body_force.acceleration=0.3",
                                 "particles.mass=2"};
    all.insert(all.end(), more.begin(), more.end());
    return scene(all);
}

constexpr double width = 6.0;  // of either

/// PK2006's fluid, in the atoms' units.
std::vector<std::string> const mapped{"stages=['modified_verlet', 'body_force', 'sample']",
                                      "coarse_graining.atoms_per_particle=5",
                                      "coarse_graining.length=[34.2, 68.4, 8.55]",
                                      "coarse_graining.force=0.0085",
                                      "coarse_graining.viscosity=2.117",
                                      "box.shear_rate=0",
                                      "modified_verlet.gamma=45",
                                      "modified_verlet.sigma=3",
                                      "modified_verlet.soft={}",
                                      "body_force.opposed=true"};

Estimate const& estimate_of(std::vector<Quantity> const& quantities, std::string const& name) {
    Quantity const* const quantity = find_quantity(quantities, name);
    BOOST_REQUIRE_MESSAGE(quantity, "no " << name);
    return quantity->estimate;
}

void check_estimate(std::vector<Quantity> const& quantities, std::string const& name, double value,
                    double error, double within = 1e-12) {
    Estimate const& estimate = estimate_of(quantities, name);
    BOOST_TEST_CONTEXT(name) {
        BOOST_TEST(std::abs(estimate.value - value) <= within * std::max(std::abs(value), 1.0),
                   estimate.value << " is not " << value);
        BOOST_TEST(std::abs(estimate.error - error) <= within * std::max(std::abs(value), 1.0),
                   estimate.error << " is not an error of " << error);
    }
}

bool measures(std::vector<Quantity> const& quantities, std::string const& name) {
    return find_quantity(quantities, name) != nullptr;
}

/// Of so many samples, against which every mode of the flow is short: blocks of time are independent.
constexpr double long_run = 0x1p80;

/// A profile with value(y, block) in each bin; the weight of a bin must not matter.
template <class F>
Curve profile(Scene const& scene, std::size_t bins, F&& value) {
    Curve curve;
    curve.resize(bins);
    double const spacing = scene.length[1] / double(bins);
    for (std::size_t b = 0; b < bins; ++b) {
        curve.x[b] = (double(b) + 0.5) * spacing;
        auto const bin = static_cast<Eigen::Index>(b);
        for (Eigen::Index block = 0; block < curve_blocks; ++block) {
            curve.weight(bin, block) = long_run * (3.0 + double(b % 4) + double(block));
            curve.sum(bin, block) = curve.weight(bin, block) * value(curve.x[b], block);
        }
    }
    return curve;
}

/// A velocity profile of u(z, block), z from the lower wall of each flow; opposed flows mirror it. In walls
/// there are no particles.
template <class F>
Curve flow(Scene const& scene, std::size_t bins, F&& u) {
    Curve curve = profile(scene, bins, [&](double y, Eigen::Index block) {
        bool const upper = scene.stage<BodyForce>()->opposed && y >= width;
        double const z = upper ? y - width : y - scene.wall;
        return z < 0.0 || z > width ? 0.0 : (upper ? -1.0 : 1.0) * u(z, block);
    });
    for (std::size_t b = 0; b < bins; ++b)
        if (curve.x[b] < scene.wall || curve.x[b] > scene.length[1] - scene.wall)
            curve.sum.row(Eigen::Index(b)) = curve.weight.row(Eigen::Index(b)) = 0.0;
    return curve;
}

/// Blocks scatter by a share about the mean, whose error is share/sqrt(7): eight blocks.
double scattered(double mean, double share, Eigen::Index block) {
    return mean * (1.0 + (block % 2 == 0 ? -share : share));
}
double const per_share = 1.0 / std::sqrt(7.0);

double parabola(double maximum, double z) { return maximum * 4.0 * z * (width - z) / (width * width); }

}  // namespace

// --- profiles --------------------------------------------------------------------------------------------

BOOST_DATA_TEST_CASE(a_parabola_gives_viscosity_and_maximum, data::make({false, true}) * data::make({24, 96}),
                     between_walls, bins) {
    Scene const channel = between_walls ? walls() : opposed();
    BOOST_TEST(channel.channel_width() == width);
    double const maximum = 1.7, share = 0.02;
    Record record;
    record.curves["velocity_profile"] = flow(channel, std::size_t(bins), [&](double z, Eigen::Index block) {
        return scattered(parabola(maximum, z), share, block);
    });
    auto const quantities = analyze(channel, {record});
    // n m g L^2/(8 u), whose mean over blocks is not that of u
    double const eta = 3.0 * 2.0 * 0.3 * width * width / (8.0 * maximum);
    check_estimate(quantities, "poiseuille_viscosity", eta / (1.0 - share * share),
                   eta * share / (1.0 - share * share) * per_share);
    check_estimate(quantities, "maximum_velocity", maximum, maximum * share * per_share, 1e-7);
    check_estimate(quantities, "power_law_index", 1.0, 0.0, 1e-6);
    check_estimate(quantities, "slip", 0.0, 0.0);
    BOOST_TEST(estimate_of(quantities, "slip").blocks == std::size_t(curve_blocks));
    BOOST_TEST(estimate_of(quantities, "power_law_index").blocks == std::size_t(curve_blocks));
    // a force the other way drives the fluid the other way
    auto const backwards =
        between_walls ? walls({"body_force.acceleration=-0.3"}) : opposed({"body_force.acceleration=-0.3"});
    record.curves["velocity_profile"].sum *= -1.0;
    auto const mirrored = analyze(backwards, {record, record});
    check_estimate(mirrored, "maximum_velocity", -maximum, maximum * share / std::sqrt(15.0), 1e-7);
    BOOST_TEST(estimate_of(mirrored, "poiseuille_viscosity").value == eta / (1.0 - share * share),
               tolerance(1e-12));
}

BOOST_DATA_TEST_CASE(a_power_law_gives_its_index,
                     data::make({false, true}) * data::make({0.3, 0.738, 0.9, 1.2, 2.5}), between_walls,
                     index) {
    Scene const channel = between_walls ? walls() : opposed();
    double const maximum = 0.21;
    Record record;
    record.curves["velocity_profile"] = flow(channel, 48, [&](double z, Eigen::Index) {
        return maximum * (1.0 - std::pow(std::abs(1.0 - 2.0 * z / width), 1.0 / index + 1.0));
    });
    auto const quantities = analyze(channel, {record});
    check_estimate(quantities, "power_law_index", index, 0.0, 2e-6);
    check_estimate(quantities, "maximum_velocity", maximum, 0.0, 1e-7);
    // flatter than a parabola, seen by a parabola: a slip
    BOOST_TEST((estimate_of(quantities, "slip").value > 1e-3) == (index < 1.0));
    BOOST_TEST((estimate_of(quantities, "slip").value < -1e-3) == (index > 1.0));
}

// The flow's energy is a part of this temperature: slow, and hidden from blocking by what is fast.
BOOST_AUTO_TEST_CASE(the_temperature_of_a_driven_flow_has_errors_as_slow_as_the_flow) {
    Scene const channel = opposed({"sample.profile.bins=24"});
    double const share = 0.001;
    Record record;
    record.curves["velocity_profile"] =
        flow(channel, 24, [](double z, Eigen::Index) { return parabola(1.7, z); });
    auto& series = record.series["kinetic_temperature"];
    constexpr std::size_t in_block = 1000;
    for (Eigen::Index block = 0; block < curve_blocks; ++block)
        for (std::size_t k = 0; k < in_block; ++k)
            series.push_back(scattered(1.2, share, block) + (k % 2 == 0 ? 0.1 : -0.1));
    auto const series_before = series;
    check_estimate(analyze(channel, {record}), "kinetic_temperature", 1.2, 1.2 * share * per_share);
    // a run shorter than the flow remembers says less
    record.curves["velocity_profile"].sum /= 1e3 * long_run;
    record.curves["velocity_profile"].weight /= 1e3 * long_run;
    BOOST_TEST(estimate_of(analyze(channel, {record}), "kinetic_temperature").error >
               2.0 * 1.2 * share * per_share);
    // with fewer samples than blocks there is no such error, and the mean stays
    record.series["kinetic_temperature"] = {1.2, 1.3, 1.1};
    BOOST_TEST(estimate_of(analyze(channel, {record}), "kinetic_temperature").blocks == 3u);
    record.series["kinetic_temperature"] = series_before;
    // without a flow that drives it blocks are as long as the series asks for
    record.curves.clear();
    BOOST_TEST(estimate_of(analyze(channel, {record}), "kinetic_temperature").error <
               0.9 * 1.2 * share * per_share);
}

BOOST_DATA_TEST_CASE(slip_is_told_from_the_parabola,
                     data::make({false, true}) * data::make({-0.1, 0.05, 0.4}), between_walls, slip) {
    Scene const channel = between_walls ? walls() : opposed();
    Record record;
    record.curves["velocity_profile"] = flow(channel, 48, [&](double z, Eigen::Index block) {
        return scattered(parabola(1.3, z), 0.02, block) + scattered(1.3 * slip, 0.02, block);
    });
    auto const quantities = analyze(channel, {record});
    check_estimate(quantities, "slip", slip, 0.0);
    // the viscosity is that of the parabola without slip that fits best: u = c p, c = sum p u / sum p^2
    double product = 0.0, square = 0.0;
    for (int bin = 0; bin < (between_walls ? 36 : 24); ++bin) {
        double const z = width * (bin + 0.5) / (between_walls ? 36 : 24), p = z * (width - z);
        product += p * (parabola(1.3, z) + 1.3 * slip);
        square += p * p;
    }
    double const eta = 3.0 * 2.0 * 0.3 / (2.0 * product / square);
    check_estimate(quantities, "poiseuille_viscosity", eta / (1.0 - 0.02 * 0.02),
                   eta * 0.02 / (1.0 - 0.02 * 0.02) * per_share);
}

BOOST_DATA_TEST_CASE(densities_across_a_channel, data::make({false, true}), between_walls) {
    Scene const channel = between_walls ? walls() : opposed();
    std::size_t const bins = between_walls ? 32 : 48;  // 24 in each channel, 12 of them in its middle half
    Record record;
    record.curves["velocity_profile"] =
        flow(channel, bins, [](double z, Eigen::Index) { return parabola(1.0, z); });
    record.curves["density_profile"] = profile(channel, bins, [&](double y, Eigen::Index block) {
        double const z = channel.stage<BodyForce>()->opposed && y >= width ? y - width : y - channel.wall;
        if (z < 0.0 || z > width) return between_walls && y < 1.0 ? 77.0 : 0.0;  // not fluid
        double const n = std::abs(z - 3.0) < 1.5 ? 2.7 : z < 0.25 ? 5.1 : 3.6;
        return scattered(n, 0.05, block);
    });
    auto const quantities = analyze(channel, {record});
    check_estimate(quantities, "bulk_density", 0.9, 0.9 * 0.05 * per_share);
    check_estimate(quantities, "density_peak", 1.7, 1.7 * 0.05 * per_share);
}

BOOST_AUTO_TEST_CASE(what_is_no_channel_gives_nothing_of_one) {
    Record record;
    auto const names = {"poiseuille_viscosity", "maximum_velocity", "power_law_index", "slip",
                        "bulk_density",         "density_peak",     "mach_number"};
    auto const fill = [&](Scene const& fluid, std::size_t bins) {
        record.curves["velocity_profile"] =
            profile(fluid, bins, [](double y, Eigen::Index) { return std::sin(y); });
        record.curves["density_profile"] = profile(fluid, bins, [](double, Eigen::Index) { return 3.0; });
    };
    // one direction in a periodic box; a force of nothing; three bins in the channel at most; no force
    for (auto const& [fluid, bins] : {std::pair(opposed({"body_force.opposed=false"}), 24),
                                      std::pair(opposed({"body_force.acceleration=0"}), 24),
                                      std::pair(opposed(), 2), std::pair(opposed(), 3), std::pair(walls(), 5),
                                      std::pair(scene({"stages=['shardlow', 'sample', 'drift']",
                                                       "box.length=[5, 12, 5]", "shardlow.friction=1"}),
                                                24)}) {
        fill(fluid, std::size_t(bins));
        auto const quantities = analyze(fluid, {record});
        for (char const* name : names) BOOST_TEST(!measures(quantities, name), name << ", " << bins);
    }
    fill(opposed(), 4);
    auto quantities = analyze(opposed(), {record});
    BOOST_TEST(measures(quantities, "slip"));
    for (char const* name : {"navier_stokes_ratio", "navier_stokes_deviation", "mach_number"})
        BOOST_TEST(!measures(quantities, name), name);  // without a map
    // a block that never saw a particle in one bin is left out; outside of the channel it does not matter
    record.curves["velocity_profile"].weight(2, 3) = record.curves["velocity_profile"].sum(2, 3) = 0.0;
    BOOST_TEST(estimate_of(analyze(opposed(), {record}), "slip").blocks == 7u);
    record.curves.erase("density_profile");
    BOOST_TEST(!measures(analyze(opposed(), {record}), "bulk_density"));
    BOOST_TEST(measures(analyze(opposed(), {record}), "slip"));
    record.curves.clear();
    BOOST_TEST(!measures(analyze(opposed(), {record}), "slip"));
}

// The scene knows what Navier & Stokes expect.
BOOST_AUTO_TEST_CASE(profiles_against_navier_and_stokes) {
    Scene const channel = scene(mapped);
    double const eta = 2.117, rc = std::cbrt(5.0 * 3.0 / 0.8), L = 34.2 / rc, n = channel.density(),
                 unit = eta / 3.0 / (1.97 / 0.8) * rc * rc, force = 0.0085 * unit * unit / rc;
    BOOST_TEST(channel.channel_width() == L, tolerance(1e-14));
    BOOST_TEST(channel.stage<BodyForce>()->acceleration == force, tolerance(1e-13));
    BOOST_TEST(n == 3.0, tolerance(2e-3));  // whole particles
    double const expected = n * force * L * L / (8.0 * eta);
    for (double const factor : {0.8, 1.1}) {
        Record record;
        record.curves["velocity_profile"] = profile(channel, 130, [&](double y, Eigen::Index block) {
            double const z = y >= L ? y - L : y;
            return (y >= L ? -1.0 : 1.0) * scattered(factor * expected, 0.01, block) * 4.0 * z * (L - z) /
                   (L * L);
        });
        auto const quantities = analyze(channel, {record});
        check_estimate(quantities, "navier_stokes_ratio", factor, factor * 0.01 * per_share, 1e-7);
        // root mean square of 4 z (L - z)/L^2 in the bins, times |factor - 1|
        double square = 0.0;
        for (int bin = 0; bin < 65; ++bin) {
            double const z = (bin + 0.5) / 65.0;
            square += std::pow(4.0 * z * (1.0 - z), 2) / 65.0;
        }
        check_estimate(quantities, "navier_stokes_deviation", std::sqrt(square) * std::abs(factor - 1.0),
                       std::sqrt(square) * factor * 0.01 * per_share);
        // c^2 = (kT/m)(1 + 2 alpha a n/kT), which at n = 3 is 15.36 N_m kT/m
        double const slope = 1.0 + (15.36 * 5.0 - 1.0) * n / 3.0, c = std::sqrt(0.1 * slope);
        check_estimate(quantities, "mach_number", factor * expected / c,
                       factor * expected / c * 0.01 * per_share, 1e-6);
        BOOST_TEST(c == std::sqrt(0.1 * 15.36 * 5.0), tolerance(2e-3));
    }
}

BOOST_AUTO_TEST_CASE(two_opposed_flows_are_laid_over_each_other) {
    Scene const channel = opposed();
    Record record;
    record.curves["velocity_profile"] =
        flow(channel, 24, [](double z, Eigen::Index block) { return z * (width - z) + double(block); });
    // the upper flow is faster and counted three times as often
    auto& curve = record.curves["velocity_profile"];
    curve.weight.bottomRows(12) *= 3.0;
    curve.sum.bottomRows(12) *= 6.0;
    auto const across = curve_of(channel, {record}, "channel_profile");
    BOOST_REQUIRE_EQUAL(across.x.size(), 12u);
    for (std::size_t bin = 0; bin < 12; ++bin) {
        double const z = 0.25 + 0.5 * double(bin);
        BOOST_TEST(across.x[bin] == z, tolerance(1e-8));
        double mean = 0.0;
        auto const row = Eigen::Index(bin);
        for (Eigen::Index block = 0; block < curve_blocks; ++block) {
            double const low = curve.weight(row, block), high = curve.weight(row + 12, block);
            mean +=
                (low + 2.0 * high) / (low + high) * (z * (width - z) + double(block)) / double(curve_blocks);
        }
        BOOST_TEST(across.y[bin].value == mean, tolerance(1e-12));
        BOOST_TEST(across.y[bin].blocks == std::size_t(curve_blocks));
    }
    // a middle that is no bin's edge leaves the bins of either flow apart, in the order of their heights
    record.curves["velocity_profile"] =
        flow(channel, 15, [](double z, Eigen::Index) { return parabola(1.0, z); });
    auto const apart = curve_of(channel, {record, record}, "channel_profile");
    BOOST_TEST(apart.x.size() == 14u);
    for (std::size_t bin = 0; bin < apart.x.size(); ++bin) {
        BOOST_TEST(apart.y[bin].value == parabola(1.0, apart.x[bin]), tolerance(1e-7));
        BOOST_TEST(apart.y[bin].blocks == 2 * std::size_t(curve_blocks));
        if (bin > 0) BOOST_TEST(apart.x[bin] > apart.x[bin - 1]);
    }
    BOOST_TEST(curve_of(channel, {}, "channel_profile").x.empty());
}

BOOST_AUTO_TEST_CASE(the_profile_between_walls_and_its_units) {
    Scene const channel = walls();
    Record record;
    record.curves["velocity_profile"] = flow(channel, 32, [](double z, Eigen::Index) { return z; });
    auto const across = curve_of(channel, {record}, "channel_profile");
    BOOST_REQUIRE_EQUAL(across.x.size(), 24u);  // without the walls
    for (std::size_t bin = 0; bin < 24; ++bin) {
        BOOST_TEST(across.x[bin] == 0.125 + 0.25 * double(bin), tolerance(1e-8));
        BOOST_TEST(across.y[bin].value == across.x[bin], tolerance(1e-8));
    }
    // in sigma and sigma/tau where the scene says what an atom is: rc sigma, and rc/time unit
    auto assignments = mapped;
    assignments.push_back("body_force.opposed=false");
    assignments.push_back("walls.thickness=1");
    Scene const atoms = scene(assignments);
    double const rc = std::cbrt(5.0 * 3.0 / 0.8), unit = 2.117 / 3.0 / (1.97 / 0.8) * rc * rc;
    BOOST_TEST(atoms.length[1] == 68.4 / rc + 2.0, tolerance(1e-14));
    BOOST_TEST(atoms.channel_width() == 68.4 / rc, tolerance(1e-14));
    record.curves["velocity_profile"] = profile(atoms, 50, [](double y, Eigen::Index) { return y - 1.0; });
    auto const scaled = curve_of(atoms, {record}, "channel_profile");
    BOOST_REQUIRE(scaled.x.size() > 40u);
    BOOST_TEST(scaled.x.front() > 0.0);
    BOOST_TEST(scaled.x.back() < 68.4);
    BOOST_TEST(scaled.x.back() > 66.0);
    for (std::size_t bin = 0; bin < scaled.x.size(); ++bin)
        BOOST_TEST(scaled.y[bin].value == scaled.x[bin] / unit, tolerance(1e-6));
}

// --- g(r) ------------------------------------------------------------------------------------------------

namespace {

/// g(r) in 100 bins up to 1.
template <class F>
Record with_g(F&& g) {
    Record record;
    Curve& curve = record.curves["radial_distribution"];
    curve.resize(100);
    for (std::size_t b = 0; b < 100; ++b) {
        curve.x[b] = 0.01 * (double(b) + 0.5);
        for (Eigen::Index block = 0; block < curve_blocks; ++block) {
            curve.weight(Eigen::Index(b), block) = 1.0 + double(b) + double(block);
            curve.sum(Eigen::Index(b), block) = curve.weight(Eigen::Index(b), block) * g(curve.x[b], block);
        }
    }
    return record;
}

}  // namespace

// alpha is [(1 - r/rc)(r/rc) g]/(2 d rc^d): pi/30 or pi/24 of a gas, and by hand without pairs below rc/2.
BOOST_DATA_TEST_CASE(pressure_and_sound_by_g,
                     data::make({2, 3}) * data::make({"shardlow", "modified_verlet"}) *
                         data::make({1.0, 0.8}) * data::make({false, true}),
                     d, thermostat, rc, hole) {
    bool const shardlow = thermostat == std::string("shardlow");
    std::string const mover = shardlow ? "verlet" : "modified_verlet";
    std::vector<std::string> assignments{
        fmt::format("dimension={}", d), d == 2 ? "box.length=[5, 6]" : "box.length=[5, 6, 5]",
        "particles.mass=2", mover + ".soft.strength=12", fmt::format("{}.soft.cutoff={}", mover, rc)};
    if (shardlow)
        for (char const* more :
             {"stages=['shardlow', 'sample', 'verlet']", "shardlow.friction=4.5", "shardlow.kT=0.7"})
            assignments.push_back(more);
    else
        for (char const* more : {"stages=['modified_verlet', 'sample']", "modified_verlet.gamma=5",
                                 "modified_verlet.sigma=2.6457513110645906"})
            assignments.push_back(more);
    Scene const fluid = scene(assignments);
    BOOST_TEST(fluid.thermostat_kT() == 0.7, tolerance(1e-14));
    Record const record = with_g([&](double r, Eigen::Index block) {
        return hole && r < 0.5 * rc ? 0.0 : scattered(1.0, 0.1, block);
    });
    auto const quantities = analyze(fluid, {record});
    double const pi = std::numbers::pi;
    // integrals of (1-x) x^2 and (1-x) x^3 from 0 or 1/2 to 1, times 2 pi/4 and 4 pi/6
    double const alpha = d == 2
                             ? pi / 2.0 * (hole ? 1.0 / 12.0 - 1.0 / 24.0 + 1.0 / 64.0 : 1.0 / 12.0)
                             : 2.0 * pi / 3.0 * (hole ? 1.0 / 20.0 - 1.0 / 64.0 + 1.0 / 160.0 : 1.0 / 20.0);
    if (!hole) BOOST_TEST(alpha == (d == 2 ? pi / 24.0 : pi / 30.0), tolerance(1e-14));
    double const share = 0.1 * per_share, n = 3.0, a = 12.0 / rc;
    check_estimate(quantities, "repulsion_constant", alpha, alpha * share, 1e-7);
    double const excess = alpha * a * std::pow(rc, d + 1) * n * n;
    check_estimate(quantities, "pressure_by_g", 0.7 * n + excess, excess * share, 1e-7);
    auto const sound = [&](double factor) { return std::sqrt((0.7 + 2.0 * factor * excess / n) / 2.0); };
    check_estimate(quantities, "speed_of_sound_by_g", 0.5 * (sound(0.9) + sound(1.1)),
                   0.5 * (sound(1.1) - sound(0.9)) * per_share, 1e-7);
    // the same by theory's own words, g as the record has it
    theory::Gas const gas{.d = d, .n = n, .m = 2.0, .kT = 0.7, .rc = rc};
    auto const level = [&](double g) {
        return [&, g](double r) { return hole && r < 0.5 * rc ? 0.0 : r < 1.0 ? g : 1.0; };
    };
    BOOST_TEST(estimate_of(quantities, "pressure_by_g").value == theory::virial_pressure(gas, a, level(1.0)),
               tolerance(1e-7));
    BOOST_TEST(sound(1.1) == theory::virial_sound_speed(gas, a, level(1.1)), tolerance(1e-7));
}

BOOST_AUTO_TEST_CASE(without_repulsion_g_tells_no_pressure) {
    Record const record = with_g([](double, Eigen::Index) { return 1.0; });
    for (std::vector<std::string> const& assignments :
         {std::vector<std::string>{"stages=['shardlow', 'sample', 'drift']", "shardlow.friction=1"},
          {"stages=['sample', 'verlet']", "verlet.soft.strength=25"},  // no thermostat
          {"stages=['shardlow', 'sample', 'verlet']", "shardlow.friction=1", "verlet.soft.strength=0"},
          {"stages=['shardlow', 'sample', 'verlet']", "shardlow.friction=1", "verlet.lennard_jones={}"}}) {
        auto all = assignments;
        all.push_back("box.length=[6, 6, 6]");
        auto const quantities = analyze(scene(all), {record});
        BOOST_TEST(measures(quantities, "pair_density"));
        for (char const* name : {"pressure_by_g", "speed_of_sound_by_g", "repulsion_constant"})
            BOOST_TEST(!measures(quantities, name), name);
    }
}

// --- derived ---------------------------------------------------------------------------------------------

BOOST_DATA_TEST_CASE(what_follows_from_a_measured_viscosity, data::make({false, true}), with_force) {
    std::vector<std::string> assignments{"stages=['modified_verlet', 'sample']",
                                         "coarse_graining.atoms_per_particle=5",
                                         "coarse_graining.length=[34.2, 34.2, 8.55]",
                                         "box.shear_rate=0",
                                         "modified_verlet.gamma=45",
                                         "modified_verlet.sigma=3",
                                         "modified_verlet.soft={}"};
    Scene const fluid = scene(with_force ? mapped : assignments);
    double const eta = 2.5, share = 1e-3;
    std::vector<Quantity> quantities{{"viscosity", {.value = eta, .error = share * eta, .blocks = 12}}};
    derive(fluid, quantities);
    // by hand, in the atoms' units: rc^3 = 5 * 3/0.8, nu_md = 1.97/0.8
    double const rc = std::cbrt(18.75), unit = eta / 3.0 / 2.4625 * rc * rc,
                 force = 0.0085 * unit * unit / rc, L = 34.2 / rc,
                 velocity = 3.0 * force * L * L / (8.0 * eta);
    check_estimate(quantities, "time_unit", unit, share * unit, 1e-10);
    // tau^2/eta grows as eta; the difference quotient has the slope of a straight line
    check_estimate(quantities, "predicted_velocity", velocity, share * velocity, 1e-10);
    double const mach = velocity / std::sqrt(15.36 * 5.0 * 0.1);
    check_estimate(quantities, "predicted_mach_number", mach, share * mach, 1e-10);
    BOOST_TEST(mach == theory::mach_number({.Nm = 5.0}, eta, 0.1, 0.0085, 34.2), tolerance(1e-13));
    BOOST_TEST(measures(quantities, "force_ratio") == with_force);
    if (with_force) {
        // the scene was told 2.117
        double const ratio = std::pow(2.117 / eta, 2);
        BOOST_TEST(estimate_of(quantities, "force_ratio").value == ratio, tolerance(1e-12));
        check_estimate(quantities, "force_ratio", ratio, 2.0 * share * ratio, 3e-6);
    }
    BOOST_TEST(quantities.size() == (with_force ? 5u : 4u));
    for (auto const& quantity : quantities) BOOST_TEST(quantity.estimate.blocks == 12u);

    // a tenth of the force is a tenth of the force, per mass of a particle
    if (with_force) {
        auto weaker = mapped;
        weaker.push_back("coarse_graining.force=0.00085");
        weaker.push_back("particles.mass=2");
        BOOST_TEST(
            scene(weaker).stage<BodyForce>()->acceleration == fluid.stage<BodyForce>()->acceleration / 20.0,
            tolerance(1e-12));
        std::vector<Quantity> other{{"viscosity", {.value = eta, .error = 0.0, .blocks = 2}}};
        derive(scene(weaker), other);
        BOOST_TEST(estimate_of(other, "force_ratio").value == std::pow(2.117 / eta, 2), tolerance(1e-12));
    }
    // nothing comes from nothing, or without a map
    std::vector<Quantity> none;
    derive(fluid, none);
    BOOST_TEST(none.empty());
    std::vector<Quantity> plain{{"viscosity", {.value = eta, .error = 0.1, .blocks = 12}}};
    derive(opposed(), plain);
    BOOST_TEST(plain.size() == 1u);
}

BOOST_AUTO_TEST_CASE(slopes_of_the_pressure) {
    Scene const fluid =
        scene({"stages=['shardlow', 'sample', 'verlet']", "box.length=[5, 5, 5]", "verlet.soft.strength=25",
               "shardlow.friction=4.5", "shardlow.kT=0.8", "particles.mass=2"});
    Estimate const below{.value = 20.0, .error = 0.03, .blocks = 9},
        above{.value = 26.0, .error = 0.04, .blocks = 7};
    std::vector<Quantity> quantities;
    derive_from_densities(fluid, 0.2, below, above, quantities);
    check_estimate(quantities, "pressure_slope", 30.0, 0.25, 1e-11);
    check_estimate(quantities, "inverse_compressibility", 37.5, 0.25 / 0.8, 1e-11);
    check_estimate(quantities, "speed_of_sound", std::sqrt(15.0), 0.5 * 0.25 / 30.0 * std::sqrt(15.0), 1e-4);
    BOOST_TEST(estimate_of(quantities, "speed_of_sound").value == std::sqrt(15.0), tolerance(1e-14));
    BOOST_TEST(!measures(quantities, "inverse_compressibility_per_atom"));
    BOOST_TEST(quantities.size() == 3u);
    for (auto const& quantity : quantities) BOOST_TEST(quantity.estimate.blocks == 7u);
    // of an unstable fluid no sound is known
    std::vector<Quantity> unstable;
    derive_from_densities(fluid, 0.2, above, below, unstable);
    check_estimate(unstable, "pressure_slope", -30.0, 0.25, 1e-11);
    BOOST_TEST(estimate_of(unstable, "speed_of_sound").value == 0.0);
    // what was not measured
    std::vector<Quantity> none;
    derive_from_densities(fluid, 0.2, below, {}, none);
    derive_from_densities(fluid, 0.2, {}, above, none);
    BOOST_TEST(none.empty());
    // per atom, where the scene knows of atoms; kT is 0.1 there
    std::vector<Quantity> per_atom;
    derive_from_densities(scene(mapped), 0.2, below, above, per_atom);
    check_estimate(per_atom, "inverse_compressibility", 300.0, 2.5, 1e-11);
    check_estimate(per_atom, "inverse_compressibility_per_atom", 60.0, 0.5, 1e-11);
}

// --- displacements in a flow -----------------------------------------------------------------------------

namespace {

struct Flow {
    char const* name;
    std::vector<std::string> assignments;
    int components;
};

std::ostream& operator<<(std::ostream& stream, Flow const& at) { return stream << at.name; }

template <int d>
void check_components(Scene const& scene, int components) {
    BOOST_TEST(diffusing_components(scene) == components);
    BOOST_TEST(scene.sample.components == components);
    std::unique_ptr<Recorder<d>> recorder;
    std::vector<Field<d>> position, velocity;
    auto simulation = build<d>(scene, [&](Simulation<d>& s) {
        (*recorder)(s);
        Field<d> x(s.particles.size(), d), v(s.particles.size(), d);
        for (Eigen::Index p = 0; p < s.particles.size(); ++p) {
            auto const id = Eigen::Index{s.particles.id[p]};
            for (int axis = 0; axis < d; ++axis)
                x(id, axis) =
                    s.particles.position(p, axis) + s.box.length[axis] * double(s.particles.image(p, axis));
            v.row(id) = s.particles.velocity.row(p);
        }
        position.push_back(x);
        velocity.push_back(v);
    });
    recorder = std::make_unique<Recorder<d>>(scene.sample, simulation);
    for (std::uint64_t step = 0; step < scene.steps(); ++step) simulation.advance();
    auto const curve = curve_of(scene, {recorder->record()}, "velocity_autocorrelation");
    for (std::size_t lag = 0; lag <= 4; ++lag) {
        double displacement = 0.0, correlation = 0.0, count = 0.0, x_only = 0.0;
        std::vector<double> by_origin;
        for (std::size_t origin = 0; origin + 4 < position.size(); ++origin) {
            Field<d> const moved = position[origin + lag] - position[origin];
            Field<d> const product = velocity[origin + lag] * velocity[origin];
            for (int axis = d - components; axis < d; ++axis) {
                displacement += moved.col(axis).square().sum();
                correlation += product.col(axis).sum();
            }
            x_only += moved.col(0).square().sum();
            count += double(simulation.particles.fluid);  // the walls' particles add nothing
        }
        auto const row = static_cast<Eigen::Index>(lag);
        auto const total = [&](char const* name) {
            auto const& sampled = recorder->record().curves.at(name);
            BOOST_TEST(sampled.weight.row(row).sum() == count);
            return sampled.sum.row(row).sum();
        };
        BOOST_TEST(total("mean_square_displacement") == displacement, tolerance(1e-12));
        BOOST_TEST(total("velocity_autocorrelation") == correlation, tolerance(1e-12));
        if (lag > 0) BOOST_TEST(std::abs(x_only - displacement) > 1e-3 * displacement);
    }
    // per component
    double mean = 0.0, blocks = 0.0;
    auto const& sampled = recorder->record().curves.at("velocity_autocorrelation");
    for (double const value : sampled.block_means(0)) mean += value / components, blocks += 1.0;
    BOOST_TEST(curve.y[0].value == mean / blocks, tolerance(1e-12));
    // 2 components D t
    Record made;
    Curve& straight = made.curves["mean_square_displacement"];
    straight.resize(11);
    for (std::size_t lag = 0; lag <= 10; ++lag) straight.x[lag] = 0.1 * double(lag);
    straight.weight.setConstant(1e6);
    for (Eigen::Index lag = 0; lag <= 10; ++lag)
        straight.sum.row(lag) = 1e6 * 2.0 * components * 0.7 * 0.1 * double(lag);
    made.curves["velocity_autocorrelation"] = straight;
    made.curves["velocity_autocorrelation"].sum.setConstant(1e6 * components * 0.5);
    auto const quantities = analyze(scene, {made});
    check_estimate(quantities, "diffusion_constant", 0.7, 0.0);
    check_estimate(quantities, "green_kubo_diffusion_constant", 0.5, 0.0);
}

std::vector<std::string> const free_flight{"modified_verlet.gamma=0", "modified_verlet.sigma=0",
                                           "modified_verlet.soft.strength=0", "walls.thickness=1"};

std::vector<Flow> flows() {
    auto channel = free_flight, driven = free_flight;
    channel.push_back("stages=['modified_verlet', 'sample']");
    driven.push_back("stages=['body_force', 'modified_verlet', 'sample']");
    driven.push_back("body_force.acceleration=0.5");
    return {{"at rest", {"stages=['sample', 'drift']"}, 3},
            {"shear", {"stages=['sample', 'drift']", "box.shear_rate=0.4"}, 2},
            {"body force", {"stages=['body_force', 'sample', 'drift']", "body_force.acceleration=0.5"}, 2},
            {"opposed",
             {"stages=['body_force', 'sample', 'drift']", "body_force.acceleration=0.5",
              "body_force.opposed=true"},
             2},
            {"walls", channel, 1},
            {"flow between walls", driven, 1}};
}

}  // namespace

BOOST_DATA_TEST_CASE(what_flows_or_is_confined_is_no_diffusion, data::make(flows()), at) {
    for (int const d : {3, 2}) {
        auto assignments = at.assignments;
        for (char const* more :
             {"particles.density=1", "time.duration=1.2", "sample.mean_square_displacement.longest=0.4",
              "sample.velocity_autocorrelation.longest=0.4"})
            assignments.push_back(more);
        assignments.push_back(fmt::format("dimension={}", d));
        assignments.push_back(d == 2 ? "box.length=[4, 6]" : "box.length=[4, 6, 4]");
        if (d == 3)
            check_components<3>(scene(assignments), at.components);
        else if (at.components > 1)
            check_components<2>(scene(assignments), at.components - 1);
        else  // nothing is left
            BOOST_CHECK_EXCEPTION(scene(assignments), InputError, [](InputError const& error) {
                std::string const message = error.what();
                return message.find("sample: ") != std::string::npos &&
                       message.find("no direction") != std::string::npos &&
                       message.find('\n') == std::string::npos;
            });
    }
}

BOOST_AUTO_TEST_CASE(a_plane_channel_without_displacements_is_allowed) {
    auto assignments = free_flight;
    for (char const* more : {"dimension=2", "box.length=[4, 6]", "stages=['modified_verlet', 'sample']",
                             "sample.observables=['kinetic_temperature']"})
        assignments.push_back(more);
    BOOST_TEST(diffusing_components(scene(assignments)) == 0);
    for (char const* wrong :
         {"sample.mean_square_displacement.longest=1", "sample.velocity_autocorrelation.longest=1"}) {
        auto more = assignments;
        more.push_back(wrong);
        BOOST_CHECK_THROW(scene(more), InputError);
    }
}
