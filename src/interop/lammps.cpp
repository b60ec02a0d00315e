#include "lammps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <vector>

#include "conventions.hpp"
#include "errors.hpp"
#include "run.hpp"
#include "toml_reader.hpp"
#include "version.hpp"

namespace dpd {
namespace {

[[noreturn]] void refuse(std::string_view what, std::string_view problem, std::string_view allowed) {
    throw InputError(fmt::format("export lammps: {}: {}; allowed: {}", what, problem, allowed));
}

// --- what LAMMPS can do ----------------------------------------------------------------------------------

constexpr std::string_view step_lists =
    "[modified_verlet], [verlet], [shardlow, verlet] or [shardlow, drift], with sample at the end";

void check_stages(Scene const& scene) {
    using List = std::vector<std::string>;
    static std::array<List, 4> const steps{List{"modified_verlet"}, List{"verlet"},
                                           List{"shardlow", "verlet"}, List{"shardlow", "drift"}};
    List movers;
    if (scene.until) refuse("time.until", "LAMMPS runs a number of steps", "time.duration alone");
    for (AnyStage const& stage : scene.stages) {
        std::string const name(kind_of(stage).name);
        if (kind_of(stage).lammps.empty()) refuse("stage " + name, "LAMMPS has no such stage", step_lists);
        if (!std::holds_alternative<Sample>(stage)) movers.push_back(name);
    }
    if (std::find(steps.begin(), steps.end(), movers) == steps.end())
        refuse("stages", "LAMMPS has no such step", step_lists);
    // a drift changes no velocity, so it does not matter where a gas is seen
    if (scene.stage<Sample>() && scene.stage<Verlet>() && scene.stage<Shardlow>() &&
        !std::holds_alternative<Sample>(scene.stages.back()))
        refuse("stages", "sample is before verlet, but LAMMPS measures at the end of a step",
               "sample at the end");
}

void check_modified_verlet(Scene const& scene, ModifiedVerlet const& p) {
    if (p.lambda != 0.5)
        refuse("modified_verlet.lambda", fmt::format("{} is not the velocity-Verlet of LAMMPS", p.lambda),
               "0.5");
    if (p.friction_again)
        refuse("modified_verlet.friction_again", "LAMMPS finds friction once a step", "false");
    if (p.gamma == 0.0 && p.sigma > 0.0)
        refuse("modified_verlet.sigma", "LAMMPS computes the noise from friction and temperature",
               "0 where gamma is 0");
    if (!exponent(p.weight))
        refuse("modified_verlet.weight", "parabolic is no power of 1 - r/cutoff",
               "constant, root, linear, quadratic, power");
    auto const* const soft = scene.soft();
    if (soft && soft->cutoff != p.cutoff)
        refuse("modified_verlet.soft.cutoff", fmt::format("{} is not that of the friction", soft->cutoff),
               fmt::format("{}", p.cutoff));
}

// Between neighbour lists a pair may come closer by this, in cutoffs; LAMMPS rebuilds them in time.
constexpr double skin_in_cutoffs = 0.3;
double skin(Scene const& scene) { return skin_in_cutoffs * scene.cutoff(); }

void check_shardlow(Scene const& scene, Shardlow const& p) {
    if (p.scheme != Scheme::shardlow)
        refuse("shardlow.scheme", fmt::format("fix shardlow does not know {}", name_of(p.scheme)),
               "shardlow");
    if (p.weight != Weight::quadratic)
        refuse("shardlow.weight", "fix shardlow has (1 - r/cutoff)^2 only", "quadratic");
    if (p.kT == 0.0) refuse("shardlow.kT", "fix shardlow divides by it", "a number > 0");
    if (scene.shear_rate != 0.0) refuse("box.shear_rate", "fix shardlow refuses a sheared box", "0");
    if (scene.sample.asks("stress"))
        refuse("sample.observables", "LAMMPS does not keep the stress of fix shardlow's impulses",
               "kinetic_temperature, potential_energy, pressure");
    if (scene.order != Order::cell) refuse("pairs.order", "fix shardlow has an order of its own", "cell");
    for (double const side : scene.length)
        if (double const least = 2.0 * (scene.cutoff() + skin(scene)); side <= least)
            refuse("box.length", fmt::format("{} is too small for fix shardlow", side),
                   fmt::format("more than {:g}", least));
    if (!scene.stage<Verlet>()) return;
    auto const* const soft = scene.soft();
    if (!soft) refuse("verlet.lennard_jones", "pair dpd/fdt has a soft potential", "verlet.soft");
    if (soft->cutoff != p.cutoff)
        refuse("verlet.soft.cutoff", fmt::format("{} is not that of the friction", soft->cutoff),
               fmt::format("{}", p.cutoff));
}

void check(Scene const& scene) {
    check_stages(scene);
    if (scene.wall > 0.0) refuse("walls", "LAMMPS has no such bounce-back", "no walls");
    if (auto const* const modified = scene.stage<ModifiedVerlet>()) check_modified_verlet(scene, *modified);
    if (auto const* const verlet = scene.stage<Verlet>(); verlet && verlet->substeps != 1)
        refuse("verlet.substeps", "LAMMPS has one step for all forces", "1");
    if (auto const* const s1 = scene.stage<Shardlow>()) check_shardlow(scene, *s1);
}

// --- the deck --------------------------------------------------------------------------------------------

// LAMMPS takes 1 to 9 10^8.
std::uint64_t lammps_seed(Scene const& scene) {
    constexpr std::uint64_t most = 900'000'000;
    return (scene.seed % most + most - 1) % most + 1;
}

// The force of LAMMPS is A (1 - r/cutoff).
double force_amplitude(Soft const& soft) { return soft.strength / soft.cutoff; }

std::string pair_lines(Scene const& scene) {
    auto const seed = lammps_seed(scene);
    auto const* const soft = scene.soft();
    auto const* const lj = scene.potential() ? std::get_if<LennardJones>(scene.potential()) : nullptr;
    if (auto const* const s1 = scene.stage<Shardlow>())
        return fmt::format("pair_style dpd/fdt {} {} {}\npair_coeff 1 1 {} {} {}\n", s1->kT, s1->cutoff, seed,
                           scene.stage<Verlet>() ? force_amplitude(*soft) : 0.0,
                           std::sqrt(2.0 * s1->friction * s1->kT), s1->cutoff);
    std::string const shift = lj && lj->shifted ? "pair_modify shift yes\n" : "";
    if (scene.stage<Verlet>()) {
        if (soft)
            return fmt::format("pair_style dpd 0 {0} {1}\npair_coeff 1 1 {2} 0 {0}\n", soft->cutoff, seed,
                               force_amplitude(*soft));
        return fmt::format("pair_style lj/cut {}\npair_coeff 1 1 {} {}\n", lj->cutoff, lj->epsilon,
                           lj->sigma) +
               shift;
    }
    auto const& p = *scene.stage<ModifiedVerlet>();
    double const kT = p.temperature();
    bool const quadratic = p.weight == Weight::quadratic;
    // friction along the line of the pair, none across; w_R has half the power of w_D
    std::string const friction =
        quadratic ? fmt::format("{} {}", p.gamma, p.cutoff)
                  : fmt::format("{} 0 {} 1 {}", p.gamma, 0.5 * *exponent(p.weight), p.cutoff);
    if (soft)
        return fmt::format("pair_style {} {} {} {}\npair_coeff 1 1 {} {}\n", quadratic ? "dpd" : "dpd/ext",
                           kT, p.cutoff, seed, force_amplitude(*soft), friction);
    std::string_view const thermostat = quadratic ? "dpd/tstat" : "dpd/ext/tstat";
    return fmt::format(
               "pair_style hybrid/overlay lj/cut {0} {1} {2} {2} {3} {4}\n"
               "pair_coeff 1 1 lj/cut {5} {6}\npair_coeff 1 1 {1} {7}\n",
               lj->cutoff, thermostat, kT, p.cutoff, seed, lj->epsilon, lj->sigma, friction) +
           shift;
}

// A column of scalars.dat: the name, and what LAMMPS is asked for.
struct Column {
    std::string name, value;
};

// The pressure without friction and noise, as dpdref has it, is not kept by LAMMPS where one pair style does
// all forces. That of a soft potential follows from what `pair->single` gives, the conservative part: f r =
// cutoff f - 2 U for each pair. Since 21 Nov 2023 LAMMPS wants to be told that these are pairs, not
// particles; before, it does not know the word.
std::string conservative_virial_lines(Scene const& scene) {
    if (!scene.stage<ModifiedVerlet>()) return "compute virial all pressure NULL virial\n";
    if (!scene.soft()) return "compute virial all pressure NULL pair/hybrid lj/cut\n";
    return "compute force all pair/local force\n"
           "if \"$(version) >= 20231121\" then \"compute forces all reduce sum c_force inputs local\" &\n"
           "    else \"compute forces all reduce sum c_force\"\n";
}

std::string conservative_virial_pressure(Scene const& scene) {
    auto const* const soft = scene.soft();
    if (!scene.stage<ModifiedVerlet>() || !soft) return "c_virial";
    return fmt::format("({}*c_forces-2*c_energy)/{}", soft->cutoff, scene.dimension * scene.volume());
}

// The peculiar momentum that a drift carries, by the velocities that drifted, as in `kinetic_stress`.
std::string stress_lines(Scene const& scene) {
    return fmt::format(
        "variable half_y atom vy-fy*{0}\n"
        "variable half_x atom vx-fx*{0}-{1}*(y-{2}*v_half_y)\n"
        "variable carried atom v_half_x*v_half_y\n"
        "compute carried all reduce sum v_carried\n"
        "compute all_virial all pressure NULL virial\n"
        "compute lammps all pressure temperature\n",
        0.5 * scene.time_step / scene.mass, scene.shear_rate, 0.5 * scene.time_step);
}

std::string scalar_lines(Scene const& scene) {
    auto const& sample = scene.sample;
    double const n = double(scene.particles);
    std::string lines;
    std::vector<Column> columns;
    if (sample.asks("kinetic_temperature")) columns.push_back({"kinetic_temperature", "c_temperature"});
    if (sample.asks("potential_energy"))
        columns.push_back({"potential_energy", fmt::format("c_energy/{}", n)});
    if (sample.asks("pressure")) {
        lines += conservative_virial_lines(scene);
        columns.push_back({"pressure", fmt::format("{}*c_temperature/{}+{}", n - 1.0, scene.volume(),
                                                   conservative_virial_pressure(scene))});
    }
    if (scene.stage<ModifiedVerlet>() && (sample.asks("pressure") || sample.asks("lammps_pressure"))) {
        lines += "compute lammps_pressure all pressure temperature\n";
        columns.push_back({"lammps_pressure", "c_lammps_pressure"});
    }
    if (sample.asks("stress")) {
        lines += stress_lines(scene);
        std::string const kinetic = fmt::format("-{}*c_carried", scene.mass / scene.volume());
        columns.push_back({"stress_xy", kinetic + "-c_all_virial[4]"});
        columns.push_back({"kinetic_stress", kinetic});
        columns.push_back({"lammps_stress_xy", "-c_lammps[4]"});
    }
    if (columns.empty()) return "";
    std::string names, values;
    for (auto const& [name, value] : columns) {
        lines += fmt::format("variable {} equal {}\n", name, value);
        names += " " + name;
        values += " v_" + name;
    }
    return lines + fmt::format(
                       "fix scalars all ave/time {0} 1 {0}{1} file scalars.dat format \" %.15g\" &\n"
                       "    title1 \"# dpdref observables, shear rate {3}\" title2 \"# step{2}\"\n",
                       sample.interval, values, names, scene.shear_rate);
}

// Blocks of g(r), each one entry of rdf.dat.
constexpr std::uint64_t rdf_blocks = 16;

std::string rdf_lines(Scene const& scene) {
    auto const& p = scene.sample.radial_distribution;
    if (!p) return "";
    auto const repeats = std::max<std::uint64_t>(1, scene.production_steps / (p->interval * rdf_blocks));
    return fmt::format(
        "compute rdf all rdf {} cutoff {}\n"
        "fix rdf all ave/time {} {} {} c_rdf[1] c_rdf[2] mode vector file rdf.dat &\n"
        "    title1 \"# dpdref radial_distribution, shear rate {}\" title2 \"# step bins\" title3 \"# bin r "
        "g\"\n",
        p->bins, p->range, p->interval, repeats, p->interval * repeats, scene.shear_rate);
}

// Displacements since the last origin, which moves on when the longest lag is reached.
std::string msd_lines(Scene const& scene) {
    auto const& p = scene.sample.mean_square_displacement;
    if (!p) return "";
    static constexpr std::array<std::string_view, 3> unwrapped{"xu", "yu", "zu"};
    auto const d = static_cast<std::size_t>(scene.dimension);
    auto const components = static_cast<std::size_t>(scene.sample.components);
    std::uint64_t const longest = p->spacing * p->lags;
    std::string names, reduced, sum, lines;
    for (std::size_t c = 1; c <= components; ++c) {
        auto const name = unwrapped[d - components + c - 1];
        std::string const column =
            components == 1 ? "" : fmt::format("[{}]", c);  // LAMMPS: a vector has none
        lines += fmt::format("compute {0} all property/atom {0}\nvariable moved_{0} atom c_{0}-f_origin{1}\n",
                             name, column);
        names += fmt::format(" {}", name);
        reduced += fmt::format(" v_moved_{}", name);
        sum += fmt::format("{}c_squares{}", c == 1 ? "" : "+", column);
    }
    return lines + fmt::format(
                       "compute squares all reduce sumsq{0}\n"
                       "variable lag equal \"{1}*((step-1)%{2}+1)\"\n"
                       "variable mean_square_displacement equal ({3})/{4}\n"
                       "fix msd all ave/time {5} 1 {5} v_lag v_mean_square_displacement file msd.dat format "
                       "\" %.15g\" &\n"
                       "    title1 \"# dpdref mean_square_displacement, sum over{6}, shear rate {7}\" &\n"
                       "    title2 \"# step lag mean_square_displacement\"\n"
                       "fix origin all store/state {2}{6}\n",
                       reduced, scene.time_step, longest, sum, scene.particles, p->spacing, names,
                       scene.shear_rate);
}

std::vector<std::string> not_measured(Scene const& scene) {
    auto const& s = scene.sample;
    std::vector<std::string> names;
    auto const add = [&](bool wanted, char const* name) {
        if (wanted) names.emplace_back(name);
    };
    add(s.asks("momentum"), "momentum");
    add(s.asks("configurational_temperature"), "configurational_temperature");
    add(s.profile.has_value(), "profile");
    add(s.bond_order.has_value(), "bond_order");
    add(s.configuration, "configuration");
    add(s.velocity_autocorrelation.has_value(), "velocity_autocorrelation");
    add(s.green_kubo_window > 0, "green_kubo");
    return names;
}

// --- files -----------------------------------------------------------------------------------------------

constexpr std::array<std::string_view, 4> written_here{"in.dpdref", "particles.data", "scene.toml", "README"};
constexpr std::array<std::string_view, 6> written_by_deck{"scalars.dat",     "rdf.dat",    "msd.dat",
                                                          "trajectory.dump", "log.lammps", "reference.h5"};

void write(std::filesystem::path const& file, std::string const& text) {
    std::ofstream stream(file, std::ios::binary);
    if (!(stream << text << std::flush))
        throw InputError(fmt::format("{}: cannot be written", file.string()));
}

// The third side of a plane box means nothing, but the neighbour lists of fix shardlow need it.
double half_height(Scene const& scene) { return scene.stage<Shardlow>() ? 2.0 * scene.cutoff() : 0.5; }

template <int d>
std::string particle_data(Scene const& scene) {
    auto const simulation = build<d>(scene, {});
    auto const& particles = simulation.particles;
    std::string text = fmt::format("dpdref {}: {}\n\n{} atoms\n1 atom types\n\n", version,
                                   one_line(scene.title), particles.size());
    static constexpr std::array<char, 3> axes{'x', 'y', 'z'};
    for (int axis = 0; axis < d; ++axis)
        text += fmt::format("0 {} {}lo {}hi\n", scene.length[std::size_t(axis)], axes[std::size_t(axis)],
                            axes[std::size_t(axis)]);
    if (d == 2) text += fmt::format("{} {} zlo zhi\n", -half_height(scene), half_height(scene));
    // LAMMPS moves the box at the end of a step, after the forces: it has to be one step ahead
    if (scene.shear_rate != 0.0)
        text += fmt::format("{} 0 0 xy xz yz\n",
                            std::remainder(simulation.box.image_speed() * scene.time_step, scene.length[0]));
    text += fmt::format("\nMasses\n\n1 {}\n\nAtoms # {}\n\n", scene.mass,
                        scene.stage<Shardlow>() ? "dpd" : "atomic");
    auto const vector = [](auto const& row) {
        return d == 2 ? fmt::format("{} {} 0", row[0], row[1])
                      : fmt::format("{} {} {}", row[0], row[1], row[d - 1]);
    };
    std::string_view const kind = scene.stage<Shardlow>() ? "1 1" : "1";  // type, and an internal temperature
    for (Eigen::Index p = 0; p < particles.size(); ++p)
        text += fmt::format("{} {} {}\n", particles.id[p] + 1, kind, vector(particles.position.row(p)));
    text += "\nVelocities\n\n";
    for (Eigen::Index p = 0; p < particles.size(); ++p) {
        Vec<d> velocity = particles.velocity.row(p).matrix().transpose();
        velocity[0] -= simulation.box.flow_velocity(0.0);  // LAMMPS's flow is at rest at y = 0
        text += fmt::format("{} {}\n", particles.id[p] + 1, vector(velocity));
    }
    return text;
}

std::string readme(Scene const& scene) {
    auto const missing = not_measured(scene);
    return fmt::format(
        "A scene of dpdref {} for LAMMPS: the same particles, forces and measurements. In this directory:\n\n"
        "  lmp -in in.dpdref\n"
        "  dpdref run scene.toml --seed {} --out reference.h5\n"
        "  dpdref compare scalars.dat{}{} --reference reference.h5\n\n"
        "LAMMPS needs the package{}. All quantities are in the scene's units\n"
        "(LAMMPS: lj). Columns that begin with lammps_ are LAMMPS's own definitions, which differ: "
        "docs/lammps.md.\n{}{}",
        version, scene.seed, scene.sample.mean_square_displacement ? " msd.dat" : "",
        scene.sample.radial_distribution ? " rdf.dat" : "",
        scene.stage<Shardlow>() ? "s DPD-BASIC and DPD-REACT" : " DPD-BASIC (not for Lennard-Jones alone)",
        missing.empty() ? "" : fmt::format("Not measured by the deck: {}.\n", fmt::join(missing, ", ")),
        scene.shear_rate == 0.0
            ? ""
            : "LAMMPS (29 Sep 2021) heats whenever it flips the sheared box: docs/lammps.md.\n");
}

}  // namespace

std::string lammps_deck(Scene const& scene) {
    check(scene);
    bool const sheared = scene.shear_rate != 0.0;
    auto const& rdf = scene.sample.radial_distribution;
    std::string deck = fmt::format("# {} (dpdref {}, seed {})\n", one_line(scene.title), version, scene.seed);
    deck += fmt::format("units lj\ndimension {}\natom_style {}\n", scene.dimension,
                        scene.stage<Shardlow>() ? "dpd" : "atomic");
    deck +=
        fmt::format("comm_modify vel yes{}\n",
                    rdf ? fmt::format(" cutoff {}", std::max(rdf->range, scene.cutoff()) + skin(scene)) : "");
    deck += "read_data particles.data\n" + pair_lines(scene);
    deck += fmt::format("neighbor {} bin\nneigh_modify delay 0 every 1 check yes\ntimestep {}\n", skin(scene),
                        scene.time_step);
    if (scene.stage<Shardlow>()) deck += "fix friction_and_noise all shardlow\n";
    deck += "fix move all nve\n";
    if (scene.dimension == 2) deck += "fix plane all enforce2d\n";
    if (sheared) deck += fmt::format("fix shear all deform 1 xy erate {} remap v\n", scene.shear_rate);
    deck += fmt::format("compute temperature all temp{}\ncompute energy all pe\n", sheared ? "/deform" : "");
    deck += fmt::format("thermo_style custom step c_temperature c_energy\nthermo {}\n",
                        std::max<std::uint64_t>(1, scene.steps() / 10));
    if (scene.equilibration_steps > 0)
        deck += fmt::format("run {}\nreset_timestep 0\n", scene.equilibration_steps);
    if (scene.trajectory_interval > 0)
        deck += fmt::format(
            "dump trajectory all custom {} trajectory.dump id x y z ix iy iz vx vy vz\n"
            "dump_modify trajectory sort id format float %.17g\n",
            scene.trajectory_interval);
    deck += scalar_lines(scene) + rdf_lines(scene) + msd_lines(scene);
    return deck + fmt::format("run {}\n", scene.production_steps);
}

void export_lammps(Scene const& scene, std::filesystem::path const& directory) {
    std::string const deck = lammps_deck(scene);
    auto const is_ours = [](std::string const& name) {
        auto const in = [&](auto const& list) {
            return std::find(list.begin(), list.end(), name) != list.end();
        };
        return in(written_here) || in(written_by_deck);
    };
    std::error_code error;
    std::filesystem::create_directories(directory, error);
    if (!std::filesystem::is_directory(directory))
        throw InputError(fmt::format("{}: is no directory and cannot become one", directory.string()));
    for (auto const& entry : std::filesystem::directory_iterator(directory))
        if (auto const name = entry.path().filename().string(); !is_ours(name))
            throw InputError(
                fmt::format("{}: holds {}; allowed: a new or empty directory, or that of an earlier export",
                            directory.string(), name));
    write(directory / "in.dpdref", deck);
    write(directory / "particles.data",
          scene.dimension == 2 ? particle_data<2>(scene) : particle_data<3>(scene));
    write(directory / "scene.toml", scene.text + "\n");
    write(directory / "README", readme(scene));
}

}  // namespace dpd
