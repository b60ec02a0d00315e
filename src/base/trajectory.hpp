/// @file
/// Trajectories in the H5MD layout.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

namespace dpd {

/// A trajectory in the H5MD layout (de Buyl, Colberg & Hofling, Comput. Phys. Commun. 185, 1546 (2014)), one
/// frame at a time; every frame is on disk, readable, when `append` returns.
class Trajectory {
public:
    /// Creates the file; or, with `keep_until_step` > 0, opens it and forgets all later frames.
    Trajectory(std::filesystem::path const& path, std::vector<double> const& box_length,
               std::size_t particles, double shear_rate, std::uint64_t keep_until_step);
    ~Trajectory();

    /// Row-major arrays of particles x dimension, in the order of `id`.
    void append(std::uint64_t step, double time, std::vector<double> const& position,
                std::vector<double> const& velocity, std::vector<std::int32_t> const& image);

private:
    struct File;
    std::unique_ptr<File> file_;
};

}  // namespace dpd
