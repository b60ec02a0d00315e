/// @file
/// Reading a figure's definition, verification/ID/figure.toml; docs/figures.md has its keys.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "figure.hpp"

namespace dpd {

/// Reads verification/ID/figure.toml at a budget ("quick" or "paper"). InputError as for scenes.
/// `changes` ("table.key=value") count last, in every curve whose scene has the table; InputError if none
/// has, or if a curve varies that key. The caption names them.
Figure load_figure(std::filesystem::path const& verification, std::string const& id,
                   std::string const& budget, std::vector<std::string> const& changes = {});

/// Ids of the figures that `verification` holds, sorted.
std::vector<std::string> figure_ids(std::filesystem::path const& verification);

}  // namespace dpd
