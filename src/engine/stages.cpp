/// @file
/// What the stages do to the particles, fast: the pairs in blocks, their coefficients in vectors.
#include "stages.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "forces.hpp"
#include "pair_loop.hpp"
#include "rescale.hpp"
#include "stress.hpp"
#include "wide.hpp"

namespace dpd {
namespace {

// Standard normals of the pairs of a block, in `impulse`, where the update replaces each by its impulse.
template <int d>
void draw_pair_noise(Simulation<d>& simulation, PairList<d>& pairs, NoiseKey key, PairBlock block) {
    pair_normals(key, {&pairs.i[block.begin], block.size()}, {&pairs.j[block.begin], block.size()},
                 simulation.particles.id.data(), {&pairs.impulse[block.begin], block.size()});
    simulation.counters.count_updates(block.size());
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

// The components of a particle, whose row begins at `begin`.
template <int d>
inline std::array<double, d> row(double const* field, std::size_t begin) {
    std::array<double, d> components;
    for (std::size_t axis = 0; axis < d; ++axis) components[axis] = field[begin + axis];
    return components;
}

// v_ij . e_ij
template <std::size_t d, class Speed>
inline double approach(std::array<double, d> const& v_i, std::array<double, d> const& v_j,
                       std::array<double, d> const& e, Speed image_speed) {
    double sum = (v_i[0] - v_j[0] - image_speed) * e[0];
    for (std::size_t axis = 1; axis < d; ++axis) sum += (v_i[axis] - v_j[axis]) * e[axis];
    return sum;
}

// The sequential update of all pairs within the cutoff; `impulse` gets the changes of velocity. The stress of
// friction is collected apart: noise has mean zero whatever went before. @eq{NG2007,4}
template <int d, class AOfPair>
void update_pairs(Simulation<d>& simulation, PairList<d>& pairs, NoiseKey key, double cutoff, double kT,
                  AOfPair a_of) {
    auto& particles = simulation.particles;
    PairView<d> const view(pairs);
    double const noise = std::sqrt(2.0 * kT / particles.mass);
    bool const stress_wanted = simulation.stage_stress.wanted;
    double* const v = particles.velocity.data();
    double moved = 0.0;
    std::array<double, block_size> a;
    for_each_block(pairs, [&](PairBlock block) {
        draw_pair_noise(simulation, pairs, key, block);
        double const* const r = view.distance + block.begin;
        double* const impulse = view.impulse + block.begin;  // now standard normals
        wide_loop(block.size(), [=, per_cutoff = 1.0 / cutoff, a = a.data()](std::size_t k) {
            // [pair coefficients]
            double const x = r[k] * per_cutoff;
            a[k] = x < 1.0 ? a_of(block.begin + k, x) : 0.0;
            impulse[k] *= update_b(a[k], 1.0) * noise;
            // [pair coefficients]
        });
        for_each_pair(pairs, simulation.box, block, [=, a = a.data()](std::size_t k, auto image_speed) {
            double& a_k = a[k - block.begin];
            if (a_k == 0.0) return;
            auto const [i, j, e] = PairRows<d>(view, k);
            auto const v_i = row<d>(v, i), v_j = row<d>(v, j);
            // [pair update]
            double const friction = -a_k * approach(v_i, v_j, e, image_speed);
            double const change = friction + view.impulse[k];
            for (int axis = 0; axis < d; ++axis) {
                v[i + axis] = v_i[axis] + change * e[axis];
                v[j + axis] = v_j[axis] - change * e[axis];
            }
            view.impulse[k] = change;
            // [pair update]
            a_k = friction;  // for the stress; A is not needed any more
        });
        if (stress_wanted) moved += sum_of_arms(view, block, a.data());
    });
    simulation.stage_stress.friction -=
        particles.mass * moved / (simulation.box.volume() * simulation.time_step);
    pairs.updated = true;
}

template <int d>
void apply(Drift const&, Simulation<d>& simulation, NoiseKey) {
    stream(simulation, simulation.time_step, double(simulation.step + 1) * simulation.time_step);
}

template <int d>
void apply(Scatter const&, Simulation<d>& simulation, NoiseKey key) {
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
void apply(Shardlow const& stage, Simulation<d>& simulation, NoiseKey key) {
    auto& pairs = simulation.pairs();
    simulation.stage_stress.friction = 0.0;
    // [shardlow]
    double const rate = stage.friction * simulation.time_step / simulation.particles.mass;
    with_value(stage.weight.kind, [&]<Weight::Kind w>() {
        with_value(stage.scheme, [&]<Scheme s>() {
            update_pairs(simulation, pairs, key, stage.cutoff, stage.kT,
                         [=, exponent = stage.weight.exponent](std::size_t, double x) {
                             return update_a<s>(rate * weight_at<w>(x, exponent));
                         });
        });
    });
    // [shardlow]
}

template <int d>
void apply(Lowe const& stage, Simulation<d>& simulation, NoiseKey key) {
    auto& pairs = simulation.pairs();
    simulation.stage_stress.friction = 0.0;
    double const updates = stage.rate * simulation.time_step;
    auto const sweeps = static_cast<int>(std::ceil(updates));
    if (sweeps == 0) std::fill_n(pairs.impulse.begin(), pairs.count, 0.0);
    Eigen::ArrayXd total, lot(pairs.count);
    Eigen::Map<Eigen::ArrayXd> const impulse(pairs.impulse.data(), lot.size());
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        key.sweep = static_cast<std::uint8_t>(sweep);
        // [lowe sweep]
        double const probability = updates - sweep;
        if (probability >= 1.0) {
            update_pairs(simulation, pairs, key, stage.cutoff, stage.kT,
                         [](std::size_t, double) { return 0.5; });
        } else {
            NoiseKey lots = key;
            lots.sweep |= 0x80;  // apart from the sweeps' normals
            pair_uniforms(lots, {pairs.i.data(), pairs.count}, {pairs.j.data(), pairs.count},
                          simulation.particles.id.data(), {lot.data(), pairs.count});
            simulation.counters.random_draws += pairs.count;
            update_pairs(simulation, pairs, key, stage.cutoff, stage.kT, [&](std::size_t k, double) {
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
void apply(EulerImpulses const& stage, Simulation<d>& simulation, NoiseKey key) {
    auto& pairs = simulation.pairs();
    PairView<d> const view(pairs);
    auto& particles = simulation.particles;
    simulation.momentum_change.setZero(particles.size(), d);
    double const most_drag = stage.gamma * simulation.time_step;
    double const noise = stage.sigma * std::sqrt(simulation.time_step);
    bool const stress_wanted = simulation.stage_stress.wanted;
    double moved = 0.0;
    double const per_mass = 1.0 / particles.mass;
    double const* const v = particles.velocity.data();
    double* const change = simulation.momentum_change.data();
    std::array<double, block_size> drag, friction;  // momentum per speed, and momentum
    for_each_block(pairs, [&](PairBlock block) {
        draw_pair_noise(simulation, pairs, key, block);
        double const* const r = view.distance + block.begin;
        double* const impulse = view.impulse + block.begin;  // now standard normals
        with_value(stage.weight.kind, [&]<Weight::Kind w>() {
            // by the caller's w_R, since a branch for every pair would leave vectors unused
            auto const find_coefficients = [&](auto random_weight) {
                wide_loop(block.size(), [=, per_cutoff = 1.0 / stage.cutoff, exponent = stage.weight.exponent,
                                         drag = drag.data()](std::size_t k) {
                    // [euler coefficients]
                    double const x = r[k] * per_cutoff;
                    double const w_d = x < 1.0 ? weight_at<w>(x, exponent) : 0.0;
                    double const w_r = random_weight(x, w_d);
                    drag[k] = most_drag * w_d;
                    impulse[k] *= noise * w_r;
                    // [euler coefficients]
                });
            };
            if (stage.random_weight)
                find_coefficients(
                    [own = *stage.random_weight](double x, double) { return weight_at(own, x); });
            else
                find_coefficients([](double, double w_d) { return std::sqrt(w_d); });
        });
        for_each_pair(pairs, simulation.box, block,
                      [=, drag = drag.data(), friction = friction.data()](std::size_t k, auto image_speed) {
                          auto const [i, j, e] = PairRows<d>(view, k);
                          // [euler impulse]
                          double const dissipative =
                              -drag[k - block.begin] * approach(row<d>(v, i), row<d>(v, j), e, image_speed);
                          double const momentum = dissipative + view.impulse[k];
                          for (int axis = 0; axis < d; ++axis) {
                              change[i + axis] += momentum * e[axis];
                              change[j + axis] -= momentum * e[axis];
                          }
                          // [euler impulse]
                          friction[k - block.begin] = dissipative;
                          view.impulse[k] = momentum * per_mass;
                      });
        if (stress_wanted) moved += sum_of_arms(view, block, friction.data());
    });
    simulation.stage_stress.friction = -moved / (simulation.box.volume() * simulation.time_step);
    pairs.updated = true;
}

template <int d>
void apply(Kick const&, Simulation<d>& simulation, NoiseKey) {
    auto& particles = simulation.particles;
    particles.velocity += simulation.momentum_change / particles.mass;
}

template <int d>
void apply(ForceImpulses const& stage, Simulation<d>& simulation, NoiseKey) {
    simulation.momentum_change += simulation.time_step * forces(simulation, stage.potential);
    simulation.stage_stress.potential = -simulation.pair_virials.potential / simulation.box.volume();
}

template <int d>
void apply(HalfKick const& stage, Simulation<d>& simulation, NoiseKey) {
    double const kick = 0.5 * simulation.time_step / simulation.particles.mass;
    simulation.particles.velocity += kick * forces(simulation, stage.potential);
    simulation.stage_stress.potential = -simulation.pair_virials.potential / simulation.box.volume();
}

template <int d>
void apply(HalfDrift const&, Simulation<d>& simulation, NoiseKey) {
    double const half = 0.5 * simulation.time_step;
    stream(simulation, half, std::round(simulation.time / half + 1.0) * half);
}

template <int d>
void apply(Verlet const& stage, Simulation<d>& simulation, NoiseKey) {
    auto& particles = simulation.particles;
    auto const& box = simulation.box;
    auto& stress = simulation.stage_stress;
    double const span = simulation.time_step / double(stage.substeps);
    double const kick = 0.5 * span / particles.mass;
    stress.kinetic = stress.potential = 0.0;
    // [substeps]
    for (std::uint64_t s = 0; s < stage.substeps; ++s) {
        particles.velocity += kick * forces(simulation, stage.potential);
        if (stress.wanted) {
            stress.potential += 0.5 * simulation.pair_virials.potential;
            stress.kinetic += kinetic_stress(particles, box, span);
        }
        stream(simulation, span,
               (double(simulation.step) + double(s + 1) / double(stage.substeps)) * simulation.time_step);
        particles.velocity += kick * forces(simulation, stage.potential);
        if (stress.wanted) stress.potential += 0.5 * simulation.pair_virials.potential;
    }
    stress.kinetic /= double(stage.substeps);
    stress.potential /= -double(stage.substeps) * box.volume();
    // [substeps]
    stress.streamed = true;
}

// Conservative, dissipative and random force of all pairs, from the present positions and velocities.
template <int d, class Potential>
void find_forces(ModifiedVerlet const& stage, Potential const& potential, Simulation<d>& simulation,
                 NoiseKey key) {
    auto& pairs = simulation.pairs();
    PairView<d> const view(pairs);
    auto& particles = simulation.particles;
    double const strength = stage.sigma / std::sqrt(simulation.time_step);
    simulation.force.setZero(particles.size(), d);
    double const* const v = particles.velocity.data();
    double* const force = simulation.force.data();
    PairVirials virials;
    double friction_virial = 0.0;
    bool const walls = particles.has_walls();
    std::array<double, block_size> conservative, drag, friction;  // force, force per speed, force
    for_each_block(pairs, [&](PairBlock block) {
        draw_pair_noise(simulation, pairs, key, block);
        double const* const r = view.distance + block.begin;
        double* const impulse = view.impulse + block.begin;  // now standard normals
        with_value(stage.weight.kind, [&]<Weight::Kind w>() {
            wide_loop(block.size(), [=, gamma = stage.gamma, per_cutoff = 1.0 / stage.cutoff,
                                     exponent = stage.weight.exponent, conservative = conservative.data(),
                                     drag = drag.data()](std::size_t k) {
                // [modified verlet force]
                double const x = r[k] * per_cutoff;
                double const w_d = x < 1.0 ? weight_at<w>(x, exponent) : 0.0;
                conservative[k] = r[k] < potential.cutoff ? potential.force(r[k]) : 0.0;
                drag[k] = gamma * w_d;
                impulse[k] *= strength * std::sqrt(w_d);
                // [modified verlet force]
            });
        });
        if (walls)
            for (std::size_t k = 0; k < block.size(); ++k)
                conservative[k] *= wall_factor(simulation, view.i[block.begin + k], view.j[block.begin + k]);
        for_each_pair(pairs, simulation.box, block,
                      [=, conservative = conservative.data(), drag = drag.data(), friction = friction.data()](
                          std::size_t k, auto image_speed) {
                          auto const [i, j, e] = PairRows<d>(view, k);
                          // [modified verlet sum]
                          double const dissipative =
                              -drag[k - block.begin] * approach(row<d>(v, i), row<d>(v, j), e, image_speed);
                          double const thermal = dissipative + view.impulse[k];
                          double const f = conservative[k - block.begin] + thermal;
                          for (int axis = 0; axis < d; ++axis) {
                              force[i + axis] += f * e[axis];
                              force[j + axis] -= f * e[axis];
                          }
                          // [modified verlet sum]
                          friction[k - block.begin] = dissipative;
                          view.impulse[k] = thermal;
                      });
        if (simulation.stage_stress.wanted) {
            virials.potential += sum_of_arms(view, block, conservative.data());
            virials.friction += sum_of_arms(view, block, friction.data());
            virials.thermostat += sum_of_arms(view, block, impulse);
        }
        if (simulation.stage_stress.virial_wanted)
            friction_virial += sum_of_virials(view, block, friction.data());
        // what find_friction_again will take off again
        if (stage.friction_again) std::copy_n(friction.data(), block.size(), impulse);
    });
    if (walls) forget_wall_forces(simulation, simulation.force);
    simulation.counters.potential_evaluations += pairs.count;
    simulation.pair_virials = virials;
    simulation.stage_stress.friction_virial = friction_virial;
    simulation.forces_found();
}

// Puts the friction of the present velocities in the place of that which find_forces left.
template <int d>
void find_friction_again(ModifiedVerlet const& stage, Simulation<d>& simulation) {
    auto& pairs = simulation.pairs();
    PairView<d> const view(pairs);
    auto const& particles = simulation.particles;
    double const* const v = particles.velocity.data();
    double* const force = simulation.force.data();
    double added = 0.0;
    std::array<double, block_size> change;
    for_each_block(pairs, [&](PairBlock block) {
        with_value(stage.weight.kind, [&]<Weight::Kind w>() {
            auto const again = [=, gamma = stage.gamma, per_cutoff = 1.0 / stage.cutoff,
                                exponent = stage.weight.exponent,
                                change = change.data()](std::size_t k, auto image_speed) {
                double const x = view.distance[k] * per_cutoff;
                auto const [i, j, e] = PairRows<d>(view, k);
                double const friction = x < 1.0 ? -gamma * weight_at<w>(x, exponent) *
                                                      approach(row<d>(v, i), row<d>(v, j), e, image_speed)
                                                : 0.0;
                double& difference = change[k - block.begin];
                difference = friction - view.impulse[k];
                for (int axis = 0; axis < d; ++axis) {
                    force[i + axis] += difference * e[axis];
                    force[j + axis] -= difference * e[axis];
                }
            };
            for_each_pair(pairs, simulation.box, block, again);
        });
        if (simulation.stage_stress.wanted) added += sum_of_arms(view, block, change.data());
    });
    if (particles.has_walls()) forget_wall_forces(simulation, simulation.force);
    simulation.pair_virials.friction += added;
    simulation.pair_virials.thermostat += added;
    simulation.counters.pair_updates += pairs.count;
}

template <int d>
void apply(ModifiedVerlet const& stage, Simulation<d>& simulation, NoiseKey key) {
    auto& particles = simulation.particles;
    auto& stress = simulation.stage_stress;
    double const dt = simulation.time_step;
    double const kick = 0.5 * dt / particles.mass, prediction = (stage.lambda - 0.5) * dt;
    auto const find = [&](NoiseKey with) {
        std::visit([&](auto const& potential) { find_forces(stage, potential, simulation, with); },
                   stage.potential);
    };
    if (!simulation.forces_valid()) {  // at the start
        NoiseKey first = key;
        first.sweep = 1;
        find(first);
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
    find(key);
    if (prediction != 0.0) particles.velocity += simulation.momentum_change / particles.mass;
    particles.velocity += kick * simulation.force;
    // [modified verlet]
    stress.take_mean_of(before, simulation.pair_virials, simulation.box.volume());
    stress.streamed = true;
    if (stage.friction_again) find_friction_again(stage, simulation);
}

// [body force]
template <int d>
void apply(BodyForce const& stage, Simulation<d>& simulation, NoiseKey) {
    auto& particles = simulation.particles;
    double const kick = stage.acceleration * simulation.time_step, middle = 0.5 * simulation.box.length[1];
    for (Eigen::Index p = 0; p < particles.size(); ++p)
        if (!particles.frozen(p))
            particles.velocity(p, 0) += stage.opposed && particles.position(p, 1) >= middle ? -kick : kick;
}
// [body force]

template <int d>
void apply(Sample const&, Simulation<d>& simulation, NoiseKey) {
    if (simulation.sample) simulation.sample(simulation);
}

}  // namespace

template <int d>
Stage<d>::Stage(AnyStage const& stage)
    : name(kind_of(stage).name),
      act(std::visit(
          [](auto const& parameters) -> Act {
              return [parameters](Simulation<d>& simulation, NoiseKey key) {
                  apply(parameters, simulation, key);
              };
          },
          stage)) {}

template struct Stage<2>;
template struct Stage<3>;

}  // namespace dpd
