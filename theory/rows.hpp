/// @file
/// Rows of the registry: each paper's are beside its closed forms.
#pragma once

#include <initializer_list>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "registry.hpp"

namespace dpd::theory {

std::vector<ClosedForm> my1997_rows();
std::vector<ClosedForm> ng2007_rows();
std::vector<ClosedForm> pk2006_rows();
std::vector<ClosedForm> lennard_jones_rows();
std::vector<ClosedForm> hydrodynamics_rows();
std::vector<ClosedForm> harmonic_rows();
std::vector<ClosedForm> memory_rows();

/// Groups of rows, one after the other.
std::vector<ClosedForm> joined(std::initializer_list<std::vector<ClosedForm>> groups);

/// Defaults of a form that differ from those of its parameters.
using Defaults = std::vector<std::pair<std::string_view, std::optional<std::string_view>>>;

/// A quantity of the gas that the equation does not use may be any positive number.
inline constexpr double unused = 1.0;

inline Gas gas(Arguments const& a, double n, double m, double kT) {
    return {.d = a.d(), .n = n, .m = m, .kT = kT, .rc = a["rc"]};
}

}  // namespace dpd::theory
