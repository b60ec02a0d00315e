/// @file
/// Velocity rescaling relative to the local flow, on a lattice of randomly shifted cells: a thermostat that
/// conserves momentum and sees no pairs. NG2007, "Other Thermostats"; derivations in theory/NG2007.md.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "simulation.hpp"
#include "stage_parameters.hpp"

namespace dpd {

/// Scales the velocities u relative to the mean of a cell so that sum m u^2 = d (N - N_c) kT over the cells
/// that share a factor, which hold N particles in N_c occupied cells. Where N = N_c nothing is relative and
/// nothing scaled. `monte_carlo` instead accepts or rejects a random factor per cell such that the canonical
/// distribution is stationary.
template <int d>
struct Rescale {
    Rescaling mode = Rescaling::global;
    double kT = 1.0;
    double cell = 1.0;            ///< side of a cell; divides the sides of the box
    std::uint64_t thickness = 1;  ///< of a layer, in cells
    double amplitude = 0.3;       ///< c: factors of `monte_carlo` lie in [1/(1+c), 1+c]
    void operator()(Simulation<d>& simulation, NoiseKey key);

private:
    void sort_into_cells(Simulation<d> const& simulation, NoiseKey key);

    struct Cell {
        double count = 0.0;
        Vec<d> velocity = Vec<d>::Zero();  ///< sum, then mean
        double square = 0.0;               ///< sum of |u|^2
        double factor = 1.0;
    };
    std::vector<Cell> cells_;
    std::array<std::size_t, d> sides_{};  // in cells
    std::vector<std::uint32_t> home_;     // cell of each row
    std::vector<double> height_, speed_;  // y and velocity along x of the image that lies in the lattice,
                                          // relative to the row's
};

extern template struct Rescale<2>;
extern template struct Rescale<3>;

}  // namespace dpd
