/// @file
/// The stages of a time step. Each mirrors an equation; a scene lists the ones it wants, in order.
#pragma once

#include "potential.hpp"
#include "scheme.hpp"
#include "simulation.hpp"
#include "weight.hpp"

namespace dpd {

/// Free streaming, r += v dt, and the return to the primary box. @eq{MY1997,1}
template <int d>
struct Drift {
    void operator()(Simulation<d>& simulation, NoiseKey) const;
};

/// Redraws every position uniformly at random and keeps the peculiar velocities. Not physics: in place of
/// memory it enforces molecular chaos, the assumption behind NG2007 eqs. 8, 9, 17 and MY1997 eq. 22. What
/// differs between a run with and without this stage is the effect of correlations, and nothing else.
template <int d>
struct Scatter {
    void operator()(Simulation<d>& simulation, NoiseKey key) const;
};

/// Pair after pair, friction and noise of one step: S1 and its relatives. @eq{NG2007,4} @eq{NG2007,5}
template <int d>
struct Shardlow {
    double friction = 1.0;  ///< gamma: the friction is gamma*weight(r/cutoff), mass per time
    Weight weight = Weight::linear;
    Scheme scheme = Scheme::shardlow;
    double cutoff = 1.0;
    double kT = 1.0;
    void operator()(Simulation<d>& simulation, NoiseKey key) const;
};

/// Lowe-Andersen: a pair draws a new relative velocity along its line, A = 1/2, with probability rate*dt.
/// @eq{NG2007,6} Above one per step: as many whole sweeps over all pairs as rate*dt has ones, then one in
/// which each pair is updated with the probability that remains.
template <int d>
struct Lowe {
    double rate = 1.0;  ///< Gamma: updates of a pair per time
    double cutoff = 1.0;
    double kT = 1.0;
    void operator()(Simulation<d>& simulation, NoiseKey key) const;
};

/// Euler impulses of friction and noise, all from the velocities at the start of the step; they wait in
/// `momentum_change` for the kick. @eq{MY1997,2}
template <int d>
struct EulerImpulses {
    double gamma = 1.0;                     ///< strength of the friction, mass per time
    double sigma = 1.0;                     ///< strength of the noise, momentum per time^(1/2)
    Weight weight = Weight::linear;         ///< w_D
    Weight random_weight = Weight::linear;  ///< w_R, if not matched
    bool matched = true;                    ///< w_R^2 = w_D (fluctuation and dissipation balance as dt -> 0)
    double cutoff = 1.0;
    void operator()(Simulation<d>& simulation, NoiseKey key) const;
};

/// Adds the waiting impulses to the velocities. [euler, drift, kick] moves with the old momentum, as MY1997
/// eqs. 1 and 2 are printed; [euler, kick, drift] moves with the new one.
template <int d>
struct Kick {
    void operator()(Simulation<d>& simulation, NoiseKey) const;
};

/// The Euler impulses of a conservative force, F dt, added to what waits for the kick: with EulerImpulses
/// before it, all forces of MY1997 eq. 2 from the state at the start of the step. @eq{MY1997,2}
template <int d, class Potential>
struct ForceImpulses {
    Potential potential;
    void operator()(Simulation<d>& simulation, NoiseKey) const;
};

/// v += F dt/(2m) of a conservative force: B/2 of splitting integrators. [half_kick, drift, half_kick] is
/// Verlet; [half_drift, half_kick, shardlow, half_kick, half_drift] with the exponential scheme is ABOBA
/// (X. Shang, SIAM J. Sci. Comput. 43 (2021) A1929).
template <int d, class Potential>
struct HalfKick {
    Potential potential;
    void operator()(Simulation<d>& simulation, NoiseKey) const;
};

/// Free streaming for half a step: A/2 of splitting integrators.
template <int d>
struct HalfDrift {
    void operator()(Simulation<d>& simulation, NoiseKey) const;
};

/// Velocity-Verlet with a conservative force, in `substeps` inner steps: the multiple time steps of NG2007,
/// whose thermostat acts once per (outer) step. Leaves the forces at the new positions for the next step.
template <int d, class Potential>
struct Verlet {
    Potential potential;
    std::uint64_t substeps = 1;
    void operator()(Simulation<d>& simulation, NoiseKey) const;
};

/// DPD with all forces at once, by the modified velocity-Verlet of Groot & Warren (1997): friction sees the
/// velocities predicted for the end of the step, v + lambda dt F/m. PK2006 sect. III, lambda = 1/2, which is
/// plain velocity-Verlet. With `friction_again` the friction is found once more from the final velocities,
/// for the next half kick: DPD-VV (G. Besold et al., Phys. Rev. E 62 (2000) R7611).
template <int d, class Potential>
struct ModifiedVerlet {
    Potential potential;
    double gamma = 4.5;                 ///< strength of the friction, mass per time
    double sigma = 3.0;                 ///< strength of the noise, momentum per time^(1/2)
    Weight weight = Weight::quadratic;  ///< omega_D; omega_R is its root
    double cutoff = 1.0;
    double lambda = 0.5;
    bool friction_again = false;
    void operator()(Simulation<d>& simulation, NoiseKey key) const;

private:
    void find_forces(Simulation<d>& simulation, NoiseKey key) const;
    void find_friction_again(Simulation<d>& simulation) const;
};

// [body force]
/// Accelerates along x: by `acceleration` everywhere, or by its opposite in the upper half of the box, which
/// makes two opposite Poiseuille flows without walls.
template <int d>
struct BodyForce {
    double acceleration = 0.0;
    bool opposed = false;
    void operator()(Simulation<d>& simulation, NoiseKey) const;
};
// [body force]

}  // namespace dpd
