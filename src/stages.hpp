/// @file
/// The stages of a time step. Each mirrors an equation; a scene lists the ones it wants, in order.
#pragma once

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

/// Shardlow's S1 splitting: pair after pair, the exact implicit update of friction and noise.
/// @eq{NG2007,4} @eq{NG2007,5}
template <int d>
struct Shardlow {
    double friction = 1.0;  ///< gamma: the friction is gamma*weight(r/cutoff), mass per time
    Weight weight = Weight::linear;
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

/// A(r) of the S1 update from w(r) dt/m. @eq{NG2007,5}
constexpr double shardlow_a(double w_dt_over_m) { return w_dt_over_m / (1.0 + w_dt_over_m); }

/// B = sqrt(A(1-A)/m), which keeps kT at any step and mass. NG2007, below eq. 5; the B printed in eq. 5 lacks
/// the factor 1/sqrt(m).
inline double shardlow_b(double a, double mass) { return std::sqrt(a * (1.0 - a) / mass); }

}  // namespace dpd
