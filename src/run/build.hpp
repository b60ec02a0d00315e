/// @file
/// From a scene to its simulation.
#pragma once

#include <functional>

#include "scene.hpp"
#include "simulation.hpp"

namespace dpd {

/// A simulation with the stage list that the scene names, at its initial state; `sample` (may be empty) is
/// what the stage of that name calls.
template <int d>
Simulation<d> build(Scene const& scene, std::function<void(Simulation<d>&)> sample);

}  // namespace dpd
