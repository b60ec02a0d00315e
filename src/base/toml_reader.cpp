#include "toml_reader.hpp"

#include <fmt/format.h>

#include <cmath>
#include <sstream>
#include <utility>

namespace dpd {

TomlReader::TomlReader(toml::table const& table, std::string path, std::string file)
    : table_(table), path_(std::move(path)), file_(std::move(file)) {}

bool TomlReader::has(std::string const& key) {
    known_.insert(key);
    return table_.contains(key);
}

double TomlReader::number(std::string const& key, std::optional<double> fallback, Allowed allowed) {
    toml::node const* const node = find(key, fallback.has_value(), allowed.text);
    if (!node) return *fallback;
    return checked_number(*node, key, allowed);
}

std::uint64_t TomlReader::integer(std::string const& key, std::optional<std::uint64_t> fallback,
                                  Allowed allowed) {
    toml::node const* const node = find(key, fallback.has_value(), allowed.text);
    if (!node) return *fallback;
    auto const value = node->value_exact<std::int64_t>();
    if (!value || !allowed.test(double(*value))) fail(*node, key, allowed.text);
    return static_cast<std::uint64_t>(*value);
}

bool TomlReader::boolean(std::string const& key, bool fallback) {
    toml::node const* const node = find(key, true, "true or false");
    if (!node) return fallback;
    if (!node->is_boolean()) fail(*node, key, "true or false");
    return **node->as_boolean();
}

std::string TomlReader::text(std::string const& key, std::optional<std::string> fallback,
                             std::span<std::string_view const> allowed) {
    std::string const choices = allowed.empty() ? "a string" : fmt::format("{}", fmt::join(allowed, ", "));
    toml::node const* const node = find(key, fallback.has_value(), choices);
    if (!node) return *fallback;
    auto const value = node->value_exact<std::string>();
    if (!value || (!allowed.empty() && std::find(allowed.begin(), allowed.end(), *value) == allowed.end()))
        fail(*node, key, choices);
    return *value;
}

std::vector<double> TomlReader::numbers(std::string const& key, std::optional<std::vector<double>> fallback,
                                        Allowed allowed) {
    toml::node const* const node =
        find(key, fallback.has_value(), fmt::format("a list, each {}", allowed.text));
    if (!node) return *fallback;
    if (!node->is_array()) fail(*node, key, fmt::format("a list, each {}", allowed.text));
    std::vector<double> values;
    for (auto const& element : *node->as_array()) values.push_back(checked_number(element, key, allowed));
    return values;
}

std::vector<std::string> TomlReader::texts(std::string const& key,
                                           std::optional<std::vector<std::string>> fallback,
                                           std::span<std::string_view const> allowed) {
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

std::optional<TomlReader> TomlReader::table(std::string const& key) {
    toml::node const* const node = find(key, true, "a table");
    if (!node) return std::nullopt;
    if (!node->is_table()) fail(*node, key, "a table");
    return TomlReader(*node->as_table(), path_ + key + ".", file_);
}

TomlReader TomlReader::required_table(std::string const& key) {
    find(key, false, fmt::format("a table [{}{}]", path_, key));
    return *table(key);
}

std::vector<TomlReader> TomlReader::tables(std::string const& key) {
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

void TomlReader::finish() const {
    for (auto const& [key, node] : table_)
        if (!known_.contains(std::string(key.str())))
            throw InputError(one_line(fmt::format("{}: {}{}: unknown key; allowed here: {}", where(node),
                                                  path_, key.str(), fmt::join(known_, ", "))));
}

void TomlReader::fail(std::string const& key, std::string_view problem) const {
    toml::node const* const node = table_.get(key);
    throw InputError(fmt::format("{}: {}{}: {}", where(node ? *node : table_), path_, key, problem));
}

toml::node const* TomlReader::find(std::string const& key, bool optional, std::string_view allowed) {
    known_.insert(key);
    toml::node const* const node = table_.get(key);
    if (!node && !optional)
        throw InputError(
            fmt::format("{}: {}{}: is missing; allowed: {}", where(table_), path_, key, allowed));
    return node;
}

double TomlReader::checked_number(toml::node const& node, std::string const& key, Allowed allowed) const {
    auto const value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value || !std::isfinite(*value) || !allowed.test(*value)) fail(node, key, allowed.text);
    return *value;
}

void TomlReader::fail(toml::node const& node, std::string const& key, std::string_view allowed) const {
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
    throw InputError(one_line(
        fmt::format("{}: {}{}: {} is not allowed; allowed: {}", where(node), path_, key, shown, allowed)));
}

std::string TomlReader::where(toml::node const& node) const {
    auto const& source = node.source();
    if (source.path && *source.path != file_) return *source.path;
    return source.begin.line ? fmt::format("{}:{}", file_, source.begin.line) : file_;
}

namespace {

// The parser and its tables call themselves for each dot of a key. (Brackets the parser counts itself.)
void check_depth(std::string const& text, std::string const& name) {
    constexpr int deepest = 1000;
    int line = 1, dots = 0;
    for (char const c : text) {
        if (c == '\n') ++line;
        if (c == '\n' || c == '=' || c == ',') dots = 0;
        if (c == '.' && ++dots > deepest)
            throw InputError(fmt::format("{}:{}: is nested more than {} levels deep", name, line, deepest));
    }
}

}  // namespace

toml::table parse_toml(std::string const& text, std::string const& name) {
    check_depth(text, name);
    try {
        return toml::parse(text, name);
    } catch (toml::parse_error const& error) {
        throw InputError(fmt::format("{}:{}: {}", name, error.source().begin.line, error.description()));
    }
}

namespace {

// A bare string as TOML writes it, so that parsing keeps where it came from.
std::string quoted(std::string const& text) {
    std::string result = "\"";
    for (char const c : text) {
        if (c == '"' || c == '\\')
            result += fmt::format("\\{}", c);
        else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            result += fmt::format("\\u{:04x}", c);
        else
            result += c;
    }
    return result + "\"";
}

// The value of an override as a table of one key, "value".
toml::table parse_value(std::string const& value, std::string const& name) {
    try {
        toml::table parsed = toml::parse("value = " + value, name);
        if (parsed.size() == 1) return parsed;
    } catch (toml::parse_error const&) {
        // not TOML: a bare string
    }
    return parse_toml("value = " + quoted(value), name);
}

}  // namespace

void override_key(toml::table& table, std::string const& assignment, std::string const& origin) {
    auto const equals = assignment.find('=');
    if (equals == std::string::npos || equals == 0)
        throw InputError(
            one_line(fmt::format("{} {}: not an assignment; allowed: table.key=value", origin, assignment)));
    std::string const path = assignment.substr(0, equals), value = assignment.substr(equals + 1);
    std::string const name = fmt::format("{} {}", origin, path);
    check_depth(path, name);
    toml::table parsed = parse_value(value, name);
    toml::table* target = &table;
    std::string key = path;
    for (auto dot = key.find('.'); dot != std::string::npos; dot = key.find('.')) {
        std::string const parent = key.substr(0, dot);
        if (!target->contains(parent)) {
            toml::table created = parse_value("{}", name);
            created.get("value")->as_table()->is_inline(false);  // written like a table of the file
            target->insert(parent, std::move(*created.get("value")));
        }
        toml::node* const child = target->get(parent);
        if (!child->is_table()) throw InputError(fmt::format("{}: {} is not a table", name, parent));
        target = child->as_table();
        key.erase(0, dot + 1);
    }
    target->insert_or_assign(key, std::move(*parsed.get("value")));
}

}  // namespace dpd
