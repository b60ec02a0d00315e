#include <fmt/format.h>

#include <charconv>

#include "commands.hpp"
#include "errors.hpp"

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
    double error = 0.0;
    auto const [end, problem] = std::from_chars(number.data(), number.data() + number.size(), error);
    if (percent) error /= 100.0;
    if (problem != std::errc{} || end != number.data() + number.size() || !(error > 0.0 && error < 1.0))
        return {};
    return error;
}

std::string data_path(std::string const& name) {
    std::filesystem::path directory = ".";
    if (!std::filesystem::is_directory("verification")) {
        std::error_code ignored;
        auto const program = std::filesystem::read_symlink("/proc/self/exe", ignored);
        directory = (program.parent_path() / DPDREF_DATA_DIR).lexically_normal();
    }
    return (directory / name).lexically_normal().string();
}

}  // namespace dpd::cli
