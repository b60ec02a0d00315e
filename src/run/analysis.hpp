/// @file
/// From records to measured numbers and curves.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "sample.hpp"
#include "scene.hpp"
#include "statistics.hpp"

namespace dpd {

/// One measured number.
struct Quantity {
    std::string name;   ///< of the quantity
    Estimate estimate;  ///< value, error, blocks
};

/// Takes a measured number where it is known.
using AddQuantity = std::function<void(std::string, Estimate)>;

/// The numbers that a scene's records give; several records are independent runs of it.
std::vector<Quantity> analyze(Scene const& scene, std::vector<Record> const& records);

/// A measured function: one estimate per bin.
struct CurveEstimate {
    std::vector<double> x;    ///< of the points
    std::vector<Estimate> y;  ///< at each x
};

/// The curve of that name; also "temperature_profile", and "channel_profile": the velocity across one
/// channel, in the atoms' units where coarse_graining gives the viscosity. Empty if the scene does not
/// measure it. Per component for the velocity autocorrelation.
CurveEstimate curve_of(Scene const& scene, std::vector<Record> const& records, std::string const& name);

/// The quantity of that name, or nothing.
Quantity const* find_quantity(std::vector<Quantity> const& quantities, std::string_view name);

}  // namespace dpd
