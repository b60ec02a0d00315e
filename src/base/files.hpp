/// @file
/// Files: read whole, written whole or not at all, found.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace dpd {

/// The text of a file. InputError if it cannot be read.
std::string read_file(std::filesystem::path const& file);

/// Writes beside the target and renames: the file is there whole or not at all. InputError if it cannot be.
void write_file(std::filesystem::path const& path, std::string const& content);

/// The nearest file of that name in the directory of `path` or above it, or nothing.
std::optional<std::filesystem::path> find_above(std::filesystem::path const& path, std::string const& name);

}  // namespace dpd
