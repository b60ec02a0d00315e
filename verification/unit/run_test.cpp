/// @file
/// Running scenes: the same bits whether a run is interrupted or not, files that stay readable whatever
/// happens, and counters that show that a scene pays for what it names and for nothing else.
#define BOOST_TEST_MODULE run
#include "run.hpp"

#include <unistd.h>

#include <atomic>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "analysis.hpp"
#include "archive.hpp"
#include "checkpoint.hpp"
#include "errors.hpp"
#include "particles.hpp"
#include "scene.hpp"

using namespace dpd;

namespace {

/// A scratch directory per test case.
struct Fixture {
    Fixture() { std::filesystem::create_directories(directory); }
    ~Fixture() { std::filesystem::remove_all(directory); }
    std::filesystem::path const directory =
        std::filesystem::temp_directory_path() / ("dpdref_run_test." + std::to_string(::getpid()));
    std::filesystem::path file(std::string const& name) const { return directory / name; }
};

struct Variant {
    int dimension;
    std::string thermostat;
    double shear_rate;
    std::string extra = "";  ///< more TOML, at the end
};

/// A small scene in which every sampler is active.
Scene scene_of(Variant const& variant, std::uint64_t seed = 1) {
    bool const euler = variant.thermostat == "euler";
    std::string text = "dimension = " + std::to_string(variant.dimension) + "\n";
    text += euler ? "stages = ['euler', 'sample', 'drift', 'kick']\n"
                  : "stages = ['shardlow', 'sample', 'drift']\n";
    text += variant.dimension == 2 ? "[box]\nlength = [5.0, 6.0]\n" : "[box]\nlength = [3.0, 4.0, 3.5]\n";
    text +=
        "shear_rate = " + std::to_string(variant.shear_rate) + "\n[particles]\ndensity = 2.0\nmass = 1.5\n";
    text += euler ? "[euler]\ngamma = 1.0\nsigma = 1.4\n" : "[shardlow]\nfriction = 4.0\n";
    text += R"([time]
step = 0.05
equilibration = 0.25
duration = 2.0
checkpoint = 1000.0
[sample]
interval = 2
observables = ["kinetic_temperature", "momentum", "stress"]
[sample.profile]
bins = 5
[sample.radial_distribution]
range = 1.25
bins = 10
interval = 3
[sample.mean_square_displacement]
longest = 0.6
spacing = 0.1
origins = 0.2
[sample.velocity_autocorrelation]
longest = 0.5
origins = 0.15
)" + variant.extra;
    return parse_scene(text, "run_test", {}, seed);
}

std::vector<Variant> variants() {
    std::vector<Variant> all;
    for (int const d : {2, 3})
        for (char const* thermostat : {"shardlow", "euler"})
            for (double const shear_rate : {0.0, 0.5}) all.push_back({d, thermostat, shear_rate});
    // sequential updates in a random order, and by brute force
    all.push_back({3, "shardlow", 0.5, "[pairs]\norder = 'random'\n"});
    all.push_back({2, "shardlow", 0.0, "[pairs]\nsearch = 'brute'\norder = 'id'\n"});
    return all;
}

std::string name_of(Variant const& v) {
    return std::to_string(v.dimension) + "D " + v.thermostat + " shear " + std::to_string(v.shear_rate) +
           " " + v.extra;
}

/// Bitwise equality: NaN equals itself. (Of nothing there may be no address.)
template <class T>
bool same_bits(T const* a, T const* b, std::size_t count) {
    return count == 0 || std::memcmp(a, b, count * sizeof(T)) == 0;
}

bool same(std::vector<double> const& a, std::vector<double> const& b) {
    return a.size() == b.size() && same_bits(a.data(), b.data(), a.size());
}

template <class Array>
bool same_array(Array const& a, Array const& b) {
    return a.rows() == b.rows() && a.cols() == b.cols() &&
           same_bits(a.data(), b.data(), static_cast<std::size_t>(a.size()));
}

bool same(Record const& a, Record const& b) {
    if (a.series.size() != b.series.size() || a.curves.size() != b.curves.size()) return false;
    for (auto const& [name, values] : a.series)
        if (!b.series.contains(name) || !same(values, b.series.at(name))) return false;
    for (auto const& [name, curve] : a.curves) {
        if (!b.curves.contains(name)) return false;
        auto const& other = b.curves.at(name);
        if (!same(curve.x, other.x) || !same_array(curve.sum, other.sum) ||
            !same_array(curve.weight, other.weight))
            return false;
    }
    return same_array(a.configuration, b.configuration);
}

bool same(Counters const& a, Counters const& b) {
    return a.steps == b.steps && a.searches == b.searches && a.pairs_found == b.pairs_found &&
           a.pair_updates == b.pair_updates && a.potential_evaluations == b.potential_evaluations &&
           a.random_draws == b.random_draws && a.boundary_pairs == b.boundary_pairs &&
           a.coincident_pairs == b.coincident_pairs;
}

/// Every sampler has seen something; else the equality of records says nothing.
void check_record_is_full(Record const& record) {
    BOOST_TEST(record.series.size() == 4u);
    for (auto const& [name, values] : record.series) BOOST_TEST(values.size() == 20u, name);
    BOOST_TEST(record.curves.size() == 5u);
    for (auto const& [name, curve] : record.curves) {
        BOOST_TEST(curve.weight.sum() > 0.0, name);
        BOOST_TEST(curve.sum.abs().sum() > 0.0, name);
    }
}

std::string status_of(std::filesystem::path const& file) {
    Archive archive(file, Archive::Mode::read);
    std::string status;
    archive("dpdref/status", status);
    return status;
}

/// Runs one step, or what is left if `stop` is false; true if the run is complete.
bool run_on(Scene const& scene, std::filesystem::path const& output, bool stop, RunResult* result = nullptr) {
    std::atomic<bool> const stopping = stop;
    try {
        RunResult const finished = run(scene, {.output = output, .stop = &stopping, .progress = {}});
        if (result) *result = finished;
        return true;
    } catch (Interrupted const&) {
        return false;
    }
}

/// Compares the checkpoint in a file with a simulation that has never been near a file.
template <int d>
void check_state(Scene const& scene, std::filesystem::path const& file, std::uint64_t steps) {
    std::unique_ptr<Recorder<d>> recorder;
    auto simulation = build<d>(scene, [&](Simulation<d>& s) { (*recorder)(s); });
    recorder = std::make_unique<Recorder<d>>(scene.sample, simulation);
    for (std::uint64_t s = 0; s < steps; ++s) simulation.advance();

    Archive archive(file, Archive::Mode::read);
    Particles<d> stored;
    double time = 0.0;
    std::uint64_t step = 0;
    archive("checkpoint/position", stored.position);
    archive("checkpoint/velocity", stored.velocity);
    archive("checkpoint/image", stored.image);
    archive("checkpoint/id", stored.id);
    archive("checkpoint/time", time);
    archive("checkpoint/step", step);
    BOOST_TEST(step == steps);
    BOOST_TEST(time == simulation.time);
    BOOST_TEST(same_array(stored.position, simulation.particles.position));
    BOOST_TEST(same_array(stored.velocity, simulation.particles.velocity));
    BOOST_TEST(same_array(stored.image, simulation.particles.image));
    BOOST_TEST(same_array(stored.id, simulation.particles.id));
}

void check_no_remains(std::filesystem::path const& directory) {
    for (auto const& entry : std::filesystem::directory_iterator(directory))
        BOOST_TEST(entry.path().extension() != ".part", entry.path().string());
}

template <class Error>
std::string message_of(Scene const& scene, RunOptions const& options) {
    try {
        run(scene, options);
    } catch (Error const& error) {
        std::string const message = error.what();
        BOOST_TEST(message.find('\n') == std::string::npos, message);
        return message;
    }
    BOOST_ERROR("the run was expected to fail");
    return "";
}

/// MY1997 in two dimensions, at a step beyond its critical one of 0.6.
Scene unstable_scene() {
    return parse_scene(R"(dimension = 2
stages = ["euler", "sample", "drift", "kick"]
[box]
length = [20.0, 20.0]
[particles]
density = 0.2
[euler]
gamma = 1.0
sigma = 1.0
cutoff = 4.0
[time]
step = 2.0
duration = 10000.0
[sample]
observables = ["kinetic_temperature"]
)",
                       "run_test");
}

}  // namespace

BOOST_FIXTURE_TEST_SUITE(runs, Fixture)

// --- exact resume ----------------------------------------------------------------------------------------

// Files outlive engines: an array looks the same in a file however it is kept in memory.
BOOST_AUTO_TEST_CASE(a_file_does_not_tell_the_memory_layout) {
    Eigen::ArrayX3d by_column(4, 3);
    by_column << 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12;
    Field<3> by_row = by_column, read_by_row;
    Eigen::ArrayX3d read_by_column;
    {
        Archive archive(directory / "layout.h5", Archive::Mode::write);
        archive("column", by_column);
        archive("row", by_row);
        archive.commit();
    }
    Archive archive(directory / "layout.h5", Archive::Mode::read);
    archive("column", read_by_row);
    archive("row", read_by_column);
    BOOST_TEST((read_by_row == by_row).all());
    BOOST_TEST((read_by_column == by_column).all());

    Field<2> flat;
    BOOST_CHECK_EXCEPTION(archive("row", flat), InputError, [](InputError const& error) {
        return std::string(error.what()).find("row: has 3 columns, not 2") != std::string::npos;
    });
}

BOOST_AUTO_TEST_CASE(a_checkpoint_of_what_cannot_be_is_refused) {
    Scene const scene = scene_of({3, "shardlow", 0.0});
    auto const output = file("spoilt.h5");
    auto const load_with = [&](std::function<void(Simulation<3>&)> const& spoil) {
        auto simulation = build<3>(scene, {}), spoilt = simulation;
        Recorder<3> recorder(scene.sample, simulation);
        RunFile<3> const its(scene, output);
        spoil(spoilt);
        its.save("interrupted", spoilt, recorder, 0.0);
        double seconds = 0.0;
        std::uint64_t bytes = 0;
        bool complete = false;
        its.load(simulation, recorder, seconds, bytes, complete);
    };
    BOOST_CHECK_NO_THROW(load_with([](auto&) {}));
    BOOST_CHECK_THROW(load_with([](auto& s) { s.particles.id[3] = 1u << 30; }), Damaged);
    BOOST_CHECK_THROW(load_with([](auto& s) { s.particles.id[3] = 4; }), Damaged);
    BOOST_CHECK_THROW(load_with([](auto& s) { s.particles.position(3, 1) = -1e9; }), Damaged);
    BOOST_CHECK_THROW(load_with([](auto& s) { s.particles.position(3, 1) = NAN; }), Damaged);
    BOOST_CHECK_THROW(load_with([](auto& s) { s.particles.velocity(3, 0) = INFINITY; }), Damaged);
    BOOST_CHECK_THROW(load_with([](auto& s) { s.step = 1'000'000; }), Damaged);
    BOOST_CHECK_THROW(load_with([](auto& s) { s.particles.resize(5); }), Damaged);
}

BOOST_AUTO_TEST_CASE(a_damaged_result_is_made_again) {
    Scene const scene = scene_of({2, "shardlow", 0.5});
    auto const output = file("a.h5"), aside = file("a.h5.damaged");
    RunResult const first = run(scene, {.output = output, .progress = {}});
    auto const flip = [](std::filesystem::path const& path, std::streamoff at) {
        std::fstream stream(path, std::ios::binary | std::ios::in | std::ios::out);
        stream.seekg(at);
        int const byte = stream.get();
        stream.seekp(at);
        stream.put(static_cast<char>(byte ^ 4));
    };
    flip(output, 3000);
    RunResult const again = run(scene, {.output = output, .progress = {}});
    BOOST_TEST(!again.from_cache);
    BOOST_TEST(std::filesystem::exists(aside));
    for (auto const& [name, values] : first.record.series)
        BOOST_TEST(same(values, again.record.series.at(name)), name);
    // what is not ours is refused, and passed over in a cache
    for (char const* foreign : {"", "a letter"}) {
        std::ofstream(output) << foreign;
        BOOST_CHECK_THROW(run(scene, {.output = output, .progress = {}}), InputError);
        BOOST_TEST(std::filesystem::file_size(output) == std::strlen(foreign));
        BOOST_CHECK_NO_THROW(run(scene, {.output = output, .cache = true, .progress = {}}));
        BOOST_TEST(std::filesystem::file_size(aside) == std::strlen(foreign));
    }
    // so is another scene's result, which is not damaged
    Scene const other = scene_of({2, "shardlow", 0.0});
    BOOST_CHECK_THROW(run(other, {.output = output, .progress = {}}), InputError);
    BOOST_TEST(run(scene, {.output = output, .progress = {}}).from_cache);
}

BOOST_AUTO_TEST_CASE(checkpoints_take_a_tenth_of_the_time_at_most) {
    BOOST_TEST(checkpoint_pause(30.0, 0.1) == 30.0);
    BOOST_TEST(checkpoint_pause(0.05, 2.0) == 20.0);
}

BOOST_AUTO_TEST_CASE(interrupted_after_every_step_gives_the_same_bits) {
    for (auto const& variant : variants()) BOOST_TEST_CONTEXT(name_of(variant)) {
            Scene const scene = scene_of(variant);
            RunResult const whole = run(scene);
            check_record_is_full(whole.record);

            auto const output = file("stopped.h5");
            RunResult pieces;
            std::uint64_t interruptions = 0;
            while (!run_on(scene, output, true, &pieces)) {
                ++interruptions;
                BOOST_TEST(status_of(output) == "interrupted");
                if (interruptions == 20 || interruptions + 1 == scene.steps()) {
                    if (variant.dimension == 2)
                        check_state<2>(scene, output, interruptions);
                    else
                        check_state<3>(scene, output, interruptions);
                }
            }
            BOOST_TEST(interruptions == scene.steps() - 1);
            BOOST_TEST(same(pieces.record, whole.record));
            BOOST_TEST(same(pieces.counters, whole.counters));
            BOOST_TEST(!pieces.from_cache);
            BOOST_TEST(pieces.seconds > 0.0);
            BOOST_TEST(status_of(output) == "complete");
            check_no_remains(directory);
            std::filesystem::remove(output);
        }
}

BOOST_AUTO_TEST_CASE(stages_that_leave_pairs_to_the_next_step_resume_exactly) {
    // nothing moves after the last search of a step, or ever: a resumed run has no pairs yet
    for (std::string const stages :
         {"'shardlow', 'sample'", "'shardlow', 'drift', 'euler', 'kick', 'sample'"}) {
        bool const euler = stages.find("euler") != std::string::npos;
        Scene const scene = parse_scene(
            "dimension = 2\nstages = [" + stages +
                "]\n[box]\nlength = [5, 5]\n[particles]\nnumber = 50\n[shardlow]\nfriction = 3\n" +
                (euler ? "[euler]\ngamma = 1\nsigma = 1\n" : "") +
                "[time]\nstep = 0.1\nduration = 4\n[pairs]\norder = 'random'\n"
                "[sample]\nobservables = ['kinetic_temperature'" +
                (euler ? "" : ", 'stress'") + "]\n",
            "run_test");
        RunResult const whole = run(scene);
        RunResult pieces;
        while (!run_on(scene, file("stopped.h5"), true, &pieces)) {
        }
        BOOST_TEST(same(pieces.record, whole.record), stages);
        BOOST_TEST(same(pieces.counters, whole.counters), stages);
        std::filesystem::remove(file("stopped.h5"));
    }
}

BOOST_AUTO_TEST_CASE(bond_order_and_configuration_resume_exactly) {
    for (std::string const order : {"cell", "random"}) {
        std::vector<std::string> const assignments{"sample.configuration=true", "sample.bond_order.range=1.1",
                                                   "sample.bond_order.interval=3", "pairs.order=" + order};
        Scene const scene = parse_scene(scene_of({3, "shardlow", 0.5, ""}).text, "run_test", assignments, 1);
        RunResult const whole = run(scene);
        BOOST_REQUIRE_EQUAL(whole.record.configuration.rows(), 84);
        BOOST_TEST((whole.record.configuration > 0.0).all());
        BOOST_TEST(whole.record.series.size() == 4u + 4u);
        for (std::string const name : {"global_q4", "local_q4", "global_q6", "local_q6"}) {
            auto const& values = whole.record.series.at(name);
            BOOST_TEST(values.size() == 14u, name);
            BOOST_TEST(values.front() != values.back(), name);
        }
        RunResult pieces;
        auto const output = file("stopped.h5");
        for (std::uint64_t step = 0; !run_on(scene, output, true, &pieces); ++step)
            if (step == 11) {  // what is sampled so far can be read
                Archive archive(output, Archive::Mode::read);
                Eigen::ArrayXXd configuration;
                std::vector<double> q6;
                archive("observables/configuration/value", configuration);
                archive("observables/local_q6/value", q6);
                BOOST_TEST(configuration.rows() == 84);
                BOOST_TEST(!same_array(configuration, whole.record.configuration));
                auto const& all = whole.record.series.at("local_q6");
                BOOST_TEST(same(q6, {all.begin(), all.begin() + 3}));
            }
        BOOST_TEST(same(pieces.record, whole.record));
        BOOST_TEST(same(pieces.counters, whole.counters));
        // and from the file alone
        BOOST_TEST(same(run(scene, {.output = output, .stop = {}, .progress = {}}).record, whole.record));
        std::filesystem::remove(output);
        // measuring changes nothing
        Scene const plain =
            parse_scene(scene_of({3, "shardlow", 0.5, ""}).text, "run_test", {"pairs.order=" + order}, 1);
        auto const without = run(plain);
        for (auto const& [name, values] : without.record.series)
            BOOST_TEST(same(values, whole.record.series.at(name)), name);
        BOOST_TEST(without.record.configuration.size() == 0);
    }
}

BOOST_AUTO_TEST_CASE(stopped_by_the_progress_callback_gives_the_same_bits) {
    Scene const scene = scene_of({3, "shardlow", 0.5, ""});
    Scene const longer = parse_scene(scene.text, "run_test", {"time.duration=1500.0"}, 1);
    std::atomic<bool> stop = false;
    double fraction = -1.0;
    RunOptions const options{.output = file("stopped.h5"), .stop = &stop, .progress = [&](double done) {
                                 fraction = done;
                                 stop = true;
                             }};
    int interruptions = 0;
    RunResult result;
    for (bool complete = false; !complete;) {
        stop = false;
        try {
            result = run(longer, options);
            complete = true;
            BOOST_TEST(fraction == 1.0);
        } catch (Interrupted const& interruption) {
            ++interruptions;
            BOOST_TEST(fraction > 0.0);
            BOOST_TEST(fraction < 1.0);
            auto const expected =
                "at step " + std::to_string(std::llround(fraction * double(longer.steps())));
            BOOST_TEST(std::string(interruption.what()).find(expected) != std::string::npos,
                       interruption.what());
        }
    }
    BOOST_TEST_MESSAGE(interruptions << " interruptions");
    BOOST_TEST(interruptions >= 1);
    RunResult const whole = run(longer);
    BOOST_TEST(same(result.record, whole.record));
    BOOST_TEST(same(result.counters, whole.counters));
}

BOOST_AUTO_TEST_CASE(checkpoints_change_nothing) {
    Scene const scene = scene_of({2, "euler", 0.5, ""});
    Scene eager = scene;
    eager.checkpoint_seconds = 1e-9;  // one after every step
    RunResult const whole = run(scene),
                    checkpointed = run(eager, {.output = file("a.h5"), .stop = {}, .progress = {}});
    BOOST_TEST(same(checkpointed.record, whole.record));
    BOOST_TEST(same(checkpointed.counters, whole.counters));
}

// --- until the errors are small enough -------------------------------------------------------------------

namespace {

Scene with(Scene const& scene, std::vector<std::string> const& settings) {
    return parse_scene(scene.text, "run_test", settings, scene.seed);
}

/// The small scene in another length.
Scene lasting(Scene const& scene, double duration) {
    return with(scene, {"time.duration=" + std::to_string(duration)});
}

/// What is wrong with a scene, in one line.
std::string refusal_of(std::vector<std::string> const& settings) {
    try {
        run(with(scene_of({2, "shardlow", 0.0}), settings));
    } catch (InputError const& error) {
        return error.what();
    }
    BOOST_ERROR("the scene was expected to be refused");
    return "";
}

/// 40 steps, 35 and 39: the blocks begin with 5, 35 and 39 steps.
constexpr double least_durations[] = {2.0, 1.75, 1.95};

}  // namespace

BOOST_AUTO_TEST_CASE(a_run_until_errors_are_small_has_the_bits_of_a_fixed_run_of_that_length) {
    int between = 0;  // runs that ended neither at the first look nor at the last
    for (int const d : {2, 3})
        for (double const shear_rate : {0.0, 0.5})
            for (double const least : least_durations) {
                Scene const fixed = lasting(scene_of({d, "shardlow", shear_rate}), least);
                std::string const quantity =
                    shear_rate == 0.0 ? "green_kubo_diffusion_constant" : "viscosity";
                Scene const until =
                    with(fixed, {"time.until.kinetic_temperature=0.015", "time.until." + quantity + "=0.2"});
                RunResult const result = run(until);
                BOOST_TEST_CONTEXT(d << "D, shear " << shear_rate << ", " << least << ": ended at "
                                     << result.duration) {
                    BOOST_TEST(result.duration < 64.1 * least);
                    for (double duration = least; duration < 1.01 * result.duration; duration *= 2.0) {
                        RunResult const same_length = run(lasting(fixed, duration));
                        auto const errors = errors_wanted(until, same_length.record);
                        bool const small = errors[0].reached() && errors[1].reached();
                        if (duration < 0.99 * result.duration) {
                            BOOST_TEST(!small);
                        } else {
                            BOOST_TEST((small || duration > 63.0 * least));
                            BOOST_TEST(same(result.record, same_length.record));
                            BOOST_TEST(same(result.counters, same_length.counters));
                        }
                    }
                }
                between += result.duration > 1.5 * least && result.duration < 63.0 * least;
            }
    BOOST_TEST(between > 6);
}

// The blocks of a slow mode count for less than eight, however long the run.
BOOST_AUTO_TEST_CASE(an_error_that_a_slow_mode_makes_can_be_reached) {
    Scene const scene = parse_scene(R"(
dimension = 3
stages = ["body_force", "shardlow", "sample", "drift"]
[box]
length = [3.0, 6.0, 3.0]
[particles]
density = 3.0
[body_force]
acceleration = 0.2
opposed = true
[shardlow]
friction = 9.0
[time]
step = 0.1
equilibration = 10.0
duration = 20.0
until = { poiseuille_viscosity = 0.1, kinetic_temperature = 0.1 }
[sample]
observables = ["kinetic_temperature"]
profile.bins = 12
)",
                                    "run_test", {}, 1);
    RunResult const result = run(scene);
    BOOST_TEST(result.duration < 63.0 * 20.0);
    for (auto const& wanted : errors_wanted(scene, result.record))
        BOOST_TEST(wanted.reached(), wanted.text());
}

BOOST_AUTO_TEST_CASE(blocks_that_double_end_as_eighths_of_the_run) {
    for (double const duration : {2.0, 1.75, 1.95, 0.85}) {
        Scene const scene = lasting(scene_of({2, "shardlow", 0.0}), duration);
        Record const record = run(scene).record;
        auto const& weight = record.curves.at("density_profile").weight;
        Eigen::ArrayXd samples = Eigen::ArrayXd::Zero(curve_blocks);
        for (std::uint64_t step = 0; step < scene.production_steps; ++step)
            samples[Eigen::Index(step * 8 / scene.production_steps)] += 1.0;
        for (Eigen::Index block = 0; block < curve_blocks; ++block)
            BOOST_TEST(weight(0, block) == samples[block], duration << ", block " << block);
    }
}

BOOST_AUTO_TEST_CASE(a_run_until_errors_are_small_resumes_exactly) {
    for (int const d : {2, 3}) {
        Scene const fixed = lasting(scene_of({d, "shardlow", 0.5}), 0.7);
        auto const error_after = [&](double duration) {
            Record const record = run(lasting(fixed, duration)).record;
            return errors_wanted(with(fixed, {"time.until.pair_density=0.1"}), record).at(0).error();
        };
        // g(r) has samples in all blocks at the second look, not at the first
        double const duration = 1.4, wanted = 1.01 * error_after(duration);
        BOOST_TEST(error_after(0.7) == INFINITY);
        BOOST_TEST(wanted < 1.0);
        Scene const scene = with(fixed, {"time.until.pair_density=" + std::to_string(wanted)});
        RunResult const whole = run(scene);
        BOOST_TEST(std::llround(whole.duration / scene.time_step) == 28);
        auto const output = file("until.h5");
        RunResult pieces;
        std::uint64_t interruptions = 0;
        while (!run_on(scene, output, true, &pieces)) ++interruptions;
        BOOST_TEST(interruptions >= whole.counters.steps - 1);
        BOOST_TEST(same(pieces.record, whole.record));
        BOOST_TEST(same(pieces.counters, whole.counters));
        RunResult const again = run(scene, {.output = output, .stop = {}, .progress = {}});
        BOOST_TEST(again.from_cache);
        BOOST_TEST(again.duration == whole.duration);
        BOOST_TEST(again.errors.at(0).reached());
        BOOST_TEST(same(again.record, whole.record));
        Archive archive(output, Archive::Mode::read);
        double measured = 0.0, asked = 0.0, reached = 0.0;
        archive("dpdref/until/duration", measured);
        archive("dpdref/until/pair_density/wanted", asked);
        archive("dpdref/until/pair_density/reached", reached);
        BOOST_TEST(measured == whole.duration);
        BOOST_TEST(asked == scene.until->errors.at("pair_density"));
        BOOST_TEST(reached == whole.errors.at(0).error());
        std::filesystem::remove(output);
    }
}

BOOST_AUTO_TEST_CASE(a_run_whose_errors_stay_large_ends_at_its_greatest_duration) {
    Scene const fixed = scene_of({2, "shardlow", 0.0});
    // at 8 times the least duration, the last look that is not later than 19
    Scene const until = with(fixed, {"time.until.kinetic_temperature=1e-6", "time.longest=19.0"});
    BOOST_TEST(until.steps() == 5u + 320u);
    RunResult const result = run(until);
    BOOST_TEST(result.duration == 16.0);
    BOOST_TEST(!result.errors.at(0).reached());
    BOOST_TEST(same(result.record, run(lasting(fixed, 16.0)).record));
    BOOST_TEST(with(fixed, {"time.until.kinetic_temperature=0.1", "time.longest=8.0"}).steps() == 5u + 160u);
}

BOOST_AUTO_TEST_CASE(a_run_whose_errors_are_small_at_its_least_duration_ends_there) {
    Scene const fixed = with(lasting(scene_of({2, "shardlow", 0.0}), 32.0), {"sample.interval=1"});
    RunResult const result = run(with(fixed, {"time.until.kinetic_temperature=0.5"}));
    BOOST_TEST(result.duration == 32.0);
    BOOST_TEST(result.errors.at(0).reached());
    BOOST_TEST(same(result.record, run(fixed).record));
}

BOOST_AUTO_TEST_CASE(the_rule_is_part_of_the_key) {
    Scene const fixed = scene_of({2, "shardlow", 0.0});
    Scene const one = with(fixed, {"time.until.kinetic_temperature=0.1"});
    BOOST_TEST(one.key() != fixed.key());
    BOOST_TEST(one.key() != with(fixed, {"time.until.kinetic_temperature=0.2"}).key());
    BOOST_TEST(one.key() != with(one, {"time.longest=8.0"}).key());
}

BOOST_AUTO_TEST_CASE(errors_from_few_blocks_are_not_believed_and_times_follow_the_inverse_root) {
    ErrorWanted few{"kinetic_temperature", 0.01, {.value = -2.0, .error = 0.001, .blocks = 7}};
    BOOST_TEST(!few.reached());
    few.estimate.slow_mode = true;
    BOOST_TEST(few.reached());
    few.estimate = {.value = -2.0, .error = 0.001, .blocks = 8};
    BOOST_TEST(few.reached());
    BOOST_TEST(few.error() == 0.0005);
    BOOST_TEST((!ErrorWanted{"x", 0.01, {.value = 0.0, .error = 0.0, .blocks = 8}}.reached()));
    // 40 steps after 5; an error of 3 % where 1 % is wanted takes 360 steps, which are seen at 640
    Scene const scene = with(scene_of({2, "shardlow", 0.0}), {"time.until.kinetic_temperature=0.01"});
    ErrorWanted const large{"kinetic_temperature", 0.01, {.value = 2.0, .error = 0.06, .blocks = 9}};
    BOOST_TEST(expected_steps(scene, 45, {large}) == 645u);
    BOOST_TEST(expected_steps(scene, 45, {}) == 45u);
    BOOST_TEST(expected_steps(scene, 46, {}) == 85u);
    BOOST_TEST(expected_steps(scene, 3, {}) == 45u);
}

BOOST_AUTO_TEST_CASE(what_a_run_cannot_reach_is_refused) {
    for (auto const& [settings, parts] :
         std::vector<std::pair<std::vector<std::string>, std::vector<std::string>>>{
             {{"time.until.colour=0.1"},
              {"time.until.colour", "allowed: ", "kinetic_temperature", "diffusion"}},
             {{"time.until.viscosity=0.1"}, {"time.until.viscosity", "measures", "allowed: "}},  // no shear
             {{"time.until.kinetic_temperature=0"}, {"time.until.kinetic_temperature", "between 0 and 1"}},
             {{"time.until.kinetic_temperature=1.0"}, {"time.until.kinetic_temperature", "between 0 and 1"}},
             {{"time.until.kinetic_temperature='x'"}, {"time.until.kinetic_temperature", "between 0 and 1"}},
             {{"time.until={}"}, {"time.until", "names no quantity"}},
             {{"time.until=0.1"}, {"time.until", "table"}},
             {{"time.until.kinetic_temperature=0.1", "time.longest=1.9"},
              {"time.longest", "time.duration, 2"}},
             {{"time.longest=10.0"}, {"time.longest", "time.until"}}}) {
        std::string const message = refusal_of(settings);
        for (auto const& part : parts) BOOST_TEST(message.find(part) != std::string::npos, message);
        BOOST_TEST(message.find('\n') == std::string::npos, message);
    }
}

// Its blocks are joined where a block has few time origins: not before the run.
BOOST_AUTO_TEST_CASE(a_diffusion_constant_may_be_wanted) {
    Scene const scene = with(scene_of({2, "shardlow", 0.0}),
                             {"sample.mean_square_displacement={spacing=0.1,longest=0.5,origins=0.1}",
                              "time.until.diffusion_constant=0.2"});
    BOOST_TEST(run(scene).errors.at(0).reached());
}

// --- seeds -----------------------------------------------------------------------------------------------

BOOST_AUTO_TEST_CASE(same_seed_same_bits_another_seed_other_bits) {
    for (auto const& variant : variants()) BOOST_TEST_CONTEXT(name_of(variant)) {
            RunResult const first = run(scene_of(variant, 1)), again = run(scene_of(variant, 1)),
                            other = run(scene_of(variant, 2));
            BOOST_TEST(same(first.record, again.record));
            BOOST_TEST(same(first.counters, again.counters));
            for (auto const& [name, values] : first.record.series)
                BOOST_TEST(!same(values, other.record.series.at(name)), name);
            for (auto const& [name, curve] : first.record.curves)
                BOOST_TEST(!same_array(curve.sum, other.record.curves.at(name).sum), name);
        }
}

BOOST_AUTO_TEST_CASE(extreme_seeds_work) {
    std::uint64_t const largest = ~std::uint64_t{0};
    std::vector<RunResult> results;
    for (std::uint64_t const seed : {std::uint64_t{0}, std::uint64_t{1}, largest - 1, largest}) {
        Scene const scene = scene_of({3, "shardlow", 0.0, ""}, seed);
        auto const output = file(std::to_string(seed) + ".h5");
        RunResult result;
        BOOST_TEST(!run_on(scene, output, true));
        BOOST_TEST(run_on(scene, output, false, &result));
        BOOST_TEST(same(result.record, run(scene).record));
        Archive archive(output, Archive::Mode::read);
        std::uint64_t stored = 0;
        archive("dpdref/seed", stored);
        BOOST_TEST(stored == seed);
        for (auto const& earlier : results) BOOST_TEST(!same(earlier.record, result.record));
        results.push_back(result);
    }
}

// --- files -----------------------------------------------------------------------------------------------

BOOST_AUTO_TEST_CASE(a_completed_file_is_returned_without_running) {
    Scene const scene = scene_of({3, "shardlow", 0.5, ""});
    RunOptions const options{.output = file("a.h5"), .stop = {}, .progress = {}};
    RunResult const first = run(scene, options);
    auto const written = std::filesystem::last_write_time(file("a.h5"));
    RunResult const again = run(scene, options);
    BOOST_TEST(!first.from_cache);
    BOOST_TEST(again.from_cache);
    BOOST_TEST((std::filesystem::last_write_time(file("a.h5")) == written));
    BOOST_TEST(same(first.record, again.record));
    BOOST_TEST(same(first.counters, again.counters));
    BOOST_TEST(first.seconds == again.seconds);
    BOOST_TEST(first.bytes == again.bytes);
    BOOST_TEST(first.particles == again.particles);

    // the proof that nothing was computed: it returns whatever the file says
    std::atomic<bool> const stop = true;
    BOOST_CHECK_NO_THROW(run(scene, {.output = file("a.h5"), .stop = &stop, .progress = {}}));

    auto const quantities = analyze(scene, {again.record});
    for (char const* name : {"kinetic_temperature", "viscosity", "profile_slope", "pair_density"})
        BOOST_TEST((find_quantity(quantities, name) != nullptr), name);
}

BOOST_AUTO_TEST_CASE(a_file_of_another_scene_is_refused_and_kept) {
    Scene const scene = scene_of({2, "shardlow", 0.0, ""});
    auto const output = file("a.h5");
    RunOptions const options{.output = output, .stop = {}, .progress = {}};
    run(scene, options);
    auto const size = std::filesystem::file_size(output);
    for (Scene const& other : {scene_of({2, "shardlow", 0.0, ""}, 2), scene_of({2, "euler", 0.0, ""}),
                               scene_of({3, "shardlow", 0.0, ""})}) {
        auto const message = message_of<InputError>(other, options);
        BOOST_TEST(message.starts_with(output.string() + ": "));
        BOOST_TEST(message.find("not a result of this scene") != std::string::npos, message);
    }
    BOOST_TEST(std::filesystem::file_size(output) == size);
    BOOST_TEST(run(scene, options).from_cache);

    // neither is a file that is no result at all
    std::ofstream(file("notes.txt")) << "do not lose me";
    auto const message =
        message_of<InputError>(scene, {.output = file("notes.txt"), .stop = {}, .progress = {}});
    BOOST_TEST(message.starts_with(file("notes.txt").string() + ": "));
    BOOST_TEST(std::filesystem::file_size(file("notes.txt")) == 14u);
    check_no_remains(directory);
}

BOOST_AUTO_TEST_CASE(outputs_that_cannot_be_written_are_refused_before_the_work) {
    Scene const scene = scene_of({2, "shardlow", 0.0, ""});
    std::ofstream(file("file")) << "x";
    for (auto const& output : {file("no/such/directory/a.h5"), directory, file("file/a.h5")}) {
        auto const message = message_of<InputError>(
            scene,
            {.output = output, .stop = {}, .progress = [](double) { BOOST_ERROR("the run has started"); }});
        BOOST_TEST(message.starts_with(output.string() + ": "), message);
    }
    // results and trajectory in one file
    auto const message =
        message_of<InputError>(scene_of({2, "shardlow", 0.0, "[trajectory]\ninterval = 5\n"}),
                               {.output = file("a.h5md"), .stop = {}, .progress = {}});
    BOOST_TEST(message.find("trajectory") != std::string::npos, message);
    check_no_remains(directory);
}

BOOST_AUTO_TEST_CASE(an_interrupted_file_is_readable) {
    Scene const scene = scene_of({3, "shardlow", 0.5, ""});
    auto const output = file("a.h5");
    for (int step = 0; step < 20; ++step) BOOST_TEST(!run_on(scene, output, true));
    Archive archive(output, Archive::Mode::read);
    std::string key, text;
    std::uint64_t steps = 0;
    std::vector<double> kT;
    archive("dpdref/key", key);
    archive("dpdref/scene", text);
    archive("dpdref/counters/steps", steps);
    archive("observables/kinetic_temperature/value", kT);
    BOOST_TEST(key == scene.key());
    BOOST_TEST(parse_scene(text, "stored", {}, 1).key() == key);  // the provenance suffices to run it again
    BOOST_TEST(steps == 20u);
    BOOST_TEST(kT.size() == 8u);  // steps 5, 7, ... 19
    auto const whole = run(scene).record.series.at("kinetic_temperature");
    BOOST_TEST(same(kT, {whole.begin(), whole.begin() + 8}));
}

BOOST_AUTO_TEST_CASE(a_trajectory_survives_interruption) {
    Scene const scene = scene_of({2, "shardlow", 0.5, "[trajectory]\ninterval = 3\n"});
    run(scene, {.output = file("whole.h5"), .stop = {}, .progress = {}});
    while (!run_on(scene, file("pieces.h5"), true)) {
    }
    Archive whole(file("whole.h5md"), Archive::Mode::read), pieces(file("pieces.h5md"), Archive::Mode::read);
    for (char const* name : {"position/value", "velocity/value", "position/time"}) {
        std::vector<double> a, b;
        whole(std::string("particles/all/") + name, a);
        pieces(std::string("particles/all/") + name, b);
        BOOST_TEST(!a.empty());
        BOOST_TEST(same(a, b), name);
    }
    std::vector<std::uint64_t> steps;
    pieces("particles/all/position/step", steps);
    BOOST_TEST(steps.size() == scene.steps() / 3);
    for (std::size_t k = 0; k < steps.size(); ++k) BOOST_TEST(steps[k] == 3 * (k + 1));
}

BOOST_AUTO_TEST_CASE(a_killed_run_repeats_its_last_frames) {
    // the frames after the last checkpoint are written again, not twice
    Scene const scene = scene_of({2, "shardlow", 0.0, "[trajectory]\ninterval = 1\n"});
    auto const output = file("a.h5");
    for (int step = 0; step < 10; ++step) run_on(scene, output, true);
    std::filesystem::copy_file(output, file("checkpoint"));
    for (int step = 0; step < 7; ++step) run_on(scene, output, true);
    std::filesystem::rename(file("checkpoint"), output);
    BOOST_TEST(run_on(scene, output, false));
    std::vector<std::uint64_t> steps;
    Archive(file("a.h5md"), Archive::Mode::read)("particles/all/position/step", steps);
    BOOST_TEST(steps.size() == scene.steps());
    for (std::size_t k = 0; k < steps.size(); ++k) BOOST_TEST(steps[k] == k + 1);
}

// --- divergence ------------------------------------------------------------------------------------------

BOOST_AUTO_TEST_CASE(euler_beyond_its_critical_step_diverges_and_says_where) {
    Scene const scene = unstable_scene();
    auto const output = file("a.h5");
    RunOptions const options{.output = output, .stop = {}, .progress = {}};
    std::string const message = message_of<Diverged>(scene, options);
    BOOST_TEST(message.starts_with("diverged at step "), message);
    auto const step = std::stoull(message.substr(std::string("diverged at step ").size()));
    BOOST_TEST(step > 1u);
    BOOST_TEST(step < scene.steps());
    BOOST_TEST(message.find("kinetic temperature") != std::string::npos, message);
    BOOST_TEST(message.find("time.step") != std::string::npos, message);

    // the file tells the same and holds what was measured before
    BOOST_TEST(status_of(output) == "diverged: " + message);
    {
        Archive archive(output, Archive::Mode::read);
        std::vector<double> kT;
        std::uint64_t steps = 0;
        archive("observables/kinetic_temperature/value", kT);
        archive("dpdref/counters/steps", steps);
        BOOST_TEST(steps == step - 1);
        BOOST_TEST((kT.size() == step || kT.size() == step - 1));
        BOOST_TEST(kT.front() < 2.0);
        BOOST_TEST(kT.back() > 1e3);
        for (double const value : kT) BOOST_TEST(std::isfinite(value));
    }
    check_no_remains(directory);
    // again: the file says so at once and is left as it is; without a file the run does
    auto const written = std::filesystem::last_write_time(output);
    BOOST_TEST(message_of<Diverged>(scene, options) == message);
    BOOST_TEST((std::filesystem::last_write_time(output) == written));
    BOOST_TEST(message_of<Diverged>(scene, {}) == message);

    // below the critical step it does not diverge
    BOOST_CHECK_NO_THROW(run(parse_scene(scene.text, "run_test", {"time.step=0.1", "time.duration=50"})));
}

// --- counters --------------------------------------------------------------------------------------------

BOOST_AUTO_TEST_CASE(a_scene_pays_for_what_it_names) {
    for (auto const& variant : variants()) BOOST_TEST_CONTEXT(name_of(variant)) {
            Scene const scene = scene_of(variant);
            Counters const counters = run(scene).counters;
            BOOST_TEST(counters.steps == scene.steps());
            BOOST_TEST(counters.searches == scene.steps());  // one, shared by all stages of a step
            BOOST_TEST(counters.pairs_found > 0u);
            BOOST_TEST(counters.pair_updates == counters.pairs_found);
            // a random order draws once more for each pair
            BOOST_TEST(counters.random_draws ==
                       counters.pairs_found * (scene.order == Order::random ? 2u : 1u));
            BOOST_TEST(counters.potential_evaluations == 0u);  // an ideal gas
            BOOST_TEST(counters.coincident_pairs == 0u);
            BOOST_TEST((counters.boundary_pairs > 0) == (variant.shear_rate != 0.0));
        }
}

BOOST_AUTO_TEST_CASE(free_flight_costs_nothing_but_the_flight) {
    for (double const shear_rate : {0.0, 0.5}) {
        Scene const scene = parse_scene(
            "dimension = 3\nstages = ['drift']\n[box]\nlength = [4, 4, 4]\nshear_rate = " +
                std::to_string(shear_rate) + "\n[particles]\nnumber = 50\n[time]\nstep = 0.1\nduration = 5\n",
            "run_test");
        RunResult const result = run(scene);
        BOOST_TEST(result.counters.steps == 50u);
        BOOST_TEST(result.counters.searches == 0u);
        BOOST_TEST(result.counters.pairs_found == 0u);
        BOOST_TEST(result.counters.pair_updates == 0u);
        BOOST_TEST(result.counters.random_draws == 0u);
        BOOST_TEST(result.counters.boundary_pairs == 0u);
        BOOST_TEST(result.counters.potential_evaluations == 0u);
        BOOST_TEST(result.record.series.empty());
        BOOST_TEST(result.record.curves.empty());
        // position, velocity (doubles), image, id (4 bytes): nothing else is held
        BOOST_TEST(result.bytes == 50u * (6 * 8 + 4 * 4));
    }
}

BOOST_AUTO_TEST_SUITE_END()
