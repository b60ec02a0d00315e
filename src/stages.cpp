#include "stages.hpp"

#include <cmath>
#include <type_traits>

namespace dpd {
namespace {

// Standard normals of all pairs of the list, in `impulse`, where the update replaces each by its impulse.
template <int d>
double* draw_pair_noise(Simulation<d>& simulation, PairList<d>& pairs, NoiseKey key) {
    pair_normals(key, {pairs.i.data(), pairs.count}, {pairs.j.data(), pairs.count},
                 simulation.particles.id.data(), {pairs.impulse.data(), pairs.count});
    simulation.counters.random_draws += pairs.count;
    simulation.counters.pair_updates += pairs.count;
    return pairs.impulse.data();
}

// Calls visit(k, speed) for every pair of the list, where `speed` is that of j's image along x: zero, known
// at compile time, except across a sheared boundary.
template <int d, class Visit>
void for_each_pair(PairList<d> const& pairs, Box<d> const& box, Visit&& visit) {
    double const speed = box.image_speed();
    std::size_t k = 0;
    for (std::size_t const crossing : pairs.crossing) {
        for (; k < crossing; ++k) visit(k, std::integral_constant<int, 0>{});
        visit(k++, speed);
    }
    for (; k < pairs.count; ++k) visit(k, std::integral_constant<int, 0>{});
}

// v_ij . e_ij
template <int d, class Speed>
inline double approach(double const* const (&velocity)[d], std::uint32_t i, std::uint32_t j,
                       double const (&e)[d], Speed image_speed) {
    double sum = (velocity[0][i] - velocity[0][j] - image_speed) * e[0];
    for (int axis = 1; axis < d; ++axis) sum += (velocity[axis][i] - velocity[axis][j]) * e[axis];
    return sum;
}

}  // namespace

template <int d>
void Drift<d>::operator()(Simulation<d>& simulation, NoiseKey) const {
    auto& particles = simulation.particles;
    particles.position += particles.velocity * simulation.time_step;
    simulation.time = double(simulation.step + 1) * simulation.time_step;
    simulation.box.wrap(particles, simulation.time);
    simulation.positions_changed();
}

template <int d>
void Scatter<d>::operator()(Simulation<d>& simulation, NoiseKey key) const {
    auto& particles = simulation.particles;
    auto const& box = simulation.box;
    for (Eigen::Index p = 0; p < particles.size(); ++p) {
        double const y = particles.position(p, 1);
        for (int axis = 0; axis < d; ++axis)
            particles.position(p, axis) =
                box.length[axis] * uniform(key, particles.id[p], static_cast<std::uint32_t>(axis));
        particles.velocity(p, 0) += box.shear_rate * (particles.position(p, 1) - y);
    }
    simulation.counters.random_draws += static_cast<std::uint64_t>(particles.size()) * d;
    simulation.positions_changed();
}

template <int d>
void Shardlow<d>::operator()(Simulation<d>& simulation, NoiseKey key) const {
    auto& pairs = simulation.pairs();
    auto& particles = simulation.particles;
    double* const impulse = draw_pair_noise(simulation, pairs, key);
    double const rate = friction * simulation.time_step / particles.mass;
    double const noise = std::sqrt(2.0 * kT / particles.mass);
    double const per_cutoff = 1.0 / cutoff;

    double* velocity[d];
    for (int axis = 0; axis < d; ++axis) velocity[axis] = particles.velocity.col(axis).data();
    with_weight(weight, [&]<Weight w>() {
        for_each_pair(pairs, simulation.box, [&](std::size_t k, auto image_speed) {
            double const x = pairs.distance[k] * per_cutoff;
            if (x >= 1.0) {
                impulse[k] = 0.0;
                return;
            }
            double const a = shardlow_a(rate * weight_at<w>(x));
            double e[d];
            for (int axis = 0; axis < d; ++axis) e[axis] = pairs.unit[axis][k];
            auto const i = pairs.i[k], j = pairs.j[k];
            double const change =
                -a * approach<d>(velocity, i, j, e, image_speed) + shardlow_b(a, 1.0) * noise * impulse[k];
            for (int axis = 0; axis < d; ++axis) {
                velocity[axis][i] += change * e[axis];
                velocity[axis][j] -= change * e[axis];
            }
            impulse[k] = change;
        });
    });
}

template <int d>
void EulerImpulses<d>::operator()(Simulation<d>& simulation, NoiseKey key) const {
    auto& pairs = simulation.pairs();
    auto& particles = simulation.particles;
    double* const impulse = draw_pair_noise(simulation, pairs, key);
    simulation.momentum_change.setZero(particles.size(), d);
    double const friction = gamma * simulation.time_step;
    double const noise = sigma * std::sqrt(simulation.time_step);
    double const per_mass = 1.0 / particles.mass;
    double const per_cutoff = 1.0 / cutoff;

    double const* velocity[d];
    double* change[d];
    for (int axis = 0; axis < d; ++axis) {
        velocity[axis] = particles.velocity.col(axis).data();
        change[axis] = simulation.momentum_change.col(axis).data();
    }
    with_weight(weight, [&]<Weight w>() {
        for_each_pair(pairs, simulation.box, [&](std::size_t k, auto image_speed) {
            double const x = pairs.distance[k] * per_cutoff;
            if (x >= 1.0) {
                impulse[k] = 0.0;
                return;
            }
            double const w_d = weight_at<w>(x);
            double const w_r = matched ? std::sqrt(w_d) : weight_at(random_weight, x);
            double e[d];
            for (int axis = 0; axis < d; ++axis) e[axis] = pairs.unit[axis][k];
            auto const i = pairs.i[k], j = pairs.j[k];
            double const momentum =
                -friction * w_d * approach<d>(velocity, i, j, e, image_speed) + noise * w_r * impulse[k];
            for (int axis = 0; axis < d; ++axis) {
                change[axis][i] += momentum * e[axis];
                change[axis][j] -= momentum * e[axis];
            }
            impulse[k] = momentum * per_mass;
        });
    });
}

template <int d>
void Kick<d>::operator()(Simulation<d>& simulation, NoiseKey) const {
    auto& particles = simulation.particles;
    particles.velocity += simulation.momentum_change / particles.mass;
}

template struct Drift<2>;
template struct Drift<3>;
template struct Scatter<2>;
template struct Scatter<3>;
template struct Shardlow<2>;
template struct Shardlow<3>;
template struct EulerImpulses<2>;
template struct EulerImpulses<3>;
template struct Kick<2>;
template struct Kick<3>;

}  // namespace dpd
