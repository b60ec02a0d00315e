#include "scene.hpp"

#include <algorithm>
#include <array>
#include <boost/uuid/name_generator_sha1.hpp>
#include <boost/uuid/uuid_io.hpp>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "toml_reader.hpp"
#include "version.hpp"

namespace dpd {

std::string read_file(std::filesystem::path const& file) {
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream content;
    bool const readable = !std::filesystem::is_directory(file) && stream;
    bool const empty = readable && stream.peek() == std::ifstream::traits_type::eof();
    if (!readable || (!empty && !(content << stream.rdbuf())))
        throw InputError(fmt::format("{}: cannot be read", file.string()));
    return content.str();
}

toml::table parse_toml(std::string const& text, std::string const& name) {
    try {
        return toml::parse(text, name);
    } catch (toml::parse_error const& error) {
        throw InputError(fmt::format("{}:{}: {}", name, error.source().begin.line, error.description()));
    }
}

namespace {

// A bare string as TOML writes it, so that parsing keeps where it came from.
std::string quoted(std::string const& text) {
    std::string result = "\"";
    for (char const c : text) {
        if (c == '"' || c == '\\')
            result += fmt::format("\\{}", c);
        else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            result += fmt::format("\\u{:04x}", c);
        else
            result += c;
    }
    return result + "\"";
}

// The value of an override as a table of one key, "value".
toml::table parse_value(std::string const& value, std::string const& name) {
    try {
        toml::table parsed = toml::parse("value = " + value, name);
        if (parsed.size() == 1) return parsed;
    } catch (toml::parse_error const&) {
        // not TOML: a bare string
    }
    return parse_toml("value = " + quoted(value), name);
}

}  // namespace

void override_key(toml::table& table, std::string const& assignment, std::string const& origin) {
    auto const equals = assignment.find('=');
    if (equals == std::string::npos || equals == 0)
        throw InputError(
            one_line(fmt::format("{} {}: not an assignment; allowed: table.key=value", origin, assignment)));
    std::string const path = assignment.substr(0, equals), value = assignment.substr(equals + 1);
    std::string const name = fmt::format("{} {}", origin, path);
    toml::table parsed = parse_value(value, name);
    toml::table* target = &table;
    std::string key = path;
    for (auto dot = key.find('.'); dot != std::string::npos; dot = key.find('.')) {
        std::string const parent = key.substr(0, dot);
        if (!target->contains(parent)) {
            toml::table created = parse_value("{}", name);
            created.get("value")->as_table()->is_inline(false);  // written like a table of the file
            target->insert(parent, std::move(*created.get("value")));
        }
        toml::node* const child = target->get(parent);
        if (!child->is_table()) throw InputError(fmt::format("{}: {} is not a table", name, parent));
        target = child->as_table();
        key.erase(0, dot + 1);
    }
    target->insert_or_assign(key, std::move(*parsed.get("value")));
}

namespace {

constexpr std::array<std::string_view, 6> stage_names{"shardlow", "euler",   "kick",
                                                      "drift",    "scatter", "sample"};
constexpr std::array<std::string_view, 3> observable_names{"kinetic_temperature", "momentum", "stress"};

constexpr Allowed bin_count{[](double x) { return x >= 1.0 && x <= 1e6; }, "an integer, 1 to 10^6"};

std::uint64_t steps_of(double time, double step) {
    return static_cast<std::uint64_t>(std::llround(time / step));
}

Weight read_weight(TomlReader& reader, std::string const& key) {
    std::array<std::string_view, weights.size()> names;
    std::transform(weights.begin(), weights.end(), names.begin(), [](auto const& w) { return w.name; });
    return *weight_from_name(reader.text(key, "linear", names));
}

void read_box(Scene& scene, TomlReader reader) {
    scene.length = reader.numbers("length", std::nullopt, positive);
    if (scene.length.size() != static_cast<std::size_t>(scene.dimension))
        reader.fail("length", fmt::format("has {} sides; allowed: {}, one per dimension", scene.length.size(),
                                          scene.dimension));
    scene.shear_rate = reader.number("shear_rate", 0.0, any_number);
    reader.finish();
}

void read_particles(Scene& scene, TomlReader reader) {
    if (reader.has("number") == reader.has("density"))
        reader.fail("density", "give either particles.number or particles.density");
    double const count = reader.has("number")
                             ? double(reader.integer("number", std::nullopt, positive_integer))
                             : reader.number("density", std::nullopt, positive) * scene.volume();
    if (!(std::round(count) >= 2.0 && count < 1e9))
        reader.fail(reader.has("number") ? "number" : "density",
                    fmt::format("gives {:.0f} particles; allowed: 2 to 10^9", count));
    scene.particles = static_cast<std::uint64_t>(std::llround(count));
    scene.mass = reader.number("mass", 1.0, positive);
    scene.kT = reader.number("kT", 1.0, non_negative);
    reader.finish();
}

void read_time(Scene& scene, TomlReader reader) {
    scene.time_step = reader.number("step", std::nullopt, positive);
    double const duration = reader.number("duration", std::nullopt, positive);
    double const equilibration = reader.number("equilibration", 0.0, non_negative);
    if ((duration + equilibration) / scene.time_step > 1e15)
        reader.fail("duration", "is more than 10^15 steps");
    scene.production_steps = std::max<std::uint64_t>(1, steps_of(duration, scene.time_step));
    scene.equilibration_steps = steps_of(equilibration, scene.time_step);
    scene.checkpoint_seconds = reader.number("checkpoint", 30.0, positive);
    reader.finish();
}

void read_thermostats(Scene& scene, TomlReader& root) {
    for (std::string const name : {"shardlow", "euler"})
        if (root.has(name) && !scene.has_stage(name))
            root.fail(name, fmt::format("is given, but \"{}\" is not among the stages", name));
    if (auto reader = root.table("shardlow")) {
        auto& p = scene.shardlow;
        p.friction = reader->number("friction", std::nullopt, non_negative);
        p.cutoff = reader->number("cutoff", 1.0, positive);
        p.kT = reader->number("kT", 1.0, non_negative);
        p.weight = read_weight(*reader, "weight");
        reader->finish();
    } else if (scene.has_stage("shardlow")) {
        root.fail("shardlow", "is missing; allowed: a table [shardlow] with at least friction");
    }
    if (auto reader = root.table("euler")) {
        auto& p = scene.euler;
        p.gamma = reader->number("gamma", std::nullopt, non_negative);
        p.sigma = reader->number("sigma", std::nullopt, non_negative);
        p.cutoff = reader->number("cutoff", 1.0, positive);
        p.weight = read_weight(*reader, "weight");
        if (reader->has("random_weight")) p.random_weight = read_weight(*reader, "random_weight");
        reader->finish();
    } else if (scene.has_stage("euler")) {
        root.fail("euler", "is missing; allowed: a table [euler] with at least gamma and sigma");
    }
}

CorrelationParameters read_correlation(Scene const& scene, TomlReader reader) {
    double const time_step = scene.time_step;
    double const spacing = reader.number("spacing", time_step, positive);
    double const longest = reader.number("longest", std::nullopt, positive);
    double const origins = reader.number("origins", spacing, positive);
    reader.finish();
    CorrelationParameters p;
    p.spacing = std::max<std::uint64_t>(1, steps_of(spacing, time_step));
    p.lags = std::max<std::uint64_t>(1, steps_of(longest, time_step * double(p.spacing)));
    p.origin_spacing =
        p.spacing * std::max<std::uint64_t>(1, steps_of(origins, time_step * double(p.spacing)));
    if (p.spacing * p.lags >= scene.production_steps)
        reader.fail("longest", fmt::format("{} does not fit into time.duration", longest));
    return p;
}

void read_sample(Scene& scene, TomlReader reader) {
    auto& sample = scene.sample;
    sample.interval = reader.integer("interval", 1, positive_integer);
    for (auto const& name : reader.texts("observables", std::vector<std::string>{}, observable_names)) {
        if (name == "kinetic_temperature") sample.kinetic_temperature = true;
        if (name == "momentum") sample.momentum = true;
        if (name == "stress") sample.stress = true;
    }
    if (auto table = reader.table("profile")) {
        sample.profile = {.interval = table->integer("interval", 1, positive_integer),
                          .bins = table->integer("bins", 40, bin_count)};
        table->finish();
    }
    if (auto table = reader.table("radial_distribution")) {
        sample.radial_distribution = {.interval = table->integer("interval", 100, positive_integer),
                                      .bins = table->integer("bins", 100, bin_count),
                                      .range = table->number("range", 2.0, positive)};
        for (double const side : scene.length)
            if (side < 2.0 * sample.radial_distribution->range)
                table->fail("range",
                            fmt::format("must not exceed half the shortest box side, {}", side / 2.0));
        table->finish();
    }
    if (auto table = reader.table("mean_square_displacement"))
        sample.mean_square_displacement = read_correlation(scene, *table);
    if (auto table = reader.table("velocity_autocorrelation"))
        sample.velocity_autocorrelation = read_correlation(scene, *table);
    reader.finish();
}

void read_pairs(Scene& scene, TomlReader reader) {
    static constexpr std::array<std::string_view, 2> searches{"cell", "brute"};
    static constexpr std::array<std::string_view, 3> orders{"cell", "id", "random"};
    scene.search = reader.text("search", "cell", searches) == "cell" ? Search::cell : Search::brute;
    auto const order = reader.text("order", "cell", orders);
    scene.order = order == "cell" ? Order::cell : order == "id" ? Order::id : Order::random;
    reader.finish();
}

// Stages that hand something on need an order.
void check_stages(Scene const& scene, TomlReader const& root) {
    bool impulses_wait = false, impulses_at_positions = false;
    for (auto const& stage : scene.stages) {
        if (stage == "euler") impulses_wait = true;
        if (stage == "shardlow" || stage == "euler") impulses_at_positions = true;
        if (stage == "drift" || stage == "scatter") impulses_at_positions = false;
        if (stage == "kick" && !impulses_wait) root.fail("stages", "has a kick but no euler before it");
        if (stage == "sample" && scene.sample.stress && !impulses_at_positions)
            root.fail("stages",
                      "samples the stress where no pair impulses are at hand; allowed: sample after shardlow "
                      "or euler and before drift");
    }
}

Scene read_scene(toml::table const& table, std::string const& name) {
    TomlReader root(table, "", name);
    auto const required = [&](std::string const& key) {
        if (!root.has(key)) root.fail(key, fmt::format("is missing; allowed: a table [{}]", key));
        return *root.table(key);
    };
    Scene scene;
    scene.title = root.text("title", "");
    scene.dimension = static_cast<int>(
        root.integer("dimension", std::nullopt, {[](double x) { return x == 2 || x == 3; }, "2 or 3"}));
    scene.seed = root.integer("seed", 1, non_negative_integer);
    scene.stages = root.texts("stages", std::nullopt, stage_names);
    if (scene.stages.empty())
        root.fail("stages", fmt::format("is empty; allowed: {}", fmt::join(stage_names, ", ")));
    read_box(scene, required("box"));
    read_particles(scene, required("particles"));
    read_time(scene, required("time"));
    read_thermostats(scene, root);
    double cutoff = 0.0;
    if (scene.has_stage("shardlow")) cutoff = std::max(cutoff, scene.shardlow.cutoff);
    if (scene.has_stage("euler")) cutoff = std::max(cutoff, scene.euler.cutoff);
    for (double const side : scene.length)
        if (side < 2.0 * cutoff)
            required("box").fail("length", fmt::format("{} is too small; allowed: at least two cutoffs, {}",
                                                       side, 2.0 * cutoff));
    if (auto reader = root.table("sample")) {
        if (!scene.has_stage("sample"))
            root.fail("sample", "is given, but \"sample\" is not among the stages");
        read_sample(scene, *reader);
    }
    scene.sample.equilibration = scene.equilibration_steps;
    scene.sample.steps = scene.steps();
    if (auto reader = root.table("pairs")) read_pairs(scene, *reader);
    if (auto reader = root.table("trajectory")) {
        scene.trajectory_interval = reader->integer("interval", std::nullopt, positive_integer);
        reader->finish();
    }
    root.finish();
    check_stages(scene, root);
    return scene;
}

}  // namespace

double Scene::volume() const {
    double product = 1.0;
    for (double const side : length) product *= side;
    return product;
}

bool Scene::has_stage(std::string const& name) const {
    return std::find(stages.begin(), stages.end(), name) != stages.end();
}

std::string Scene::key() const {
    boost::uuids::name_generator_sha1 const generate(boost::uuids::ns::oid());
    return boost::uuids::to_string(
        generate(fmt::format("{}\nrevision {}\nseed {}", text, engine_revision, seed)));
}

Scene parse_scene(std::string const& text, std::string const& name, std::vector<std::string> const& overrides,
                  std::optional<std::uint64_t> seed) {
    toml::table table = parse_toml(text, name);
    for (auto const& assignment : overrides) override_key(table, assignment, "--set");
    Scene scene = read_scene(table, name);
    if (seed) scene.seed = *seed;
    // what does not change the results does not change the key
    table.erase("seed");
    table.erase("title");
    table["time"].as_table()->erase("checkpoint");
    std::ostringstream merged;
    merged << table;
    scene.text = merged.str();
    return scene;
}

Scene load_scene(std::filesystem::path const& file, std::vector<std::string> const& overrides,
                 std::optional<std::uint64_t> seed) {
    return parse_scene(read_file(file), file.string(), overrides, seed);
}

}  // namespace dpd
