/// @file
/// From the records of independent runs to estimates.
#pragma once

#include <string>
#include <vector>

#include "sample.hpp"
#include "statistics.hpp"

namespace dpd {

/// The series of that name, one per run that has it.
std::vector<std::vector<double>> series_of(std::vector<Record> const& records, std::string const& name);

/// The curves of that name, one per run that has it.
std::vector<Curve const*> curves_of(std::vector<Record> const& records, std::string const& name);

/// Evaluates `f(curve, means)` for each block of each curve, where means[bin] is the block's mean in that
/// bin, and pools the runs.
template <class F>
Estimate by_block(std::vector<Curve const*> const& curves, F&& f) {
    std::vector<std::vector<double>> runs;
    for (auto const* curve : curves) {
        auto& values = runs.emplace_back();
        for (Eigen::Index block = 0; block < curve->sum.cols(); ++block) {
            if ((curve->weight.col(block) == 0.0).any()) continue;
            values.push_back(f(*curve, (curve->sum.col(block) / curve->weight.col(block)).eval()));
        }
    }
    return pool(runs);
}

/// Ratio of the means of two series sampled together; the error is that of numerator - ratio*denominator.
Estimate ratio_of(std::vector<std::vector<double>> numerator,
                  std::vector<std::vector<double>> const& denominator);

}  // namespace dpd
