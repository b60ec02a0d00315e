/// @file
/// Running a figure's scenes, and what its points measured.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "campaign.hpp"
#include "figure.hpp"
#include "run.hpp"

namespace dpd {

/// What the runs of a campaign took, each run counted once, whenever it was done.
struct RunTime {
    std::size_t runs = 0;  ///< how many
    double seconds = 0.0;  ///< of one core
};

/// Runs what the cache lacks, `jobs` at a time, and measures each figure when its last run is there, of which
/// `finished` is told, one figure at a time. Throws the first error of a run. Nothing if options name a
/// shard: the figures are then as they were.
std::optional<RunTime> run_points(std::vector<Figure>& figures, CampaignOptions const& options,
                                  std::function<void(Figure const&)> const& finished = {});

/// Finished runs by the keys of their scenes.
using Results = std::map<std::string, RunResult const*>;

/// A figure whose points are what the first `fraction` of each run's production measured.
Figure measured(Figure const& planned, Results const& results, double fraction = 1.0);

/// The points of a curve at x; its only point, if it has one, stands for all x.
std::vector<Point const*> points_of(std::string const& name, std::vector<FigureCurve> const& curves,
                                    std::vector<Point> const& points, double x);

}  // namespace dpd
