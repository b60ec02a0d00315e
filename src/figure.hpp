/// @file
/// Regenerating figures: a figure is a base scene, curves of parameter variations, and comparisons with
/// closed forms. Defined by verification/ID/figure.toml, drawn by verification/ID/plot.gp; docs/figures.md.
#pragma once

#include <atomic>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "run.hpp"
#include "scene.hpp"
#include "statistics.hpp"

namespace dpd {

/// How a measured quantity should stand to the theory.
enum class Relation {
    equal,
    at_most,   ///< the theory is an upper bound
    at_least,  ///< the theory is a lower bound
    differs,   ///< by more than the tolerance
};

/// What a measured quantity is held against.
struct Criterion {
    std::string
        quantity;  ///< as `analyze` names it; or "exponent:NAME", d ln NAME/d ln x from the point before
    std::string theory;  ///< id of a closed form; "curve:NAME"; "quantity:NAME"; or "value" with `value`
    double value = 0.0;
    Relation relation = Relation::equal;
    double tolerance = 0.0;    ///< 0: exact; else how far the theory may be off, relative
    double resolution = 0.01;  ///< relative standard error that an exact agreement needs
};

/// One measured point against one criterion.
struct Comparison {
    std::string figure, curve, parameter;
    double x = 0.0;  ///< value of the varied parameter
    Criterion criterion{};
    Estimate estimate{};
    double theory = 0.0;
    double theory_error = 0.0;  ///< of a "curve:NAME" reference
    std::uint64_t runs = 0;
    double seconds = 0.0;  ///< run time of all runs behind the point
};

/// Probability that any comparison of a report disagrees by chance although all are true.
inline constexpr double family_false_alarm = 0.01;

/// Verdict of one among `family` comparisons.
Verdict judge(Comparison const& comparison, std::size_t family);

/// Seconds more that would decide an undecided comparison.
double seconds_to_decide(Comparison const& comparison, std::size_t family);

/// A figure's points: scenes to run and criteria to judge.
struct Point {
    std::size_t curve = 0;
    double x = 0.0;
    std::vector<Scene> runs;  ///< one per seed
    std::vector<Quantity> quantities;
    Eigen::ArrayXXd configuration;  ///< positions of the first run, where the scene keeps them
    double seconds = 0.0;
};

struct FigureCurve {
    std::string name, label, parameter;
    std::vector<Criterion> criteria;
    std::vector<double> line;                ///< range of the theory line; empty: the points'
    std::string join;                        ///< name of a curve whose quantities are added at the same x
    std::vector<std::string> slope_between;  ///< names of the curves at a lower and at a higher density
    std::string record;                      ///< what is drawn is this measured curve, over its own x
    double from = 0.0, to = INFINITY;        ///< of the measured curve
    std::uint64_t every = 1;                 ///< one in so many of its bins
};

struct Figure {
    std::string id, paper, number, title, caption;
    std::filesystem::path directory;
    std::vector<FigureCurve> curves;
    std::vector<Point> points;
    double seconds = 0.0;  ///< run time of all its scenes, each counted once
};

/// Reads verification/ID/figure.toml at a budget ("quick" or "paper"). InputError as for scenes.
Figure load_figure(std::filesystem::path const& verification, std::string const& id,
                   std::string const& budget);

/// Ids of the figures that `verification` holds, sorted.
std::vector<std::string> figure_ids(std::filesystem::path const& verification);

struct CampaignOptions {
    std::filesystem::path cache;
    std::filesystem::path output;
    unsigned jobs = 1;
    std::atomic<bool> const* stop = nullptr;
};

/// Runs what the cache lacks, the longest runs first, `jobs` at a time. Throws the first error of a run.
void run_points(std::vector<Figure>& figures, CampaignOptions const& options);

/// Compares every point of a figure with its criteria.
std::vector<Comparison> compare(Figure const& figure);

/// Writes data, comparisons and pictures of a figure to `output`; gnuplot draws.
void write_figure(Figure const& figure, std::vector<Comparison> const& comparisons, std::string const& budget,
                  std::filesystem::path const& output);

/// The comparisons that write_figure left in `output`.
std::vector<Comparison> load_comparisons(std::filesystem::path const& output);

/// Prints the table of comparisons and writes report.csv and report.json to `output`. True if none disagrees.
bool report(std::vector<Comparison> const& comparisons, std::filesystem::path const& output);

/// Value of a closed form for the parameters of a scene.
double theory_for(Scene const& scene, std::string const& id);

}  // namespace dpd
