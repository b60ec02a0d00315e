/// @file
/// Data and picture of a figure's errors against the run time.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "figure.hpp"

namespace dpd {

/// Writes the data; and the picture, where the definitions come with a convergence.gp.
void write_convergence(Figure const& figure, std::string const& budget, std::filesystem::path const& output);

/// What write_convergence left in `output`, of the criteria that the figure still has; nothing if it left
/// none.
std::vector<Convergence> load_convergence(Figure const& figure, std::filesystem::path const& output);

/// The picture alone, of data that are there.
void draw_convergence(Figure const& figure, std::string const& budget, std::filesystem::path const& output);

}  // namespace dpd
