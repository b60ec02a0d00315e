/// @file
/// A figure judged and drawn again from what is on disk, without a run.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "figure.hpp"

namespace dpd {

/// Takes the values that write_figure left in `output/data`, judges them by the criteria of the definition as
/// it is now, and writes and draws the figure again; its errors against run time are drawn only. Closed forms
/// are evaluated; InputError for any other criterion that is new, or where `output` has not the figure.
std::vector<Comparison> redraw_figure(Figure const& definition, std::filesystem::path const& output);

}  // namespace dpd
