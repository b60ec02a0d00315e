/// @file
/// Data, comparisons and pictures of a figure on disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "figure.hpp"

namespace dpd {

/// Writes data, comparisons, convergence and pictures of a figure to `output`; gnuplot draws, in the style of
/// the nearest style.gp above the figure's directory.
void write_figure(Figure const& figure, std::vector<Comparison> const& comparisons, std::string const& budget,
                  std::filesystem::path const& output);

/// A figure on disk.
struct Written {
    std::string budget;                     ///< quick or paper
    std::uint64_t engine_revision = 0;      ///< that its runs were made with
    double seconds = 0.0;                   ///< run time of all its scenes, each counted once
    std::vector<Comparison> comparisons{};  ///< as they were judged
    std::string measured{};  ///< of its data file: all that was measured, compared or not, and positions
};

/// What write_figure left of one figure; InputError where there is none.
Written load_written(std::string const& id, std::filesystem::path const& output);

/// As write_figure, with what was measured taken from `written`. The convergence stays as it is.
void rewrite_figure(Figure const& definition, std::vector<Comparison> const& comparisons,
                    Written const& written, std::filesystem::path const& output);

/// The comparisons that write_figure left in `output`.
std::vector<Comparison> load_comparisons(std::filesystem::path const& output);

}  // namespace dpd
