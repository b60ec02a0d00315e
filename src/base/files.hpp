/// @file
/// Files: read whole, written whole or not at all, found, locked.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace dpd {

/// The text of a regular file or of a pipe. InputError if it is neither, or cannot be read.
std::string read_file(std::filesystem::path const& file);

/// Writes beside the target, waits until the disk has it, and renames: the file is there whole or not at all.
/// InputError if it cannot be, or if something that is no regular file has that name; nothing is then left.
void write_file(std::filesystem::path const& path, std::string_view content);

/// Puts `temporary`, which is complete, in the place of `path`, once the disk has it. InputError if it cannot
/// be; it is then removed.
void put_in_place(std::filesystem::path const& temporary, std::filesystem::path const& path);

/// Renames a file that cannot be used, so that nothing is lost; returns its new name, `path`.damaged.
std::filesystem::path move_aside(std::filesystem::path const& path);

/// The nearest file of that name in the directory of `path` or above it, or nothing.
std::optional<std::filesystem::path> find_above(std::filesystem::path const& path, std::string const& name);

/// CRC-64 (ECMA-182) of some bytes.
std::uint64_t digest(std::string_view bytes);

/// While it lives, no other process and no other thread has the lock of that file, `path`.lock. Where the
/// file system knows no locks there is none.
class FileLock {
public:
    /// Waits for the lock, asking `stopped` now and then; says once per process that it waits. Interrupted if
    /// stopped meanwhile.
    FileLock(std::filesystem::path const& path, std::function<bool()> const& stopped);
    ~FileLock();
    FileLock(FileLock const&) = delete;
    FileLock& operator=(FileLock const&) = delete;

private:
    std::filesystem::path path_;
    int descriptor_ = -1;
};

}  // namespace dpd
