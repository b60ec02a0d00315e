/// @file
/// Data and picture of a figure's errors against the run time.
#pragma once

#include <filesystem>
#include <string>

#include "figure.hpp"

namespace dpd {

/// Writes the data; and the picture, where the definitions come with a convergence.gp.
void write_convergence(Figure const& figure, std::string const& budget, std::filesystem::path const& output);

}  // namespace dpd
