/// @file
/// Errors against run time, from the first parts of finished runs.
#pragma once

#include <vector>

#include "figure.hpp"
#include "run_figure.hpp"

namespace dpd {

/// The first `fraction` of what was measured: of the samples of each series, of the blocks of each curve.
Record first_part(Record const& record, double fraction);

/// Every criterion that a value should equal, against the run time, from the first parts of the same runs.
std::vector<Convergence> converge(Figure const& planned, Results const& results);

/// State and floor of one criterion from its comparisons at the end of a part. The floor is
/// sqrt(max(0, rms deviation^2 - rms error^2)); its error takes points as independent and their noise as
/// normal. It is resolved if it exceeds twice its error, and the difference of the squares twice the standard
/// error that this would have without a floor.
Convergence convergence_of(std::vector<Comparison> const& comparisons, double seconds);

}  // namespace dpd
