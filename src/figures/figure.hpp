/// @file
/// Regenerating figures: a figure is a base scene, curves of parameter variations, and comparisons with
/// closed forms. Defined by verification/ID/figure.toml, drawn by verification/ID/plot.gp; docs/figures.md.
#pragma once

#include <atomic>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analysis.hpp"
#include "campaign.hpp"
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
    double seconds = 0.0;                    ///< run time behind its points, each run counted once
};

/// One criterion of a curve against the run time. Errors and deviations are relative to the theory (absolute
/// if that is zero).
struct Convergence {
    /// What the first part of the runs would have told.
    struct State {
        double seconds = 0.0;    ///< run time of this part, equilibration included
        double error = 0.0;      ///< root mean square over the points of the standard error
        double deviation = 0.0;  ///< root mean square over the points of the deviation
        std::size_t points = 0;  ///< whose error is known
    };
    std::size_t curve = 0;
    Criterion criterion{};
    std::vector<State> states;  ///< in the order of time; the last one is of the whole runs
    double floor = 0.0;         ///< what is left of the deviation, in squares, without the error
    double floor_error = 0.0;   ///< standard error of `floor`
    bool floor_resolved = false;
};

struct Figure {
    std::string id, paper, number, title, caption;
    std::filesystem::path directory;
    std::vector<FigureCurve> curves;
    std::vector<Point> points;
    double seconds = 0.0;  ///< run time of all its scenes, each counted once
    std::vector<Convergence> convergence;
};

/// Reads verification/ID/figure.toml at a budget ("quick" or "paper"). InputError as for scenes.
Figure load_figure(std::filesystem::path const& verification, std::string const& id,
                   std::string const& budget);

/// Ids of the figures that `verification` holds, sorted.
std::vector<std::string> figure_ids(std::filesystem::path const& verification);

/// What the runs of a campaign took, each run counted once, whenever it was done.
struct RunTime {
    std::size_t runs = 0;
    double seconds = 0.0;  ///< of one core
};

/// Runs what the cache lacks, the longest runs first, `jobs` at a time. Throws the first error of a run.
/// Nothing if options name a shard: the figures are then as they were.
std::optional<RunTime> run_points(std::vector<Figure>& figures, CampaignOptions const& options);

/// Finished runs by the keys of their scenes.
using Results = std::map<std::string, RunResult const*>;

/// A figure whose points are what the first `fraction` of each run's production measured.
Figure measured(Figure const& planned, Results const& results, double fraction = 1.0);

/// The first `fraction` of what was measured: of the samples of each series, of the blocks of each curve.
Record first_part(Record const& record, double fraction);

/// Every criterion that a value should equal, against the run time, from the first parts of the same runs.
std::vector<Convergence> converge(Figure const& planned, Results const& results);

/// State and floor of one criterion from its comparisons at the end of a part. The floor is
/// sqrt(max(0, rms deviation^2 - rms error^2)); its error takes points as independent and their noise as
/// normal. It is resolved if it exceeds twice its error, and the difference of the squares twice the standard
/// error that this would have without a floor.
Convergence convergence_of(std::vector<Comparison> const& comparisons, double seconds);

/// Compares every point of a figure with its criteria. InputError for a quantity that was not measured.
std::vector<Comparison> compare(Figure const& figure);

/// Point p against one criterion, as `compare` does; nothing where it needs a point before and there is none.
std::optional<Comparison> compare_point(Figure const& figure, std::size_t p, Criterion const& criterion);

/// Writes data, comparisons, convergence and pictures of a figure to `output`; gnuplot draws, in the style of
/// the nearest style.gp above the figure's directory.
void write_figure(Figure const& figure, std::vector<Comparison> const& comparisons, std::string const& budget,
                  std::filesystem::path const& output);

/// The comparisons that write_figure left in `output`.
std::vector<Comparison> load_comparisons(std::filesystem::path const& output);

/// Writes the run time of all figures at a budget to `output`, for `report`.
void write_run_time(RunTime const& run_time, std::string const& budget, std::filesystem::path const& output);

/// Prints the table of comparisons, and the run times that run_time.json in `output` and in its `quick`
/// state, and writes report.csv and report.json to `output`. True if none disagrees.
bool report(std::vector<Comparison> const& comparisons, std::filesystem::path const& output);

/// The closed forms' parameters, by the names of the command line, as a scene has them.
std::map<std::string, std::string> theory_arguments(Scene const& scene);

/// Value of a closed form, which takes from `arguments` what it depends on.
double theory_value(std::string const& id, std::map<std::string, std::string> const& arguments);

/// Value of a closed form for the parameters of a scene.
double theory_for(Scene const& scene, std::string const& id);

}  // namespace dpd
