/// @file
/// The plain engine: the papers as code, to be read from top to bottom. All pairs are looked at, in the order
/// of ids; an equation is a loop; nothing is done for speed. The fast engine has its bits (plain_test).
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "elementary.hpp"
#include "stages.hpp"
#include "state.hpp"
#include "stress.hpp"
#include "sums.hpp"

namespace dpd::plain {

/// A standard normal variate of the pair {i, j}, in whichever order; one uniform in [0, 1) of (a, b).
double normal_noise(NoiseKey key, std::uint32_t i, std::uint32_t j);
double uniform_noise(NoiseKey key, std::uint32_t a, std::uint32_t b);

/// What the stages of a time step do to the state: `act` is called for each that the scene names, in turn,
/// with the key of its noise: seed, step, and place in the list. Row i of a field is the particle with id i.
template <int d>
struct Stages {
    State<d>& state;                                               ///< that the stages change
    Field<d>& r = state.particles.position;                        ///< positions, N x d
    Field<d>& v = state.particles.velocity;                        ///< velocities, N x d
    Field<d>& f = state.force;                                     ///< forces at the present positions, N x d
    PairList<d>& list = state.pair_list;                           ///< all pairs within the cutoff
    StageStress& stress = state.stage_stress;                      ///< what stages measure while they move
    Box<d> const& box = state.box;                                 ///< that holds the particles
    double const m = state.particles.mass, volume = box.volume();  ///< of a particle; of the box
    double const dt = state.time_step, half = 0.5 * dt;            ///< the step, and half of it
    Eigen::Index const N = r.rows();                               ///< number of particles
    using Row = Eigen::Array<double, 1, d>;                        ///< one particle's components
    /// r += v dt. @eq{MY1997,1}
    void act(Drift const&, NoiseKey) { stream(dt, double(state.step + 1) * dt); }
    /// r += v dt/2.
    void act(HalfDrift const&, NoiseKey) { stream(half, std::round(state.time / half + 1.0) * half); }

    /// Moves all particles for a time `span` that ends at `end`.
    // [streaming]
    void stream(double span, double end) {
        r += v * span;
        state.time = end;
        if (state.particles.has_walls()) box.bounce_back(state.particles, span);
        box.wrap(state.particles, state.time);
        state.positions_changed();
    }
    // [streaming]

    /// New positions, uniformly random; velocities relative to the flow stay.
    void act(Scatter const&, NoiseKey key) {
        for (std::uint32_t i = 0; i < N; ++i) {
            double const y = r(i, 1);
            for (std::uint32_t axis = 0; axis < d; ++axis)
                r(i, axis) = box.length[axis] * uniform_noise(key, i, axis);
            v(i, 0) += box.shear_rate * (r(i, 1) - y);
        }
        state.counters.random_draws += std::uint64_t(r.size());
        state.positions_changed();
    }

    // [body force]
    /// v_x += acceleration dt, or its opposite in the upper half of the box.
    void act(BodyForce const& p, NoiseKey) {
        for (Eigen::Index i = 0; i < N; ++i) {
            bool const opposite = p.opposed && r(i, 1) >= 0.5 * box.length[1];
            if (!state.particles.frozen(i)) v(i, 0) += (opposite ? -p.acceleration : p.acceleration) * dt;
        }
    }
    // [body force]

    /// v_ij . e
    double approach(Pair<d> const& p) const {
        Row v_ij = v.row(p.i) - v.row(p.j);
        if (p.crossing) v_ij[0] -= box.image_speed();
        double sum = v_ij[0] * p.e[0];
        for (int axis = 1; axis < d; ++axis) sum += v_ij[axis] * p.e[axis];
        return sum;
    }

    /// Fills the list of pairs: the nearest image of each, in shear that of Lees & Edwards.
    void find_pairs() {
        list.clear();
        double const offset = std::remainder(box.offset(state.time), box.length[0]);
        for (std::uint32_t a = 0; a < N; ++a)
            for (std::uint32_t b = a + 1; b < N; ++b) {
                // across a sheared boundary j is the one whose image lies above the box, displaced along x
                bool const crossing = box.sheared() && std::abs(r(a, 1) - r(b, 1)) > 0.5 * box.length[1];
                bool const turned = crossing && r(a, 1) < r(b, 1);
                std::uint32_t const i = turned ? b : a, j = turned ? a : b;
                Row r_ij = r.row(i) - r.row(j);
                if (crossing) r_ij[0] -= offset;
                double squared = 0.0;
                for (int axis = 0; axis < d; ++axis) {
                    double const side = box.length[axis];
                    if (std::abs(r_ij[axis]) > 0.5 * side) r_ij[axis] -= std::copysign(side, r_ij[axis]);
                    squared += r_ij[axis] * r_ij[axis];
                }
                if (squared == 0.0) ++list.coincident;  // no direction, so no interaction
                if (squared == 0.0 || squared >= list.cutoff * list.cutoff) continue;
                list.append({i, j, r_ij * (1.0 / std::sqrt(squared)), std::sqrt(squared), crossing});
            }
        state.pairs_found(state.step);
    }

    /// The list is good until positions change.
    void need_pairs() {
        if (state.pairs_of_step()) return;
        find_pairs();
        state.counters.count_search(list);
    }

    // [pair update]
    /// v_i += {-A v_ij.e + B xi} e, v_j -= the same, one pair after the other. @eq{NG2007,4}
    template <class A>
    void update_pairs(NoiseKey key, double kT, A const& a_of) {
        std::vector<double> moments;
        for (std::size_t k = 0; k < list.count; ++k) {
            auto const ij = list.pair(k);
            double const a = a_of(ij), b = update_b(a, 1.0) * std::sqrt(2.0 * kT / m);
            double const friction = -a * approach(ij), noise = normal_noise(key, ij.i, ij.j) * b;
            v.row(ij.i) += (friction + noise) * ij.e;
            v.row(ij.j) -= (friction + noise) * ij.e;
            list.impulse[k] = friction + noise;
            moments.push_back(moment(ij, friction));
        }
        stress.friction -= m * sum_in_blocks(moments) / (volume * dt);
        list.updated = true;
        state.counters.count_updates(list.count);
    }

    /// S1 and its relatives: A of the friction w dt/m. @eq{NG2007,5}
    void act(Shardlow const& p, NoiseKey key) {
        need_pairs();
        stress.friction = 0.0;
        update_pairs(key, p.kT, [&](Pair<d> const& ij) {
            return update_a(p.scheme, p.friction * dt / m * weight_at(p.weight, ij.r * (1.0 / p.cutoff)));
        });
    }
    // [pair update]

    /// Lowe-Andersen: A = 1/2, with probability rate*dt; above one per step in several sweeps. @eq{NG2007,6}
    void act(Lowe const& p, NoiseKey key) {
        need_pairs();
        stress.friction = 0.0;
        std::vector<double> impulse(list.count, 0.0);
        // [lowe]
        for (int sweep = 0; sweep < p.rate * dt; ++sweep) {
            key.sweep = std::uint8_t(sweep);
            NoiseKey lots = key;
            lots.sweep |= 0x80;  // apart from the sweeps' normals
            double const probability = p.rate * dt - sweep;
            update_pairs(key, p.kT, [&](Pair<d> const& ij) {
                if (ij.r * (1.0 / p.cutoff) >= 1.0) return 0.0;
                if (probability >= 1.0) return 0.5;
                return uniform_noise(lots, std::min(ij.i, ij.j), std::max(ij.i, ij.j)) < probability ? 0.5
                                                                                                     : 0.0;
            });
            if (probability < 1.0) state.counters.random_draws += list.count;
            for (std::size_t k = 0; k < list.count; ++k) impulse[k] += list.impulse[k];
        }
        // [lowe]
        std::copy(impulse.begin(), impulse.end(), list.impulse.begin());
        list.updated = true;
    }

    /// Impulses of friction and noise in an Euler step, which wait for the kick. @eq{MY1997,2}
    void act(EulerImpulses const& p, NoiseKey key) {
        need_pairs();
        state.momentum_change.setZero(N, d);
        std::vector<double> moments;
        for (std::size_t k = 0; k < list.count; ++k) {
            // [euler]
            auto const ij = list.pair(k);
            double const x = ij.r * (1.0 / p.cutoff), w_d = weight_at(p.weight, x);
            double const w_r = p.random_weight ? weight_at(*p.random_weight, x) : std::sqrt(w_d);
            double const friction = -(p.gamma * dt * w_d) * approach(ij);
            double const noise = normal_noise(key, ij.i, ij.j) * (p.sigma * std::sqrt(dt) * w_r);
            state.momentum_change.row(ij.i) += (friction + noise) * ij.e;
            state.momentum_change.row(ij.j) -= (friction + noise) * ij.e;
            // [euler]
            list.impulse[k] = (friction + noise) * (1.0 / m);
            moments.push_back(moment(ij, friction));
        }
        stress.friction = -sum_in_blocks(moments) / (volume * dt);
        list.updated = true;
        state.counters.count_updates(list.count);
    }

    /// v += what waits, over m.
    void act(Kick const&, NoiseKey) { v += state.momentum_change / m; }

    /// Adds the forces at the present positions to `field`; returns the sum of their moments.
    double add_forces(AnyPotential const& potential, Field<d>& field) {
        need_pairs();
        std::vector<double> moments;
        for (std::size_t k = 0; k < list.count; ++k) {
            // [forces]
            auto const ij = list.pair(k);
            double const force = force_at(potential, ij.r) * wall_factor(state, ij.i, ij.j);
            field.row(ij.i) += force * ij.e;
            field.row(ij.j) -= force * ij.e;
            // [forces]
            moments.push_back(moment(ij, force));
        }
        forget_wall_forces(state, field);
        state.counters.potential_evaluations += list.count;
        return sum_in_blocks(moments);
    }

    /// f becomes the force at the present positions, which is found once.
    void need_forces(AnyPotential const& potential) {
        if (state.forces_valid()) return;
        f.setZero(N, d);
        state.pair_virials = {.potential = add_forces(potential, f)};
        state.forces_found();
    }

    /// Impulses f dt, which wait with those of `euler`. @eq{MY1997,2}
    void act(ForceImpulses const& p, NoiseKey) {
        need_forces(p.potential);
        state.momentum_change += dt * f;
        stress.potential = -state.pair_virials.potential / volume;
    }

    /// v += f dt/(2m).
    void act(HalfKick const& p, NoiseKey) {
        need_forces(p.potential);
        v += half / m * f;
        stress.potential = -state.pair_virials.potential / volume;
    }

    /// Velocity-Verlet in substeps of dt/n.
    void act(Verlet const& p, NoiseKey) {
        double const n = double(p.substeps), span = dt / n;
        stress.kinetic = stress.potential = 0.0;
        // [verlet]
        for (std::uint64_t s = 0; s < p.substeps; ++s) {
            need_forces(p.potential);
            v += 0.5 * span / m * f;
            stress.potential += 0.5 * state.pair_virials.potential;
            stress.kinetic += kinetic_stress(state.particles, box, span);
            stream(span, (double(state.step) + double(s + 1) / n) * dt);
            need_forces(p.potential);
            v += 0.5 * span / m * f;
            stress.potential += 0.5 * state.pair_virials.potential;
        }
        // [verlet]
        stress.kinetic /= n;
        stress.potential /= -n * volume;
        stress.streamed = true;
    }

    /// f becomes the sum of conservative, dissipative and random forces. @eq{PK2006,1}
    void find_all_forces(ModifiedVerlet const& p, NoiseKey key) {
        need_pairs();
        f.setZero(N, d);
        std::vector<double> conservative, dissipative, thermal, along_r;
        for (std::size_t k = 0; k < list.count; ++k) {
            // [all forces]
            auto const ij = list.pair(k);
            double const w_d = weight_at(p.weight, ij.r * (1.0 / p.cutoff)), w_r = std::sqrt(w_d);
            double const f_c = force_at(p.potential, ij.r) * wall_factor(state, ij.i, ij.j);
            double const f_d = -(p.gamma * w_d) * approach(ij);
            double const f_r = normal_noise(key, ij.i, ij.j) * (p.sigma / std::sqrt(dt) * w_r);
            f.row(ij.i) += (f_c + (f_d + f_r)) * ij.e;
            f.row(ij.j) -= (f_c + (f_d + f_r)) * ij.e;
            // [all forces]
            list.impulse[k] = p.friction_again ? f_d : f_d + f_r;
            conservative.push_back(moment(ij, f_c));
            dissipative.push_back(moment(ij, f_d));
            along_r.push_back(f_d * ij.r);
            thermal.push_back(moment(ij, f_d + f_r));
        }
        forget_wall_forces(state, f);
        state.pair_virials = {sum_in_blocks(conservative), sum_in_blocks(thermal),
                              sum_in_blocks(dissipative)};
        stress.friction_virial = sum_in_blocks(along_r);
        state.counters.potential_evaluations += list.count;
        state.counters.count_updates(list.count);
        state.forces_found();
    }

    /// Replaces the friction in f, which the list holds as impulses, by that of the present velocities.
    void find_friction_again(ModifiedVerlet const& p) {
        std::vector<double> moments;
        for (std::size_t k = 0; k < list.count; ++k) {
            auto const ij = list.pair(k);
            double const friction = -(p.gamma * weight_at(p.weight, ij.r * (1.0 / p.cutoff))) * approach(ij);
            double const change = friction - list.impulse[k];
            f.row(ij.i) += change * ij.e;
            f.row(ij.j) -= change * ij.e;
            moments.push_back(moment(ij, change));
        }
        forget_wall_forces(state, f);
        state.pair_virials.friction += sum_in_blocks(moments);
        state.pair_virials.thermostat += sum_in_blocks(moments);
        state.counters.pair_updates += list.count;
    }

    /// The modified velocity-Verlet of Groot & Warren; with `friction_again` DPD-VV. PK2006 sect. III
    void act(ModifiedVerlet const& p, NoiseKey key) {
        if (!state.forces_valid()) find_all_forces(p, {key.seed, key.step, key.stream, 1});
        auto const before = state.pair_virials;
        // [modified verlet]
        v += half / m * f;
        stress.kinetic = kinetic_stress(state.particles, box, dt);
        stream(dt, double(state.step + 1) * dt);
        // friction sees the velocities v + lambda dt f/m, predicted from the beginning of the step
        Field<d> const f_before = f;
        v += (p.lambda - 0.5) * dt / m * f_before;
        find_all_forces(p, key);
        v -= (p.lambda - 0.5) * dt * f_before / m;
        v += half / m * f;
        // [modified verlet]
        stress.take_mean_of(before, state.pair_virials, volume);
        stress.streamed = true;
        if (p.friction_again) find_friction_again(p);
    }

    /// Scales velocities u relative to the mean of a cell so that m sum u^2 = d (N - N_c) kT, for N particles
    /// in the N_c cells that share a factor: all, a layer's, or one, whose factor is drawn. A particle above
    /// the lattice, which is shifted at random, stands for its image below. NG2007, "Other Thermostats".
    void act(Rescale const& p, NoiseKey key) {
        struct Cell {
            double count = 0.0, square = 0.0, factor = 1.0;
            Row mean = Row::Zero();
        };
        Row shift, sides;
        for (std::uint32_t axis = 0; axis < d; ++axis) {
            shift[axis] = p.cell * uniform_noise(key, axis, 0);
            sides[axis] = std::round(box.length[axis] / p.cell);
        }
        std::vector<Cell> cells(std::size_t(sides.prod()));
        std::vector<Cell*> home;
        auto const above = [&](Eigen::Index i) { return r(i, 1) + shift[1] >= box.length[1]; };
        auto const image = [&](Eigen::Index i) { return above(i) ? -box.image_speed() : 0.0; };
        for (Eigen::Index i = 0; i < N; ++i) {
            double index = 0.0;
            for (int const axis : {1, 0, 2}) {  // layers across y are contiguous
                if (axis >= d) continue;
                double const along = axis == 0 && above(i) ? r(i, 0) - box.offset(state.time) : r(i, axis);
                double const turns = (along + shift[axis]) / box.length[axis];
                double const place = std::floor((turns - std::floor(turns)) * sides[axis]);
                index = index * sides[axis] + std::min(place, sides[axis] - 1.0);
            }
            home.push_back(&cells[std::size_t(index)]);
            home.back()->count += 1.0;
            home.back()->mean += v.row(i);
            home.back()->mean[0] += image(i);
        }
        for (Cell& cell : cells) cell.mean /= std::max(1.0, cell.count);
        for (Eigen::Index i = 0; i < N; ++i) {
            Row u = v.row(i) - home[std::size_t(i)]->mean;
            u[0] += image(i);
            home[std::size_t(i)]->square += sum_of_squares(u);
        }
        std::size_t together = 1;
        if (p.mode == Rescaling::global) together = cells.size();
        if (p.mode == Rescaling::layers) together = p.thickness * std::size_t(sides.prod() / sides[1]);
        for (std::size_t begin = 0; begin < cells.size(); begin += together) {
            std::size_t const end = std::min(begin + together, cells.size());
            double free = 0.0, square = 0.0, factor = 1.0;
            for (std::size_t c = begin; c < end; ++c) {
                free += std::max(0.0, cells[c].count - 1.0);
                square += cells[c].square;
            }
            if (free == 0.0) continue;
            if (p.mode == Rescaling::monte_carlo) {
                auto const cell = std::uint32_t(begin);
                double const psi = 1.0 + p.amplitude * uniform_noise(key, cell, 1);
                double const drawn = uniform_noise(key, cell, 2) < 0.5 ? psi : 1.0 / psi;
                double const log_weight =
                    d * free * logarithm(drawn) - 0.5 * m / p.kT * square * (drawn * drawn - 1.0);
                if (logarithm(1.0 - uniform_noise(key, cell, 3)) < log_weight) factor = drawn;
                state.counters.random_draws += 3;
            } else if (square > 0.0) {
                factor = std::sqrt(d * free * p.kT / (m * square));
            }
            for (std::size_t c = begin; c < end; ++c) cells[c].factor = factor;
        }
        double moved = 0.0;
        for (Eigen::Index i = 0; i < N; ++i) {
            Cell const& cell = *home[std::size_t(i)];
            double const before = v(i, 0), y = r(i, 1) + (above(i) ? -box.length[1] : 0.0);
            for (int axis = 0; axis < d; ++axis) {
                double const speed = axis == 0 ? image(i) : 0.0, mean = cell.mean[axis];
                v(i, axis) = mean - speed + cell.factor * (v(i, axis) + speed - mean);
            }
            moved += (v(i, 0) - before) * y;
        }
        stress.rescaling = -m * moved / (volume * dt);
        state.counters.random_draws += d;
    }
};

}  // namespace dpd::plain
