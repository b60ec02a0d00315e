/// @file
/// Running a scene: from text to results on disk, with checkpoints, resume and progress.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "sample.hpp"
#include "scene.hpp"
#include "statistics.hpp"

namespace dpd {

/// The run was asked to stop and has left a checkpoint.
struct Interrupted : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// What a finished run leaves.
struct RunResult {
    Record record;
    Counters counters;
    std::uint64_t particles = 0;
    double seconds = 0.0;              ///< wall clock of all its parts
    std::uint64_t bytes = 0;           ///< memory of state, pair list and search
    double kinetic_temperature = 0.0;  ///< at the end, energy; 0 if read from a file
    bool from_cache = false;
};

struct RunOptions {
    std::optional<std::filesystem::path> output;  ///< HDF5 file; also where checkpoints live
    std::atomic<bool> const* stop = nullptr;      ///< ends the run after the present step
    std::function<void(double fraction)> progress;
};

/// A simulation with the stage list that the scene names, at its initial state; `sample` (may be empty) is
/// what the stage of that name calls.
template <int d>
Simulation<d> build(Scene const& scene, std::function<void(Simulation<d>&)> sample);

/// Runs a scene to its end. With an output file: returns its results if it holds this scene completed,
/// resumes if it holds a checkpoint of it. Throws InputError (also if the file holds another scene),
/// Diverged, Interrupted; the file then keeps what was computed.
RunResult run(Scene const& scene, RunOptions const& options = {});

/// One measured number.
struct Quantity {
    std::string name;
    Estimate estimate;
};

/// The numbers that a scene's records give; several records are independent runs of it.
std::vector<Quantity> analyze(Scene const& scene, std::vector<Record> const& records);

/// Adds f(arguments), arguments by name, unless it is there or one of them is missing; its error from theirs,
/// taken as independent, by finite differences.
void add_function(std::vector<Quantity>& quantities, std::string name,
                  std::vector<std::string> const& arguments,
                  std::function<double(std::vector<double> const&)> const& f);

/// Adds what follows from quantities of several scenes at one state point (viscosity under shear, g(r) and
/// diffusion at rest): `potential_relaxation_rate` by eq. 16, `kinetic_viscosity_by_rates` by eq. 14,
/// `schmidt_number`. @eq{NG2007,14} @eq{NG2007,16}
void derive(Scene const& scene, std::vector<Quantity>& quantities);

/// Adds what follows from the pressures of a scene's fluid `below` and `above` its density, `densities`
/// apart: `pressure_slope` dp/dn, `inverse_compressibility` (1/kT) dp/dn (also per atom) and the isothermal
/// `speed_of_sound` sqrt((dp/dn)/m). @eq{PK2006,3} @eq{PK2006,7}
void derive_from_densities(Scene const& scene, double densities, Estimate const& below, Estimate const& above,
                           std::vector<Quantity>& quantities);

/// Adds what a velocity autocorrelation is compared with at lag t: `exponential_decay`, the exponential of
/// the same integral, and, where viscosity and diffusion are known, `hydrodynamic_tail` in the periodic box.
void derive_at_lag(Scene const& scene, std::vector<Quantity>& quantities, double t);

/// A measured function: one estimate per bin.
struct CurveEstimate {
    std::vector<double> x;
    std::vector<Estimate> y;
};

/// The curve of that name; also "temperature_profile", and "channel_profile": the velocity across one
/// channel, in the atoms' units where coarse_graining gives the viscosity. Empty if the scene does not
/// measure it. Per component for the velocity autocorrelation.
CurveEstimate curve_of(Scene const& scene, std::vector<Record> const& records, std::string const& name);

/// The quantity of that name, or nothing.
Quantity const* find_quantity(std::vector<Quantity> const& quantities, std::string_view name);

}  // namespace dpd
