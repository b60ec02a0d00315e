#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "analysis.hpp"
#include "commands.hpp"
#include "files.hpp"
#include "lammps.hpp"
#include "progress.hpp"
#include "run.hpp"
#include "signals.hpp"

namespace dpd::cli {
namespace {

using Json = nlohmann::ordered_json;

// What the inverse-root law asks for.
std::string more_time(double duration, ErrorWanted const& e) {
    if (!std::isfinite(e.error())) return "";
    return fmt::format(" (an error that falls as t^(-1/2) needs about {:.2g})",
                       duration * std::pow(e.error() / e.wanted, 2));
}

void warn(Scene const& scene, RunResult const& result) {
    if (result.counters.coincident_pairs > 0)
        fmt::print(stderr, "dpdref: warning: {} pairs at r = 0 had no direction and did not interact\n",
                   result.counters.coincident_pairs);
    // soft forces are bounded: beyond their stable step a run is hot, but ends
    if (double const set = scene.thermostat_kT(); set > 0.0 && result.kinetic_temperature > 10.0 * set)
        fmt::print(stderr,
                   "dpdref: warning: kT ended at {:.3g}, the thermostat is set to {:.3g}; try a smaller "
                   "time.step\n",
                   result.kinetic_temperature, set);
    for (auto const& e : result.errors)
        if (!e.reached())
            fmt::print(stderr,
                       "dpdref: warning: after the greatest duration, {:g}, {}; allow more: time.longest{}\n",
                       result.duration, e.text(), more_time(result.duration, e));
}

// What costs N^2 says so beforehand.
void announce_plain(Scene const& scene) {
    if (scene.cutoff() == 0.0) return;  // no pairs
    auto const n = double(scene.particles + scene.wall_particles), pairs = 0.5 * n * (n - 1.0);
    auto const* const verlet = scene.stage<Verlet>();
    double const searches = double(scene.steps()) * double(verlet ? verlet->substeps : 1);
    constexpr double seconds_per_look = 2e-8;  // at one pair, measured
    fmt::print(stderr,
               "dpdref: the plain engine looks at all {:.3g} pairs of particles in each of {:.3g} searches: "
               "about {}\n",
               pairs, searches, duration_text(pairs * searches * seconds_per_look));
}

// Nanoseconds per particle and step.
double cost_of(RunResult const& result) {
    return 1e9 * result.seconds /
           (double(std::max<std::uint64_t>(1, result.counters.steps)) * double(result.particles));
}

void print_json(Scene const& scene, RunResult const& result) {
    auto const& counters = result.counters;
    Json output{
        {"title", scene.title}, {"key", scene.key()}, {"seed", scene.seed}, {"seconds", result.seconds}};
    for (auto const& q : analyze(scene, {result.record}))
        output["quantities"][q.name] = {
            {"value", q.estimate.value}, {"error", q.estimate.error}, {"blocks", q.estimate.blocks}};
    if (scene.until) {
        output["until"]["duration"] = result.duration;
        for (auto const& e : result.errors) {
            auto& error = output["until"]["errors"][e.quantity];
            error = {{"wanted", e.wanted}, {"error", nullptr}, {"reached", e.reached()}};
            if (std::isfinite(e.error())) error["error"] = e.error();
        }
    }
    output["counters"] = {{"steps", counters.steps},
                          {"searches", counters.searches},
                          {"pairs_found", counters.pairs_found},
                          {"pair_updates", counters.pair_updates},
                          {"potential_evaluations", counters.potential_evaluations},
                          {"random_draws", counters.random_draws},
                          {"boundary_pairs", counters.boundary_pairs},
                          {"coincident_pairs", counters.coincident_pairs}};
    output["bytes"] = result.bytes;
    output["nanoseconds_per_particle_and_step"] = cost_of(result);
    fmt::print("{}\n", output.dump(1, ' ', false, Json::error_handler_t::replace));
}

void print_text(Scene const& scene, RunResult const& result) {
    auto const& counters = result.counters;
    fmt::print("{}\n{} particles, {} steps, {} ({:.0f} ns per particle and step){}\n", scene.title,
               result.particles, counters.steps, duration_text(result.seconds), cost_of(result),
               result.from_cache ? ", read from file" : "");
    for (auto const& q : analyze(scene, {result.record})) {
        if (std::isfinite(q.estimate.error) && q.estimate.error > 0.0)
            fmt::print("  {:<30} {:>14.6g} +- {:<9.2g} ({} blocks)\n", q.name, q.estimate.value,
                       q.estimate.error, q.estimate.blocks);
        else
            fmt::print("  {:<30} {:>14.6g}\n", q.name, q.estimate.value);
    }
    for (auto const& e : result.errors)
        fmt::print("  {}: {} after a duration of {:g}\n", e.text(), e.reached() ? "reached" : "not reached",
                   result.duration);
    if (scene.stage<BodyForce>() && scene.sample.asks("kinetic_temperature") && !result.from_cache)
        fmt::print(
            "  kinetic_temperature counts the flow as heat; across the flow kT ended at {:.3g} (along the "
            "channel: sample.profile)\n",
            result.kinetic_temperature);
    fmt::print(
        "  pairs found {}, updated {}; random draws {}; potential evaluations {}; coincident pairs {}\n",
        counters.pairs_found, counters.pair_updates, counters.random_draws, counters.potential_evaluations,
        counters.coincident_pairs);
}

// "viscosity=1%" as the setting of a scene, "time.until.viscosity=0.01".
std::string until_setting(std::string const& wanted) {
    auto const equals = wanted.find('=');
    std::string const quantity = wanted.substr(0, equals);
    auto const error = relative_error(equals == std::string::npos ? "" : wanted.substr(equals + 1));
    if (quantity.empty() || quantity.find_first_of(". ") != std::string::npos || !error)
        throw InputError(fmt::format(
            "--until {}: is not allowed; allowed: QUANTITY=ERROR, an error above 0 and below 1 or 100%",
            wanted));
    return fmt::format("time.until.{}={}", quantity, *error);
}

// --csv FILE: refused before the run where nothing could be written.
void check_csv(Scene const& scene, std::string const& file) {
    auto const& sample = scene.sample;
    if (!sample.profile && !sample.radial_distribution && !sample.mean_square_displacement &&
        !sample.velocity_autocorrelation)
        throw InputError(
            "--csv: the scene measures no curve; allowed: with sample.radial_distribution, profile, "
            "mean_square_displacement or velocity_autocorrelation");
    auto const folder = std::filesystem::absolute(file).parent_path();
    if (file != "-" && !std::filesystem::is_directory(folder))
        throw InputError(fmt::format("--csv {}: {} is no directory", file, folder.string()));
}

// The curves of a run, a line for each point.
std::string curves_csv(Scene const& scene, Record const& record) {
    std::vector<std::string> names;
    for (auto const& [name, curve] : record.curves) {
        if (name == "velocity_squared_profile")
            names.emplace_back("temperature_profile");
        else
            names.push_back(name);
        if (name == "velocity_profile" && scene.stage<BodyForce>()) names.emplace_back("channel_profile");
    }
    std::string text = "curve,x,value,error,blocks\n";
    for (auto const& name : names) {
        auto const [x, y] = curve_of(scene, {record}, name);
        for (std::size_t k = 0; k < x.size(); ++k)
            if (y[k].blocks > 0)
                text += fmt::format("{},{},{},{},{}\n", name, x[k], y[k].value, y[k].error, y[k].blocks);
    }
    return text;
}

// A scene file with what the command line adds to it.
struct SceneOptions {
    std::string file;
    std::vector<std::string> overrides;
    std::vector<std::string> until;
    std::optional<std::string> seed;

    void add_to(CLI::App& command) {
        command.add_option("scene", file, "TOML file")->required();
        command.add_option("--set", overrides, "table.key=value, on top of the file")
            ->allow_extra_args(false);
        command.add_option("--seed", seed, "seed of all noise, 0 to 2^64-1");
    }
    void add_until_to(CLI::App& command) {
        command
            .add_option(
                "--until", until,
                "QUANTITY=ERROR, relative: 1% or 0.01. Runs time.duration, then twice as long, four times, "
                "... until the errors by blocking are that small, or for time.longest")
            ->allow_extra_args(false)
            ->delimiter(',');
    }
    Scene load() const {
        auto settings = overrides;
        for (auto const& wanted : until) settings.push_back(until_setting(wanted));
        return load_scene(file, settings, read_seed(seed));
    }
};

}  // namespace

Command run(CLI::App& app) {
    struct Options {
        SceneOptions scene;
        std::optional<std::string> out, csv;
        std::string engine = "fast";
        bool json = false;
    };
    auto const options = std::make_shared<Options>();
    auto* const command = app.add_subcommand("run", "run a scene");
    options->scene.add_to(*command);
    options->scene.add_until_to(*command);
    command->add_option("--out", options->out, "HDF5 file of results, checkpoints and provenance");
    command->add_option("--engine", options->engine, "fast, or plain: the papers as code, src/plain")
        ->check(CLI::IsMember(std::vector<std::string>(names<Engine>.begin(), names<Engine>.end())));
    command->add_flag("--json", options->json, "print JSON");
    command->add_option("--csv", options->csv,
                        "file of the curves as text: curve,x,value,error,blocks; -: print them alone");
    return {command, [options] {
                Scene scene = options->scene.load();
                scene.use(*value_of<Engine>(options->engine));
                if (options->csv) check_csv(scene, *options->csv);
                if (scene.engine == Engine::plain) announce_plain(scene);
                RunOptions how;
                if (options->out) how.output = *options->out;
                how.stop = &stop_requested();
                RunResult result;
                {
                    Progress progress(scene.title.empty() ? options->scene.file : scene.title);
                    how.progress = [&](double fraction) { progress(fraction); };
                    how.tell = [&](std::string const& text) { progress.tell(text); };
                    result = dpd::run(scene, how);
                }
                warn(scene, result);
                std::string const curves = options->csv ? curves_csv(scene, result.record) : "";
                if (options->csv && *options->csv != "-") write_file(*options->csv, curves);
                if (options->csv == "-")
                    fmt::print("{}", curves);
                else if (options->json)
                    print_json(scene, result);
                else
                    print_text(scene, result);
                return exit_done;
            }};
}

Command export_scene(CLI::App& app) {
    struct Options {
        SceneOptions scene;
        std::string out;
    };
    auto const options = std::make_shared<Options>();
    auto* const command = app.add_subcommand("export", "write a scene for another program");
    command->require_subcommand(1);
    auto* const lammps = command->add_subcommand("lammps", "a directory with an input deck for LAMMPS");
    options->scene.add_to(*lammps);
    lammps->add_option("--out", options->out, "directory: new, empty, or of an earlier export")->required();
    return {command, [options] {
                export_lammps(options->scene.load(), options->out);
                fmt::print("{}: written; next: see {}/README\n", options->out, options->out);
                return exit_done;
            }};
}

}  // namespace dpd::cli
