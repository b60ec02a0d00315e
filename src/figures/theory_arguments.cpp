#include "theory_arguments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "theory/closed_forms.hpp"
#include "theory/registry.hpp"

namespace dpd {

TheoryArguments theory_arguments(Scene const& scene) {
    TheoryArguments arguments{{"d", fmt::format("{}", scene.dimension)},
                              {"n", argument(scene.density())},
                              {"m", argument(scene.mass)},
                              {"dt", argument(scene.time_step)},
                              {"kT", argument(scene.kT)}};
    // of a box that is no cube, the cube of the same volume
    arguments["box"] = argument(std::pow(scene.volume(), 1.0 / scene.dimension));
    StageSetting const setting = scene.stage_setting();
    for (AnyStage const& stage : scene.stages)
        std::visit([&](auto const& s) { s.set_arguments(arguments, setting); }, stage);
    if (auto const& map = scene.coarse_graining) {
        arguments["Nm"] = argument(map->atoms_per_particle);
        if (map->viscosity > 0.0) {
            arguments["eta"] = argument(map->viscosity);
            arguments["force_md"] = argument(map->force);
            arguments["L_md"] =
                argument(scene.channel_width() * theory::cutoff_radius({.Nm = map->atoms_per_particle}));
        }
    }
    return arguments;
}

double theory_value(std::string const& id, TheoryArguments const& arguments) {
    theory::ClosedForm const& form = *theory::find(id);
    std::vector<std::pair<std::string, std::string>> given;
    for (auto const& [name, text] : arguments) {
        auto const takes = [&wanted = name](auto const& names) {
            return std::find(names.begin(), names.end(), wanted) != names.end();
        };
        if (takes(form.parameters) || takes(form.without_effect)) given.emplace_back(name, text);
    }
    return theory::evaluate(id, given);
}

double theory_for(Scene const& scene, std::string const& id) {
    return theory_value(id, theory_arguments(scene));
}

std::optional<double> theory_or_nothing(Scene const& scene, std::string const& id) {
    try {
        return theory_for(scene, id);
    } catch (std::domain_error const&) {
        if (theory::find(id)->costly) return {};
        throw;
    }
}

}  // namespace dpd
