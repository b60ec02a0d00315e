/// @file
/// Periodic box, at rest or in simple shear (Lees & Edwards).
#pragma once

#include <cmath>
#include <limits>

#include "errors.hpp"
#include "particles.hpp"

namespace dpd {

/// Box [0, length). In shear the flow is along x (axis 0), its gradient along y (axis 1): u_x(y) =
/// shear_rate (y - length_y/2). The image of the box across the upper y boundary is displaced by
/// `offset(time)` along x and moves at `image_speed()` relative to the primary box.
template <int d>
struct Box {
    Vec<d> length = Vec<d>::Ones();  ///< sides
    double shear_rate = 0.0;         ///< du_x/dy, 1/time
    double wall = 0.0;  ///< thickness of the wall at either y boundary; the fluid is between them

    /// Of the whole box, walls included: length^d.
    double volume() const {
        double product = length[0];
        for (int axis = 1; axis < d; ++axis) product *= length[axis];
        return product;
    }
    /// Between the walls.
    double fluid_volume() const { return volume() * (1.0 - 2.0 * wall / length[1]); }
    /// Whether there is a flow.
    bool sheared() const { return shear_rate != 0.0; }
    /// Speed of the image above the box along x, length per time.
    double image_speed() const { return shear_rate * length[1]; }
    /// Displacement of the image above the box along x at a time, within one side.
    double offset(double time) const { return std::fmod(image_speed() * time, length[0]); }
    /// u_x at the height y; zero in the middle of the box.
    double flow_velocity(double y) const { return shear_rate * (y - 0.5 * length[1]); }

    // [bounce back]
    /// Sends back what has entered a wall in the last `span` of time: along its own path, with its velocity
    /// reversed (bounce-back, no slip). Throws Diverged for what is deeper inside than the wall is thick.
    void bounce_back(Particles<d>& particles, double span) const {
        for (Eigen::Index p = 0; p < particles.size(); ++p) {
            double const y = particles.position(p, 1);
            double const depth = y < wall ? wall - y : y - (length[1] - wall);
            if (!(depth > 0.0) || particles.frozen(p)) continue;
            double const inside = depth / std::abs(particles.velocity(p, 1));  // time since the crossing
            if (!(depth <= wall && inside <= span * (1.0 + 1e-9)))
                throw Diverged("a particle went through a wall");
            particles.position.row(p) -= 2.0 * inside * particles.velocity.row(p);
            particles.velocity.row(p) = -particles.velocity.row(p);
        }
    }
    // [bounce back]

    /// Returns every particle to the primary box at `time`; a particle that leaves through a y boundary in
    /// shear changes to its image's x and velocity. Throws Diverged for a position that is not a number or
    /// lies more than 2^30 boxes away.
    void wrap(Particles<d>& particles, double time) const {
        if (sheared()) wrap_axis(particles, 1, offset(time), image_speed());
        for (int axis = 0; axis < d; ++axis)
            if (axis != 1 || !sheared()) wrap_axis(particles, axis, 0.0, 0.0);
    }

private:
    void wrap_axis(Particles<d>& particles, int axis, double shift, double speed) const {
        double const side = length[axis];
        for (Eigen::Index p = 0; p < particles.size(); ++p) {
            double& x = particles.position(p, axis);
            if (x >= 0.0 && x < side) [[likely]]
                continue;
            double const boxes = std::floor(x / side);
            if (!(std::abs(boxes) < std::numeric_limits<std::int32_t>::max() / 2.0))
                throw Diverged("a particle's position is no longer a finite number of boxes away");
            x -= boxes * side;
            if (x >= side || x < 0.0) x = 0.0;  // rounding at the boundary itself
            particles.image(p, axis) += static_cast<std::int32_t>(boxes);
            if (shift != 0.0 || speed != 0.0) {
                particles.position(p, 0) -= boxes * shift;
                particles.velocity(p, 0) -= boxes * speed;
            }
        }
    }
};

}  // namespace dpd
