/// @file
/// A comparison as JSON, and back.
#pragma once

#include <nlohmann/json.hpp>

#include "figure.hpp"

namespace dpd {

nlohmann::ordered_json to_json(Comparison const& comparison);

/// Throws nlohmann::json::exception where a member is missing or of another kind, InputError for an unknown
/// relation.
Comparison comparison_from_json(nlohmann::ordered_json const& json);

}  // namespace dpd
