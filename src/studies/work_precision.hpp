/// @file
/// Work and precision of integrators: the errors that a finite step leaves in what a fluid is measured for,
/// against a reference at step zero, and what one digit costs. Defined by
/// verification/work-precision/integrators/study.toml; docs/work_precision.md.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "analysis.hpp"
#include "campaign.hpp"
#include "run.hpp"
#include "statistics.hpp"

namespace dpd {

/// One scene of a study: an integrator at one step, at rest or sheared.
struct StudyRun {
    std::string integrator;              ///< by name
    bool reference = false;              ///< a long run for the limit of step zero
    bool sheared = false;                ///< whether it is measured in shear
    double step = 0.0;                   ///< time
    Scene scene;                         ///< that is run
    bool diverged = false;               ///< whether it ended early
    Record record{};                     ///< all that was sampled
    std::vector<Quantity> quantities{};  ///< made from it
    double seconds_per_step = 0.0;       ///< processor time, measured apart from the run
};

/// What is measured, and where.
struct Observable {
    std::string quantity;         ///< its name
    std::string label;            ///< as pictures have it
    bool sheared = false;         ///< whether it is measured in shear
    std::optional<double> exact;  ///< known at step zero
};

/// The observables of a study; "g(r)" stands for the whole function.
std::vector<Observable> const& study_observables();

/// A fluid and its integrators.
struct Study {
    std::string name;                         ///< of its files
    std::string title;                        ///< of its pictures
    double table_step = 0.0;                  ///< of the table of deviations
    std::vector<std::string> integrators;     ///< in the order of the file
    std::vector<std::string> other_dynamics;  ///< of these, those with transport coefficients of their own
    std::vector<StudyRun> runs;               ///< all of its runs
};

/// The limit of step zero: value(step) = value + c step^2, fitted to long runs of an integrator of second
/// order.
struct Limit {
    Estimate estimate;                   ///< the limit of step zero
    double chi_squared = 0.0;            ///< of the fit
    std::size_t degrees_of_freedom = 0;  ///< of the fit
};
Limit limit_of_step_zero(std::vector<double> const& steps, std::vector<Estimate> const& values);

/// Deviation of one measurement from the limit of step zero, relative to that.
struct Deviation {
    double step = 0.0;         ///< time step
    double duration = 0.0;     ///< time that was simulated
    double value = 0.0;        ///< measured
    double error = 0.0;        ///< standard error, the reference's included
    double statistical = 0.0;  ///< standard error of the run alone
    double seconds = 0.0;      ///< processor time of the run
};

/// How the deviation depends on the step: c_1 step + c_2 step^2 + ..., as many terms as the data bear; and
/// the order seen, the slope of the logarithms where the deviation is clear of its error.
struct ErrorLaw {
    std::vector<double> coefficients;  ///< of the powers of the step
    Eigen::MatrixXd covariance;        ///< of the coefficients
    double order = 0.0;                ///< slope of the logarithms
    double order_error = 0.0;          ///< its standard error
    std::size_t order_points = 0;      ///< with fewer than two there is no order

    /// Root mean square of what the law says the deviation is at a step, given its own uncertainty.
    double bias(double step) const;
};
ErrorLaw fit_error_law(std::vector<Deviation> const& deviations);

/// Processor time until bias and statistics together, as root mean square, are `target`: infinity where the
/// bias alone is more. `variance_time`: relative variance of a mean times the duration behind it.
double seconds_to_reach(double target, double bias, double variance_time, double seconds_per_time);

/// Reads the fluids of a budget ("quick" or "paper"). InputError as for scenes.
std::vector<Study> load_studies(std::filesystem::path const& directory, std::string const& budget);

/// Runs what the cache lacks, the longest first, and measures the cost of a step of each scene. A run that
/// diverges is marked. False if options name a shard: some runs are then unknown.
bool run_studies(std::vector<Study>& studies, CampaignOptions const& options);

/// Writes data, pictures and the table of the cheapest integrators of a study to `output`, and prints the
/// table.
void write_study(Study const& study, std::string const& budget, std::filesystem::path const& directory,
                 std::filesystem::path const& output);

/// The pictures alone, of the data in `output`; InputError where there are none.
void draw_study(Study const& study, std::filesystem::path const& directory,
                std::filesystem::path const& output);

}  // namespace dpd
