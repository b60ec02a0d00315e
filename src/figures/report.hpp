/// @file
/// The table of all comparisons, and the run time behind it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "figure.hpp"
#include "run_figure.hpp"

namespace dpd {

/// Writes the run time of all figures at a budget to `output`, for `report`.
void write_run_time(RunTime const& run_time, std::string const& budget, std::filesystem::path const& output);

/// Prints the table of comparisons, and the run times that run_time.json in `output` and in its `quick`
/// state, and writes report.csv, report.json and report.md, the summary by kinds, to `output`. True if none
/// disagrees.
bool report(std::vector<Comparison> const& comparisons, std::filesystem::path const& output);

}  // namespace dpd
