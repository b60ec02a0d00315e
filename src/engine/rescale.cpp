#include "rescale.hpp"

#include <algorithm>
#include <cmath>

namespace dpd {

// A particle above the lattice's upper end stands for its image at the lower one, which in shear lies
// elsewhere along x and moves with other speed.
template <int d>
void Rescale<d>::sort_into_cells(Simulation<d> const& simulation, NoiseKey key) {
    auto const& particles = simulation.particles;
    auto const& box = simulation.box;
    auto const rows = static_cast<std::size_t>(particles.size());
    std::array<double, d> shift;
    std::size_t count = 1;
    for (int axis = 0; axis < d; ++axis) {
        auto const a = static_cast<std::size_t>(axis);
        sides_[a] = static_cast<std::size_t>(std::llround(box.length[axis] / cell));
        shift[a] = cell * uniform(key, static_cast<std::uint32_t>(axis), 0);
        count *= sides_[a];
    }
    cells_.assign(count, {});
    home_.resize(rows);
    height_.resize(rows);
    speed_.resize(rows);
    double const offset = box.sheared() ? box.offset(simulation.time) : 0.0;
    for (std::size_t p = 0; p < rows; ++p) {
        Vec<d> place = particles.position.row(Eigen::Index(p)).matrix().transpose();
        bool const above = place[1] + shift[1] >= box.length[1];
        height_[p] = above ? -box.length[1] : 0.0;
        speed_[p] = above ? -box.image_speed() : 0.0;
        if (above) place[0] -= offset;
        std::size_t index = 0;
        for (int axis : {1, 0, 2}) {  // layers across y are contiguous
            if (axis >= d) continue;
            auto const a = static_cast<std::size_t>(axis);
            double const x = (place[axis] + shift[a]) / box.length[axis];
            auto const along = static_cast<std::size_t>((x - std::floor(x)) * double(sides_[a]));
            index = index * sides_[a] + std::min(along, sides_[a] - 1);
        }
        home_[p] = static_cast<std::uint32_t>(index);
        Cell& home = cells_[index];
        home.count += 1.0;
        home.velocity += particles.velocity.row(Eigen::Index(p)).matrix().transpose();
        home.velocity[0] += speed_[p];
    }
    for (Cell& c : cells_)
        if (c.count > 0.0) c.velocity /= c.count;
    for (std::size_t p = 0; p < rows; ++p) {
        Cell& home = cells_[home_[p]];
        Vec<d> u = particles.velocity.row(Eigen::Index(p)).matrix().transpose() - home.velocity;
        u[0] += speed_[p];
        home.square += u.squaredNorm();
    }
}

template <int d>
void Rescale<d>::operator()(Simulation<d>& simulation, NoiseKey key) {
    sort_into_cells(simulation, key);
    auto& particles = simulation.particles;
    double const mass = particles.mass;

    if (mode == Rescaling::monte_carlo) {
        for (std::size_t c = 0; c < cells_.size(); ++c) {
            Cell& now = cells_[c];
            if (now.count < 2.0) continue;
            auto const lot = [&](std::uint32_t which) {
                return uniform(key, static_cast<std::uint32_t>(c), which);
            };
            double const psi = 1.0 + amplitude * lot(1);
            double const factor = lot(2) < 0.5 ? psi : 1.0 / psi;
            double const log_weight = d * (now.count - 1.0) * std::log(factor) -
                                      0.5 * mass / kT * now.square * (factor * factor - 1.0);
            simulation.counters.random_draws += 3;
            if (std::log1p(-lot(3)) < log_weight) now.factor = factor;
        }
    } else {
        std::size_t const layer = cells_.size() / sides_[1];
        std::size_t const size = mode == Rescaling::layers ? layer * thickness : cells_.size();
        for (std::size_t begin = 0; begin < cells_.size(); begin += size) {
            std::size_t const end = std::min(begin + size, cells_.size());
            double free = 0.0, square = 0.0;  // N - N_c, and the sum of |u|^2
            for (std::size_t c = begin; c < end; ++c) {
                free += std::max(0.0, cells_[c].count - 1.0);
                square += cells_[c].square;
            }
            double const factor =
                free > 0.0 && square > 0.0 ? std::sqrt(d * free * kT / (mass * square)) : 1.0;
            for (std::size_t c = begin; c < end; ++c) cells_[c].factor = factor;
        }
    }
    simulation.counters.random_draws += d;

    double moved = 0.0;  // sum of the changes of v_x times y
    for (Eigen::Index p = 0; p < particles.size(); ++p) {
        auto const row = static_cast<std::size_t>(p);
        Cell const& home = cells_[home_[row]];
        double const before = particles.velocity(p, 0);
        for (int axis = 0; axis < d; ++axis) {
            double const image = axis == 0 ? speed_[row] : 0.0;
            double& v = particles.velocity(p, axis);
            v = home.velocity[axis] - image + home.factor * (v + image - home.velocity[axis]);
        }
        moved += (particles.velocity(p, 0) - before) * (particles.position(p, 1) + height_[row]);
    }
    simulation.stage_stress.rescaling = -mass * moved / (simulation.box.volume() * simulation.time_step);
}

template struct Rescale<2>;
template struct Rescale<3>;

}  // namespace dpd
