#include "scene.hpp"

#include <algorithm>
#include <array>
#include <boost/uuid/name_generator_sha1.hpp>
#include <boost/uuid/uuid_io.hpp>
#include <filesystem>
#include <functional>
#include <set>

#include "configuration.hpp"
#include "files.hpp"
#include "size.hpp"
#include "theory/closed_forms.hpp"
#include "toml_reader.hpp"
#include "version.hpp"

namespace dpd {

namespace {

// Each has a stream of noise of its own.
constexpr std::size_t most_stages = 250;

// A run until errors are small may be so many times as long as its least duration, if it does not say.
constexpr double default_growth = 64.0;

constexpr Allowed relative_error{[](double x) { return x > 0.0 && x < 1.0; },
                                 "a relative error, between 0 and 1"};

constexpr Allowed bin_count{[](double x) { return x >= 1.0 && x <= 1e6; }, "an integer, 1 to 10^6"};

// The time `key` of a table in steps.
std::uint64_t steps_of(TomlReader const& table, std::string const& key, double time, double step) {
    constexpr double most = 1e14;
    if (!(time / step <= most))
        table.fail(key, fmt::format("is {:.3g} steps; allowed: at most 10^14", time / step));
    return static_cast<std::uint64_t>(std::llround(time / step));
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
    if (!std::isfinite(scene.volume()))
        reader.fail("length", "gives a volume that is no number; allowed: smaller sides");
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

constexpr std::string_view from_file = "file";  // as particles.start has it

void read_particles(Scene& scene, TomlReader reader) {
    if (reader.has("number") == reader.has("density"))
        reader.fail("density", "give either particles.number or particles.density");
    double const count = reader.has("number")
                             ? double(reader.integer("number", std::nullopt, positive_integer))
                             : reader.number("density", std::nullopt, positive) * scene.fluid_volume();
    if (!(std::round(count) >= 2.0 && count <= 1e9))
        reader.fail(reader.has("number") ? "number" : "density",
                    fmt::format("gives {:.0f} particles; allowed: 2 to 10^9", count));
    scene.particles = static_cast<std::uint64_t>(std::llround(count));
    scene.wall_particles =
        static_cast<std::uint64_t>(std::llround(scene.density() * (scene.volume() - scene.fluid_volume())));
    std::vector<std::string_view> starts(names<Start>.begin(), names<Start>.end());
    starts.push_back(from_file);
    if (auto const start = reader.text("start", "random", starts); start != from_file)
        scene.start = *value_of<Start>(start);
    else if (scene.wall > 0.0)
        reader.fail("start", "is \"file\" between walls; allowed: no walls");
    else
        reader.text("file", std::nullopt), reader.text("file_digest", "");
    scene.mass = reader.number("mass", 1.0, positive);
    scene.kT = reader.number("kT", 1.0, non_negative);
    reader.finish();
}

// Takes positions and velocities from the file that the scene names, seen from the scene's folder or from
// here. Returns the digest of its bytes.
std::string read_start(Scene& scene, TomlReader reader, std::string const& name) {
    std::filesystem::path const named = reader.text("file", std::nullopt);
    std::filesystem::path const beside = std::filesystem::path(name).parent_path() / named;
    std::string const file = (std::filesystem::exists(beside) ? beside : named).string(),
                      bytes = read_file(file);
    std::string const found = fmt::format("{:016x}", digest(bytes)),
                      wanted = reader.text("file_digest", found);
    if (found != wanted)
        reader.fail("file_digest",
                    fmt::format("is {}, but that of {} is {}; allowed: the file that it was, or no "
                                "digest",
                                wanted, file, found));
    auto state = read_configuration(bytes, file, scene.particles, static_cast<std::size_t>(scene.dimension));
    for (std::size_t axis = 0; axis < scene.length.size(); ++axis)
        if (std::abs(state.length[axis] - scene.length[axis]) > 1e-9 * scene.length[axis])
            reader.fail("file", fmt::format("{} has a box of {}; allowed: that of the scene, {}", file,
                                            fmt::join(state.length, " x "), fmt::join(scene.length, " x ")));
    for (std::size_t k = 0; k < state.position.size(); ++k) {
        double const side = scene.length[k % scene.length.size()];
        double& x = state.position[k];
        x -= side * std::floor(x / side);
        if (!(x >= 0.0 && x < side)) x = 0.0;
    }
    scene.configuration = std::make_shared<Configuration const>(std::move(state));
    return found;
}

void read_time(Scene& scene, TomlReader reader) {
    scene.time_step = reader.number("step", std::nullopt, positive);
    double const duration = reader.number("duration", std::nullopt, positive);
    double const equilibration = reader.number("equilibration", 0.0, non_negative);
    scene.production_steps = steps_of(reader, "duration", duration, scene.time_step);
    scene.equilibration_steps = steps_of(reader, "equilibration", equilibration, scene.time_step);
    if (scene.production_steps == 0)
        reader.fail("duration", fmt::format("{:g} is below one step; allowed: at least time.step, {:g}",
                                            duration, scene.time_step));
    scene.checkpoint_seconds = reader.number("checkpoint", 30.0, positive);
    if (reader.has("longest") && !reader.has("until"))
        reader.fail("longest", "is for a run until errors are small; allowed: with time.until");
    if (auto table = reader.table("until")) {
        auto& until = scene.until.emplace();
        for (auto const& [key, value] : table->raw()) {
            std::string const quantity(key.str());
            until.errors[quantity] = table->number(quantity, std::nullopt, relative_error);
        }
        table->finish();
        if (until.errors.empty())
            reader.fail("until", "names no quantity; allowed: { viscosity = 0.01 } and the like");
        double const longest = reader.number("longest", default_growth * duration, positive);
        if (!(longest >= duration))
            reader.fail("longest",
                        fmt::format("is {:g}; allowed: at least time.duration, {:g}", longest, duration));
        steps_of(reader, "longest", longest, scene.time_step);
        constexpr double rounding = 1.0 + 1e-9;  // 0.3 is three times 0.1
        until.longest = scene.production_steps;
        for (double growth = 2.0; growth <= longest / duration * rounding; growth *= 2.0) until.longest *= 2;
    }
    reader.finish();
}

// Every kind of stage that the scene lists, from its table if it has parameters.
void read_stage_parameters(Scene& scene, TomlReader& root) {
    StageSetting const setting = scene.stage_setting();
    for (AnyStage stage : all_stages()) {
        StageKind const& kind = kind_of(stage);
        if (!kind.least) continue;
        std::string const name(kind.name);
        auto table = root.table(name);
        if (table && !scene.has_stage(name))
            root.fail(name, fmt::format("is given, but \"{}\" is not among the stages", name));
        if (!table && scene.has_stage(name))
            root.fail(name, fmt::format("is missing; allowed: a table [{}]{}{}", name,
                                        *kind.least ? " with " : "", kind.least));
        if (!table) continue;
        std::visit([&](auto& s) { s.read(*table, setting); }, stage);
        table->finish();
        for (AnyStage& listed : scene.stages)
            if (listed.index() == stage.index()) listed = stage;
    }
}

// What the paper's numbers mean in the units of the DPD fluid.
void set_coarse_graining(Scene& scene, TomlReader const& root) {
    auto const& map = *scene.coarse_graining;
    if (!scene.soft()) root.fail("coarse_graining", "is for a soft potential");
    double const kT = scene.thermostat_kT();
    if (kT == 0.0) root.fail("coarse_graining", "needs a thermostat with kT > 0");
    try {
        double const strength = theory::conservative_coefficient(map_of(scene), kT);
        double const acceleration =
            map.viscosity > 0.0
                ? theory::force_in_dpd_units(map_of(scene), map.viscosity, map.force) / scene.mass
                : 0.0;
        auto const set = [&](auto& stage) {
            if constexpr (requires { stage.potential; }) std::get<Soft>(stage.potential).strength = strength;
            if constexpr (requires { stage.acceleration; })
                if (map.viscosity > 0.0) stage.acceleration = acceleration;
        };
        for (AnyStage& stage : scene.stages) std::visit(set, stage);
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
    p.spacing = std::max<std::uint64_t>(1, steps_of(reader, "spacing", spacing, time_step));
    if (p.spacing >= scene.production_steps)
        reader.fail("spacing", fmt::format("{} does not fit into time.duration", spacing));
    double const between = time_step * double(p.spacing);
    p.lags = std::max<std::uint64_t>(1, steps_of(reader, "longest", longest, between));
    p.origin_spacing = p.spacing * std::max<std::uint64_t>(1, steps_of(reader, "origins", origins, between));
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
    std::vector<std::string_view> known;
    for_each_series([&](auto const& series) {
        if (std::find(known.begin(), known.end(), series.observable) == known.end())
            known.push_back(series.observable);
    });
    for (auto const& name : reader.texts("observables", std::vector<std::string>{}, known))
        sample.observables.insert(name);
    if (sample.asks("friction_stress")) sample.observables.insert("stress");
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
        sample.green_kubo_window =
            2 * std::max<std::uint64_t>(1, steps_of(*table, "window", 0.5 * window, scene.time_step));
        if (!sample.asks("stress") || sample.interval != 1 || scene.flows() || scene.wall > 0.0)
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
    scene.search = reader.choice<Search>("search", "cell");
    scene.order = reader.choice<Order>("order", "cell");
    reader.finish();
}

// The names of the stages that have a property, for messages.
template <class Property>
std::string names_of_stages(Property&& has, std::string_view before_last = ", ") {
    std::vector<std::string_view> found;
    for (AnyStage const& stage : all_stages())
        if (has(stage)) found.push_back(kind_of(stage).name);
    std::string_view const last = found.back();
    found.pop_back();
    return fmt::format("{}{}{}", fmt::join(found, ", "), found.empty() ? "" : before_last, last);
}

bool leaves_impulses(AnyStage const& stage) { return kind_of(stage).impulses == Impulses::left; }
bool knows_walls(AnyStage const& stage) { return kind_of(stage).walls == Walls::known; }

template <class S>
bool is(AnyStage const& stage) {
    return std::holds_alternative<S>(stage);
}

// What a scene must not ask of all its stages together.
void check_stages(Scene const& scene, TomlReader const& root) {
    auto const number_of = [&](auto&& property) {
        return std::count_if(scene.stages.begin(), scene.stages.end(), property);
    };
    auto const that_move = [&](Moves how) {
        return number_of([how](AnyStage const& stage) { return kind_of(stage).moves == how; });
    };
    auto const thermostats = number_of(leaves_impulses), half_drifts = that_move(Moves::half),
               half_kicks = number_of(is<HalfKick>);
    if (scene.sample.asks("stress") && thermostats > 1)
        root.fail("stages", "have several pair thermostats; allowed with stress: one");
    if (scene.potential() && that_move(Moves::whole) + half_drifts / 2 > 1)
        root.fail("stages",
                  "move the particles twice; allowed: one of drift, verlet, modified_verlet and a "
                  "pair of half_drift");
    if (half_drifts % 2 != 0 || half_drifts > 2 || half_kicks % 2 != 0 || half_kicks > 2)
        root.fail("stages", "have an odd half_drift or half_kick; allowed: two of each, or none");
    std::set<std::size_t> with_potential;
    for (AnyStage const& stage : scene.stages)
        if (potential_of(stage)) with_potential.insert(stage.index());
    if (with_potential.size() > 1)
        root.fail("stages", fmt::format("have several that hold a potential; allowed: one of {}",
                                        names_of_stages(potential_of)));
    if (scene.potential() && scene.sample.asks("stress") && scene.equilibration_steps == 0)
        root.fail("time", "has no equilibration; allowed with a potential and stress: at least one step");
    if (scene.sample.asks("friction_stress") && thermostats == 0 && !scene.stage<ModifiedVerlet>())
        root.fail("stages", fmt::format("have no friction_stress to sample; allowed: with {} or {}",
                                        names_of_stages(leaves_impulses), ModifiedVerlet::kind.name));
    if (scene.sample.asks("lammps_pressure") && !scene.stage<ModifiedVerlet>())
        root.fail("stages",
                  fmt::format("have no friction that is a force, for lammps_pressure; allowed: with {}",
                              ModifiedVerlet::kind.name));
    if (scene.wall_strength && !scene.soft())
        root.fail("walls", "have a strength without a soft potential; allowed: no strength");
    if (scene.wall > 0.0 && scene.opposed_flows())
        root.fail("body_force", "is opposed between walls; allowed: walls, or opposed flows without them");
    if (scene.wall > 0.0) {
        if (!scene.stage<ModifiedVerlet>() || number_of(std::not_fn(knows_walls)) > 0)
            root.fail("stages",
                      fmt::format("do not know walls; allowed with walls: {}", names_of_stages(knows_walls)));
        if (scene.sample.asks("stress") || scene.sample.asks("pressure") ||
            scene.sample.asks("lammps_pressure") || scene.sample.radial_distribution)
            root.fail("sample",
                      "asks for stress, pressure or radial_distribution, which mean nothing with walls");
        if (scene.wall < scene.cutoff())
            root.fail("walls", fmt::format("are thinner than the cutoff, {0}: a particle would see what is "
                                           "behind; allowed: thickness at least {0}",
                                           scene.cutoff()));
    }
}

// Stages that hand something on to each other need an order.
void check_order(Scene const& scene, TomlReader const& root) {
    bool const has_thermostat = std::any_of(scene.stages.begin(), scene.stages.end(), leaves_impulses);
    bool impulses_wait = false, impulses_at_positions = false, sampled = false, moved = false;
    for (AnyStage const& stage : scene.stages) {
        Moves const moves = kind_of(stage).moves;
        if (is<EulerImpulses>(stage)) impulses_wait = true;
        if (is<ForceImpulses>(stage) && (!impulses_wait || moved))
            root.fail("stages",
                      "has no euler before force, or moves between them; allowed: euler, then force");
        if (scene.sample.asks("stress") &&
            (moves == Moves::half || (is<HalfKick>(stage) && (sampled || moved))))
            root.fail("stages",
                      "has no place where a whole step's stress is known; allowed with stress: half_kick, a "
                      "thermostat, half_kick, sample, drift");
        sampled |= is<Sample>(stage);
        moved |= moves == Moves::half || moves == Moves::whole;
        if (leaves_impulses(stage)) impulses_at_positions = true;
        if (moves != Moves::none) impulses_at_positions = false;
        if (is<Kick>(stage) && !impulses_wait) root.fail("stages", "has a kick but no euler before it");
        if (is<Sample>(stage) && scene.sample.asks("stress") && has_thermostat && !impulses_at_positions)
            root.fail("stages", fmt::format("samples the stress where no pair impulses are at hand; allowed: "
                                            "sample after {} and before {} or {}",
                                            names_of_stages(leaves_impulses, " or "), Drift::kind.name,
                                            Verlet::kind.name));
    }
}

// The stages in the order of a step, their parameters still to be read.
void read_stage_list(Scene& scene, TomlReader& root) {
    auto const kinds = all_stages();
    std::vector<std::string_view> known;
    for (AnyStage const& stage : kinds) known.push_back(kind_of(stage).name);
    for (auto const& name : root.texts("stages", std::nullopt, known))
        scene.stages.push_back(
            kinds[std::size_t(std::find(known.begin(), known.end(), name) - known.begin())]);
    if (scene.stages.empty())
        root.fail("stages", fmt::format("is empty; allowed: {}", fmt::join(known, ", ")));
    if (scene.stages.size() > most_stages)
        root.fail("stages", fmt::format("are {}; allowed: 1 to {}", scene.stages.size(), most_stages));
}

Scene read_scene(toml::table const& table, std::string const& name) {
    TomlReader root(table, "", name);
    Scene scene;
    scene.title = root.text("title", "");
    scene.dimension = static_cast<int>(
        root.integer("dimension", std::nullopt, {[](double x) { return x == 2 || x == 3; }, "2 or 3"}));
    scene.seed = root.integer("seed", 1, non_negative_integer);
    read_stage_list(scene, root);
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
    check_size(scene, root);
    check_stages(scene, root);
    check_order(scene, root);
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

bool Scene::has_stage(std::string_view name) const {
    return std::any_of(stages.begin(), stages.end(),
                       [name](AnyStage const& stage) { return kind_of(stage).name == name; });
}

std::vector<std::string> Scene::stage_names() const {
    std::vector<std::string> found;
    for (AnyStage const& stage : stages) found.emplace_back(kind_of(stage).name);
    return found;
}

StageSetting Scene::stage_setting() const {
    return {.length = length,
            .volume = volume(),
            .particles = double(particles),
            .mass = mass,
            .time_step = time_step,
            .coarse_grained = coarse_graining.has_value(),
            .force_mapped = coarse_graining && coarse_graining->viscosity > 0.0};
}

AnyPotential const* Scene::potential() const {
    for (AnyStage const& stage : stages)
        if (AnyPotential const* const found = potential_of(stage)) return found;
    return nullptr;
}

Soft const* Scene::soft() const { return potential() ? std::get_if<Soft>(potential()) : nullptr; }

bool Scene::opposed_flows() const {
    auto const* const force = stage<BodyForce>();
    return force && force->opposed;
}

double Scene::fluid_volume() const { return volume() * (1.0 - 2.0 * wall / length[1]); }

double Scene::channel_width() const { return opposed_flows() ? 0.5 * length[1] : length[1] - 2.0 * wall; }

double Scene::cutoff() const {
    double longest = 0.0;
    for (AnyStage const& stage : stages)
        longest = std::max(longest, std::visit([](auto const& s) { return s.range(); }, stage));
    return longest;
}

double Scene::thermostat_kT() const {
    double highest = 0.0;
    for (AnyStage const& stage : stages)
        highest = std::max(highest, std::visit([](auto const& s) { return s.temperature(); }, stage));
    return highest;
}

void Scene::use(Engine which) {
    if (which == Engine::plain && order == Order::random)
        throw InputError(
            "pairs.order: is random; allowed with the plain engine: cell or id, both the order of ids");
    engine = which;
}

std::string Scene::key() const {
    boost::uuids::name_generator_sha1 const generate(boost::uuids::ns::oid());
    return boost::uuids::to_string(
        generate(fmt::format("{}\nrevision {}.{}\nseed {}{}", text, engine_revision, measurement_revision,
                             seed, engine == Engine::plain ? "\nplain engine " DPDREF_PLAIN_TEXT : "")));
}

Scene parse_scene(std::string const& text, std::string const& name, std::vector<std::string> const& overrides,
                  std::optional<std::uint64_t> seed) {
    toml::table table = parse_toml(text, name);
    for (auto const& assignment : overrides) override_key(table, assignment, "--set");
    Scene scene = read_scene(table, name);
    if (seed) scene.seed = *seed;
    // the content of a file is part of what is simulated
    if (toml::table& particles = *table["particles"].as_table();
        particles["start"].value_or(std::string()) == from_file)
        particles.insert_or_assign("file_digest",
                                   read_start(scene, *TomlReader(table, "", name).table("particles"), name));
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
