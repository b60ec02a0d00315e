/// @file
/// What a campaign may spend: the tables [budget.quick] and [budget.paper] of its definition.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <type_traits>

#include "toml_reader.hpp"

namespace dpd {

inline constexpr std::array<std::string_view, 2> budget_names{
    "quick", "paper"};  ///< for a look, and at the papers' fidelity

/// What `read(table)` makes of the table of that budget. Both tables are read, so that a mistake in either is
/// found whichever is asked for; `read` leaves `finish` to this function.
template <class Read>
auto read_budget(TomlReader& root, std::string const& budget, Read&& read) {
    std::invoke_result_t<Read&, TomlReader&> chosen{};
    auto tables = root.required_table("budget");
    for (auto const name : budget_names) {
        auto table = tables.required_table(std::string(name));
        auto its = read(table);
        table.finish();
        if (name == budget) chosen = std::move(its);
    }
    tables.finish();
    return chosen;
}

}  // namespace dpd
