#include "rescale.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "elementary.hpp"
#include "sums.hpp"

namespace dpd {
namespace {

template <int d>
struct Cell {
    double count = 0.0;
    Vec<d> velocity = Vec<d>::Zero();  // sum, then mean
    double square = 0.0;               // sum of |u|^2
    double factor = 1.0;
};

template <int d>
struct Lattice {
    std::vector<Cell<d>> cells;
    std::array<std::size_t, d> sides;   // in cells
    std::vector<std::uint32_t> home;    // cell of each row
    std::vector<double> height, speed;  // y and velocity along x of the image that lies in the lattice,
                                        // relative to the row's
};

// A particle above the lattice's upper end stands for its image at the lower one, which in shear lies
// elsewhere along x and moves with other speed.
template <int d>
Lattice<d> sort_into_cells(Rescale const& stage, Simulation<d> const& simulation, NoiseKey key) {
    Lattice<d> lattice;
    auto& [cells, sides, homes, height, speed] = lattice;
    auto const& particles = simulation.particles;
    auto const& box = simulation.box;
    auto const rows = static_cast<std::size_t>(particles.size());
    std::array<double, d> shift;
    std::size_t count = 1;
    for (int axis = 0; axis < d; ++axis) {
        auto const a = static_cast<std::size_t>(axis);
        sides[a] = static_cast<std::size_t>(std::llround(box.length[axis] / stage.cell));
        shift[a] = stage.cell * uniform(key, static_cast<std::uint32_t>(axis), 0);
        count *= sides[a];
    }
    cells.assign(count, {});
    homes.resize(rows);
    height.resize(rows);
    speed.resize(rows);
    double const offset = box.sheared() ? box.offset(simulation.time) : 0.0;
    for (std::size_t p = 0; p < rows; ++p) {
        Vec<d> place = particles.position.row(Eigen::Index(p)).matrix().transpose();
        bool const above = place[1] + shift[1] >= box.length[1];
        height[p] = above ? -box.length[1] : 0.0;
        speed[p] = above ? -box.image_speed() : 0.0;
        if (above) place[0] -= offset;
        std::size_t index = 0;
        for (int axis : {1, 0, 2}) {  // layers across y are contiguous
            if (axis >= d) continue;
            auto const a = static_cast<std::size_t>(axis);
            double const x = (place[axis] + shift[a]) / box.length[axis];
            auto const along = static_cast<std::size_t>((x - std::floor(x)) * double(sides[a]));
            index = index * sides[a] + std::min(along, sides[a] - 1);
        }
        homes[p] = static_cast<std::uint32_t>(index);
        Cell<d>& home = cells[index];
        home.count += 1.0;
        home.velocity += particles.velocity.row(Eigen::Index(p)).matrix().transpose();
        home.velocity[0] += speed[p];
    }
    for (auto& c : cells)
        if (c.count > 0.0) c.velocity /= c.count;
    for (std::size_t p = 0; p < rows; ++p) {
        Cell<d>& home = cells[homes[p]];
        Vec<d> u = particles.velocity.row(Eigen::Index(p)).matrix().transpose() - home.velocity;
        u[0] += speed[p];
        home.square += sum_of_squares(u);
    }
    return lattice;
}

}  // namespace

template <int d>
void apply(Rescale const& stage, Simulation<d>& simulation, NoiseKey key) {
    Lattice<d> lattice = sort_into_cells(stage, simulation, key);
    auto& cells = lattice.cells;
    auto& particles = simulation.particles;
    double const mass = particles.mass;

    if (stage.mode == Rescaling::monte_carlo) {
        for (std::size_t c = 0; c < cells.size(); ++c) {
            Cell<d>& now = cells[c];
            if (now.count < 2.0) continue;
            auto const lot = [&](std::uint32_t which) {
                return uniform(key, static_cast<std::uint32_t>(c), which);
            };
            double const psi = 1.0 + stage.amplitude * lot(1);
            double const factor = lot(2) < 0.5 ? psi : 1.0 / psi;
            double const log_weight = d * (now.count - 1.0) * logarithm(factor) -
                                      0.5 * mass / stage.kT * now.square * (factor * factor - 1.0);
            simulation.counters.random_draws += 3;
            if (logarithm(1.0 - lot(3)) < log_weight) now.factor = factor;
        }
    } else {
        std::size_t const layer = cells.size() / lattice.sides[1];
        std::size_t const size = stage.mode == Rescaling::layers ? layer * stage.thickness : cells.size();
        for (std::size_t begin = 0; begin < cells.size(); begin += size) {
            std::size_t const end = std::min(begin + size, cells.size());
            double free = 0.0, square = 0.0;  // N - N_c, and the sum of |u|^2
            for (std::size_t c = begin; c < end; ++c) {
                free += std::max(0.0, cells[c].count - 1.0);
                square += cells[c].square;
            }
            double const factor =
                free > 0.0 && square > 0.0 ? std::sqrt(d * free * stage.kT / (mass * square)) : 1.0;
            for (std::size_t c = begin; c < end; ++c) cells[c].factor = factor;
        }
    }
    simulation.counters.random_draws += d;

    double moved = 0.0;  // sum of the changes of v_x times y
    for (Eigen::Index p = 0; p < particles.size(); ++p) {
        auto const row = static_cast<std::size_t>(p);
        Cell<d> const& home = cells[lattice.home[row]];
        double const before = particles.velocity(p, 0);
        for (int axis = 0; axis < d; ++axis) {
            double const image = axis == 0 ? lattice.speed[row] : 0.0;
            double& v = particles.velocity(p, axis);
            v = home.velocity[axis] - image + home.factor * (v + image - home.velocity[axis]);
        }
        moved += (particles.velocity(p, 0) - before) * (particles.position(p, 1) + lattice.height[row]);
    }
    simulation.stage_stress.rescaling = -mass * moved / (simulation.box.volume() * simulation.time_step);
}

template void apply(Rescale const&, Simulation<2>&, NoiseKey);
template void apply(Rescale const&, Simulation<3>&, NoiseKey);

}  // namespace dpd
