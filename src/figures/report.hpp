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

/// Writes report.csv, report.json and report.md, the summary by kinds, of all comparisons to `output`, and
/// prints the table of those of the figures `ids` (of all where there are none) with the run times that
/// run_time.json in `output` and in its `quick` state. True if none that is printed disagrees.
bool report(std::vector<Comparison> const& comparisons, std::filesystem::path const& output,
            std::vector<std::string> const& ids = {});

}  // namespace dpd
