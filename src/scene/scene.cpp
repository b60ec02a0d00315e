#include "scene.hpp"

#include <algorithm>
#include <array>
#include <boost/uuid/name_generator_sha1.hpp>
#include <boost/uuid/uuid_io.hpp>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "stages.hpp"
#include "theory/closed_forms.hpp"
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

// [stage names]
constexpr std::array<std::string_view, 14> stage_names{
    "shardlow",   "lowe",   "euler",           "force",   "kick",       "half_kick", "drift",
    "half_drift", "verlet", "modified_verlet", "rescale", "body_force", "scatter",   "sample"};
// [stage names]
constexpr std::array<std::string_view, 7> observable_names{
    "kinetic_temperature",        "momentum", "stress", "friction_stress", "potential_energy", "pressure",
    "configurational_temperature"};

constexpr Allowed bin_count{[](double x) { return x >= 1.0 && x <= 1e6; }, "an integer, 1 to 10^6"};

std::uint64_t steps_of(double time, double step) {
    return static_cast<std::uint64_t>(std::llround(time / step));
}

Weight read_weight(TomlReader& reader, std::string const& key, std::string const& fallback = "linear") {
    return reader.choice<Weight>(key, fallback);
}

void read_coarse_graining(Scene& scene, TomlReader reader) {
    auto& map = scene.coarse_graining.emplace();
    map.atoms_per_particle = reader.number("atoms_per_particle", std::nullopt, positive);
    map.length = reader.numbers("length", std::vector<double>{}, positive);
    map.force = reader.number("force", 0.0, positive);
    if (scene.dimension != 3) reader.fail("atoms_per_particle", "is for three dimensions");
    if (reader.has("force") && !scene.has_stage("body_force"))
        reader.fail("force", "belongs to the stage body_force; allowed: both or neither");
    if (reader.has("force")) map.viscosity = reader.number("viscosity", std::nullopt, positive);
    reader.finish();
}

theory::CoarseGraining map_of(Scene const& scene) {
    return {.Nm = scene.coarse_graining->atoms_per_particle};
}

// Whether the sides are given in the atoms' units; they are then those of the fluid.
bool has_mapped_sides(Scene const& scene) {
    return scene.coarse_graining && !scene.coarse_graining->length.empty();
}

void read_box(Scene& scene, TomlReader reader) {
    bool const mapped = has_mapped_sides(scene);
    if (mapped && reader.has("length"))
        reader.fail("length", "is also in coarse_graining; allowed: one of them");
    scene.length = mapped ? scene.coarse_graining->length : reader.numbers("length", std::nullopt, positive);
    if (mapped)
        for (double& side : scene.length) side = theory::length_in_dpd_units(map_of(scene), side);
    if (scene.length.size() != static_cast<std::size_t>(scene.dimension))
        reader.fail("length", fmt::format("has {} sides; allowed: {}, one per dimension", scene.length.size(),
                                          scene.dimension));
    scene.shear_rate = reader.number("shear_rate", 0.0, any_number);
    reader.finish();
}

void read_walls(Scene& scene, TomlReader reader) {
    scene.wall = reader.number("thickness", std::nullopt, positive);
    if (reader.has("strength")) scene.wall_strength = reader.number("strength", std::nullopt, non_negative);
    if (has_mapped_sides(scene)) scene.length[1] += 2.0 * scene.wall;
    if (2.0 * scene.wall >= scene.length[1])
        reader.fail("thickness",
                    fmt::format("{} leaves no fluid between the walls; allowed: less than half of "
                                "box.length[1], {}",
                                scene.wall, 0.5 * scene.length[1]));
    if (scene.shear_rate != 0.0) reader.fail("thickness", "has walls in a sheared box; allowed: one of them");
    reader.finish();
}

void read_particles(Scene& scene, TomlReader reader) {
    if (reader.has("number") == reader.has("density"))
        reader.fail("density", "give either particles.number or particles.density");
    double const count = reader.has("number")
                             ? double(reader.integer("number", std::nullopt, positive_integer))
                             : reader.number("density", std::nullopt, positive) * scene.fluid_volume();
    if (!(std::round(count) >= 2.0 && count < 1e9))
        reader.fail(reader.has("number") ? "number" : "density",
                    fmt::format("gives {:.0f} particles; allowed: 2 to 10^9", count));
    scene.particles = static_cast<std::uint64_t>(std::llround(count));
    scene.wall_particles =
        static_cast<std::uint64_t>(std::llround(scene.density() * (scene.volume() - scene.fluid_volume())));
    scene.start = reader.choice<Start>("start", "random", start_names);
    scene.mass = reader.number("mass", 1.0, positive);
    scene.kT = reader.number("kT", 1.0, non_negative);
    reader.finish();
}

void read_time(Scene& scene, TomlReader reader) {
    scene.time_step = reader.number("step", std::nullopt, positive);
    double const duration = reader.number("duration", std::nullopt, positive);
    double const equilibration = reader.number("equilibration", 0.0, non_negative);
    if ((duration + equilibration) / scene.time_step > 1e14)
        reader.fail("duration", "is more than 10^14 steps");
    scene.production_steps = std::max<std::uint64_t>(1, steps_of(duration, scene.time_step));
    scene.equilibration_steps = steps_of(equilibration, scene.time_step);
    scene.checkpoint_seconds = reader.number("checkpoint", 30.0, positive);
    reader.finish();
}

Scheme read_scheme(TomlReader& reader, std::string const& key) {
    return reader.choice<Scheme>(key, "shardlow");
}

void read_shardlow(Scene& scene, TomlReader& reader) {
    auto& p = scene.shardlow;
    p.friction = reader.number("friction", std::nullopt, non_negative);
    p.cutoff = reader.number("cutoff", 1.0, positive);
    p.kT = reader.number("kT", 1.0, non_negative);
    p.weight = read_weight(reader, "weight");
    p.scheme = read_scheme(reader, "scheme");
    if (p.scheme == Scheme::linear && p.friction * scene.time_step > scene.mass)
        reader.fail("friction", fmt::format("{} times the step is above the mass; allowed with scheme "
                                            "\"linear\": at most {}",
                                            p.friction, scene.mass / scene.time_step));
}

void read_lowe(Scene& scene, TomlReader& reader) {
    auto& p = scene.lowe;
    p.rate = reader.number("rate", std::nullopt, non_negative);
    p.cutoff = reader.number("cutoff", 1.0, positive);
    p.kT = reader.number("kT", 1.0, non_negative);
    if (p.rate * scene.time_step > most_sweeps)
        reader.fail("rate", fmt::format("{} is {:g} updates of a pair per step; allowed: at most {:g}",
                                        p.rate, p.rate * scene.time_step, most_sweeps));
}

void read_euler(Scene& scene, TomlReader& reader) {
    auto& p = scene.euler;
    p.gamma = reader.number("gamma", std::nullopt, non_negative);
    p.sigma = reader.number("sigma", std::nullopt, non_negative);
    p.cutoff = reader.number("cutoff", 1.0, positive);
    p.weight = read_weight(reader, "weight");
    if (reader.has("random_weight")) p.random_weight = read_weight(reader, "random_weight");
}

void read_potential(Scene& scene, TomlReader& reader) {
    if (reader.has("soft") == reader.has("lennard_jones"))
        reader.fail("soft", "give either a table soft or a table lennard_jones");
    if (auto table = reader.table("soft")) {
        Soft soft;
        soft.cutoff = table->number("cutoff", 1.0, positive);
        if (scene.coarse_graining && (table->has("strength") || soft.cutoff != 1.0))
            table->fail("strength", "and cutoff follow from coarse_graining; allowed: one of them");
        // coarse_graining is known, the thermostat's kT perhaps not yet: set_coarse_graining
        if (!scene.coarse_graining) soft.strength = table->number("strength", std::nullopt, non_negative);
        table->finish();
        scene.potential = soft;
    }
    if (auto table = reader.table("lennard_jones")) {
        LennardJones lj;
        lj.epsilon = table->number("epsilon", 1.0, positive);
        lj.sigma = table->number("sigma", 1.0, positive);
        lj.cutoff = table->number("cutoff", 2.5 * lj.sigma, positive);
        lj.shifted = table->boolean("shifted", false);
        table->finish();
        scene.potential = lj;
    }
}

void read_verlet(Scene& scene, TomlReader& reader) {
    scene.substeps = reader.integer("substeps", 1, positive_integer);
    read_potential(scene, reader);
}

void read_modified_verlet(Scene& scene, TomlReader& reader) {
    auto& p = scene.modified_verlet;
    p.gamma = reader.number("gamma", std::nullopt, non_negative);
    p.sigma = reader.number("sigma", std::nullopt, non_negative);
    p.cutoff = reader.number("cutoff", 1.0, positive);
    p.weight = read_weight(reader, "weight", "quadratic");
    p.lambda = reader.number("lambda", 0.5, non_negative);
    p.friction_again = reader.boolean("friction_again", false);
    read_potential(scene, reader);
}

void read_rescale(Scene& scene, TomlReader& reader) {
    auto& p = scene.rescale;
    p.mode = reader.choice<Rescaling>("mode", "global", rescaling_names);
    p.kT = reader.number("kT", 1.0, positive);
    p.cell = reader.number("cell", 1.0, positive);
    p.thickness = reader.integer("thickness", 1, positive_integer);
    p.amplitude = reader.number("amplitude", 0.3, positive);
    for (double const side : scene.length) {
        double const cells = side / p.cell;
        if (std::abs(cells - std::round(cells)) > 1e-9 * cells || cells < 0.5 || cells > 1e6)
            reader.fail("cell",
                        fmt::format("{} does not divide the box side {}; allowed: a side over a whole "
                                    "number",
                                    p.cell, side));
    }
}

// [body force]
void read_body_force(Scene& scene, TomlReader& reader) {
    bool const mapped = scene.coarse_graining && scene.coarse_graining->viscosity > 0.0;
    if (mapped && reader.has("acceleration"))
        reader.fail("acceleration", "follows from coarse_graining.force; allowed: one of them");
    if (!mapped) scene.body_force.acceleration = reader.number("acceleration", std::nullopt, any_number);
    scene.body_force.opposed = reader.boolean("opposed", false);
}
// [body force]

// [stage tables]
struct StageTable {
    char const* stage;
    char const* needs;
    void (*read)(Scene&, TomlReader&);
};

// The stages that have parameters.
constexpr std::array<StageTable, 9> stage_tables{
    {{"modified_verlet", " with at least gamma, sigma and a potential", read_modified_verlet},
     {"force", " with a potential", read_potential},
     {"half_kick", " with a potential", read_potential},
     {"shardlow", " with at least friction", read_shardlow},
     {"lowe", " with at least rate", read_lowe},
     {"euler", " with at least gamma and sigma", read_euler},
     {"verlet", " with at least a potential", read_verlet},
     {"rescale", "", read_rescale},
     {"body_force", " with at least acceleration", read_body_force}}};
// [stage tables]

void read_stage_parameters(Scene& scene, TomlReader& root) {
    for (auto const& [stage, needs, read] : stage_tables) {
        auto reader = root.table(stage);
        if (reader && !scene.has_stage(stage))
            root.fail(stage, fmt::format("is given, but \"{}\" is not among the stages", stage));
        if (!reader && scene.has_stage(stage))
            root.fail(stage, fmt::format("is missing; allowed: a table [{}]{}", stage, needs));
        if (!reader) continue;
        read(scene, *reader);
        reader->finish();
    }
}

// What the paper's numbers mean in the units of the DPD fluid.
void set_coarse_graining(Scene& scene, TomlReader const& root) {
    auto const& map = *scene.coarse_graining;
    auto* const soft = std::get_if<Soft>(&scene.potential);
    if (!scene.has_potential() || !soft) root.fail("coarse_graining", "is for a soft potential");
    double const kT = scene.thermostat_kT();
    if (kT == 0.0) root.fail("coarse_graining", "needs a thermostat with kT > 0");
    try {
        soft->strength = theory::conservative_coefficient(map_of(scene), kT);
        if (map.viscosity > 0.0)
            scene.body_force.acceleration =
                theory::force_in_dpd_units(map_of(scene), map.viscosity, map.force) / scene.mass;
    } catch (std::exception const& error) {
        root.fail("coarse_graining", error.what());
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

void check_range(Scene const& scene, TomlReader const& table, double range) {
    double const shortest = *std::min_element(scene.length.begin(), scene.length.end());
    if (shortest < 2.0 * range)
        table.fail("range", fmt::format("must not exceed half the shortest box side, {}", shortest / 2.0));
}

void read_sample(Scene& scene, TomlReader reader) {
    auto& sample = scene.sample;
    sample.interval = reader.integer("interval", 1, positive_integer);
    for (auto const& name : reader.texts("observables", std::vector<std::string>{}, observable_names)) {
        if (name == "kinetic_temperature") sample.kinetic_temperature = true;
        if (name == "momentum") sample.momentum = true;
        if (name == "stress") sample.stress = true;
        if (name == "friction_stress") sample.stress = sample.friction_stress = true;
        if (name == "potential_energy") sample.potential_energy = true;
        if (name == "pressure") sample.pressure = true;
        if (name == "configurational_temperature") sample.configurational_temperature = true;
    }
    if (auto table = reader.table("profile")) {
        sample.profile = {.interval = table->integer("interval", 1, positive_integer),
                          .bins = table->integer("bins", 40, bin_count),
                          .temperature = table->boolean("temperature", false)};
        table->finish();
    }
    if (auto table = reader.table("radial_distribution")) {
        sample.radial_distribution = {.interval = table->integer("interval", 100, positive_integer),
                                      .bins = table->integer("bins", 100, bin_count),
                                      .range = table->number("range", 2.0, positive)};
        check_range(scene, *table, sample.radial_distribution->range);
        table->finish();
    }
    sample.configuration = reader.boolean("configuration", false);
    if (auto table = reader.table("bond_order")) {
        sample.bond_order = {.interval = table->integer("interval", 100, positive_integer),
                             .range = table->number("range", std::nullopt, positive)};
        if (scene.dimension != 3) table->fail("range", "is for three dimensions");
        check_range(scene, *table, sample.bond_order->range);
        table->finish();
    }
    if (auto table = reader.table("green_kubo")) {
        double const window = table->number("window", std::nullopt, positive);
        table->finish();
        sample.green_kubo_window = 2 * std::max<std::uint64_t>(1, steps_of(0.5 * window, scene.time_step));
        if (!sample.stress || sample.interval != 1 || scene.flows() || scene.wall > 0.0)
            reader.fail("green_kubo",
                        "needs every step's stress of a fluid at rest; allowed: observables with \"stress\", "
                        "interval 1, no flow, no walls");
        if (sample.green_kubo_window * curve_blocks > scene.production_steps)
            reader.fail("green_kubo",
                        fmt::format("has a window of {}; allowed: an eighth of time.duration", window));
    }
    sample.components = diffusing_components(scene);
    if (auto table = reader.table("mean_square_displacement"))
        sample.mean_square_displacement = read_correlation(scene, *table);
    if (auto table = reader.table("velocity_autocorrelation"))
        sample.velocity_autocorrelation = read_correlation(scene, *table);
    reader.finish();
}

void read_pairs(Scene& scene, TomlReader reader) {
    static constexpr std::array<std::string_view, 2> searches{"cell", "brute"};
    static constexpr std::array<std::string_view, 3> orders{"cell", "id", "random"};
    scene.search = reader.choice<Search>("search", "cell", searches);
    scene.order = reader.choice<Order>("order", "cell", orders);
    reader.finish();
}

constexpr std::array<std::string_view, 3> pair_thermostats{"shardlow", "lowe", "euler"};
constexpr std::array<std::string_view, 4> potential_stages{"force", "half_kick", "verlet", "modified_verlet"};

// Stages that hand something on need an order.
void check_stages(Scene const& scene, TomlReader const& root) {
    auto const is_pair_thermostat = [](std::string const& stage) {
        return std::find(pair_thermostats.begin(), pair_thermostats.end(), stage) != pair_thermostats.end();
    };
    auto const count = std::count_if(scene.stages.begin(), scene.stages.end(), is_pair_thermostat);
    bool const has_pair_thermostat = count > 0;
    if (scene.sample.stress && count > 1)
        root.fail("stages", "have several pair thermostats; allowed with stress: one");
    auto const number_of = [&](std::string_view stage) {
        return std::count(scene.stages.begin(), scene.stages.end(), stage);
    };
    auto const half_drifts = number_of("half_drift"), half_kicks = number_of("half_kick");
    auto const movers =
        number_of("drift") + number_of("verlet") + number_of("modified_verlet") + half_drifts / 2;
    if (scene.has_potential() && movers > 1)
        root.fail("stages",
                  "move the particles twice; allowed: one of drift, verlet, modified_verlet and a "
                  "pair of half_drift");
    if (half_drifts % 2 != 0 || half_drifts > 2 || half_kicks % 2 != 0 || half_kicks > 2)
        root.fail("stages", "have an odd half_drift or half_kick; allowed: two of each, or none");
    if (std::count_if(potential_stages.begin(), potential_stages.end(),
                      [&](std::string_view stage) { return number_of(stage) > 0; }) > 1)
        root.fail("stages", fmt::format("have several that hold a potential; allowed: one of {}",
                                        fmt::join(potential_stages, ", ")));
    if (scene.has_potential() && scene.sample.stress && scene.equilibration_steps == 0)
        root.fail("time", "has no equilibration; allowed with a potential and stress: at least one step");
    if (scene.sample.friction_stress && !has_pair_thermostat && !scene.has_stage("modified_verlet"))
        root.fail(
            "stages",
            "have no friction_stress to sample; allowed: with shardlow, lowe, euler or modified_verlet");
    if (scene.wall_strength && !std::holds_alternative<Soft>(scene.potential))
        root.fail("walls", "have a strength without a soft potential; allowed: no strength");
    if (scene.wall > 0.0 && scene.body_force.opposed)
        root.fail("body_force", "is opposed between walls; allowed: walls, or opposed flows without them");
    if (scene.wall > 0.0) {
        if (!scene.has_stage("modified_verlet") || count > 0 || scene.has_stage("rescale"))
            root.fail("stages", "do not know walls; allowed with walls: modified_verlet, body_force, sample");
        if (scene.sample.stress || scene.sample.pressure || scene.sample.radial_distribution)
            root.fail("sample",
                      "asks for stress, pressure or radial_distribution, which mean nothing with walls");
        if (scene.wall < scene.cutoff())
            root.fail("walls", fmt::format("are thinner than the cutoff, {0}: a particle would see what is "
                                           "behind; allowed: thickness at least {0}",
                                           scene.cutoff()));
    }
    bool impulses_wait = false, impulses_at_positions = false, sampled = false, moved = false;
    for (auto const& stage : scene.stages) {
        if (stage == "euler") impulses_wait = true;
        if (stage == "force" && (!impulses_wait || moved))
            root.fail("stages",
                      "has no euler before force, or moves between them; allowed: euler, then force");
        if (scene.sample.stress && (stage == "half_drift" || (stage == "half_kick" && (sampled || moved))))
            root.fail("stages",
                      "has no place where a whole step's stress is known; allowed with stress: half_kick, a "
                      "thermostat, half_kick, sample, drift");
        sampled |= stage == "sample";
        moved |= stage == "drift" || stage == "half_drift";
        if (is_pair_thermostat(stage)) impulses_at_positions = true;
        if (stage == "drift" || stage == "half_drift" || stage == "verlet" || stage == "modified_verlet" ||
            stage == "scatter")
            impulses_at_positions = false;
        if (stage == "kick" && !impulses_wait) root.fail("stages", "has a kick but no euler before it");
        if (stage == "sample" && scene.sample.stress && has_pair_thermostat && !impulses_at_positions)
            root.fail(
                "stages",
                "samples the stress where no pair impulses are at hand; allowed: sample after shardlow, "
                "lowe or euler and before drift or verlet");
    }
}

Scene read_scene(toml::table const& table, std::string const& name) {
    TomlReader root(table, "", name);
    Scene scene;
    scene.title = root.text("title", "");
    scene.dimension = static_cast<int>(
        root.integer("dimension", std::nullopt, {[](double x) { return x == 2 || x == 3; }, "2 or 3"}));
    scene.seed = root.integer("seed", 1, non_negative_integer);
    scene.stages = root.texts("stages", std::nullopt, stage_names);
    if (scene.stages.empty())
        root.fail("stages", fmt::format("is empty; allowed: {}", fmt::join(stage_names, ", ")));
    if (auto reader = root.table("coarse_graining")) read_coarse_graining(scene, *reader);
    toml::table const no_table;
    bool const mapped = has_mapped_sides(scene);
    read_box(scene,
             mapped && !root.has("box") ? TomlReader(no_table, "box.", name) : root.required_table("box"));
    if (auto reader = root.table("walls")) read_walls(scene, *reader);
    read_particles(scene, root.required_table("particles"));
    read_time(scene, root.required_table("time"));
    read_stage_parameters(scene, root);
    if (scene.coarse_graining) set_coarse_graining(scene, root);
    for (double const side : scene.length)
        if (side < 2.0 * scene.cutoff())
            (mapped ? *root.table("coarse_graining") : root.required_table("box"))
                .fail("length", fmt::format("{} is too small; allowed: at least two cutoffs, {}", side,
                                            2.0 * scene.cutoff()));
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
    if (scene.sample.mean_square_displacement || scene.sample.velocity_autocorrelation)
        if (diffusing_components(scene) == 0)
            root.fail("sample", "asks for displacements, but a plane channel has no direction left for them");
    return scene;
}

}  // namespace

int diffusing_components(Scene const& scene) {
    return scene.dimension - (scene.wall > 0.0 ? 2 : scene.flows() ? 1 : 0);
}

double Scene::volume() const {
    double product = 1.0;
    for (double const side : length) product *= side;
    return product;
}

bool Scene::has_stage(std::string const& name) const {
    return std::find(stages.begin(), stages.end(), name) != stages.end();
}

bool Scene::has_potential() const {
    return std::any_of(potential_stages.begin(), potential_stages.end(),
                       [this](std::string_view stage) { return has_stage(std::string(stage)); });
}

double Scene::fluid_volume() const { return volume() * (1.0 - 2.0 * wall / length[1]); }

double Scene::channel_width() const { return body_force.opposed ? 0.5 * length[1] : length[1] - 2.0 * wall; }

double Scene::cutoff() const {
    double longest = 0.0;
    if (has_stage("shardlow")) longest = std::max(longest, shardlow.cutoff);
    if (has_stage("lowe")) longest = std::max(longest, lowe.cutoff);
    if (has_stage("euler")) longest = std::max(longest, euler.cutoff);
    if (has_stage("modified_verlet")) longest = std::max(longest, modified_verlet.cutoff);
    if (has_potential())
        longest = std::max(longest, std::visit([](auto const& p) { return p.cutoff; }, potential));
    return longest;
}

double Scene::thermostat_kT() const {
    double highest = 0.0;
    if (has_stage("shardlow")) highest = std::max(highest, shardlow.kT);
    if (has_stage("lowe")) highest = std::max(highest, lowe.kT);
    if (has_stage("rescale")) highest = std::max(highest, rescale.kT);
    if (has_stage("modified_verlet") && modified_verlet.gamma > 0.0)
        highest =
            std::max(highest, modified_verlet.sigma * modified_verlet.sigma / (2.0 * modified_verlet.gamma));
    if (has_stage("euler") && euler.gamma > 0.0)
        highest = std::max(highest, euler.sigma * euler.sigma / (2.0 * euler.gamma));
    return highest;
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
