/// @file
/// Transport coefficients and profiles from what one run recorded.
#pragma once

#include <vector>

#include "sample.hpp"
#include "scene.hpp"
#include "statistics.hpp"

namespace dpd {

/// Slope of the mean-square displacement over the second half of its lags, over twice the number of
/// components.
double diffusion_from(Curve const& curve, Eigen::ArrayXd const& mean, int components);

/// Least-squares slope of the velocity profile over the imposed shear rate.
double relative_slope(Curve const& curve, Eigen::ArrayXd const& mean, double shear_rate);

/// kT in bins of y, one value per block: what flows, imposed or not, is not heat.
std::vector<Curve> temperature_profiles(Scene const& scene, std::vector<Record> const& records);

/// The shear viscosity of a fluid at rest, by Green-Kubo in Helfand's form.
Estimate green_kubo_viscosity(Scene const& scene, std::vector<Record> const& records);

}  // namespace dpd
