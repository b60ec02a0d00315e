/// @file
/// The file of one run: its results, or the state from which it goes on.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "sample.hpp"
#include "scene.hpp"
#include "simulation.hpp"

namespace dpd {

/// How the state of a run that diverged begins; what it said follows.
inline constexpr std::string_view diverged = "diverged: ";

/// Seconds from the end of a checkpoint, which took `took`, to the next: what the scene wants, and at least
/// ten times as long, so that a slow disk never takes more than a tenth of the time.
inline double checkpoint_pause(double wanted, double took) { return std::max(wanted, 10.0 * took); }

/// Its state is "complete", "interrupted" (with a checkpoint) or "diverged: ...".
template <int d>
class RunFile {
public:
    /// Of a run of that scene; an empty path: nothing is kept.
    RunFile(Scene const& scene, std::filesystem::path path) : scene_(scene), path_(std::move(path)) {}

    /// Stores all of it; with a status that is not "complete" it is a checkpoint.
    void save(std::string status, Simulation<d>& simulation, Recorder<d>& recorder, double seconds) const;

    /// Restores a checkpoint or a result; false if there is no file yet. A run that diverged would do so
    /// again: throws what it said. Damaged if the file is not as it was written or holds what cannot be;
    /// simulation and recorder are then of no use.
    bool load(Simulation<d>& simulation, Recorder<d>& recorder, double& seconds, std::uint64_t& bytes,
              bool& complete) const;

private:
    Scene const& scene_;
    std::filesystem::path path_;
};

}  // namespace dpd
