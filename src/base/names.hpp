/// @file
/// Enumerations by the names of their values.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace dpd {

/// How many values an enumeration has. They count from 0, and each has a name: beside the enumeration stands
/// `constexpr std::string_view name_of(Enum)`, a switch over its values, so that a value without a name does
/// not compile without a warning, and empty for what is no value.
template <class Enum>
constexpr std::size_t count_of() {
    std::size_t count = 0;
    while (!name_of(static_cast<Enum>(count)).empty()) ++count;
    return count;
}

/// The names of an enumeration, in the order of its values.
template <class Enum>
inline constexpr auto names = [] {
    std::array<std::string_view, count_of<Enum>()> list;
    for (std::size_t value = 0; value < list.size(); ++value) list[value] = name_of(static_cast<Enum>(value));
    return list;
}();

/// The names of an enumeration in one text, for messages: "constant, linear, ...".
template <class Enum>
std::string name_list() {
    std::string list;
    for (auto const name : names<Enum>) list.append(list.empty() ? "" : ", ").append(name);
    return list;
}

/// The value of that name, or nothing.
template <class Enum>
constexpr std::optional<Enum> value_of(std::string_view name) {
    for (std::size_t value = 0; value < names<Enum>.size(); ++value)
        if (names<Enum>[value] == name) return static_cast<Enum>(value);
    return std::nullopt;
}

/// Calls `f.operator()<value>()`, so that an inner loop is compiled once per value of the enumeration.
template <class Enum, std::size_t candidate = 0, class F>
decltype(auto) with_value(Enum value, F&& f) {
    if constexpr (candidate + 1 < count_of<Enum>())
        if (static_cast<std::size_t>(value) != candidate) return with_value<Enum, candidate + 1>(value, f);
    return f.template operator()<static_cast<Enum>(candidate)>();
}

}  // namespace dpd
