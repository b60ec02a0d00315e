#include "stages.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "sample.hpp"

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

// [streaming]
// Moves all particles for a time `span` that ends at `end`.
template <int d>
void stream(Simulation<d>& simulation, double span, double end) {
    auto& particles = simulation.particles;
    particles.position += particles.velocity * span;
    simulation.time = end;
    if (particles.has_walls()) simulation.box.bounce_back(particles, span);
    simulation.box.wrap(particles, simulation.time);
    simulation.positions_changed();
}
// [streaming]

// v_ij . e_ij
template <int d, class Speed>
inline double approach(double const* const (&velocity)[d], std::uint32_t i, std::uint32_t j,
                       double const (&e)[d], Speed image_speed) {
    double sum = (velocity[0][i] - velocity[0][j] - image_speed) * e[0];
    for (int axis = 1; axis < d; ++axis) sum += (velocity[axis][i] - velocity[axis][j]) * e[axis];
    return sum;
}

// The sequential update of all pairs within the cutoff; `impulse` holds the pairs' noise and gets the changes
// of velocity. The stress of friction is collected apart: noise has mean zero whatever went before. a_of(k,
// x) is A of pair k at x = r/cutoff. @eq{NG2007,4}
template <int d, class AOfPair>
void update_pairs(Simulation<d>& simulation, PairList<d>& pairs, double cutoff, double kT, AOfPair&& a_of) {
    auto& particles = simulation.particles;
    double* const impulse = pairs.impulse.data();
    double const noise = std::sqrt(2.0 * kT / particles.mass);
    double const per_cutoff = 1.0 / cutoff;
    double* velocity[d];
    for (int axis = 0; axis < d; ++axis) velocity[axis] = particles.velocity.col(axis).data();
    bool const stress_wanted = simulation.stage_stress.wanted;
    double moved = 0.0;
    for_each_pair(pairs, simulation.box, [&](std::size_t k, auto image_speed) {
        double const x = pairs.distance[k] * per_cutoff;
        double const a = x < 1.0 ? a_of(k, x) : 0.0;
        if (a == 0.0) {
            impulse[k] = 0.0;
            return;
        }
        double e[d];
        for (int axis = 0; axis < d; ++axis) e[axis] = pairs.unit[axis][k];
        auto const i = pairs.i[k], j = pairs.j[k];
        // [pair update]
        double const friction = -a * approach<d>(velocity, i, j, e, image_speed);
        double const change = friction + update_b(a, 1.0) * noise * impulse[k];
        if (stress_wanted) moved += friction * e[0] * e[1] * pairs.distance[k];
        for (int axis = 0; axis < d; ++axis) {
            velocity[axis][i] += change * e[axis];
            velocity[axis][j] -= change * e[axis];
        }
        impulse[k] = change;
        // [pair update]
    });
    simulation.stage_stress.friction -=
        particles.mass * moved / (simulation.box.volume() * simulation.time_step);
    pairs.updated = true;
}

}  // namespace

template <int d>
void Drift<d>::operator()(Simulation<d>& simulation, NoiseKey) const {
    stream(simulation, simulation.time_step, double(simulation.step + 1) * simulation.time_step);
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
    draw_pair_noise(simulation, pairs, key);
    simulation.stage_stress.friction = 0.0;
    // [shardlow]
    double const rate = friction * simulation.time_step / simulation.particles.mass;
    with_weight(weight, [&]<Weight w>() {
        with_scheme(scheme, [&]<Scheme s>() {
            update_pairs(simulation, pairs, cutoff, kT,
                         [&](std::size_t, double x) { return update_a<s>(rate * weight_at<w>(x)); });
        });
    });
    // [shardlow]
}

template <int d>
void Lowe<d>::operator()(Simulation<d>& simulation, NoiseKey key) const {
    auto& pairs = simulation.pairs();
    simulation.stage_stress.friction = 0.0;
    double const updates = rate * simulation.time_step;
    auto const sweeps = static_cast<int>(std::ceil(updates));
    if (sweeps == 0) std::fill_n(pairs.impulse.begin(), pairs.count, 0.0);
    Eigen::ArrayXd total, lot(pairs.count);
    Eigen::Map<Eigen::ArrayXd> const impulse(pairs.impulse.data(), lot.size());
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        key.sweep = static_cast<std::uint8_t>(sweep);
        draw_pair_noise(simulation, pairs, key);
        // [lowe sweep]
        double const probability = updates - sweep;
        if (probability >= 1.0) {
            update_pairs(simulation, pairs, cutoff, kT, [](std::size_t, double) { return 0.5; });
        } else {
            NoiseKey lots = key;
            lots.sweep |= 0x80;  // apart from the sweeps' normals
            pair_uniforms(lots, {pairs.i.data(), pairs.count}, {pairs.j.data(), pairs.count},
                          simulation.particles.id.data(), {lot.data(), pairs.count});
            simulation.counters.random_draws += pairs.count;
            update_pairs(simulation, pairs, cutoff, kT, [&](std::size_t k, double) {
                return lot[Eigen::Index(k)] < probability ? 0.5 : 0.0;
            });
        }
        // [lowe sweep]
        if (sweeps > 1) total = sweep == 0 ? Eigen::ArrayXd(impulse) : Eigen::ArrayXd(total + impulse);
    }
    if (sweeps > 1) std::copy_n(total.data(), pairs.count, pairs.impulse.begin());
    pairs.updated = true;
}

template <int d>
void EulerImpulses<d>::operator()(Simulation<d>& simulation, NoiseKey key) const {
    auto& pairs = simulation.pairs();
    auto& particles = simulation.particles;
    double* const impulse = draw_pair_noise(simulation, pairs, key);
    simulation.momentum_change.setZero(particles.size(), d);
    double const friction = gamma * simulation.time_step;
    double const noise = sigma * std::sqrt(simulation.time_step);
    bool const stress_wanted = simulation.stage_stress.wanted;
    double moved = 0.0;
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
            // [euler impulse]
            double const dissipative = -friction * w_d * approach<d>(velocity, i, j, e, image_speed);
            double const momentum = dissipative + noise * w_r * impulse[k];
            for (int axis = 0; axis < d; ++axis) {
                change[axis][i] += momentum * e[axis];
                change[axis][j] -= momentum * e[axis];
            }
            // [euler impulse]
            if (stress_wanted) moved += dissipative * e[0] * e[1] * pairs.distance[k];
            impulse[k] = momentum * per_mass;
        });
    });
    simulation.stage_stress.friction = -moved / (simulation.box.volume() * simulation.time_step);
    pairs.updated = true;
}

template <int d>
void Kick<d>::operator()(Simulation<d>& simulation, NoiseKey) const {
    auto& particles = simulation.particles;
    particles.velocity += simulation.momentum_change / particles.mass;
}

template <int d, class Potential>
void ForceImpulses<d, Potential>::operator()(Simulation<d>& simulation, NoiseKey) const {
    simulation.momentum_change += simulation.time_step * forces(simulation, potential);
    simulation.stage_stress.potential = -simulation.pair_virials.potential / simulation.box.volume();
}

template <int d, class Potential>
void HalfKick<d, Potential>::operator()(Simulation<d>& simulation, NoiseKey) const {
    double const kick = 0.5 * simulation.time_step / simulation.particles.mass;
    simulation.particles.velocity += kick * forces(simulation, potential);
    simulation.stage_stress.potential = -simulation.pair_virials.potential / simulation.box.volume();
}

template <int d>
void HalfDrift<d>::operator()(Simulation<d>& simulation, NoiseKey) const {
    double const half = 0.5 * simulation.time_step;
    stream(simulation, half, std::round(simulation.time / half + 1.0) * half);
}

template <int d, class Potential>
void Verlet<d, Potential>::operator()(Simulation<d>& simulation, NoiseKey) const {
    auto& particles = simulation.particles;
    auto const& box = simulation.box;
    auto& stress = simulation.stage_stress;
    double const span = simulation.time_step / double(substeps);
    double const kick = 0.5 * span / particles.mass;
    stress.kinetic = stress.potential = 0.0;
    // [substeps]
    for (std::uint64_t s = 0; s < substeps; ++s) {
        particles.velocity += kick * forces(simulation, potential);
        if (stress.wanted) {
            stress.potential += 0.5 * simulation.pair_virials.potential;
            stress.kinetic += kinetic_stress(particles, box, span);
        }
        stream(simulation, span,
               (double(simulation.step) + double(s + 1) / double(substeps)) * simulation.time_step);
        particles.velocity += kick * forces(simulation, potential);
        if (stress.wanted) stress.potential += 0.5 * simulation.pair_virials.potential;
    }
    stress.kinetic /= double(substeps);
    stress.potential /= -double(substeps) * box.volume();
    // [substeps]
    stress.streamed = true;
}

// Conservative, dissipative and random force of all pairs, from the present positions and velocities.
template <int d, class Potential>
void ModifiedVerlet<d, Potential>::find_forces(Simulation<d>& simulation, NoiseKey key) const {
    auto& pairs = simulation.pairs();
    auto& particles = simulation.particles;
    double* const noise = draw_pair_noise(simulation, pairs, key);
    double const strength = sigma / std::sqrt(simulation.time_step);
    double const per_cutoff = 1.0 / cutoff;
    simulation.force.setZero(particles.size(), d);
    double const* velocity[d];
    double* force[d];
    for (int axis = 0; axis < d; ++axis) {
        velocity[axis] = particles.velocity.col(axis).data();
        force[axis] = simulation.force.col(axis).data();
    }
    PairVirials virials;
    bool const walls = particles.has_walls();
    with_weight(weight, [&]<Weight w>() {
        for_each_pair(pairs, simulation.box, [&](std::size_t k, auto image_speed) {
            double e[d];
            for (int axis = 0; axis < d; ++axis) e[axis] = pairs.unit[axis][k];
            auto const i = pairs.i[k], j = pairs.j[k];
            double const r = pairs.distance[k], x = r * per_cutoff;
            // [modified verlet force]
            double conservative = r < potential.cutoff ? potential.force(r) : 0.0;
            if (walls) conservative *= wall_factor(simulation, i, j);
            double friction = 0.0, thermal = 0.0;
            if (x < 1.0) {
                double const w_d = weight_at<w>(x);
                friction = -gamma * w_d * approach<d>(velocity, i, j, e, image_speed);
                thermal = friction + strength * std::sqrt(w_d) * noise[k];
            }
            double const f = conservative + thermal;
            // [modified verlet force]
            for (int axis = 0; axis < d; ++axis) {
                force[axis][i] += f * e[axis];
                force[axis][j] -= f * e[axis];
            }
            double const arm = e[0] * e[1] * r;
            virials.potential += conservative * arm;
            virials.friction += friction * arm;
            virials.thermostat += thermal * arm;
            if (friction_again) noise[k] = friction;  // to be replaced
        });
    });
    if (walls) forget_wall_forces(simulation, simulation.force);
    simulation.counters.potential_evaluations += pairs.count;
    simulation.pair_virials = virials;
    simulation.forces_found();
}

// Puts the friction of the present velocities in the place of that which find_forces left.
template <int d, class Potential>
void ModifiedVerlet<d, Potential>::find_friction_again(Simulation<d>& simulation) const {
    auto& pairs = simulation.pairs();
    auto const& particles = simulation.particles;
    double const* velocity[d];
    double* force[d];
    for (int axis = 0; axis < d; ++axis) {
        velocity[axis] = particles.velocity.col(axis).data();
        force[axis] = simulation.force.col(axis).data();
    }
    double added = 0.0;
    with_weight(weight, [&]<Weight w>() {
        for_each_pair(pairs, simulation.box, [&](std::size_t k, auto image_speed) {
            double const r = pairs.distance[k], x = r / cutoff;
            if (x >= 1.0) return;
            double e[d];
            for (int axis = 0; axis < d; ++axis) e[axis] = pairs.unit[axis][k];
            auto const i = pairs.i[k], j = pairs.j[k];
            double const friction = -gamma * weight_at<w>(x) * approach<d>(velocity, i, j, e, image_speed);
            double const change = friction - pairs.impulse[k];
            for (int axis = 0; axis < d; ++axis) {
                force[axis][i] += change * e[axis];
                force[axis][j] -= change * e[axis];
            }
            added += change * e[0] * e[1] * r;
        });
    });
    if (particles.has_walls()) forget_wall_forces(simulation, simulation.force);
    simulation.pair_virials.friction += added;
    simulation.pair_virials.thermostat += added;
    simulation.counters.pair_updates += pairs.count;
}

template <int d, class Potential>
void ModifiedVerlet<d, Potential>::operator()(Simulation<d>& simulation, NoiseKey key) const {
    auto& particles = simulation.particles;
    auto& stress = simulation.stage_stress;
    double const dt = simulation.time_step;
    double const kick = 0.5 * dt / particles.mass, prediction = (lambda - 0.5) * dt;
    if (!simulation.forces_valid()) {  // at the start
        NoiseKey first = key;
        first.sweep = 1;
        find_forces(simulation, first);
    }
    auto const before = simulation.pair_virials;
    // [modified verlet]
    particles.velocity += kick * simulation.force;
    if (stress.wanted) stress.kinetic = kinetic_stress(particles, simulation.box, dt);
    stream(simulation, dt, double(simulation.step + 1) * dt);
    // what the prediction adds waits to be taken back, since the search may sort the particles
    if (prediction != 0.0) {
        particles.velocity += prediction / particles.mass * simulation.force;
        simulation.momentum_change = -prediction * simulation.force;
    }
    find_forces(simulation, key);
    if (prediction != 0.0) particles.velocity += simulation.momentum_change / particles.mass;
    particles.velocity += kick * simulation.force;
    // [modified verlet]
    auto const average = [&](double PairVirials::*part) {
        return -0.5 * (before.*part + simulation.pair_virials.*part) / simulation.box.volume();
    };
    stress.potential = average(&PairVirials::potential);
    stress.collision = average(&PairVirials::thermostat);
    stress.friction = average(&PairVirials::friction);
    stress.streamed = true;
    if (friction_again) find_friction_again(simulation);
}

// [body force]
template <int d>
void BodyForce<d>::operator()(Simulation<d>& simulation, NoiseKey) const {
    auto& particles = simulation.particles;
    double const kick = acceleration * simulation.time_step, middle = 0.5 * simulation.box.length[1];
    for (Eigen::Index p = 0; p < particles.size(); ++p)
        if (!particles.frozen(p))
            particles.velocity(p, 0) += opposed && particles.position(p, 1) >= middle ? -kick : kick;
}
// [body force]

template struct Drift<2>;
template struct Drift<3>;
template struct Scatter<2>;
template struct Scatter<3>;
template struct Shardlow<2>;
template struct Shardlow<3>;
template struct Lowe<2>;
template struct Lowe<3>;
template struct EulerImpulses<2>;
template struct EulerImpulses<3>;
template struct Kick<2>;
template struct Kick<3>;
template struct HalfDrift<2>;
template struct HalfDrift<3>;
template struct ForceImpulses<2, Soft>;
template struct ForceImpulses<3, Soft>;
template struct ForceImpulses<2, LennardJones>;
template struct ForceImpulses<3, LennardJones>;
template struct HalfKick<2, Soft>;
template struct HalfKick<3, Soft>;
template struct HalfKick<2, LennardJones>;
template struct HalfKick<3, LennardJones>;
template struct Verlet<2, Soft>;
template struct Verlet<3, Soft>;
template struct Verlet<2, LennardJones>;
template struct Verlet<3, LennardJones>;
template struct ModifiedVerlet<2, Soft>;
template struct ModifiedVerlet<3, Soft>;
template struct ModifiedVerlet<2, LennardJones>;
template struct ModifiedVerlet<3, LennardJones>;
// [body force instances]
template struct BodyForce<2>;
template struct BodyForce<3>;
// [body force instances]

}  // namespace dpd
