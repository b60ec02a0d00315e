/// @file
/// Data, comparisons and pictures of a figure on disk.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "figure.hpp"

namespace dpd {

/// Writes data, comparisons, convergence and pictures of a figure to `output`; gnuplot draws, in the style of
/// the nearest style.gp above the figure's directory.
void write_figure(Figure const& figure, std::vector<Comparison> const& comparisons, std::string const& budget,
                  std::filesystem::path const& output);

/// The comparisons that write_figure left in `output`.
std::vector<Comparison> load_comparisons(std::filesystem::path const& output);

}  // namespace dpd
