#include <fmt/format.h>

#include <charconv>
#include <fstream>
#include <system_error>

#include "commands.hpp"
#include "errors.hpp"
#include "number.hpp"

namespace dpd::cli {

std::vector<std::pair<std::string, std::string>> split(std::vector<std::string> const& assignments) {
    std::vector<std::pair<std::string, std::string>> given;
    for (auto const& assignment : assignments) {
        auto const equals = assignment.find('=');
        if (equals == std::string::npos)
            throw InputError(fmt::format("{}: not an assignment; allowed: key=value", assignment));
        given.emplace_back(assignment.substr(0, equals), assignment.substr(equals + 1));
    }
    return given;
}

std::optional<std::uint64_t> read_seed(std::optional<std::string> const& text) {
    if (!text) return std::nullopt;
    std::uint64_t seed = 0;
    auto const [end, error] = std::from_chars(text->data(), text->data() + text->size(), seed);
    if (error != std::errc{} || end != text->data() + text->size())
        throw InputError(fmt::format("--seed: {} is not allowed; allowed: an integer, 0 to 2^64-1", *text));
    return seed;
}

std::optional<double> relative_error(std::string number) {
    bool const percent = number.ends_with('%');
    if (percent) number.pop_back();
    double const error = number_in(number).value_or(0.0) / (percent ? 100.0 : 1.0);
    if (!(error > 0.0 && error < 1.0)) return {};
    return error;
}

namespace {

// The source of a build tree; empty elsewhere.
std::filesystem::path source_of_build(std::filesystem::path const& tree) {
    std::ifstream cache(tree / "CMakeCache.txt");
    std::string const key = "CMAKE_HOME_DIRECTORY:INTERNAL=";
    for (std::string line; std::getline(cache, line);)
        if (line.starts_with(key)) return line.substr(key.size());
    return {};
}

// Empty: the folder in which the program was started.
std::filesystem::path find_data() {
    std::error_code ignored;
    auto const holds = [&](std::filesystem::path const& place) {
        // a build tree has a folder `verification`, too
        return std::filesystem::exists(place / "verification" / "integrators.toml", ignored);
    };
    std::filesystem::path const program =
        std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path();
    auto const installed = (program / DPDREF_DATA_DIR).lexically_normal();
    for (std::filesystem::path const& place : {std::filesystem::path(), installed})
        if (holds(place)) return place;
    for (auto above = program; above.has_relative_path(); above = above.parent_path())
        if (holds(above)) return above;
    auto const source = source_of_build(program);
    return !source.empty() && holds(source) ? source : installed;
}

}  // namespace

std::string data_path(std::string const& name) {
    static std::filesystem::path const place = find_data();
    return (place / name).string();
}

std::string const& present(std::string const& path, std::string_view option) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored))
        throw InputError(fmt::format("{}: is not there; allowed: {} with another place", path, option));
    return path;
}

}  // namespace dpd::cli
