/// @file
/// Pictures that gnuplot draws.
#pragma once

#include <filesystem>
#include <string>

namespace dpd {

/// A string of gnuplot's.
std::string quoted(std::string const& plain);

/// Draws `stem`.svg and, 1.4 times as large, `stem`.png by the script `plot`, which finds `definitions`,
/// `caption_size` and the nearest style.gp above it. Size in pixels of the svg. InputError if gnuplot fails,
/// whose messages are then kept.
void draw(std::filesystem::path const& stem, std::filesystem::path const& plot,
          std::string const& definitions, int width = 800, int height = 800);

}  // namespace dpd
