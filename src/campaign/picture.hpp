/// @file
/// Files that are written whole, and pictures that gnuplot draws.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace dpd {

/// Writes beside the target and renames: the file is there whole or not at all. InputError if it cannot be.
void write_file(std::filesystem::path const& path, std::string const& content);

/// A string of gnuplot's.
std::string quoted(std::string const& plain);

/// The nearest file of that name in the directory of `path` or above it, or nothing.
std::optional<std::filesystem::path> find_above(std::filesystem::path const& path, std::string const& name);

/// Draws `stem`.svg and, 1.4 times as large, `stem`.png by the script `plot`, which finds `definitions`,
/// `caption_size` and the nearest style.gp above it. Size in pixels of the svg. InputError if gnuplot fails,
/// whose messages are then kept.
void draw(std::filesystem::path const& stem, std::filesystem::path const& plot,
          std::string const& definitions, int width = 800, int height = 800);

}  // namespace dpd
