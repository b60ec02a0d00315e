/// @file
/// Scenes for LAMMPS: an input deck that does and measures the same, from the same initial state. What is
/// exported and what is refused: docs/lammps.md.
#pragma once

#include <filesystem>
#include <string>

#include "scene.hpp"

namespace dpd {

/// The input deck of a scene, in the scene's units (LAMMPS: `units lj`). Throws InputError for what LAMMPS
/// cannot do, or does otherwise: one line that names the stage or key and what is allowed.
std::string lammps_deck(Scene const& scene);

/// Writes `in.dpdref` (the deck), `particles.data` (the state at step 0), `scene.toml` and `README` into a
/// directory that is new, empty, or holds an earlier export and what its deck writes. Throws InputError.
void export_lammps(Scene const& scene, std::filesystem::path const& directory);

}  // namespace dpd
