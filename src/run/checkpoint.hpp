/// @file
/// The file of one run: its results, or the state from which it goes on.
#pragma once

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

/// Its state is "complete", "interrupted" (with a checkpoint) or "diverged: ...".
template <int d>
class RunFile {
public:
    RunFile(Scene const& scene, std::filesystem::path path) : scene_(scene), path_(std::move(path)) {}

    void save(std::string status, Simulation<d>& simulation, Recorder<d>& recorder, double seconds) const;

    /// Restores a checkpoint or a result; false if there is no file yet. A run that diverged would do so
    /// again: throws what it said.
    bool load(Simulation<d>& simulation, Recorder<d>& recorder, double& seconds, std::uint64_t& bytes,
              bool& complete) const;

private:
    Scene const& scene_;
    std::filesystem::path path_;
};

}  // namespace dpd
