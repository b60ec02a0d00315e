/// @file
/// Reading TOML tables so that every mistake gets one line: where, which key, what is allowed.
#pragma once

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "errors.hpp"
#include "names.hpp"

namespace dpd {

/// What a number may be, and how to say so.
struct Allowed {
    bool (*test)(double);   ///< whether the number may be
    std::string_view text;  ///< what may be, for messages
};
inline constexpr Allowed positive{[](double x) { return x > 0.0; }, "a number > 0"};
inline constexpr Allowed non_negative{[](double x) { return x >= 0.0; }, "a number >= 0"};
inline constexpr Allowed any_number{[](double) { return true; }, "a finite number"};
inline constexpr Allowed positive_integer{[](double x) { return x >= 1.0; }, "an integer >= 1"};
inline constexpr Allowed non_negative_integer{[](double x) { return x >= 0.0; }, "an integer >= 0"};

/// A table whose keys are read one by one; `finish` complains about those that nothing has asked for.
class TomlReader {
public:
    /// The table at `path` (dots between the tables) of `file`, as messages name them.
    TomlReader(toml::table const& table, std::string path, std::string file);

    /// Whether the key is there; counts as asking for it.
    bool has(std::string const& key);
    /// A finite number; without a fallback it must be there. InputError, as of all below, says what is
    /// allowed.
    double number(std::string const& key, std::optional<double> fallback, Allowed allowed);
    /// A whole number.
    std::uint64_t integer(std::string const& key, std::optional<std::uint64_t> fallback, Allowed allowed);
    /// true or false.
    bool boolean(std::string const& key, bool fallback);
    /// A text, one of `allowed` if that is not empty.
    std::string text(std::string const& key, std::optional<std::string> fallback,
                     std::span<std::string_view const> allowed = {});

    /// A value of an enumeration, by its name.
    template <class Enum>
    Enum choice(std::string const& key, std::optional<std::string> fallback) {
        return *value_of<Enum>(text(key, std::move(fallback), names<Enum>));
    }

    /// A list of numbers, each allowed.
    std::vector<double> numbers(std::string const& key, std::optional<std::vector<double>> fallback,
                                Allowed allowed);
    /// A list of texts, each one of `allowed` if that is not empty.
    std::vector<std::string> texts(std::string const& key, std::optional<std::vector<std::string>> fallback,
                                   std::span<std::string_view const> allowed = {});

    /// A sub-table; nothing if it is not there.
    std::optional<TomlReader> table(std::string const& key);

    /// A sub-table that must be there.
    TomlReader required_table(std::string const& key);

    /// All tables of an array of tables; empty if it is not there.
    std::vector<TomlReader> tables(std::string const& key);

    /// The table as toml++ has it.
    toml::table const& raw() const { return table_; }

    /// InputError for a key that nothing has asked for.
    void finish() const;

    /// InputError: where the key stands, its name, the problem.
    [[noreturn]] void fail(std::string const& key, std::string_view problem) const;

private:
    toml::node const* find(std::string const& key, bool optional, std::string_view allowed);
    double checked_number(toml::node const& node, std::string const& key, Allowed allowed) const;
    [[noreturn]] void fail(toml::node const& node, std::string const& key, std::string_view allowed) const;
    std::string where(toml::node const& node) const;

    toml::table const& table_;
    std::string path_;
    std::string file_;
    std::set<std::string> known_;
};

/// Parses TOML; a syntax error becomes an InputError with file and line.
toml::table parse_toml(std::string const& text, std::string const& name);

/// Applies "table.key=value" to a table. The value is TOML, or else taken as a string.
void override_key(toml::table& table, std::string const& assignment, std::string const& origin);

}  // namespace dpd
