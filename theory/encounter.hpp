/// @file
/// Two particles meet in a medium: integrals over time of what their thermostat does to them. Derived in
/// theory/memory.md.
///
/// Unit of length is the cutoff, of mass the particle's, of energy kT; so m = kT = rc = 1 here. r is the
/// distance of the two, g their relative velocity, r^ the unit vector between them, [f] a volume integral.
#pragma once

#include <functional>
#include <memory>
#include <variant>

#include "closed_forms.hpp"

namespace dpd::theory {

/// What happens to a pair in range: friction w(r) and noise along r^, or a new relative velocity along r^
/// drawn at a rate.
using Thermostat = std::variant<Shardlow, Lowe>;

/// Where partners are found that repel each other, and what pushes them. Nothing set: an ideal gas.
struct Structure {
    PairDistribution g;                        ///< how often a distance occurs; must not be zero
    std::function<double(double)> mean_force;  ///< d ln g/dr, on a partner from the other and all around
    std::function<double(double)> force;       ///< on a partner from the other alone, -du/dr
};

/// A pair in a medium that exerts the friction `medium` on either of the two. In continuous time (step = 0),
/// or in steps: all collide once (A = A(w step) by the scheme, or a new velocity with probability Gamma step)
/// and the medium keeps exp(-medium step) of a velocity, then all drift.
struct Encounter {
    int d = 3;                 ///< dimension
    Thermostat thermostat;     ///< what happens in range
    double medium = 0.0;       ///< rate at which the medium alone would relax a velocity
    double step = 0.0;         ///< time; 0: continuous
    Structure structure = {};  ///< with a potential; for soft_force_memory and soft_stress_memory
};

/// Weight of the pair's friction; of Lowe's thermostat 1.
Weight weight_of(Thermostat const& thermostat);

/// Of the Hermite polynomial of order i in the relative velocity along r^, the share that a collision takes
/// at the distance r, per unit time: 1 - (1 - 2A)^i over the step, 2 w i in continuous time; Gamma for Lowe's
/// thermostat.
double loss(Encounter const& pair, int i, double r);

/// A number known from both sides. The mean of the bounds is much closer to it than either.
struct Bounds {
    double lower = 0.0;  ///< not above the number
    double upper = 0.0;  ///< not below it
    /// Of the two.
    double mean() const { return 0.5 * (lower + upper); }
};

/// \f$\int d\mathbf r\int_0^\infty dt\,\langle f(0)f(t)\,\hat{\mathbf r}_0\cdot\hat{\mathbf r}_t\rangle\f$
/// with \f$f=w\,\hat{\mathbf r}\cdot\mathbf g\f$: what the force of one partner remembers of itself. In steps
/// \f$w\f$ is A/step, and the integral the sum over all later steps times the step.
/// `degree` (even, >= 2) is the highest degree of the polynomials in the velocity. The drift of a step enters
/// with its first two moments, which is exact for distances that change little in a step; FlyingPair has it
/// exactly. Throws std::invalid_argument unless d is 2 or 3, the frictions are positive, the step is not
/// negative and the degree is allowed.
Bounds force_memory(Encounter const& pair, int degree);

/// The same for stresses, with \f$s=w\,r\,\hat x\hat y\,(\hat{\mathbf r}\cdot\mathbf g)\f$, the stress that
/// the pair's friction carries, and \f$B=-w(\hat{\mathbf r}\cdot\mathbf g)(\hat xg_y+\hat yg_x)+4w\,\hat
/// x\hat y\f$, the rate at which it changes \f$g_xg_y/2\f$; in steps both are changes in a collision over the
/// step.
struct StressMemory {
    Bounds collision;   ///< \f$\int\int\langle s(0)s(t)\rangle\f$
    Bounds relaxation;  ///< \f$\int\int\langle B(0)B(t)\rangle\f$
    Bounds
        cross;  ///< \f$\int\int\langle s(0)B(t)\rangle\f$; the two truncations, which need not be bounds here
};
StressMemory stress_memory(Encounter const& pair, int degree);

/// Memory of the force in a fluid with a potential, integrals over g as the others are over the volume;
/// \f$F\f$ is the potential's force along r^, in `potential` the partner's own at first and the mean one
/// later.
struct SoftForceMemory {
    double friction;   ///< \f$\int\int\langle f(0)f(t)\,\hat{\mathbf r}_0\cdot\hat{\mathbf r}_t\rangle\f$
    double potential;  ///< the same of F and F
    double cross;      ///< of f(0) and F(t), the mean force
};
/// The pair moves in its mean force. Continuous time. Throws as force_memory.
SoftForceMemory soft_force_memory(Encounter const& pair, int degree);

/// The same for stresses, with \f$\Phi=rF\hat x\hat y\f$ and \f$B_F=F(\hat xg_y+\hat yg_x)\f$, what the
/// potential does to \f$g_xg_y/2\f$. With s and B the force is the mean one.
struct SoftStressMemory {
    double collision;   ///< \f$\int\int\langle s(0)s(t)\rangle\f$
    double relaxation;  ///< \f$\int\int\langle(B-B_F)(0)\,(B+B_F)(t)\rangle\f$, one force in B_F B_F mean
    double cross;       ///< \f$\int\int\langle s(0)\,(B+B_F)(t)\rangle\f$
    double potential;   ///< \f$\int\int\langle\Phi(0)s(t)\rangle\f$
    /// \f$\int\int\langle\Phi(0)\,(B+B_F)(t)\rangle\f$ with the partner's own force in \f$\Phi\f$ and the
    /// mean one in B_F, and the other way round. Exact solutions would agree.
    double kinetic, kinetic_by_mean_stress;
};
SoftStressMemory soft_stress_memory(Encounter const& pair, int degree);

/// What a pair remembers of the heat that explicit steps leave in it: \f$\int d\mathbf r\,\langle X\rangle\f$
/// just before a step, less what it would be in Maxwell's distribution at every distance.
/// \f$X=a\,(e+a)+2^{1/2}a\,(a-1+\kappa)H_2\f$ is the energy over 2kT that the pair gains in a step,
/// \f$H_2=(u_r^2-1)/2^{1/2}\f$, e = `excess`, kappa = `decay` what the medium takes of a velocity in a step,
/// and a = w step, so that a step adds 4 a (e + a) to the variance of \f$u_r\f$. The heat of all earlier
/// steps counts, and that a heated pair parts sooner. `pair` has the thermostat as it is; its medium has no
/// meaning here. Flights as in force_memory, which it throws as.
double heat_memory(Encounter const& pair, double decay, double excess, int degree);

/// The same integrals (in steps: sums) with the flights between two collisions exact: a pair that leaves the
/// range flies through the medium, straight or diffusing, until it is in range again, and all of that is a
/// Gaussian integral for each wave vector. Polynomials of the velocity are needed in the range only. Made
/// once for a pair and asked for any medium; what is known of lower degrees is kept.
class FlyingPair {
public:
    /// `rank` is 1 for the force, 2 for the stresses. The pair's `medium` has no meaning here. Throws as
    /// force_memory.
    FlyingPair(Encounter const& pair, int rank);
    ~FlyingPair();

    /// As dpd::theory::force_memory, for a friction of the medium; polynomials up to `degree` >= 2.
    double force_memory(double medium, int degree);
    /// \f$\langle ss\rangle\f$, \f$\langle BB\rangle\f$, \f$\langle sB\rangle\f$ as in StressMemory.
    struct Stress {
        double collision;   ///< \f$\langle ss\rangle\f$
        double relaxation;  ///< \f$\langle BB\rangle\f$
        double cross;       ///< \f$\langle sB\rangle\f$
    };
    /// As dpd::theory::stress_memory, for a friction of the medium; polynomials up to `degree` >= 2.
    Stress stress_memory(double medium, int degree);

private:
    class Waves;
    std::unique_ptr<Waves> waves_;
};

}  // namespace dpd::theory
