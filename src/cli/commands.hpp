/// @file
/// The subcommands of `dpdref`, one function each, in the order of `dpdref --help`.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dpd::cli {

inline constexpr int exit_done = 0, exit_disagrees = 1, exit_bad_input = 2, exit_diverged = 3,
                     exit_not_compared = 4, exit_interrupted = 130;

/// A subcommand, and what it does once the command line has been read; returns the exit code.
struct Command {
    CLI::App* subcommand = nullptr;  ///< that CLI11 has read
    std::function<int()> act;        ///< what it does; returns the exit code
};

// theory_commands.cpp
Command theory(CLI::App& app);
Command tune(CLI::App& app);
Command convert(CLI::App& app);

// scene_commands.cpp
Command run(CLI::App& app);
Command export_scene(CLI::App& app);

// campaign_commands.cpp
Command figure(CLI::App& app);
Command stability(CLI::App& app);
Command work_precision(CLI::App& app);
Command answers(CLI::App& app);
Command report(CLI::App& app);

// answer_commands.cpp
Command answer(CLI::App& app);
Command exact(CLI::App& app);
Command compare(CLI::App& app);

// shared by the families: options.cpp

/// "key=value" texts as pairs. InputError for a text without "=".
std::vector<std::pair<std::string, std::string>> split(std::vector<std::string> const& assignments);

/// A seed, 0 to 2^64-1. InputError for anything else: CLI11 would wrap a negative or too large one silently.
std::optional<std::uint64_t> read_seed(std::optional<std::string> const& text);

/// "1%" or "0.01" as 0.01; nothing for what is no relative error above 0 and below 1.
std::optional<double> relative_error(std::string number);

/// A file or directory of this project, as in "verification/answers": in the clone that the program was
/// started from, in the installed data, above the program (whose build is in its clone), or in the source of
/// its build. The place of the installed one if there is none.
std::string data_path(std::string const& name);

/// The path, which must be there; InputError names the option that says where else it is.
std::string const& present(std::string const& path, std::string_view option);

}  // namespace dpd::cli
