/// @file
/// What other codes write, read: tables, logs, H5MD. docs/compare.md lists the formats.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis.hpp"
#include "statistics.hpp"

namespace dpd {

/// The number of blocks of an error that comes without one, which is taken as exact.
inline constexpr std::size_t many_blocks = 1'000'000;

/// The number that a text is, and nothing else.
std::optional<double> to_number(std::string_view text);

/// A name without its unit, as OpenMM's `Time (ps)`, and without the object that it is of, as HOOMD-blue's
/// `Simulation.timestep`.
std::string bare(std::string const& name);

/// What a code wrote: numbers with errors, or series of samples in the order of time, or g(r).
struct CodeOutput {
    std::string file;              ///< as given
    std::string code;              ///< that wrote it, where the file tells
    std::vector<Quantity> values;  ///< numbers with errors, where the file has such
    std::string axis;              ///< name of the column of times or steps; empty without one
    std::vector<double> at;        ///< times or steps of the samples
    std::vector<std::pair<std::string, std::vector<double>>>
        series;                             ///< columns by name, in the order of time
    std::vector<double> r;                  ///< middle of the bins of g(r)
    std::vector<std::vector<double>> g;     ///< samples of each bin
    CurveEstimate curve{};                  ///< or g(r) with errors
    std::vector<std::string> notes;         ///< what was left out
    std::optional<double> shear_rate = {};  ///< if the file says it as a number, as a deck's does; 0: at rest
    bool per_particle = true;               ///< whether a LAMMPS log's energies are
    /// Commands of a LAMMPS log before the run, as words: units, timestep, pair_style, fix, compute and
    /// others.
    std::vector<std::vector<std::string>> commands;
    double atoms = 0.0;            ///< as a LAMMPS log counts them; 0: not said
    std::vector<double> box;       ///< sides as a LAMMPS log has them, length; empty: not said
    std::string partition;         ///< of a LAMMPS log of several, which are runs of their own
    std::vector<CodeOutput> also;  ///< series of the same file with other times: lines of fix print in a log
};

/// Which run of a log `read_output` reads, if all: their rows one after the other.
inline constexpr std::size_t all_runs = std::size_t(-1);

/// Reads a table (between commas, semicolons, tabs or blanks; its header may be a comment, be in each line,
/// or be missing), GROMACS' .xvg, a LAMMPS log (the thermo table of its k-th run; 0: of the last), a file of
/// LAMMPS' fix ave/time or ave/chunk, H5MD, or a result of `dpdref run`, recognised by content. InputError
/// names file and line.
CodeOutput read_output(std::filesystem::path const& file, std::size_t run = 0);

}  // namespace dpd
