/// @file
/// Another code's output against a reference: averaging, judging. docs/compare.md.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analysis.hpp"
#include "read_output.hpp"
#include "statistics.hpp"

namespace dpd {

/// COLUMN=quantity[*factor]: `factor` times the column is the quantity.
struct Renaming {
    std::string column;    ///< of the output
    std::string quantity;  ///< that it is, by dpdref's name
    double factor = 1.0;   ///< from the output's unit to the quantity's
};

/// InputError for anything else.
Renaming renaming_from_text(std::string const& text);

/// Samples to leave out as equilibration: a share of each series, or those before a time or step.
struct Discard {
    double share = 0.0;         ///< 0 to 1
    double before = -INFINITY;  ///< in the units of the file's own column
};

/// "20%", or a time or step. InputError for anything else.
Discard discard_from_text(std::string const& text);

/// "all", or the number of a log's thermo table, 0 for the last. InputError for anything else.
std::size_t table_from_text(std::string const& text);

/// Numbers to compare with.
struct Reference {
    std::string name;                     ///< of the reference
    std::vector<Quantity> quantities;     ///< with their errors
    CurveEstimate radial_distribution{};  ///< g(r); empty if there is none
    double shear_rate = 0.0;              ///< of the flow behind the viscosities, 1/time; 0 without
    int components = 3;                   ///< axes that a mean-square displacement sums
    int dimension = 3;                    ///< of space
    std::uint64_t particles = 0;          ///< of the fluid; 0: not known
    /// Friction and noise are forces of the integrator, so that a code may count them in its pressure.
    bool thermostat_forces = false;
    /// Its fluid in its units: kT, mass, cutoff, a (force at contact), gamma, timestep, density, exponent of
    /// w_D; what is not known is not there.
    std::map<std::string, double> facts = {};
    std::string integrator = {};  ///< what its step is called
};

/// A state point of a file of reference answers (schema dpdref-answers/1).
Reference answer_reference(std::filesystem::path const& answers, std::string const& id);

/// The same from the text of such a file, which messages call `file`.
Reference answer_reference(std::string const& answers, std::string const& file, std::string const& id);

/// A result of `dpdref run --out`.
Reference run_reference(std::filesystem::path const& file);

/// What was read of a file.
struct FileSummary {
    std::string file, code;   ///< its name, and who wrote it; empty: not known
    std::size_t columns = 0;  ///< with the one of times
    std::size_t samples = 0;  ///< of the longest column, before any were discarded
};

/// The averages of outputs, by dpdref's names where these are known.
struct Averages {
    std::vector<Quantity> quantities;      ///< with their errors
    CurveEstimate radial_distribution{};   ///< g(r); empty if there is none
    std::vector<std::string> notes;        ///< for the reader, a line each
    std::vector<std::string> differences;  ///< in which a log says that its fluid is another
    std::vector<std::string> definitions;  ///< of columns, as the code that wrote them has them
    std::vector<FileSummary> files;        ///< in the order of reading
    double particles = 0.0;                ///< where the outputs say it
};

/// Names the columns (as they are called; other codes' names; `renamings`), discards, and averages: errors by
/// blocking. Partitions of one LAMMPS run are averaged together. In a shear flow stresses become viscosities,
/// and what was measured in one (the file says so, or `sheared`) is compared with the reference's sheared
/// values; `lag` and `mean_square_displacement` become a diffusion constant, as `analyze` makes it. A log is
/// held against the reference, and its own columns are brought to the reference's units. Notes say what was
/// discarded and which halves of a series differ. InputError for a quantity that comes twice, a column that
/// is not there, another shear rate.
Averages average(std::vector<CodeOutput> const& outputs, Reference const& reference,
                 std::vector<Renaming> const& renamings, Discard const& discard, bool sheared = false);

/// A quantity of both.
struct CodeComparison {
    std::string quantity;                  ///< that both have
    Estimate value;                        ///< of the output
    Estimate reference;                    ///< of the reference
    Estimate difference{};                 ///< with the combined error
    Verdict verdict = Verdict::undecided;  ///< at the false-alarm rate of the whole table
    /// The difference in units of its error.
    double z() const { return difference.value / difference.error; }
};

/// A family of comparisons; `family_false_alarm` is the chance that any of it disagrees although all are
/// true.
struct CodeReport {
    std::vector<CodeComparison> comparisons;  ///< one per quantity and bin
    std::vector<Quantity> without_reference;  ///< measured by the code alone
    std::vector<std::string> not_measured;    ///< the reference's other quantities
    std::vector<std::string> hints;           ///< what a disagreement looks like
    std::vector<std::string> notes;           ///< what could not be compared as it was
};

/// Compares all that both have, by Student's t with Welch's degrees of freedom and Bonferroni's share of the
/// false alarms. g(r) is one member of the family: its share is divided among its bins, of which the one
/// that is furthest off is reported. *agrees* asks for critical t times the combined error of at most
/// `resolution` times the reference (of g(r): for the error alone, times its peak). If g(r) has other bins,
/// those of the finer curve are put together into the other's; if that cannot be, it is left out with a note.
CodeReport compare(Averages const& averages, Reference const& reference, double resolution);

/// What a script wants to know.
enum class Outcome {
    agrees,     ///< something was compared, and nothing disagrees
    disagrees,  ///< a quantity does, or a log is of another fluid
    nothing,    ///< no column has a reference
};

/// Of a report on these averages.
Outcome outcome_of(CodeReport const& report, Averages const& averages);

/// Prints report and notes as a table or as JSON; what a log says otherwise than the reference comes first.
void print(CodeReport const& report, Averages const& averages, Reference const& reference, bool json);

/// One line for a report without a comparison: its columns, and what there is a reference for.
std::string nothing_compared(CodeReport const& report, Reference const& reference);

}  // namespace dpd
