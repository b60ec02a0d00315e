/// @file
/// Other codes' output: files as LAMMPS writes them, mistakes in files, names; and the verdicts' false alarms
/// and power on made-up data of known truth. Seeds are fixed; a correct code fails a statistical check for
/// about 6e-5 of all seeds (4 standard errors).
#define BOOST_TEST_MODULE compare
#include "compare.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <fstream>
#include <functional>
#include <random>

#include "archive.hpp"
#include "errors.hpp"
#include "figure.hpp"
#include "files.hpp"
#include "judge_figure.hpp"
#include "lammps_log.hpp"
#include "run.hpp"
#include "toml_reader.hpp"

using namespace dpd;

namespace {

std::filesystem::path const lammps = std::filesystem::path(DPDREF_TEST_DATA) / "lammps";

struct Directory {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("dpdref_compare_" + std::to_string(std::random_device{}()));
    Directory() { std::filesystem::create_directories(path); }
    ~Directory() { std::filesystem::remove_all(path); }

    std::filesystem::path write(std::string const& name, std::string const& text) const {
        std::ofstream(path / name) << text;
        return path / name;
    }
};

std::string replaced(std::string text, std::string const& from, std::string const& to) {
    auto const at = text.find(from);
    BOOST_REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

std::vector<double> series_of(CodeOutput const& output, std::string const& name) {
    for (auto const& [column, samples] : output.series)
        if (column == name) return samples;
    BOOST_FAIL("no column " + name);
    throw 0;
}

Reference reference_of(std::vector<Quantity> quantities) {
    Reference reference;
    reference.name = "test";
    reference.quantities = std::move(quantities);
    return reference;
}

Estimate estimate_of(Averages const& averages, std::string const& name) {
    auto const* const found = find_quantity(averages.quantities, name);
    BOOST_REQUIRE_MESSAGE(found, "no " + name);
    return found->estimate;
}

auto says(std::string const& part) {
    return [part](InputError const& error) {
        std::string const what = error.what();
        bool const good = what.find(part) != std::string::npos && what.find('\n') == std::string::npos;
        if (!good) BOOST_TEST_MESSAGE("says: " << what << "; lacks: " << part);
        return good;
    };
}

Reference const fluid = reference_of({{"kinetic_temperature", {1.0, 0.01, 20}},
                                      {"pressure", {23.7, 0.05, 20}},
                                      {"potential_energy", {4.55, 0.01, 20}}});

}  // namespace

// --- files -----------------------------------------------------------------------------------------------

BOOST_AUTO_TEST_CASE(a_log_of_two_runs) {
    auto const last = read_output(lammps / "log.lammps"), first = read_output(lammps / "log.lammps", 1);
    BOOST_TEST(first.axis == "Step");
    BOOST_TEST(first.at.size() == 11u);
    BOOST_TEST(last.at.size() == 31u);
    BOOST_TEST(last.at.front() == 100.0);
    BOOST_TEST(last.series.size() == 5u);
    BOOST_TEST(series_of(last, "Temp").back() == 0.98653062);
    BOOST_TEST(series_of(last, "Press")[1] == 23.538293);
    BOOST_TEST(series_of(first, "E_pair")[0] == 7.8756267);
    BOOST_TEST(last.per_particle);
    BOOST_TEST(last.notes.size() == 1u);  // that it is the last of two
    BOOST_TEST(first.notes.empty());
    BOOST_CHECK_EXCEPTION(read_output(lammps / "log.lammps", 3), InputError, says("allowed: 1 to 2"));

    auto const averages = average({last}, fluid, {}, {});
    double sum = 0.0;
    for (double const x : series_of(last, "Temp")) sum += x;
    auto const kT = estimate_of(averages, "kinetic_temperature");
    // blocking leaves out a remainder that is shorter than a block
    BOOST_TEST(std::abs(kT.value - sum / 31.0) < 0.02);
    BOOST_TEST(kT.value == blocking(series_of(last, "Temp")).value);
    BOOST_TEST(estimate_of(averages, "potential_energy").blocks > 2u);
    BOOST_TEST(estimate_of(averages, "TotEng").value > 5.0);  // under its own name, without a reference
}

BOOST_AUTO_TEST_CASE(logs_of_other_versions_and_ends) {
    Directory const directory;
    std::string const log = read_file(lammps / "log.lammps");
    auto const read = [&](std::string const& text) { return read_output(directory.write("log", text)); };
    // before 2018 the line before the header was another
    auto old = log;
    for (int k = 0; k < 2; ++k)
        old = replaced(old, "Per MPI rank memory allocation (min/avg/max)", "Memory usage per processor");
    BOOST_TEST(series_of(read(old), "Temp").size() == 31u);
    // messages within a table
    auto const warned = read(
        replaced(log, "     200   0.94", "WARNING: FENE bond too long (src/bond.cpp:80)\n\n     200   0.94"));
    BOOST_TEST(series_of(warned, "Temp").size() == 31u);
    // killed while it wrote: the last row may lack digits, even if it has all columns
    for (std::string const end : {"     390   0.97133226    4.5642981            0    6.0174112    24.2",
                                  "     390   0.97133226    4.56", "     39"}) {
        auto const cut = read(log.substr(0, log.find("     390 ")) + end);
        BOOST_TEST(series_of(cut, "Temp").size() == 29u);
        BOOST_TEST(cut.notes.at(0).find("has no end and was left out") != std::string::npos);
    }
    auto const broken =
        read(log.substr(0, log.find("     390 ")) + "ERROR: Lost atoms: original 375 current 374\n");
    BOOST_TEST(broken.notes.at(0).find("Lost atoms") != std::string::npos);
    // energies of the whole system are not taken for those of a particle
    for (auto const& [from, to] :
         {std::pair{"thermo 10", "thermo_modify norm no"}, {"units lj", "units real"}}) {
        auto whole = read(replaced(log, from, to));
        BOOST_TEST(!whole.per_particle);
        whole.commands.clear();  // and with them the units
        BOOST_TEST(estimate_of(average({whole}, fluid, {}, {}), "potential_energy").value < 0.02);
        whole.atoms = 0.0;
        auto const averages = average({whole}, fluid, {}, {});
        BOOST_TEST(!find_quantity(averages.quantities, "potential_energy"));
        BOOST_TEST(estimate_of(averages, "E_pair").value > 4.0);
        BOOST_TEST(find_quantity(averages.quantities, "kinetic_temperature"));
    }
    BOOST_TEST(read(replaced(log, "units lj", "units real\nthermo_modify norm yes")).per_particle);
}

BOOST_AUTO_TEST_CASE(files_of_fix_ave_time) {
    auto const scalars = read_output(lammps / "scalars.dat");
    BOOST_TEST(scalars.axis == "TimeStep");
    BOOST_TEST(scalars.at.size() == 41u);
    BOOST_TEST(series_of(scalars, "c_thermo_press")[1] == 28.1499);
    auto const averages = average({scalars}, fluid, {}, discard_from_text("100"));
    BOOST_TEST(estimate_of(averages, "kinetic_temperature").value < 1.1);
    BOOST_TEST(averages.notes.at(0).find("first 10 of 41 samples") != std::string::npos);

    auto const g = read_output(lammps / "rdf.dat");
    BOOST_TEST(g.r.size() == 10u);
    BOOST_TEST(g.r[3] == 0.35);
    BOOST_TEST(g.g[0].size() == 4u);
    BOOST_TEST(g.at == (std::vector<double>{100, 200, 300, 400}), boost::test_tools::per_element());
    auto const curve = average({g}, fluid, {}, discard_from_text("50%")).radial_distribution;
    BOOST_TEST(curve.y[7].blocks == 2u);
    BOOST_TEST(curve.y[7].value == 0.5 * (g.g[7][2] + g.g[7][3]), boost::test_tools::tolerance(1e-12));

    Directory const directory;
    std::string const text = read_file(lammps / "rdf.dat");
    auto const cut = read_output(directory.write("cut", text.substr(0, text.size() - 60)));
    BOOST_TEST(cut.g[0].size() == 3u);
    BOOST_TEST(cut.notes.size() == 1u);
}

BOOST_AUTO_TEST_CASE(comma_separated_values) {
    Directory const directory;
    auto const values =
        read_output(directory.write("v",
                                    "# of a code\n# in two lines\nquantity,value,error,blocks\n\"pressure\", "
                                    "23.5 ,0.1,12\r\nviscosity,+1e0,2e-3,4\n"));
    BOOST_TEST(values.values.size() == 2u);
    BOOST_TEST(values.values[0].name == "pressure");
    BOOST_TEST(values.values[0].estimate.blocks == 12u);
    BOOST_TEST(values.values[1].estimate.value == 1.0);
    auto const samples = read_output(directory.write("s", "time,T,p\n0,1.1,23\n0.5,1.0,24\n1.0,0.9,25"));
    BOOST_TEST(samples.axis == "time");
    BOOST_TEST(series_of(samples, "p").back() == 25.0);  // an editor may leave out the last line's end
    auto const renamed = average({samples}, fluid,
                                 {renaming_from_text("T=kinetic_temperature*2"), {"p", "pressure", 1.0}}, {});
    BOOST_TEST(estimate_of(renamed, "kinetic_temperature").value == 2.0);
    auto const curve =
        read_output(directory.write("c", "r,radial_distribution,error\n0.1,0.2,0.01\n0.3,0.4,0.01\n"));
    BOOST_TEST(curve.curve.x[1] == 0.3);
    BOOST_TEST(curve.curve.y[1].value == 0.4);
}

// The same three samples as numpy, a spreadsheet, HOOMD-blue and OpenMM write them.
BOOST_AUTO_TEST_CASE(tables_of_other_programs) {
    Directory const directory;
    Reference gas = fluid;
    gas.particles = 10;
    double const kelvin = 1.0 / 8.31446261815324e-3;
    std::string const openmm = fmt::format(
        "#\"Step\",\"Time (ps)\",\"Potential Energy (kJ/mole)\",\"Temperature "
        "(K)\"\n0,0.0,45.0,{}\n100,4.0,46.0,{}\n"
        "200,8.0,44.0,{}\n",
        1.25 * kelvin, 1.0 * kelvin, 0.75 * kelvin);
    for (std::string const& text :
         {std::string(
              "# time kinetic_temperature pressure\n0.0e+00 1.25e+00 2.3e+01\n1.0e+00 1.0e+00 2.4e+01\n"
              "2.0e+00 7.5e-01 2.5e+01\n"),
          std::string("time\tkinetic_temperature\tpressure\n0\t1.25\t23\n1\t1\t24\n2\t0.75\t25\n"),
          std::string(" Simulation.timestep  ThermodynamicQuantities.kinetic_temperature  "
                      "ThermodynamicQuantities.pressure \n   0    1.25     23\n   100   1.0   24\n   200   "
                      "0.75  25\n"),
          openmm}) {
        auto const output = read_output(directory.write("table", text));
        BOOST_TEST_INFO(text);
        BOOST_TEST(!output.axis.empty());
        BOOST_TEST(output.at.size() == 3u);
        auto const averages = average({output}, gas, {}, {});
        BOOST_TEST(estimate_of(averages, "kinetic_temperature").value == 1.0,
                   boost::test_tools::tolerance(1e-12));
        if (text != openmm) {
            BOOST_TEST(estimate_of(averages, "pressure").value == 24.0);
            continue;
        }
        BOOST_TEST(estimate_of(averages, "potential_energy").value == 4.5,
                   boost::test_tools::tolerance(1e-12));
        BOOST_TEST(averages.definitions.at(0).find("of the reference's 10 particles") != std::string::npos);
    }
}

// Each file of verification/data/outputs, in the format of another program, holds what expected.toml says.
BOOST_AUTO_TEST_CASE(formats_of_other_programs) {
    auto const folder = lammps.parent_path() / "outputs";
    auto const check_series = [](CodeOutput const& output, toml::table const& holds) {
        for (auto const& [name, samples] : holds) {
            std::vector<double> numbers;
            for (auto const& number : *samples.as_array()) numbers.push_back(*number.value<double>());
            if (name == "at") {
                BOOST_TEST(output.at == numbers, boost::test_tools::per_element());
            } else if (samples.is_array()) {
                auto const read = series_of(output, std::string(name.str()));
                BOOST_REQUIRE(read.size() == numbers.size());
                for (std::size_t k = 0; k < read.size(); ++k)
                    BOOST_TEST(read[k] == numbers[k], boost::test_tools::tolerance(1e-8));
            }
        }
    };
    auto const expected = toml::parse_file((folder / "expected.toml").string());
    for (auto const& entry : *expected["output"].as_array()) {
        auto const& table = *entry.as_table();
        auto const file = *table["file"].value<std::string>();
        BOOST_TEST_CONTEXT(file) {
            auto const output = read_output(folder / file, std::size_t(table["run"].value_or(0)));
            BOOST_TEST(output.code == *table["code"].value<std::string>());
            BOOST_TEST(output.axis == *table["axis"].value<std::string>());
            std::vector<std::string> names, columns;
            for (auto const& [name, samples] : output.series) names.push_back(name);
            for (auto const& name : *table["columns"].as_array())
                columns.push_back(*name.value<std::string>());
            BOOST_TEST(names == columns, boost::test_tools::per_element());
            check_series(output, *table["holds"].as_table());
            toml::table at;
            if (auto const* const times = table["at"].as_array()) at.insert("at", *times);
            check_series(output, at);
            std::string const note = table["note"].value_or("");
            BOOST_TEST((note.empty() ||
                        std::any_of(output.notes.begin(), output.notes.end(),
                                    [&](auto const& said) { return said.find(note) != std::string::npos; })));
            BOOST_TEST(output.also.size() == table.contains("also"));
            if (auto const* const also = table["also"].as_table()) {
                BOOST_TEST(output.also.at(0).axis == *(*also)["axis"].value<std::string>());
                toml::table holds = *also;
                holds.erase("axis");
                check_series(output.also[0], holds);
            }
        }
    }
    BOOST_CHECK_EXCEPTION(read_output(folder / "partition.log"), InputError, says("each has its own log"));
}

// All that these files hold is one fluid, by its own definitions: kT 1.0286, U 4.5764, p 23.732.
BOOST_AUTO_TEST_CASE(definitions_of_other_programs) {
    auto const folder = lammps.parent_path() / "outputs";
    Reference reference = fluid;
    reference.particles = 3000;
    double const kT = (1.0312 + 1.0254 + 1.0291) / 3.0, u = (4.5811 + 4.5702 + 4.5779) / 3.0,
                 p = (23.801 + 23.644 + 23.752) / 3.0;
    for (auto const& [file, what] :
         std::vector<std::pair<std::string, std::string>>{{"runs.log", "d (N - 1)"},
                                                          {"multi.log", "d (N - 1)"},
                                                          {"yaml.log", "d (N - 1)"},
                                                          {"scalars.yaml", "d (N - 1)"},
                                                          {"chunk.dat", "brought to d (N - 1)"},
                                                          {"mirheo.csv", "brought to 3 (N - 1)"},
                                                          {"hoomd.txt", "of its method"},
                                                          {"openmm.csv", "CMMotionRemover"},
                                                          {"energy.xvg", "in K"}})
        BOOST_TEST_CONTEXT(file) {
            auto const averages = average({read_output(folder / file)}, reference, {}, {});
            double const factor = file == "chunk.dat" ? 3000.0 / 2999.0 : 1.0,
                         off = file == "chunk.dat" ? 1e-3 : 1e-6;
            BOOST_TEST(std::abs(estimate_of(averages, "kinetic_temperature").value / (factor * kT) - 1.0) <
                       off);
            if (auto const* const known = find_quantity(averages.quantities, "potential_energy"))
                BOOST_TEST(known->estimate.value == u, boost::test_tools::tolerance(1e-6));
            if (auto const* const known = find_quantity(averages.quantities, "pressure"))
                BOOST_TEST(known->estimate.value == p, boost::test_tools::tolerance(1e-6));
            BOOST_TEST(std::any_of(
                averages.definitions.begin(), averages.definitions.end(),
                [&, &part = what](auto const& text) { return text.find(part) != std::string::npos; }));
        }
    // two partitions are two runs of one fluid; the same file twice is not
    auto const one = read_output(folder / "partition.log.0"), other = read_output(folder / "partition.log.1");
    auto const both = average({one, other}, reference, {}, {});
    BOOST_TEST(estimate_of(both, "kinetic_temperature").value == kT + 0.0005,
               boost::test_tools::tolerance(1e-9));
    BOOST_CHECK_EXCEPTION(average({one, one}, reference, {}, {}), InputError, says("allowed: once"));
    // what fix print printed
    auto const printed = average({read_output(folder / "fix_print.log")}, reference,
                                 {renaming_from_text("p=pressure_by_g")}, {});
    BOOST_TEST(estimate_of(printed, "pressure_by_g").value == 0.5 * (23.644 + 23.752),
               boost::test_tools::tolerance(1e-9));
}

// A file of which no column has a reference is no agreement.
BOOST_AUTO_TEST_CASE(nothing_compared_is_said) {
    Directory const directory;
    auto const averages =
        average({read_output(lammps.parent_path() / "outputs" / "numpy_plain.dat")}, fluid, {}, {});
    auto const report = compare(averages, fluid, 0.01);
    BOOST_TEST((outcome_of(report, averages) == Outcome::nothing));
    BOOST_TEST(nothing_compared(report, fluid).find("no column (column_1, column_2, column_3)") !=
               std::string::npos);
}

namespace {

// The standard fluid as a scene and as a log; the log in units of energy e, length l, mass m and LAMMPS'
// constants.
std::string const standard_scene =
    "dimension = 3\nstages = ['modified_verlet', 'sample']\nbox.length = [10.0, 10.0, 10.0]\n"
    "particles.density = 3.0\nmodified_verlet = { gamma = 4.5, sigma = 3.0, soft.strength = 25.0 }\n"
    "time = { step = 0.04, duration = 1.0 }\nsample.observables = ['kinetic_temperature']\n";

Reference standard(std::string const& scene = standard_scene) {
    Reference reference = fluid;
    reference.particles = 3000;
    reference.thermostat_forces = true;
    describe_fluid(reference, parse_scene(scene, "test"));
    return reference;
}

std::string log_of(std::string const& units, double e, double l, double m, double boltzmann, double mvv,
                   double ktv) {
    double const time = l * std::sqrt(m * mvv / e), share = units == "lj" ? 1.0 : 3000.0;
    return fmt::format(
        "LAMMPS (29 Sep 2021)\nunits {}\nCreated orthogonal box = (0 0 0) to ({} {} {})\nmass 1 {}\n"
        "pair_style dpd {} {} 11\npair_coeff * * {} {} {}\ntimestep {}\nfix 1 all nve\nrun 200\n"
        "Per MPI rank memory allocation = 1\n Step Temp PotEng Press\n 0 {} {} {}\n 100 {} {} {}\n"
        "Loop time of 1 on 1 procs for 200 steps with 3000 atoms\n",
        units, 10 * l, 10 * l, 10 * l, m, e / boltzmann, l, 25 * e / l, 4.5 * e * time / (l * l), l,
        0.04 * time, 1.1 * e / boltzmann, share * 4.5 * e, 23.0 * e / (l * l * l) * ktv, 1.3 * e / boltzmann,
        share * 4.7 * e, 24.0 * e / (l * l * l) * ktv);
}

}  // namespace

// What a log says of its fluid is held against the reference; a difference makes no agreement.
BOOST_AUTO_TEST_CASE(a_log_of_another_fluid_is_named) {
    Directory const directory;
    Reference const reference = standard();
    std::string const right = log_of("lj", 1, 1, 1, 1, 1, 1);
    auto const check = [&](std::string const& text, Reference const& against) {
        return average({read_output(directory.write("log", text))}, against, {}, {});
    };
    BOOST_TEST(check(right, reference).differences.empty());
    BOOST_TEST(reference.integrator == "modified velocity-Verlet");
    for (auto const& [from, to, said] : std::vector<std::array<std::string, 3>>{
             {"timestep 0.04", "timestep 0.02", "timestep 0.02 (reference: 0.04)"},
             {"timestep 0.04\n", "", "timestep 0.005 (reference: 0.04)"},
             {"to (10 10 10)", "to (10 10 12)", "density 2.5 (reference: 3)"},
             {"25 4.5", "25 9", "gamma 9 (reference: 4.5)"},
             {"25 4.5", "30 4.5", "a 30 (reference: 25)"},
             {"dpd 1 1 11", "dpd 2 1 11", "kT 2 (reference: 1)"},
             {"mass 1 1", "mass 1 2", "mass 2 (reference: 1)"},
             {"pair_style dpd 1 1 11", "pair_style lj/cut 2.5", "pair_style lj/cut (reference: DPD)"},
             {"pair_style dpd 1 1 11\npair_coeff * * 25 4.5 1",
              "pair_style dpd/ext 1 1 11\npair_coeff 1 1 25 4.5 0 0.5 0 1",
              "exponent of w_D 1 (reference: 2)"},
             {"fix 1 all nve", "fix 1 all nvt temp 1 1 1", "fix nvt (reference: no such thermostat)"},
             {"fix 1 all nve", "fix 0 all shardlow\nfix 1 all nve",
              "integrator S1 (reference: modified velocity-Verlet)"}})
        BOOST_TEST_CONTEXT(said) {
            auto const averages = check(replaced(right, from, to), reference);
            BOOST_REQUIRE(averages.differences.size() == 1u);
            BOOST_TEST(averages.differences[0].find(said) != std::string::npos, averages.differences[0]);
            auto const report = compare(averages, reference, 0.5);
            BOOST_TEST((outcome_of(report, averages) == Outcome::disagrees));
        }
    auto const flow =
        check(replaced(right, "fix 1", "fix d all deform 1 xy erate 0.3 remap v\nfix 1"), reference);
    BOOST_TEST(flow.differences.at(0).find("shear rate 0.3 (reference: 0)") != std::string::npos);
    // the last of several commands counts, of a hybrid style the part of DPD, and what was taken away is gone
    auto const hybrid = replaced(
        replaced(right, "pair_style dpd 1", "timestep 1\npair_style hybrid/overlay lj/cut 2.5 dpd/omp 1"),
        "pair_coeff * *", "pair_coeff * * lj/cut 1 1\npair_coeff * * dpd/omp");
    BOOST_TEST(check(replaced(hybrid, "fix 1", "fix t all langevin 1 1 1 5\nunfix t\nfix 1"), reference)
                   .differences.empty());
    auto const s1 =
        replaced(replaced(standard_scene, "'modified_verlet'", "'shardlow', 'verlet'"),
                 "modified_verlet = { gamma = 4.5, sigma = 3.0, soft.strength = 25.0 }",
                 "shardlow = { friction = 4.5, weight = 'quadratic' }\nverlet.soft.strength = 25.0");
    BOOST_TEST(
        check(replaced(replaced(right, "dpd 1", "dpd/fdt 1"), "25 4.5 1\n", "25 3 1\nfix s all shardlow\n"),
              standard(s1))
            .differences.empty());
}

// One fluid in four systems of units; constants from LAMMPS' update.cpp.
BOOST_AUTO_TEST_CASE(logs_in_other_units) {
    Directory const directory;
    Reference const reference = standard();
    for (auto const& text : {log_of("lj", 1, 1, 1, 1, 1, 1), log_of("lj", 4, 2, 3, 1, 1, 1),
                             log_of("real", 0.6, 7.1, 54, 0.0019872067, 48.88821291 * 48.88821291, 68568.415),
                             log_of("metal", 0.026, 7.1, 54, 8.617343e-5, 1.0364269e-4, 1.6021765e6)})
        BOOST_TEST_CONTEXT(text) {
            auto const averages = average({read_output(directory.write("log", text))}, reference, {}, {});
            BOOST_TEST(averages.differences.empty());
            BOOST_TEST(estimate_of(averages, "kinetic_temperature").value == 1.2,
                       boost::test_tools::tolerance(1e-6));
            BOOST_TEST(estimate_of(averages, "potential_energy").value == 4.6,
                       boost::test_tools::tolerance(1e-6));
            // the reference has friction and noise among its forces
            BOOST_TEST(estimate_of(averages, "lammps_pressure").value == 23.5,
                       boost::test_tools::tolerance(1e-6));
        }
    std::string const real = log_of("real", 0.6, 7.1, 54, 0.0019872067, 48.88821291 * 48.88821291, 68568.415);
    auto const read = [&](std::string const& text) {
        return average({read_output(directory.write("log", text))}, reference, {}, {});
    };
    BOOST_TEST(read(replaced(real, "pair_coeff * * 2", "pair_coeff * * 3")).differences.size() == 1u);
    auto const blind = read(replaced(real, "pair_style dpd", "# pair_style dpd"));
    BOOST_TEST(!find_quantity(blind.quantities, "kinetic_temperature"));
    BOOST_TEST(blind.notes.at(0).find("does not say kT and the cutoff") != std::string::npos);
    BOOST_TEST(read(replaced(real, "mass 1", "# mass 1")).notes.at(0).find("does not say the mass") !=
               std::string::npos);
}

// LAMMPS's own pressure is the reference's only where friction and noise are no forces.
BOOST_AUTO_TEST_CASE(a_pressure_with_friction_is_another_quantity) {
    Directory const directory;
    auto const log = read_output(directory.write("ave",
                                                 "# Time-averaged data for fix s\n# TimeStep c_thermo_temp "
                                                 "c_thermo_press\n10 1.0 23.0\n20 1.0 24.0\n"));
    Reference reference = fluid;
    BOOST_TEST(estimate_of(average({log}, reference, {}, {}), "pressure").value == 23.5);
    reference.thermostat_forces = true;
    auto const averages = average({log}, reference, {}, {});
    BOOST_TEST(!find_quantity(averages.quantities, "pressure"));
    BOOST_TEST(estimate_of(averages, "lammps_pressure").value == 23.5);
    BOOST_TEST(averages.notes.back().find("--as c_thermo_press=pressure") != std::string::npos);
    auto const forced = average({log}, reference, {renaming_from_text("c_thermo_press=pressure")}, {});
    BOOST_TEST(estimate_of(forced, "pressure").value == 23.5);
    reference.quantities.push_back({"lammps_pressure", {23.4, 0.1, 16}});
    auto const judged = average({log}, reference, {}, {});
    BOOST_TEST(judged.notes.back().find("--as") == std::string::npos);
    BOOST_TEST(compare(judged, reference, 0.05).comparisons.at(1).quantity == "lammps_pressure");
}

// A deck in shear says its rate; kT is then that of the flow, and what has no sheared reference has none.
BOOST_AUTO_TEST_CASE(a_flow_is_compared_with_the_flow) {
    Directory const directory;
    Reference reference = fluid;
    reference.shear_rate = 0.25;
    reference.quantities.push_back({"sheared_kinetic_temperature", {1.035, 0.001, 100}});
    auto const deck = [&](std::string const& rate) {
        return read_output(directory.write("scalars", "# dpdref observables, shear rate " + rate +
                                                          "\n# step kinetic_temperature pressure stress_xy\n"
                                                          "10 1.0 23.0 0.2\n20 1.5 24.0 0.3\n"));
    };
    auto const flow = average({deck("0.25")}, reference, {}, {});
    BOOST_TEST(estimate_of(flow, "sheared_kinetic_temperature").value == 1.25);
    BOOST_TEST(estimate_of(flow, "viscosity").value == 1.0);
    auto const report = compare(flow, reference, 0.01);
    BOOST_TEST(report.comparisons.size() == 1u);  // `fluid` has no viscosity
    BOOST_TEST(report.comparisons[0].quantity == "sheared_kinetic_temperature");
    auto const rest = average({deck("0")}, reference, {}, {});
    BOOST_TEST(estimate_of(rest, "kinetic_temperature").value == 1.25);
    BOOST_TEST(estimate_of(rest, "pressure").value == 23.5);
    BOOST_TEST(!find_quantity(rest.quantities, "viscosity"));
    BOOST_CHECK_EXCEPTION(average({deck("0.5")}, reference, {}, {}), InputError, says("allowed: 0.25"));
    auto const said = read_output(directory.write("t", "time,kinetic_temperature\n0,1.0\n1,1.5\n"));
    BOOST_TEST(estimate_of(average({said}, reference, {}, {}, true), "sheared_kinetic_temperature").value ==
               1.25);
}

// A log of fix deform is of a flow, too; what its temperature is depends on the compute.
BOOST_AUTO_TEST_CASE(a_sheared_log_is_compared_with_the_flow) {
    Directory const directory;
    Reference reference = standard();
    reference.shear_rate = 0.25;
    reference.quantities.push_back({"sheared_kinetic_temperature", {1.2, 0.001, 100}});
    auto const averaged = [&](std::string const& units, double time, std::string const& shear,
                              std::string const& text) {
        auto const log = replaced(text, "run 200\n", replaced(shear, "RATE", fmt::format("{}", 0.25 / time)));
        auto const averages = average({read_output(directory.write("log", log))}, reference, {}, {});
        BOOST_TEST_CONTEXT(units) BOOST_TEST(fmt::format("{}", fmt::join(averages.differences, "; ")) == "");
        return averages;
    };
    double const mvv = 48.88821291 * 48.88821291, time = 7.1 * std::sqrt(54 * mvv / 0.6);
    std::string const lj = log_of("lj", 1, 1, 1, 1, 1, 1),
                      real = log_of("real", 0.6, 7.1, 54, 0.0019872067, mvv, 68568.415),
                      deform = "fix 2 all deform 1 xy erate RATE remap v\nrun 200\n",
                      peculiar = "compute c all temp/deform\nthermo_modify temp c\n";
    for (auto const& [units, unit, log] : {std::tuple{"lj", 1.0, lj}, std::tuple{"real", time, real}}) {
        auto const flow = averaged(units, unit, peculiar + deform, log);
        BOOST_TEST(estimate_of(flow, "sheared_kinetic_temperature").value == 1.2,
                   boost::test_tools::tolerance(1e-6));
        BOOST_TEST(!find_quantity(flow.quantities, "kinetic_temperature"));
        auto const heat = averaged(units, unit, deform, log);
        for (auto const* const name :
             {"kinetic_temperature", "sheared_kinetic_temperature", "lammps_pressure"})
            BOOST_TEST(!find_quantity(heat.quantities, name));
        BOOST_TEST(find_quantity(heat.quantities, "Temp"));
        BOOST_TEST(find_quantity(heat.quantities, "sheared_potential_energy"));
    }
    auto const differences = [&](std::string const& fix) {
        auto const log = read_output(directory.write("log", replaced(lj, "run 200\n", fix + "\nrun 200\n")));
        return average({log}, reference, {}, {}).differences;
    };
    BOOST_TEST(differences("fix 2 all deform 1 xy erate 0.5").size() == 1u);
    BOOST_TEST(differences("fix 2 all deform 1 x erate 0.25").size() == 1u);
    BOOST_TEST(differences("fix 2 all deform 1 xy erate 0.25\nunfix 2").empty());
    // a file beside the log, whose temperature is compute temp's
    auto const beside = read_output(
        directory.write("ave", "# Time-averaged data for fix s\n# TimeStep c_thermo_temp\n10 1.0\n20 1.2\n"));
    auto const log = read_output(
        directory.write("log", replaced(lj, "run 200\n", "fix 2 all deform 1 xy erate 0.25\nrun 200\n")));
    BOOST_TEST(!find_quantity(average({log, beside}, reference, {}, {}).quantities, "kinetic_temperature"));
}

BOOST_AUTO_TEST_CASE(a_factor_that_is_known_is_named) {
    Directory const directory;
    auto const values = read_output(
        directory.write("v", "quantity,value,error,blocks\nkinetic_temperature,3.08,0.004,100\n"));
    auto const report = compare(average({values}, fluid, {}, {}), fluid, 0.01);
    BOOST_TEST(name_of(report.comparisons.at(0).verdict) == "disagrees");
    BOOST_TEST(report.hints.at(0).find("not divided by the dimension?") != std::string::npos);

    // The measured values are those of each mistake made on purpose in a program of its own: 192 particles, n
    // = 3, a = 25, gamma = 4.5, step 0.04.
    Reference reference = standard();
    reference.quantities[0].estimate = {1.0285, 0.0005, 100};
    auto const hints_for = [&](std::string const& quantity, double value, double error) {
        Averages averages;
        averages.quantities = {{quantity, {value, error, 100}}};
        auto const hints = compare(averages, reference, 0.01).hints;
        return fmt::format("{}", fmt::join(hints, "\n"));
    };
    for (auto const& [value, what] : {std::pair{0.3374, "[-1, 1] without sqrt 3?"},
                                      {0.08365, "without sqrt 12?"},
                                      {26.82, "noise over dt"},
                                      {0.0400, "noise not over sqrt dt?"},
                                      {0.0016, "noise times sqrt dt"},
                                      {3.497, "sigma and gamma swapped?"},
                                      {9.616, "sigma^2 for sigma?"},
                                      {0.514, "sigma^2 = gamma kT"}})
        BOOST_TEST(hints_for("kinetic_temperature", value, 0.001 * value).find(what) != std::string::npos,
                   what);
    // no name for a ratio that is none of these: each partner with noise of its own, one alone, the same sign
    // on both
    for (double const value : {1.169, 0.590, 1.314})
        BOOST_TEST(hints_for("kinetic_temperature", value, 0.002).empty());

    // a hundred particles, as shared inputs have them: N kT of the thermostat for (N - 1) kT measured
    reference.particles = 100;
    reference.quantities[0].estimate = {1.0017, 0.0002, 100};
    reference.quantities[1].estimate = {23.611, 0.002, 100};
    BOOST_TEST(hints_for("pressure", 23.635, 0.002).find("N kT of the thermostat") != std::string::npos);
    BOOST_TEST(hints_for("pressure", 23.611 + 0.03005, 0.0005).find("N kT measured") != std::string::npos);
    BOOST_TEST(hints_for("pressure", 23.66, 0.002).empty());
    BOOST_TEST(hints_for("kinetic_temperature", 1.0017 * 0.99, 0.0003).find("over d N degrees") !=
               std::string::npos);
    BOOST_TEST(hints_for("kinetic_temperature", 1.0017 * 0.985, 0.0003).empty());
}

BOOST_AUTO_TEST_CASE(h5md_of_others_and_of_dpdref) {
    Directory const directory;
    auto const path = directory.path / "other.h5";
    {
        Archive archive(path, Archive::Mode::write);
        std::vector<double> temperature{1.0, 1.2, 0.8, 1.0};
        Eigen::Array<double, Eigen::Dynamic, 2> flux = Eigen::Array<double, Eigen::Dynamic, 2>::Zero(4, 2);
        archive("observables/kinetic_temperature/value", temperature);
        archive("observables/flux/value", flux);
        std::vector<double> times{0.0, 0.5, 1.0, 1.5};
        archive("observables/kinetic_temperature/time", times);
        Eigen::ArrayXXd column(1, 4);  // a file has it transposed: four rows
        column << 1.0, 2.0, 3.0, 4.0;
        archive("observables/solvent/pressure/value", column);
        archive("observables/solvent/density/value", times);
        archive("observables/density/value", times);
        std::vector<double> number{3000.0};
        archive("observables/particle_number", number);
        archive.commit();
    }
    auto const other = read_output(path);
    BOOST_TEST(other.series.size() == 5u);
    BOOST_TEST(series_of(other, "kinetic_temperature")[1] == 1.2);
    BOOST_TEST(series_of(other, "pressure")[2] == 3.0);  // of a subsystem, a column
    BOOST_TEST(series_of(other, "solvent/density").size() == 4u);
    BOOST_TEST(series_of(other, "particle_number").size() == 1u);  // one value for all times
    BOOST_TEST(other.axis == "time");
    BOOST_TEST(other.at.back() == 1.5);
    BOOST_CHECK_EXCEPTION(run_reference(path), InputError, says("finished result"));

    auto const text =
        "dimension = 3\nstages = ['shardlow', 'sample', 'drift']\nbox.length = [3.0, 3.0, 3.0]\n"
        "particles.density = 3.0\nshardlow.friction = 4.5\ntime = { step = 0.05, duration = 20.0 }\n"
        "[sample]\nobservables = ['kinetic_temperature']\n"
        "[sample.radial_distribution]\nrange = 1.0\nbins = 5\n";
    for (std::uint64_t const seed : {1u, 2u})
        run(parse_scene(text, "test", {}, seed),
            {.output = directory.path / fmt::format("{}.h5", seed), .progress = {}});
    auto const reference = run_reference(directory.path / "1.h5");
    auto const averages = average({read_output(directory.path / "2.h5")}, reference, {}, {});
    auto const report = compare(averages, reference, INFINITY);
    BOOST_TEST(report.comparisons.size() >= 3u);
    bool curve = false;
    for (auto const& c : report.comparisons) {
        BOOST_TEST(name_of(c.verdict) == "agrees", c.quantity);
        BOOST_TEST(c.z() != 0.0);  // other noise
        curve = curve || c.quantity.starts_with("radial_distribution at ");
    }
    BOOST_TEST(curve);
    BOOST_TEST(report.not_measured.empty());
}

BOOST_AUTO_TEST_CASE(mistakes_in_files_are_named_with_their_line) {
    Directory const directory;
    std::string const log = read_file(lammps / "log.lammps"), rdf = read_file(lammps / "rdf.dat"),
                      scalars = read_file(lammps / "scalars.dat");
    std::size_t const line_of_row =
        1 +
        std::size_t(std::count(log.begin(), log.begin() + std::ptrdiff_t(log.find("     200   0.9")), '\n'));
    auto const in_row = [&](std::string const& what) { return fmt::format("f:{}: {}", line_of_row, what); };
    std::vector<std::pair<std::string, std::string>> const cases{
        {"", "holds no samples"},
        {"no comma\n", "holds no samples"},
        {"a,b\n1,2\n3\n", "f:3: 1 columns; allowed: 2"},
        {"a,b\n1,2\n3,x\n", "f:3: x is not allowed; allowed: a number"},
        {"a,b\n1,nan\n", "f:2: nan is not allowed"},
        {"quantity,value,error,runs\nx,1,1,1\n", "f:1: allowed: quantity,value,error[,blocks]"},
        {"quantity,value,error\npressure,1,-1\n", "f:2: error is negative"},
        {"quantity,value,error,blocks\npressure,1,1,1\n", "f:2: blocks: allowed: an integer, 2"},
        {"quantity,value,error\npressure,1\n", "f:2: 2 columns; allowed: 3"},
        {replaced(log, "0.94730901", "0.9473x"), in_row("0.9473x is not allowed")},
        {replaced(log, "0.94730901", "-nan"), in_row("-nan is not allowed")},
        {replaced(log, "0.94730901", ""), in_row("5 columns; allowed: 6")},
        {"LAMMPS (29 Sep 2021)\nunits lj\n", "allowed: 1 to 0"},
        {"Per MPI rank memory allocation (min/avg/max) = 1\n------------ Step 0 ----- CPU = 0\n",
         "holds no samples"},
        {"step = 1 T = 1.0\nstep = 2 p = 1.0\n", "f:2: allowed: step, T with a number each"},
        {"Per MPI rank memory allocation (min/avg/max) = 1\nStep Temp\nLoop time of 1\n", "holds no samples"},
        {replaced(scalars, "2.38389 ", ""), "f:4: 2 columns; allowed: 3"},
        {replaced(rdf, "100 10", "100 ten"), "f:4: ten is not allowed"},
        {replaced(rdf, "100 10", "100"), "f:4: no head of a block"},
        {replaced(rdf, "100 10", "100 9"), "f:14: no head of a block"},
        {replaced(rdf, "2 0.15 ", "2 0.16 "), "f:15: other bins"},
        {"\x89HDF\r\n", "f: cannot open"}};
    for (auto const& [text, complaint] : cases) BOOST_TEST_CONTEXT(complaint) {
            auto const file = directory.write("f", text);
            BOOST_CHECK_EXCEPTION(read_output(file), InputError, says(complaint));
        }
    BOOST_CHECK_EXCEPTION(read_output(directory.path / "none"), InputError, says("none"));
}

BOOST_AUTO_TEST_CASE(mistakes_in_options_are_refused) {
    for (auto const* text : {"", "a", "a=", "=b", "a=b*", "a=b*x", "a=b*0", "a=b*inf"})
        BOOST_CHECK_EXCEPTION(renaming_from_text(text), InputError, says("allowed: COLUMN=quantity"));
    BOOST_TEST(renaming_from_text("c_g[2]=g*-0.5").factor == -0.5);
    BOOST_TEST(renaming_from_text("c_g[2]=g*-0.5").quantity == "g");
    for (auto const* text : {"", "x", "100%", "-1%", "1e", "nan"})
        BOOST_CHECK_EXCEPTION(discard_from_text(text), InputError, says("--discard"));
    auto const log = read_output(lammps / "log.lammps");
    BOOST_CHECK_EXCEPTION(average({log}, fluid, {{"Tmp", "kinetic_temperature", 1.0}}, {}), InputError,
                          says("no column Tmp; allowed: E_mol, E_pair, Press"));
    BOOST_CHECK_EXCEPTION(average({log, log}, fluid, {}, {}), InputError, says("kinetic_temperature: is in"));
    BOOST_CHECK_EXCEPTION(average({log}, fluid, {}, discard_from_text("1e9")), InputError,
                          says("leaves nothing"));
    CodeOutput no_axis;
    no_axis.series.emplace_back("pressure", std::vector<double>{1.0, 2.0});
    BOOST_CHECK_EXCEPTION(average({no_axis}, fluid, {}, discard_from_text("5")), InputError,
                          says("no column of times"));
}

// --- names -----------------------------------------------------------------------------------------------

BOOST_AUTO_TEST_CASE(columns_become_quantities) {
    CodeOutput output;
    for (auto const* name : {"E_pair", "PotEng", "v_pressure", "stress_xy", "c_other", "kinetic_stress"})
        output.series.emplace_back(name, std::vector<double>{1.0, 2.0, 3.0, 4.0});
    auto const at_rest = average({output}, fluid, {}, {});
    for (auto const* name :
         {"potential_energy", "PotEng", "pressure", "stress_xy", "c_other", "kinetic_stress"})
        BOOST_TEST(estimate_of(at_rest, name).value == 2.5);
    auto sheared = fluid;
    sheared.shear_rate = 0.1;
    auto const flow = average({output}, sheared, {{"c_other", "potential_stress", -2.0}}, {});
    BOOST_TEST(estimate_of(flow, "viscosity").value == 25.0);
    BOOST_TEST(estimate_of(flow, "kinetic_viscosity").value == 25.0);
    BOOST_TEST(estimate_of(flow, "potential_viscosity").value == -50.0);
}

// Displacements that grow at 2 d D; origins of four lags each, the last cut short.
BOOST_AUTO_TEST_CASE(displacements_become_a_diffusion_constant) {
    CodeOutput output;
    std::vector<double> lag, squares;
    for (int k = 0; k < 4 * 10 + 3; ++k) {
        lag.push_back(0.5 * (k % 4 + 1));
        squares.push_back(7.0 + 2.0 * 3.0 * (k / 4 % 2 == 0 ? 0.39 : 0.41) * lag.back());
    }
    squares[0] = 1e6;  // the first half of the lags does not count
    output.series = {{"lag", lag}, {"mean_square_displacement", squares}};
    auto const averages = average({output}, fluid, {}, {});
    auto const d = estimate_of(averages, "diffusion_constant");
    BOOST_TEST(d.value == 0.4, boost::test_tools::tolerance(1e-9));
    // ten independent values, 0.01 from their mean: of blocks there would be five of the same value
    BOOST_TEST(d.blocks == 10u);
    BOOST_TEST(d.error == 0.01 / 3.0, boost::test_tools::tolerance(1e-9));
    BOOST_TEST(averages.quantities.size() == 1u);
}

BOOST_AUTO_TEST_CASE(a_file_of_reference_answers) {
    Directory const directory;
    std::string const scene =
        "dimension = 2\\nstages = ['shardlow', 'sample', 'drift']\\nbox.length = [6.0, 6.0]\\n"
        "particles.density = 2.0\\nshardlow.friction = 3.0\\ntime = { step = 0.1, duration = 10.0 }\\n"
        "sample.observables = ['kinetic_temperature', 'stress']\\n";
    std::string const text =
        "{\"schema\": \"dpdref-answers/1\", \"engine_revision\": 1, \"states\": [{\"id\": \"gas\", "
        "\"title\": \"\", "
        "\"scenes\": {\"rest\": \"" +
        scene + "\", \"shear\": \"" + scene +
        "box.shear_rate = 0.25\"}, \"quantities\": {\"viscosity\": {\"value\": 1.5, \"error\": 0.01, "
        "\"blocks\": 30}, "
        "\"largest_momentum\": {\"value\": 0, \"error\": null, \"blocks\": 1}}, "
        "\"curves\": {\"radial_distribution\": {\"x\": [0.1, 0.3], \"value\": [1, 1.1], \"error\": [0.1, "
        "0.1]}}}]}";
    auto const reference = answer_reference(directory.write("a.json", text), "gas");
    BOOST_TEST(reference.shear_rate == 0.25);
    BOOST_TEST(reference.components == 2);
    BOOST_TEST(find_quantity(reference.quantities, "viscosity")->estimate.blocks == 30u);
    BOOST_TEST(reference.radial_distribution.y[1].value == 1.1);
    BOOST_CHECK_EXCEPTION(answer_reference(directory.path / "a.json", "ga"), InputError,
                          says("ga is unknown; allowed: gas"));
    for (auto const& [from, to, complaint] :
         std::vector<std::array<std::string, 3>>{{"answers/1", "answers/2", "allowed: dpdref-answers/1"},
                                                 {"\"blocks\"", "\"blocs\"", "blocks"},
                                                 {"{", "", "a.json: "}})
        BOOST_CHECK_EXCEPTION(answer_reference(directory.write("a.json", replaced(text, from, to)), "gas"),
                              InputError, says(complaint));
}

// --- verdicts --------------------------------------------------------------------------------------------

BOOST_AUTO_TEST_CASE(degrees_of_freedom_of_a_difference) {
    auto const equal = difference({3.0, 0.3, 10}, {1.0, 0.3, 10});
    BOOST_TEST(equal.value == 2.0);
    BOOST_TEST(equal.error == 0.3 * std::sqrt(2.0), boost::test_tools::tolerance(1e-12));
    BOOST_TEST(std::abs(double(equal.blocks) - 19.0) <= 1.0);  // 2 (10-1) + 1, rounded down
    BOOST_TEST(difference({3.0, 0.3, 10}, {1.0, 0.0, 1}).blocks == 10u);
    BOOST_TEST(difference({3.0, 0.3, 10}, {1.0, 1e-9, 3}).blocks == 10u);
    // (0.04+0.01)^2/(0.0016/4 + 0.0001/19) = 6.168
    BOOST_TEST(difference({0.0, 0.2, 5}, {0.0, 0.1, 20}).blocks == 7u);
    BOOST_TEST(difference({1.0, 0.0, 5}, {1.0, 0.0, 9}).blocks == 5u);
}

namespace {

// Correlated normal noise around a mean, as in statistics_test: x' = phi x + sqrt(1-phi^2) xi.
std::vector<double> noise(std::mt19937_64& generator, double mean, double phi, std::size_t n) {
    std::normal_distribution<double> normal;
    std::vector<double> series(n);
    double x = normal(generator);
    for (double& value : series) {
        value = mean + x;
        x = phi * x + std::sqrt(1.0 - phi * phi) * normal(generator);
    }
    return series;
}

// In how many of 2000 families of six true comparisons one disagrees.
int false_alarms(unsigned seed, std::function<Estimate(std::mt19937_64&, std::size_t)> const& measure) {
    std::mt19937_64 generator(seed);
    int alarms = 0;
    for (int family = 0; family < 2000; ++family) {
        Averages averages;
        Reference reference;
        for (std::size_t k = 0; k < 6; ++k) {
            averages.quantities.push_back({std::to_string(k), measure(generator, 6 + 3 * k)});
            reference.quantities.push_back({std::to_string(k), measure(generator, 20)});
        }
        auto const report = compare(averages, reference, INFINITY);
        BOOST_REQUIRE(report.comparisons.size() == 6u);
        alarms += std::any_of(report.comparisons.begin(), report.comparisons.end(),
                              [](auto const& c) { return c.verdict == Verdict::disagrees; });
    }
    return alarms;
}

}  // namespace

// At the stated rate of 1 %: 20 of 2000 families, +- 4.4. Few blocks on one side, six and more, twenty on the
// other.
BOOST_AUTO_TEST_CASE(false_alarms_come_at_the_stated_rate) {
    double const expected = 2000.0 * family_false_alarm;
    int const of_means = false_alarms(
        1, [](auto& generator, std::size_t n) { return independent(noise(generator, 5.0, 0.0, n)); });
    BOOST_TEST_MESSAGE("false alarms of independent values: " << of_means << " of 2000");
    BOOST_TEST(std::abs(of_means - expected) < 4.0 * std::sqrt(expected));
    // series: the error is found by blocking. Samples per correlation time (19 per independent one): 16 n.
    int const of_series = false_alarms(
        2, [](auto& generator, std::size_t n) { return blocking(noise(generator, 5.0, 0.9, 300 * n)); });
    BOOST_TEST_MESSAGE("false alarms of correlated series: " << of_series << " of 2000");
    BOOST_TEST(of_series < 3.0 * expected);
}

BOOST_AUTO_TEST_CASE(a_shift_is_found_and_a_wide_error_is_undecided) {
    Reference const reference =
        reference_of({{"pressure", {23.7, 0.003, 64}}, {"viscosity", {1.0, 0.001, 64}}});
    auto const verdict = [&](double value, double error) {
        Averages averages;
        averages.quantities = {{"pressure", {value, error, 64}}};
        return name_of(compare(averages, reference, 0.001).comparisons.at(0).verdict);
    };
    BOOST_TEST(verdict(23.7, 0.004) == "agrees");
    BOOST_TEST(verdict(23.7 + 5.0 * 0.005, 0.004) == "disagrees");  // five combined errors
    BOOST_TEST(verdict(23.7 - 5.0 * 0.005, 0.004) == "disagrees");
    BOOST_TEST(verdict(23.7, 0.04) == "undecided");  // within the error, which is above 0.1 %
    BOOST_TEST(verdict(23.7, NAN) == "undecided");
    // kT of five blocks, four errors off: within Student's t of four degrees of freedom, but that times the
    // error is 2 % of the value, more than was asked for
    Averages few;
    few.quantities = {{"kinetic_temperature", {1.0164, 0.0030, 5}}};
    Reference const hot = reference_of({{"kinetic_temperature", {1.02849, 0.00005, 256}}});
    BOOST_TEST(name_of(compare(few, hot, 0.01).comparisons.at(0).verdict) == "undecided");
    BOOST_TEST(name_of(compare(few, hot, 0.02).comparisons.at(0).verdict) == "agrees");
    few.quantities[0].estimate.blocks = 100;
    BOOST_TEST(name_of(compare(few, hot, 0.01).comparisons.at(0).verdict) == "disagrees");

    Averages averages;
    averages.quantities = {{"pressure", {23.7, 0.004, 64}}, {"colour", {1.0, 0.1, 8}}};
    auto const report = compare(averages, reference, 0.001);
    BOOST_TEST(report.without_reference.at(0).name == "colour");
    BOOST_TEST(report.not_measured.at(0) == "viscosity");
}

// 100 bins are one member of the family. A shift of one bin by 6 errors is found, and named.
BOOST_AUTO_TEST_CASE(a_radial_distribution_is_judged_by_its_bins) {
    std::mt19937_64 generator(3);
    auto const curve = [&](double phi) {
        CurveEstimate result;
        for (int bin = 0; bin < 100; ++bin) {
            double const r = 0.02 * (bin + 0.5), g = r < 0.2 ? 0.0 : 1.0 + 0.1 * std::sin(6.0 * r);
            auto values = noise(generator, 0.0, phi, 16);
            for (double& value : values) value = g + (g > 0.0 ? 0.01 * value : 0.0);
            result.x.push_back(r);
            result.y.push_back(independent(values));
        }
        return result;
    };
    int alarms = 0;
    for (int k = 0; k < 1000; ++k) {
        Averages averages;
        Reference reference;
        averages.radial_distribution = curve(0.0);
        reference.radial_distribution = curve(0.0);
        auto const report = compare(averages, reference, 0.01);
        alarms += report.comparisons.at(0).verdict == Verdict::disagrees;
        if (k > 0) continue;
        BOOST_TEST(name_of(report.comparisons[0].verdict) == "agrees");
        averages.radial_distribution.y[40].value =
            reference.radial_distribution.y[40].value +
            6.0 * difference(averages.radial_distribution.y[40], reference.radial_distribution.y[40]).error;
        auto const shifted = compare(averages, reference, 0.01).comparisons.at(0);
        BOOST_TEST(name_of(shifted.verdict) == "disagrees");
        BOOST_TEST(shifted.quantity == "radial_distribution at 0.81");
        BOOST_TEST(name_of(compare(averages, reference, 1e-4).comparisons.at(0).verdict) == "disagrees");
        averages.radial_distribution = reference.radial_distribution;
        BOOST_TEST(name_of(compare(averages, reference, 1e-4).comparisons.at(0).verdict) == "undecided");
    }
    BOOST_TEST_MESSAGE("false alarms of g(r): " << alarms << " of 1000");
    BOOST_TEST(std::abs(alarms - 1000.0 * family_false_alarm) < 4.0 * std::sqrt(1000.0 * family_false_alarm));
}

// Pairs that are counted in 16 blocks, where the innermost bins are hit now and then: a bin that no block has
// hit is no disagreement, unless it should have been.
BOOST_AUTO_TEST_CASE(a_bin_that_was_never_hit_has_the_error_of_counts) {
    std::mt19937_64 generator(4);
    auto const curve = [&](double counts, double core) {  // of all blocks, in the shell between 1 and 1.02
        CurveEstimate result;
        for (int bin = 0; bin < 50; ++bin) {
            double const r = 0.02 * (bin + 0.5), volume = r * r, g = r < core ? 0.0 : r < 0.2 ? 0.02 : 1.0;
            double const mean = g * volume * counts / 16.0;
            std::vector<double> values(16, 0.0);
            for (double& value : values)
                if (mean > 0.0)
                    value = std::poisson_distribution<>(mean)(generator) / (volume * counts / 16.0);
            result.x.push_back(r);
            result.y.push_back(independent(values));
        }
        return result;
    };
    int alarms = 0, empty = 0;
    Averages averages;
    Reference reference;
    for (int k = 0; k < 1000; ++k) {
        averages.radial_distribution = curve(1e4, 0.0);
        reference.radial_distribution = curve(1e8, 0.0);
        empty += averages.radial_distribution.y[1].error == 0.0;
        alarms += compare(averages, reference, 0.1).comparisons.at(0).verdict == Verdict::disagrees;
    }
    BOOST_TEST_MESSAGE("false alarms of g(r) with empty bins: " << alarms << " of 1000");
    BOOST_TEST(empty > 500);
    BOOST_TEST(alarms < 1000.0 * family_false_alarm + 4.0 * std::sqrt(1000.0 * family_false_alarm));
    averages.radial_distribution = curve(1e4, 0.5);
    auto const hard = compare(averages, reference, 0.1).comparisons.at(0);
    BOOST_TEST(name_of(hard.verdict) == "disagrees");
    BOOST_TEST(hard.z() < -5.0);
}

// g(r) = 1 + r^2/2 + sin(3 r)/5 in bins of any width, exactly averaged over shells, against bins of another.
BOOST_AUTO_TEST_CASE(other_bins_are_put_together) {
    auto const shells = [](double width, std::size_t count, int d, double first = 0.0) {
        auto const mass = [&](double r) {  // integral of g(r) r^(d-1)
            double const s = std::sin(3.0 * r), c = std::cos(3.0 * r);
            return d == 3 ? r * r * r / 3.0 + std::pow(r, 5) / 10.0 +
                                ((2.0 - 9.0 * r * r) * c + 6.0 * r * s) / 27.0 / 5.0
                          : r * r / 2.0 + std::pow(r, 4) / 8.0 + (s / 9.0 - r * c / 3.0) / 5.0;
        };
        CurveEstimate curve;
        for (std::size_t k = 0; k < count; ++k) {
            double const a = first + width * double(k), b = a + width;
            curve.x.push_back(0.5 * (a + b));
            curve.y.push_back(
                {double(d) * (mass(b) - mass(a)) / (std::pow(b, d) - std::pow(a, d)), 1e-4, 50});
        }
        return curve;
    };
    for (int const d : {2, 3})
        for (auto const& [width, count] : {std::pair{0.04, 25u}, {0.026, 50u}, {0.013, 120u}, {0.01, 100u}}) {
            Averages averages;
            Reference reference;
            reference.dimension = d;
            reference.radial_distribution = shells(0.02, 100, d);
            averages.radial_distribution = shells(width, count, d);
            averages.quantities = {{"pressure", {23.7, 0.01, 50}}};
            reference.quantities = averages.quantities;
            auto report = compare(averages, reference, 0.01);
            BOOST_TEST_CONTEXT(d << " " << width) {
                BOOST_REQUIRE(report.comparisons.size() == 2u);
                auto const& g = report.comparisons[1];
                BOOST_TEST(name_of(g.verdict) == "agrees");
                // the method itself errs by less than the statistics
                BOOST_TEST(std::abs(g.difference.value) < 1e-4, g.difference.value);
                BOOST_TEST(g.difference.error < 3e-4);
                BOOST_TEST(report.notes.at(0).find("were put together") != std::string::npos);
                for (auto& y : averages.radial_distribution.y) y.value *= 1.01;
                report = compare(averages, reference, 0.01);
                BOOST_TEST(name_of(report.comparisons[1].verdict) == "disagrees");
            }
        }
    // bins that cannot be put together do not block the rest
    for (CurveEstimate const& strange : {shells(0.02, 3, 3, 7.0), CurveEstimate{{0.1}, {{1.0, 0.1, 9}}}}) {
        Averages averages;
        Reference reference = fluid;
        reference.radial_distribution = shells(0.02, 100, 3);
        averages.radial_distribution = strange;
        averages.quantities = {fluid.quantities[0]};
        auto const report = compare(averages, reference, 0.01);
        BOOST_TEST(report.comparisons.size() == 1u);
        BOOST_TEST(report.notes.at(0).find("left out") != std::string::npos);
    }
}

BOOST_AUTO_TEST_CASE(a_drift_is_noted) {
    std::mt19937_64 generator(4);
    int noted = 0;
    for (int k = 0; k < 1000; ++k) {
        CodeOutput steady;
        steady.series.emplace_back("pressure", noise(generator, 5.0, 0.5, 400));
        noted += average({steady}, fluid, {}, {}).notes.size() > 1;
    }
    BOOST_TEST_MESSAGE("drifts noted in steady series: " << noted << " of 1000");
    BOOST_TEST(noted < 3.0 * 1000.0 * family_false_alarm);
    CodeOutput drifting;
    drifting.series.emplace_back("pressure", noise(generator, 5.0, 0.5, 400));
    for (std::size_t k = 0; k < 200; ++k) drifting.series[0].second[k] += 2.0;
    BOOST_TEST(average({drifting}, fluid, {}, {}).notes.at(1).find("pressure: its first and second half") ==
               0u);
}
