/// @file
/// Closed forms for the parameters of a scene.
#pragma once

#include <optional>
#include <string>

#include "scene.hpp"

namespace dpd {

/// The closed forms' parameters, by the names of the command line, as a scene has them.
TheoryArguments theory_arguments(Scene const& scene);

/// Value of a closed form, which takes from `arguments` what it depends on.
double theory_value(std::string const& id, TheoryArguments const& arguments);

/// Value of a closed form for the parameters of a scene.
double theory_for(Scene const& scene, std::string const& id);

/// The same; nothing where theory with memory, which is drawn as far as it goes, has no answer.
std::optional<double> theory_or_nothing(Scene const& scene, std::string const& id);

}  // namespace dpd
