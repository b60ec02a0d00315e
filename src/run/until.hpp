/// @file
/// A run that goes on until the errors of what it measures are small enough.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sample.hpp"
#include "scene.hpp"
#include "statistics.hpp"

namespace dpd {

/// An error from fewer blocks than this is not believed; curves have so many. Where a slow mode makes them
/// remember each other one less counts, however long the run.
inline constexpr std::size_t least_blocks = std::size_t(curve_blocks);

/// What a scene wants of one quantity, and what has been reached.
struct ErrorWanted {
    std::string quantity;  ///< its name
    double wanted = 0.0;   ///< relative error
    Estimate estimate;     ///< no blocks: not known yet
    /// Relative error; infinite until it can be believed.
    double error() const;
    /// Whether the error is small enough.
    bool reached() const { return error() <= wanted; }
    /// "viscosity 2.3 % (1 % wanted)"
    std::string text() const;
};

/// The errors that the scene wants, as a record has them.
std::vector<ErrorWanted> errors_wanted(Scene const& scene, Record const& record);

/// Whether a run is over after that step: at the last one, or with `until` after 1, 2, 4, ... times the
/// production steps if all errors are small enough then.
bool is_over(Scene const& scene, std::uint64_t step, Record const& record);

/// After how many steps all errors will be small enough, as the inverse root of the measured time lets
/// expect: the first at which that is looked at, and at most the last one.
std::uint64_t expected_steps(Scene const& scene, std::uint64_t step, std::vector<ErrorWanted> const& errors);

/// The error that is farthest from what is wanted, in words.
std::string progress_text(std::vector<ErrorWanted> const& errors);

/// InputError if the scene wants the error of what it does not measure; `empty` is its record before the run.
void check_errors_wanted(Scene const& scene, Record const& empty);

}  // namespace dpd
