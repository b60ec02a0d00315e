/// @file
/// Reading TOML tables so that every mistake gets one line: where, which key, what is allowed.
#pragma once

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "errors.hpp"
#include "names.hpp"

namespace dpd {

/// What a number may be, and how to say so.
struct Allowed {
    bool (*test)(double);
    std::string_view text;
};
inline constexpr Allowed positive{[](double x) { return x > 0.0; }, "a number > 0"};
inline constexpr Allowed non_negative{[](double x) { return x >= 0.0; }, "a number >= 0"};
inline constexpr Allowed any_number{[](double) { return true; }, "a finite number"};
inline constexpr Allowed positive_integer{[](double x) { return x >= 1.0; }, "an integer >= 1"};
inline constexpr Allowed non_negative_integer{[](double x) { return x >= 0.0; }, "an integer >= 0"};

/// The text on one line, for messages: line breaks become spaces.
inline std::string one_line(std::string text) {
    for (char& c : text)
        if (c == '\n' || c == '\r') c = ' ';
    return text;
}

/// A table whose keys are read one by one; `finish` complains about those that nothing has asked for.
class TomlReader {
public:
    TomlReader(toml::table const& table, std::string path, std::string file)
        : table_(table), path_(std::move(path)), file_(std::move(file)) {}

    bool has(std::string const& key) {
        known_.insert(key);
        return table_.contains(key);
    }

    double number(std::string const& key, std::optional<double> fallback, Allowed allowed) {
        toml::node const* const node = find(key, fallback.has_value(), allowed.text);
        if (!node) return *fallback;
        return checked_number(*node, key, allowed);
    }

    std::uint64_t integer(std::string const& key, std::optional<std::uint64_t> fallback, Allowed allowed) {
        toml::node const* const node = find(key, fallback.has_value(), allowed.text);
        if (!node) return *fallback;
        auto const value = node->value_exact<std::int64_t>();
        if (!value || !allowed.test(double(*value))) fail(*node, key, allowed.text);
        return static_cast<std::uint64_t>(*value);
    }

    bool boolean(std::string const& key, bool fallback) {
        toml::node const* const node = find(key, true, "true or false");
        if (!node) return fallback;
        if (!node->is_boolean()) fail(*node, key, "true or false");
        return **node->as_boolean();
    }

    std::string text(std::string const& key, std::optional<std::string> fallback,
                     std::span<std::string_view const> allowed = {}) {
        std::string const choices =
            allowed.empty() ? "a string" : fmt::format("{}", fmt::join(allowed, ", "));
        toml::node const* const node = find(key, fallback.has_value(), choices);
        if (!node) return *fallback;
        auto const value = node->value_exact<std::string>();
        if (!value ||
            (!allowed.empty() && std::find(allowed.begin(), allowed.end(), *value) == allowed.end()))
            fail(*node, key, choices);
        return *value;
    }

    /// A value of an enumeration, by its name.
    template <class Enum>
    Enum choice(std::string const& key, std::optional<std::string> fallback) {
        return *value_of<Enum>(text(key, std::move(fallback), names<Enum>));
    }

    /// An enumeration by its names, in the order of its values.
    template <class Enum>
    Enum choice(std::string const& key, std::optional<std::string> fallback,
                std::span<std::string_view const> names) {
        auto const chosen = std::find(names.begin(), names.end(), text(key, std::move(fallback), names));
        return static_cast<Enum>(chosen - names.begin());
    }

    std::vector<double> numbers(std::string const& key, std::optional<std::vector<double>> fallback,
                                Allowed allowed) {
        toml::node const* const node =
            find(key, fallback.has_value(), fmt::format("a list, each {}", allowed.text));
        if (!node) return *fallback;
        if (!node->is_array()) fail(*node, key, fmt::format("a list, each {}", allowed.text));
        std::vector<double> values;
        for (auto const& element : *node->as_array()) values.push_back(checked_number(element, key, allowed));
        return values;
    }

    std::vector<std::string> texts(std::string const& key, std::optional<std::vector<std::string>> fallback,
                                   std::span<std::string_view const> allowed = {}) {
        std::string const choices =
            allowed.empty() ? "a list of strings" : fmt::format("a list of {}", fmt::join(allowed, ", "));
        toml::node const* const node = find(key, fallback.has_value(), choices);
        if (!node) return *fallback;
        if (!node->is_array()) fail(*node, key, choices);
        std::vector<std::string> values;
        for (auto const& element : *node->as_array()) {
            auto const value = element.value_exact<std::string>();
            if (!value ||
                (!allowed.empty() && std::find(allowed.begin(), allowed.end(), *value) == allowed.end()))
                fail(element, key, choices);
            values.push_back(*value);
        }
        return values;
    }

    /// A sub-table; nothing if it is not there.
    std::optional<TomlReader> table(std::string const& key) {
        toml::node const* const node = find(key, true, "a table");
        if (!node) return std::nullopt;
        if (!node->is_table()) fail(*node, key, "a table");
        return TomlReader(*node->as_table(), path_ + key + ".", file_);
    }

    /// A sub-table that must be there.
    TomlReader required_table(std::string const& key) {
        find(key, false, fmt::format("a table [{}{}]", path_, key));
        return *table(key);
    }

    /// All tables of an array of tables; empty if it is not there.
    std::vector<TomlReader> tables(std::string const& key) {
        std::vector<TomlReader> list;
        toml::node const* const node = find(key, true, "tables [[...]]");
        if (!node) return list;
        if (!node->is_array()) fail(*node, key, "tables [[...]]");
        for (auto const& element : *node->as_array()) {
            if (!element.is_table()) fail(element, key, "tables [[...]]");
            list.emplace_back(*element.as_table(), path_ + key + ".", file_);
        }
        return list;
    }

    toml::table const& raw() const { return table_; }

    void finish() const {
        for (auto const& [key, node] : table_)
            if (!known_.contains(std::string(key.str())))
                throw InputError(one_line(fmt::format("{}: {}{}: unknown key; allowed here: {}", where(node),
                                                      path_, key.str(), fmt::join(known_, ", "))));
    }

    [[noreturn]] void fail(std::string const& key, std::string_view problem) const {
        toml::node const* const node = table_.get(key);
        throw InputError(fmt::format("{}: {}{}: {}", where(node ? *node : table_), path_, key, problem));
    }

private:
    toml::node const* find(std::string const& key, bool optional, std::string_view allowed) {
        known_.insert(key);
        toml::node const* const node = table_.get(key);
        if (!node && !optional)
            throw InputError(
                fmt::format("{}: {}{}: is missing; allowed: {}", where(table_), path_, key, allowed));
        return node;
    }

    double checked_number(toml::node const& node, std::string const& key, Allowed allowed) const {
        auto const value = node.is_number() ? node.value<double>() : std::nullopt;
        if (!value || !std::isfinite(*value) || !allowed.test(*value)) fail(node, key, allowed.text);
        return *value;
    }

    [[noreturn]] void fail(toml::node const& node, std::string const& key, std::string_view allowed) const {
        std::string shown = "this";
        node.visit([&](auto const& element) {
            if constexpr (toml::is_value<decltype(element)>) {
                std::ostringstream stream;
                stream << element;
                shown = stream.str();
            } else if constexpr (toml::is_array<decltype(element)>) {
                shown = "a list";
            } else {
                shown = "a table";
            }
        });
        throw InputError(one_line(fmt::format("{}: {}{}: {} is not allowed; allowed: {}", where(node), path_,
                                              key, shown, allowed)));
    }

    std::string where(toml::node const& node) const {
        auto const& source = node.source();
        if (source.path && *source.path != file_) return *source.path;
        return source.begin.line ? fmt::format("{}:{}", file_, source.begin.line) : file_;
    }

    toml::table const& table_;
    std::string path_;
    std::string file_;
    std::set<std::string> known_;
};

/// Parses TOML; a syntax error becomes an InputError with file and line.
toml::table parse_toml(std::string const& text, std::string const& name);

/// The text of a file. InputError if it cannot be read.
std::string read_file(std::filesystem::path const& file);

/// Applies "table.key=value" to a table. The value is TOML, or else taken as a string.
void override_key(toml::table& table, std::string const& assignment, std::string const& origin);

}  // namespace dpd
