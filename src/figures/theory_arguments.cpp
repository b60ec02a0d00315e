#include "theory_arguments.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "theory/closed_forms.hpp"
#include "theory/registry.hpp"

namespace dpd {

std::map<std::string, std::string> theory_arguments(Scene const& scene) {
    auto const text = [](double value) { return fmt::format("{}", value); };
    std::map<std::string, std::string> arguments{{"d", fmt::format("{}", scene.dimension)},
                                                 {"n", text(scene.density())},
                                                 {"m", text(scene.mass)},
                                                 {"dt", text(scene.time_step)},
                                                 {"kT", text(scene.kT)}};
    if (scene.has_stage("shardlow")) {
        arguments["gamma"] = text(scene.shardlow.friction);
        arguments["rc"] = text(scene.shardlow.cutoff);
        arguments["kT"] = text(scene.shardlow.kT);
        arguments["weight"] = name_of(scene.shardlow.weight);
        arguments["scheme"] = name_of(scene.shardlow.scheme);
    }
    if (scene.has_stage("lowe")) {
        arguments["Gamma"] = text(scene.lowe.rate);
        arguments["rc"] = text(scene.lowe.cutoff);
        arguments["kT"] = text(scene.lowe.kT);
    }
    if (scene.has_stage("modified_verlet")) {
        arguments["gamma"] = text(scene.modified_verlet.gamma);
        arguments["sigma"] = text(scene.modified_verlet.sigma);
        arguments["rc"] = text(scene.modified_verlet.cutoff);
        arguments["kT"] = text(scene.thermostat_kT());
        arguments["weight"] = name_of(scene.modified_verlet.weight);
    }
    if (auto const* const soft = std::get_if<Soft>(&scene.potential); soft && scene.has_potential())
        arguments["a"] = text(soft->strength / soft->cutoff);
    if (auto const& map = scene.coarse_graining) {
        arguments["Nm"] = text(map->atoms_per_particle);
        if (map->viscosity > 0.0) {
            arguments["eta"] = text(map->viscosity);
            arguments["force_md"] = text(map->force);
            arguments["L_md"] =
                text(scene.channel_width() * theory::cutoff_radius({.Nm = map->atoms_per_particle}));
        }
    }
    if (scene.has_stage("rescale")) arguments["kT"] = text(scene.rescale.kT);
    if (scene.has_stage("euler")) {
        // what eq. 22 calls n is, for N particles, (N-1)(N-2)/V^2 over (N-1)/V: theory/MY1997.md
        arguments["n"] = text((double(scene.particles) - 2.0) / scene.volume());
        arguments["gamma"] = text(scene.euler.gamma);
        arguments["sigma"] = text(scene.euler.sigma);
        arguments["rc"] = text(scene.euler.cutoff);
        arguments["weight"] = name_of(scene.euler.weight);
        if (scene.euler.random_weight) arguments["random_weight"] = name_of(*scene.euler.random_weight);
    }
    return arguments;
}

double theory_value(std::string const& id, std::map<std::string, std::string> const& arguments) {
    theory::ClosedForm const& form = *theory::find(id);
    std::vector<std::pair<std::string, std::string>> given;
    for (auto const& [name, text] : arguments) {
        auto const takes = [&name = name](auto const& names) {
            return std::find(names.begin(), names.end(), name) != names.end();
        };
        if (takes(form.parameters) || takes(form.without_effect)) given.emplace_back(name, text);
    }
    return theory::evaluate(id, given);
}

double theory_for(Scene const& scene, std::string const& id) {
    return theory_value(id, theory_arguments(scene));
}

}  // namespace dpd
