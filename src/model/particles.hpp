/// @file
/// The particle state: one array each of positions, velocities, images and ids.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace dpd {

template <int d>
using Vec = Eigen::Vector<double, d>;

/// One row per particle; its components are contiguous, so that a pair touches two places in memory.
template <int d, class Scalar = double>
using Field = Eigen::Array<Scalar, Eigen::Dynamic, d, Eigen::RowMajor>;

/// N particles of equal mass. Rows are kept roughly in cell order; `id` names a particle for good.
template <int d>
struct Particles {
    Field<d> position;             ///< length; inside the primary box
    Field<d> velocity;             ///< length per time; laboratory frame
    Field<d, std::int32_t> image;  ///< boxes travelled; unwrapped = position + image*length
    Eigen::Array<std::uint32_t, Eigen::Dynamic, 1> id;  ///< 0 .. N-1
    double mass = 1.0;                                  ///< of each, in the scene's unit
    std::uint32_t fluid = 0;  ///< how many may move: their ids come first; the others are the walls'

    /// N, the walls' particles included.
    Eigen::Index size() const { return position.rows(); }
    /// Whether some may not move.
    bool has_walls() const { return fluid < size(); }
    /// Whether the particle in that row belongs to a wall.
    bool frozen(Eigen::Index row) const { return id[row] >= fluid; }

    /// n fluid particles at the origin, at rest.
    void resize(Eigen::Index n) {
        position.setZero(n, d);
        velocity.setZero(n, d);
        image.setZero(n, d);
        id.setLinSpaced(n, 0, static_cast<std::uint32_t>(n > 0 ? n - 1 : 0));
        fluid = static_cast<std::uint32_t>(n);
    }
};

}  // namespace dpd
