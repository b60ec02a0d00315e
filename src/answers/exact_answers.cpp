#include "exact_answers.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "files.hpp"
#include "run.hpp"
#include "toml_reader.hpp"

namespace dpd {
namespace {

using Json = nlohmann::ordered_json;

constexpr int steps = 2;

// What a case begins with: three components per particle, of which two dimensions take the first two.
struct Before {
    std::vector<double> position, velocity;
    std::uint64_t step = 0;  // steps done before, which set the time that a sheared boundary knows
};

Before read_state(TomlReader reader) {
    Before state;
    state.position = reader.numbers("position", std::nullopt, any_number);
    state.velocity = reader.numbers("velocity", std::nullopt, any_number);
    state.step = reader.integer("step", 0, non_negative_integer);
    if (state.position.size() % 3 != 0 || state.velocity.size() != state.position.size())
        reader.fail("velocity", "and position differ in length; allowed: three numbers per particle in both");
    reader.finish();
    return state;
}

// --- the order of the pairs

PairOrder::value_type sorted(std::uint32_t i, std::uint32_t j) { return std::minmax(i, j); }

// All pairs of `count` particles, and nothing else.
void require_every_pair(PairOrder const& order, std::size_t count) {
    auto const refuse = [&](PairOrder::value_type pair, std::string_view problem) {
        throw InputError(fmt::format("order: {}-{} {}; allowed: each pair of the particles 0 to {} once",
                                     pair.first, pair.second, problem, count - 1));
    };
    for (auto const& pair : order)
        if (pair.second >= count) refuse(pair, "is no pair of the largest case");
    for (std::uint32_t i = 0; i < count; ++i)
        for (std::uint32_t j = i + 1; j < count; ++j)
            if (std::ranges::find(order, PairOrder::value_type(i, j)) == order.end())
                refuse({i, j}, "is missing");
}

// Puts the pairs that the search has found into that order.
template <int d>
void put_in_order(PairList<d>& list, Particles<d> const& particles, PairOrder const& order) {
    std::vector<Pair<d>> pairs;
    for (std::size_t k = 0; k < list.count; ++k) pairs.push_back(list.pair(k));
    std::ranges::sort(pairs, {}, [&](Pair<d> const& pair) {
        return std::ranges::find(order, sorted(particles.id[pair.i], particles.id[pair.j])) - order.begin();
    });
    std::size_t const coincident = list.coincident;
    list.clear();
    list.coincident = coincident;
    for (auto const& pair : pairs) list.append(pair);
}

// --- the noise of a step

// Of how many sweeps over the pairs a stage consists, and how far it acts; nothing if it draws no pair noise.
struct PairStage {
    double cutoff;
    double sweeps = 1.0;
};

std::optional<PairStage> pair_stage(AnyStage const& stage, double time_step) {
    if (auto const* const s = std::get_if<Shardlow>(&stage)) return PairStage{s->cutoff};
    if (auto const* const s = std::get_if<EulerImpulses>(&stage)) return PairStage{s->cutoff};
    if (auto const* const s = std::get_if<ModifiedVerlet>(&stage)) return PairStage{s->cutoff};
    if (auto const* const s = std::get_if<Lowe>(&stage)) return PairStage{s->cutoff, s->rate * time_step};
    return std::nullopt;
}

// Lists what a stage has drawn, in the order of its use. `key` is that of the stage's first draw. That these
// are the engine's own draws is for the independent check to prove: it uses no others.
template <int d>
void list_noise(Json& noise, Simulation<d>& simulation, Scene const& scene, AnyStage const& stage,
                NoiseKey key) {
    std::string const name(kind_of(stage).name);
    if (auto const* const rescale = std::get_if<Rescale>(&stage)) {
        Json entry{{"stage", name}, {"shift", Json::array()}};
        std::uint32_t cells = 1;
        for (std::uint32_t axis = 0; axis < d; ++axis) {
            entry["shift"].push_back(rescale->cell * uniform(key, axis, 0));
            cells *= static_cast<std::uint32_t>(std::llround(scene.length[axis] / rescale->cell));
        }
        if (rescale->mode == Rescaling::monte_carlo)
            for (std::uint32_t c = 0; c < cells; ++c)
                entry["lots"].push_back({uniform(key, c, 1), uniform(key, c, 2), uniform(key, c, 3)});
        noise.push_back(entry);
    }
    auto const acting = pair_stage(stage, scene.time_step);
    if (!acting) return;
    auto const& pairs = simulation.pairs();
    auto const& id = simulation.particles.id;
    std::span const i{pairs.i.data(), pairs.count}, j{pairs.j.data(), pairs.count};
    std::vector<double> normals(pairs.count), lots(pairs.count);
    for (int sweep = 0; sweep < acting->sweeps; ++sweep, ++key.sweep) {
        pair_normals(key, i, j, id.data(), normals);
        NoiseKey lots_key = key;
        lots_key.sweep |= 0x80;  // as in Lowe
        pair_uniforms(lots_key, i, j, id.data(), lots);
        for (std::size_t k = 0; k < pairs.count; ++k) {
            if (pairs.distance[k] >= acting->cutoff) continue;
            Json entry{
                {"stage", name}, {"pair", {id[pairs.i[k]], id[pairs.j[k]]}}, {"distance", pairs.distance[k]}};
            if (scene.thermostat_kT() > 0.0) entry["normal"] = normals[k];
            if (std::holds_alternative<Lowe>(stage) && acting->sweeps - sweep < 1.0)
                entry["uniform"] = lots[k];
            if (std::holds_alternative<Lowe>(stage)) entry["sweep"] = sweep;
            noise.push_back(entry);
        }
    }
}

// --- one case

template <int d>
Json state_json(Particles<d> const& particles) {
    auto const by_id = [&](auto const& field) {
        Json rows = Json::array();
        for (Eigen::Index p = 0; p < particles.size(); ++p)
            for (int axis = 0; axis < d; ++axis) rows[particles.id[p]][std::size_t(axis)] = field(p, axis);
        return rows;
    };
    return {{"position", by_id(particles.position)},
            {"velocity", by_id(particles.velocity)},
            {"image", by_id(particles.image)}};
}

template <int d>
void run_case(Json& result, Scene const& scene, Before const& state, PairOrder const& order) {
    auto simulation = build<d>(scene, {});
    for (Eigen::Index p = 0; p < simulation.particles.size(); ++p)
        for (int axis = 0; axis < d; ++axis) {
            auto const k = static_cast<std::size_t>(3 * p + axis);
            simulation.particles.position(p, axis) = state.position[k];
            simulation.particles.velocity(p, axis) = state.velocity[k];
        }
    simulation.step = state.step;
    simulation.time = double(state.step) * scene.time_step;
    Json initial = state_json(simulation.particles), first_noise = Json::array(), noise;
    for (std::size_t place = 0; place < scene.stages.size(); ++place) {
        auto& act = simulation.stages[place].act;
        act = [&, stage = scene.stages[place], plain = act](Simulation<d>& s, NoiseKey key) {
            if (std::holds_alternative<ModifiedVerlet>(stage) && !s.forces_valid()) {  // that a start needs
                NoiseKey first = key;
                first.sweep = 1;
                list_noise(first_noise, s, scene, stage, first);
            }
            bool const sequential =
                std::holds_alternative<Shardlow>(stage) || std::holds_alternative<Lowe>(stage);
            if (sequential && !order.empty()) put_in_order(s.pairs(), s.particles, order);
            plain(s, key);
            list_noise(noise, s, scene, stage, key);
        };
    }
    result["initial"] = initial;
    result["initial"]["time"] = simulation.time;
    result["steps"] = Json::array();
    for (int step = 0; step < steps; ++step) {
        noise = Json::array();
        simulation.advance();
        Json after{{"noise", noise}};
        after.update(state_json(simulation.particles));
        result["steps"].push_back(after);
    }
    result["initial"]["noise"] = first_noise;
}

// A case is a scene, a state and where the scheme comes from; a variant is the same with some keys changed.
Json answer(toml::table table, std::string const& id, std::vector<std::string> const& changes,
            TomlReader root, Search search, PairOrder const& order, std::string const& file) {
    std::string const where = fmt::format("{}: case {}", file, id);
    for (auto const& change : changes) override_key(table, change, where);
    TomlReader reader(table, "", where);
    std::string const source = reader.text("source", std::nullopt), name = reader.text("state", std::nullopt);
    auto const states = root.table("state");
    if (!states || !states->raw().contains(name))
        reader.fail("state", fmt::format("{} is not defined; allowed: a table [state.{}]", name, name));
    Before const state = read_state(*TomlReader(*states).table(name));
    table.erase("source");
    table.erase("state");
    table.erase("id");
    table.erase("variants");
    override_key(table, fmt::format("particles.number={}", state.position.size() / 3), file);
    std::ostringstream text;
    text << table;
    Scene scene = parse_scene(text.str(), where);
    if (scene.wall > 0.0) reader.fail("walls", "are given; allowed: no walls");
    for (std::size_t k = 0; k < state.position.size(); ++k)
        if (std::size_t const axis = k % 3;
            axis < scene.length.size() &&
            !(state.position[k] >= 0.0 && state.position[k] < scene.length[axis]))
            reader.fail("state", fmt::format("{} has a position outside of the box; allowed: inside", name));
    scene.search = search;

    std::ostringstream formatted;
    formatted << toml::json_formatter{table};
    Json parameters = Json::parse(formatted.str());
    Json result{{"id", id}, {"source", source}};
    result["mass"] = scene.mass;
    result["time_step"] = scene.time_step;
    for (auto const& [key, value] : parameters.items())
        if (key != "particles" && key != "time" && key != "pairs") result[key] = value;
    if (scene.dimension == 2)
        run_case<2>(result, scene, state, order);
    else
        run_case<3>(result, scene, state, order);
    return result;
}

// How many particles the largest state has.
std::size_t largest_state(toml::table const& document) {
    std::size_t most = 0;
    if (auto const* const states = document["state"].as_table())
        for (auto const& [name, state] : *states)
            if (auto const* const position = state.at_path("position").as_array())
                most = std::max(most, position->size() / 3);
    return most;
}

// --- functions of a pair, without motion

Json pair_functions() {
    double const exponent = 1.5;
    Json weight = Json::array(), update = Json::array(), potential = Json::array();
    for (double const x : {0.0, 0.1, 0.25, 0.5, 0.75, 0.9, 0.99, 1.0, 1.1}) {
        Json row{{"x", x}};
        for (auto const name : names<Weight::Kind>)
            row[std::string(name)] = weight_at({*value_of<Weight::Kind>(name), exponent}, x);
        weight.push_back(row);
    }
    for (double const mass : {1.0, 2.5})
        for (double const a : {0.0, 0.001, 0.1, 0.5, 1.0}) {
            Json row{{"a", a}, {"mass", mass}};
            for (auto const name : names<Scheme>) {
                double const A = update_a(*value_of<Scheme>(name), a);
                row[std::string(name)] = {{"A", A}, {"B", update_b(A, mass)}};
            }
            update.push_back(row);
        }
    Soft const soft{.strength = 25.0, .cutoff = 1.2};
    LennardJones const plain{.epsilon = 1.2, .sigma = 0.9, .cutoff = 2.25}, shifted{1.2, 0.9, 2.25, true};
    for (double const r : {0.1, 0.5, 0.9, 1.0, 1.1}) {
        Json row{{"r", r}};
        row["soft"] = {{"energy", soft.energy(r)}, {"force", soft.force(r)}};
        row["lennard_jones"] = {{"energy", plain.energy(r)}, {"force", plain.force(r)}};
        row["lennard_jones_shifted"] = {{"energy", shifted.energy(r)}, {"force", shifted.force(r)}};
        potential.push_back(row);
    }
    return {{"weight", weight},
            {"power", {{"exponent", exponent}}},
            {"update", update},
            {"soft", {{"strength", soft.strength}, {"cutoff", soft.cutoff}}},
            {"lennard_jones", {{"epsilon", plain.epsilon}, {"sigma", plain.sigma}, {"cutoff", plain.cutoff}}},
            {"potential", potential}};
}

// What fits goes on one line, `begin` characters of which are taken.
std::string layout(Json const& value, std::size_t indent = 0, std::size_t begin = 0) {
    constexpr std::size_t width = 140;
    std::string const line = value.dump();
    if (!value.is_structured() || begin + line.size() <= width) return line;
    std::string lines;
    for (auto const& [key, child] : value.items()) {
        std::string const name = value.is_object() ? fmt::format("\"{}\": ", key) : "";
        lines += fmt::format("{}\n{:{}}{}{}", lines.empty() ? "" : ",", "", indent + 1, name,
                             layout(child, indent + 1, indent + 1 + name.size()));
    }
    char const* const brackets = value.is_object() ? "{}" : "[]";
    return fmt::format("{}{}\n{:{}}{}", brackets[0], lines, "", indent, brackets[1]);
}

}  // namespace

PairOrder pair_order_from_text(std::string const& text, std::string const& origin) {
    std::string pairs = std::filesystem::is_regular_file(text) ? read_file(text) : text;
    std::ranges::replace(pairs, ',', ' ');
    std::istringstream words(pairs);
    PairOrder order;
    for (std::string word; words >> word;) {
        auto const refuse = [&](std::string_view problem) {
            throw InputError(fmt::format("{}: '{}' {}; allowed: pairs as 1-2,0-1,..., or a file of them",
                                         origin, word, problem));
        };
        std::uint32_t i = 0, j = 0;
        char const* const end = word.data() + word.size();
        auto const first = std::from_chars(word.data(), end, i);
        if (first.ec != std::errc{} || first.ptr == end || *first.ptr != '-') refuse("is no pair");
        auto const second = std::from_chars(first.ptr + 1, end, j);
        if (second.ec != std::errc{} || second.ptr != end || i == j) refuse("is no pair");
        if (std::ranges::find(order, sorted(i, j)) != order.end()) refuse("comes twice");
        order.push_back(sorted(i, j));
    }
    if (order.empty())
        throw InputError(
            fmt::format("{}: no pair; allowed: pairs as 1-2,0-1,..., or a file of them", origin));
    return order;
}

Json exact_answers(std::filesystem::path const& definition, Search search, PairOrder const& order) {
    std::string const file = definition.string();
    toml::table const document = parse_toml(read_file(definition), file);
    TomlReader root(document, "", file);
    if (!order.empty()) require_every_pair(order, largest_state(document));
    toml::table const common = root.has("scene") ? root.table("scene")->raw() : toml::table{};
    Json cases = Json::array();
    for (auto& reader : root.tables("case")) {
        std::string const id = reader.text("id", std::nullopt);
        toml::table table = common;
        for (auto const& [key, value] : reader.raw()) table.insert_or_assign(key, value);
        cases.push_back(answer(table, id, {}, root, search, order, file));
        auto variants = reader.table("variants");
        if (!variants) continue;
        for (auto const& [name, ignored] : variants->raw())
            cases.push_back(answer(table, fmt::format("{}-{}", id, name.str()),
                                   variants->texts(std::string(name.str()), std::nullopt), root, search,
                                   order, file));
    }
    root.has("state");
    root.finish();
    Json result{{"format", 1},
                {"documentation", "docs/exact.md"},
                {"sign", "a positive normal drives its pair apart"}};
    if (!order.empty()) result["order"] = order;
    result["functions"] = pair_functions();
    result["cases"] = cases;
    return result;
}

std::string exact_answers_text(Json const& answers) { return layout(answers) + "\n"; }

}  // namespace dpd
