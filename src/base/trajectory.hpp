/// @file
/// Trajectories in the H5MD layout.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace dpd {

/// What all frames of a trajectory share, and whose it is.
struct TrajectoryOf {
    std::string run;                 ///< key of the run: no other run writes to its file
    std::vector<double> box_length;  ///< sides
    std::size_t particles = 0;       ///< in each frame
    double shear_rate = 0.0;         ///< du_x/dy, 1/time
};

/// A trajectory in the H5MD layout (de Buyl, Colberg & Hofling, Comput. Phys. Commun. 185, 1546 (2014)). Its
/// file holds the frames up to the last `commit`, whole at any time; those since then are beside it, in
/// `path`.part, and are lost with the process. Frames have checksums. Errors: InputError naming the file.
class Trajectory {
public:
    /// Goes on after the first `frames` frames of the file, the last of them at `step`; what is behind them
    /// is forgotten. With none, begins a new file in place of an older one of the same run. Refuses a file of
    /// another run, and one that lacks frames.
    Trajectory(std::filesystem::path path, TrajectoryOf what, std::uint64_t frames, std::uint64_t step);
    ~Trajectory();

    /// Row-major arrays of particles x dimension, in the order of `id`.
    void append(std::uint64_t step, double time, std::vector<double> const& position,
                std::vector<double> const& velocity, std::vector<std::int32_t> const& image);

    /// Puts all frames in place.
    void commit();

private:
    struct File;
    std::unique_ptr<File> file_;
};

}  // namespace dpd
