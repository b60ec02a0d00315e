/// @file
/// Transport coefficients and profiles from what one run recorded.
#pragma once

#include <vector>

#include "sample.hpp"
#include "scene.hpp"
#include "statistics.hpp"

namespace dpd {

/// Half the slope of the mean-square displacement over the second half of its lags, per component. Blocks are
/// joined until each has as many origins as fit into the longest lag, and the error allows for what the
/// displacements of neighbours still share. It is NaN where the runs are too short for two such blocks.
Estimate diffusion_constant(Scene const& scene, std::vector<Record> const& records);

/// Least-squares slope of the velocity profile over the imposed shear rate.
double relative_slope(Curve const& curve, Eigen::ArrayXd const& mean, double shear_rate);

/// An estimate from the profile of the velocity whose fluctuations vanish, or repeat with the other sign,
/// `width` apart: the blocks of short runs share the shear mode, which lives for n m width^2/(pi^2 eta), and
/// the error allows for that.
Estimate of_profile(Scene const& scene, std::vector<Record> const& records, double width, double viscosity,
                    Estimate const& of_blocks);

/// kT in bins of y, one value per block: what flows, imposed or not, is not heat.
std::vector<Curve> temperature_profiles(Scene const& scene, std::vector<Record> const& records);

/// The shear viscosity of a fluid at rest, by Green-Kubo in Helfand's form.
Estimate green_kubo_viscosity(Scene const& scene, std::vector<Record> const& records);

}  // namespace dpd
