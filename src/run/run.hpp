/// @file
/// Running a scene: from text to results on disk, with checkpoints, resume and progress.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "build.hpp"
#include "errors.hpp"
#include "sample.hpp"
#include "scene.hpp"
#include "statistics.hpp"
#include "until.hpp"

namespace dpd {

/// What a finished run leaves.
struct RunResult {
    Record record;                    ///< all that was sampled
    Counters counters;                ///< of the work done
    std::uint64_t particles = 0;      ///< of the fluid
    double seconds = 0.0;             ///< processor time of all its parts
    std::uint64_t bytes = 0;          ///< memory of state, pair list and search
    bool from_cache = false;          ///< whether the file had it already
    double duration = 0.0;            ///< measured time, after equilibration
    std::vector<ErrorWanted> errors;  ///< of a scene with `until`, at the end
    /// At the end, energy; where a body force drives a flow, of the velocities across it. 0 if read from a
    /// file.
    double kinetic_temperature = 0.0;
};

/// Where a run is kept, and who may end or watch it.
struct RunOptions {
    std::optional<std::filesystem::path> output;  ///< HDF5 file; also where checkpoints live
    bool cache =
        false;  ///< the file is one of a cache: whatever cannot be used there is moved aside and made
    std::atomic<bool> const* stop = nullptr;            ///< ends the run after the present step
    std::function<void(double fraction)> progress;      ///< told now and then which fraction is done
    std::function<void(std::string const&)> tell = {};  ///< told now and then how far the errors have fallen
};

/// Runs a scene to its end, which with `until` depends on what is measured. With an output file: returns its
/// results if it holds this scene completed, resumes if it holds a checkpoint of it. A file of its own that
/// is damaged is said, moved aside and made again. Another process that works on the same file is waited for.
/// Throws InputError (also if the file holds another scene), Diverged, Interrupted; the file then keeps what
/// was computed.
RunResult run(Scene const& scene, RunOptions const& options = {});

}  // namespace dpd
