/// @file
/// The memory that a scene's run will need, known before it is taken.
#pragma once

#include "scene.hpp"
#include "toml_reader.hpp"

namespace dpd {

/// InputError, with the key and the bytes, if a part of the run alone needs more memory than the machine, or
/// the limit of the process, has: particles and their pairs, cells of the search, time origins and lags,
/// samples.
void check_size(Scene const& scene, TomlReader& root);

}  // namespace dpd
