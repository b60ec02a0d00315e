/// @file
/// Pictures that gnuplot draws.
#pragma once

#include <filesystem>
#include <string>

namespace dpd {

/// A text as a string of gnuplot's, in which gnuplot finds nothing to expand or to execute.
std::string quoted(std::string const& plain);

/// The same of a path, in full: gnuplot takes a name that begins with < or | for a command.
std::string quoted_path(std::filesystem::path const& path);

/// Draws `stem`.svg and, 1.4 times as large, `stem`.png by the script `plot`, which finds `definitions`,
/// `caption_size` and the nearest style.gp above it. Size in pixels of the svg. InputError if gnuplot fails,
/// whose messages are then kept. The pictures are there whole or not at all.
void draw(std::filesystem::path const& stem, std::filesystem::path const& plot,
          std::string const& definitions, int width = 800, int height = 800);

}  // namespace dpd
