/// @file
/// What a figure is: a base scene, curves of parameter variations, and comparisons with closed forms.
/// Defined by verification/ID/figure.toml (define_figure.hpp), run (run_figure.hpp), compared
/// (judge_figure.hpp), and drawn by verification/ID/plot.gp, and as ID-NAME by each NAME.gp beside it
/// (write_figure.hpp); docs/figures.md.
#pragma once

#include <cmath>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "analysis.hpp"
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

constexpr std::string_view name_of(Relation relation) {
    switch (relation) {
        case Relation::equal:
            return "equal";
        case Relation::at_most:
            return "at_most";
        case Relation::at_least:
            return "at_least";
        case Relation::differs:
            return "differs";
    }
    return {};
}

/// Before a quantity's name: its slope in logarithms from the point before.
inline constexpr std::string_view exponent_prefix = "exponent:";

/// What a measured quantity is held against.
struct Criterion {
    std::string
        quantity;  ///< as `analyze` names it; or "exponent:NAME", d ln NAME/d ln x from the point before
    std::string theory;  ///< id of a closed form; "curve:NAME"; "quantity:NAME"; or "value" with `value`
    double value = 0.0;  ///< the reference, for the theory "value"
    Relation relation = Relation::equal;  ///< that must hold
    double tolerance = 0.0;               ///< 0: exact; else how far the theory may be off, relative
    double resolution = 0.01;             ///< relative standard error that an exact agreement needs
    bool description = false;             ///< its tolerance was set after looking at the data
};

/// One measured point against one criterion.
struct Comparison {
    std::string figure;         ///< id
    std::string curve;          ///< name of its curve
    std::string parameter;      ///< that is along x, "table.key"
    double x = 0.0;             ///< value of the varied parameter
    Criterion criterion{};      ///< what was asked
    Estimate estimate{};        ///< the value, its error and blocks
    double theory = 0.0;        ///< the reference value
    double theory_error = 0.0;  ///< of a "curve:NAME" reference
    std::uint64_t runs = 0;     ///< behind the point
    double seconds = 0.0;       ///< run time of all runs behind the point
};

/// A figure's points: scenes to run and criteria to judge.
struct Point {
    std::size_t curve = 0;             ///< index among the figure's curves
    double x = 0.0;                    ///< of the varied parameter, or of the record
    std::vector<Scene> runs;           ///< one per seed
    std::vector<Scene> at_rest{};      ///< the same without shear, whose stress is noise; empty: left in
    std::vector<Quantity> quantities;  ///< all that was measured or derived
    Eigen::ArrayXXd configuration;     ///< positions of the first run, where the scene keeps them
    double seconds = 0.0;              ///< run time of its runs
};

/// One line of points of a figure.
struct FigureCurve {
    std::string name;                        ///< by which others refer to it
    std::string label;                       ///< in the legend
    std::string parameter;                   ///< that is varied, "table.key"
    std::vector<Criterion> criteria;         ///< for each of its points
    std::vector<double> line;                ///< range of the theory line; empty: the points'
    std::string join;                        ///< name of a curve whose quantities are added at the same x
    std::vector<std::string> slope_between;  ///< names of the curves at a lower and at a higher density
    std::string record;                      ///< what is drawn is this measured curve, over its own x
    double from = 0.0;                       ///< first x of the measured curve that is shown
    double to = INFINITY;                    ///< last one
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
    std::size_t curve = 0;        ///< index among the figure's curves
    Criterion criterion{};        ///< what was asked
    std::vector<State> states;    ///< in the order of time; the last one is of the whole runs
    double floor = 0.0;           ///< what is left of the deviation, in squares, without the error
    double floor_error = 0.0;     ///< standard error of `floor`
    bool floor_resolved = false;  ///< whether chance alone would not make it
};

/// A figure: its definition and, once its runs are there, what they measured.
struct Figure {
    std::string id;                        ///< name of its directory
    std::string paper;                     ///< that it belongs to
    std::string number;                    ///< there
    std::string title;                     ///< above the picture
    std::string caption;                   ///< below it
    std::filesystem::path directory;       ///< of its definition
    std::vector<FigureCurve> curves;       ///< in the order of the file
    std::vector<Point> points;             ///< curve by curve
    double seconds = 0.0;                  ///< run time of all its scenes, each counted once
    std::vector<Convergence> convergence;  ///< of its curves' criteria
};

}  // namespace dpd
