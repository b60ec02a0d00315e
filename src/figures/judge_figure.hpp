/// @file
/// Comparing what a figure's points measured with its criteria, and the verdicts.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "figure.hpp"
#include "statistics.hpp"

namespace dpd {

/// Compares every point of a figure with its criteria. InputError for a quantity that was not measured.
std::vector<Comparison> compare(Figure const& figure);

/// Point p against one criterion, as `compare` does; nothing where it needs a point before and there is none.
std::optional<Comparison> compare_point(Figure const& figure, std::size_t p, Criterion const& criterion);

/// Probability that any comparison of a report disagrees by chance although all are true.
inline constexpr double family_false_alarm = 0.01;

/// Verdict of one among `family` comparisons.
Verdict judge(Comparison const& comparison, std::size_t family);

/// Seconds more that would decide an undecided comparison.
double seconds_to_decide(Comparison const& comparison, std::size_t family);

}  // namespace dpd
