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
    std::vector<Quantity> values;  ///< numbers with errors, where the file has such
    std::string axis;              ///< name of the column of times or steps; empty without one
    std::vector<double> at;        ///< times or steps of the samples
    std::vector<std::pair<std::string, std::vector<double>>>
        series;                             ///< columns by name, in the order of time
    std::vector<double> r;                  ///< middle of the bins of g(r)
    std::vector<std::vector<double>> g;     ///< samples of each bin
    CurveEstimate curve{};                  ///< or g(r) with errors
    bool per_particle = true;               ///< whether a LAMMPS log's energies are
    std::vector<std::string> notes;         ///< what was left out
    std::optional<double> shear_rate = {};  ///< if the file says it, as a deck's does; 0: at rest
};

/// Reads a table (CSV, or columns between blanks; its header may be a comment), a LAMMPS log (the thermo
/// table of its k-th run; 0: of the last), a file of LAMMPS' fix ave/time, H5MD, or a result of `dpdref run`,
/// recognised by content. InputError names file and line.
CodeOutput read_output(std::filesystem::path const& file, std::size_t run = 0);

}  // namespace dpd
