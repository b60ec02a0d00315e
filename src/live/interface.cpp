// The C interface of running scenes and closed forms: what JavaScript calls. Texts come back as JSON.
#include <map>
#include <nlohmann/json.hpp>

#include "errors.hpp"
#include "live.hpp"
#include "theory/registry.hpp"

namespace {

using Json = nlohmann::ordered_json;

enum Status { running = 0, complete = 1, refused = 2, diverged = 3 };

std::map<int, std::unique_ptr<dpd::Live>> scenes;
std::string answer;           // of the last call that returned a text
std::vector<double> numbers;  // of the last call that returned numbers

std::vector<std::string> lines(char const* text) {
    std::vector<std::string> found;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);)
        if (!line.empty()) found.push_back(line);
    return found;
}

// What `action` returns; if it throws, a status, and the message is the answer.
template <class Action>
int guarded(Action&& action) {
    try {
        return action();
    } catch (dpd::Diverged const& error) {
        answer = error.what();
        return diverged;
    } catch (std::exception const& error) {
        answer = error.what();
        return refused;
    }
}

char const* said(Json const& json) {
    answer = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    return answer.c_str();
}

double const* listed(std::vector<double> values) {
    numbers = std::move(values);
    return numbers.data();
}

}  // namespace

extern "C" {

/// Begins a scene from TOML text with overrides, one a line. Returns its number, from 1 on; 0 if it is
/// refused, and live_message says why.
int live_begin(char const* text, char const* overrides) {
    int number = 0;
    guarded([&] {
        auto scene = dpd::Live::begin(text, lines(overrides));
        number = scenes.empty() ? 1 : scenes.rbegin()->first + 1;
        scenes[number] = std::move(scene);
        return running;
    });
    return number;
}

void live_end(int scene) { scenes.erase(scene); }

char const* live_message() { return answer.c_str(); }

/// Status; the text of a refusal or divergence is live_message.
int live_change(int scene, char const* overrides) {
    return guarded([&] {
        scenes.at(scene)->change(lines(overrides));
        return running;
    });
}

int live_advance(int scene, int steps) {
    return guarded([&] {
        auto& live = *scenes.at(scene);
        live.advance(static_cast<std::uint64_t>(steps));
        return live.complete() ? complete : running;
    });
}

int live_measure_again(int scene) {
    return guarded([&] {
        scenes.at(scene)->measure_again();
        return running;
    });
}

/// What the scene is and where it stands.
char const* live_state(int scene) {
    auto const& live = *scenes.at(scene);
    return said({{"dimension", live.scene().dimension},
                 {"particles", live.scene().particles + live.scene().wall_particles},
                 {"length", live.scene().length},
                 {"step", live.step()},
                 {"measured_steps", live.measured_steps()},
                 {"duration", live.scene().production_steps},
                 {"time", live.time()},
                 {"kT", live.kinetic_temperature()},
                 {"offset", live.offset()}});
}

/// particles x dimension numbers, by id; they stay until the next call that returns numbers.
double const* live_positions(int scene) { return listed(scenes.at(scene)->positions()); }
double const* live_velocities(int scene) { return listed(scenes.at(scene)->velocities()); }

/// {"quantity": [value, error, blocks], ...} of what was measured so far.
char const* live_quantities(int scene) {
    auto const& live = *scenes.at(scene);
    Json quantities = Json::object();
    for (auto const& q : dpd::analyze(live.scene(), {live.record()}))
        quantities[q.name] = {q.estimate.value, q.estimate.error, q.estimate.blocks};
    return said(quantities);
}

/// {"x": [...], "y": [...], "error": [...]} of a measured curve.
char const* live_curve(int scene, char const* name) {
    auto const& live = *scenes.at(scene);
    auto const curve = dpd::curve_of(live.scene(), {live.record()}, name);
    Json y = Json::array(), error = Json::array();
    for (auto const& estimate : curve.y) {
        y.push_back(estimate.value);
        error.push_back(estimate.error);
    }
    return said({{"x", curve.x}, {"y", y}, {"error", error}});
}

/// A closed form with its parts, {"value": ..., ...}, for "key=value" one a line; {"refused": why} where it
/// has none.
char const* live_theory(char const* id, char const* assignments) {
    std::vector<std::pair<std::string, std::string>> given;
    for (auto const& line : lines(assignments)) {
        auto const at = line.find('=');
        given.emplace_back(line.substr(0, at), at == std::string::npos ? "" : line.substr(at + 1));
    }
    Json result;
    int const status = guarded([&] {
        for (auto const& [name, value] : dpd::theory::evaluate_parts(id, given))
            result[std::string(name)] = value;
        return running;
    });
    return status == running ? said(result) : said({{"refused", std::string(answer)}});
}
}
