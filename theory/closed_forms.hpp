/// @file
/// Closed forms of the theory of dissipative particle dynamics at finite time step, one function per
/// equation.
///
/// Units are the caller's, as long as they agree: length, time, mass and energy (kT, with k_B = 1) are free.
/// `[f]` is the integral of f over d-dimensional space. The derivations are in theory/MY1997.md and
/// theory/NG2007.md.
///
/// Every function throws std::invalid_argument when d is neither 2 nor 3 or when a quantity it uses is not
/// positive and finite, and std::domain_error when the equation has no answer there; none returns NaN.
/// Only shardlow_A and shardlow_B, meant for inner loops, do not check (w >= 0, m > 0, dt > 0).
#pragma once

#include <functional>
#include <optional>

#include "weight.hpp"

namespace dpd::theory {

/// Surface of the unit sphere in d dimensions, 2 pi or 4 pi: the volume element is S_d r^(d-1) dr.
double unit_sphere_surface(int d);

/// [f] = integral of the radial function f(r) over the sphere r < rc, to a relative 1e-12. @eq{MY1997,21}
/// Unit: that of f times length^d. f may have an infinite slope at r = 0 and r = rc.
double volume_integral(int d, double rc, std::function<double(double)> const& f);

// ---------------------------------------------------------------------------------------------------------
// Marsh & Yeomans 1997: the temperature of explicit (Euler) DPD at finite step

/// Ideal gas under the explicit algorithm @eq{MY1997,2}: force -gamma w_D (e.v) e + sigma w_R xi e /
/// sqrt(dt).
struct ExplicitDpd {
    int d = 3;                                           ///< dimension of space
    double n = 0.0;                                      ///< number density, 1/length^d
    double m = 1.0;                                      ///< mass of a particle
    double gamma = 0.0;                                  ///< strength of the friction, mass/time
    double sigma = 0.0;                                  ///< strength of the noise, momentum/time^(1/2)
    double rc = 1.0;                                     ///< range of both weights
    Weight weight = Weight::linear;                      ///< w_D
    std::optional<Weight> random_weight = std::nullopt;  ///< w_R; without one it is matched, w_R^2 = w_D
};

/// A1 = gamma [w_D] / (m d): n A1 is the rate at which a momentum decays. @eq{MY1997,23}
/// Unit length^d/time. Uses d, m, gamma, rc, weight.
double A1(ExplicitDpd const& fluid);

/// A2 = 2 gamma^2 [w_D^2] / (m^2 d): what a single partner adds at second order. @eq{MY1997,23}
/// Unit length^d/time^2. Uses d, m, gamma, rc, weight.
double A2(ExplicitDpd const& fluid);

/// A3 = sigma^2 [w_R^2] / d: momentum fed in by the noise. @eq{MY1997,23}
/// Unit length^d momentum^2/time. Uses d, sigma, rc, random_weight (and weight when that is matched).
double A3(ExplicitDpd const& fluid);

/// Temperature (kT) that the explicit algorithm settles at for a time step dt. @eq{MY1997,22}
/// kT = A3 / (m (A1 (2 - A1 n dt) - A2 dt)). Throws std::domain_error at and beyond the critical step,
/// where the noise and the friction no longer balance at any temperature.
double temperature_at_finite_step(ExplicitDpd const& fluid, double dt);

/// The opposite limit, neighbours that never change: kT of explicit DPD at fixed positions, to first order in
/// dt, averaged over all degrees of freedom. kT = A3/(2 m A1) (1 + n A1 dt/2). A lower bound at any dt: each
/// normal mode of the friction settles at kT/(1 - lambda dt/2), convex in its rate lambda, whose mean is
/// n A1. Derived in theory/MY1997.md, not in the paper; for matched weights (w_R^2 = w_D) only.
/// Throws std::domain_error for a random_weight.
double temperature_with_frozen_neighbours(ExplicitDpd const& fluid, double dt);

/// Step at which eq. 22 diverges, 2 A1 / (n A1^2 + A2). @eq{MY1997,25}
/// Unit time. Uses d, n, m, gamma, rc, weight.
double critical_step(ExplicitDpd const& fluid);

/// Density at which that temperature diverges for a step dt, (2 A1 - A2 dt) / (A1^2 dt). @eq{MY1997,26}
/// Unit 1/length^d. Uses d, m, gamma, rc, weight. Throws std::domain_error for dt >= 2 A1/A2, where no
/// density, however small, is stable.
double critical_density(ExplicitDpd const& fluid, double dt);

// ---------------------------------------------------------------------------------------------------------
// Noguchi & Gompper 2007: transport coefficients of the ideal gas under pairwise thermostats

/// Ideal gas (no conservative force, g(r) = 1).
struct Gas {
    int d = 3;        ///< dimension of space
    double n = 0.0;   ///< number density, 1/length^d
    double m = 1.0;   ///< mass of a particle
    double kT = 1.0;  ///< energy
    double rc = 1.0;  ///< range of the thermostat
};

/// Thermostat of Shardlow's S1 splitting with friction w(r) = gamma weight(r/rc), mass/time.
struct Shardlow {
    double gamma = 0.0;  ///< friction where the weight is 1
    Weight weight = Weight::linear;
};

/// Lowe-Andersen thermostat: a pair within range draws a new relative velocity with probability Gamma dt per
/// step. Above Gamma dt = 1 the forms are continued with Gamma dt as the mean number of updates of a pair
/// per step, each taken as independent of the ones before: that is the line of NG2007 fig. 2, and NG2007
/// says that it then overestimates the collision viscosity, because a pair updated twice forgets the shear
/// at the first update.
struct Lowe {
    double Gamma = 0.0;  ///< rate, 1/time
};

/// A of a pair whose friction is w (mass/time): the new relative velocity along the line of centres is
/// (1 - 2A) times the old one, plus noise. In [0, 1). @eq{NG2007,5}
double shardlow_A(double w, double m, double dt);

/// B of that pair: the noise added to v_i is B xi, xi of variance 2 kT. B = sqrt(A (1 - A)/m) keeps kT.
/// Unit mass^(-1/2). @eq{NG2007,5} as printed lacks this 1/sqrt(m), see theory/NG2007.md.
double shardlow_B(double w, double m, double dt);

/// s, the factor by which the collisions of one step multiply \f$\langle v_xv_y\rangle\f$. @eq{NG2007,9}
/// exp(n [-2A/d + 4A^2/(d(d+2))]), in (0, 1). Does not use kT.
double stress_retention(Gas const& gas, Shardlow const& thermostat, double dt);
/// The same for Lowe-Andersen, exp(-n V_d rc^d Gamma dt (d+1)/(d(d+2))) with V_d = S_d/d.
double stress_retention(Gas const& gas, Lowe const& thermostat, double dt);

/// Kinetic viscosity n kT dt (1/(1 - s) - 1/2). @eq{NG2007,8}
/// Unit mass length^(2-d)/time, as for every viscosity here.
double kinetic_viscosity(Gas const& gas, Shardlow const& thermostat, double dt);
/// The same for Lowe-Andersen; does not use m.
double kinetic_viscosity(Gas const& gas, Lowe const& thermostat, double dt);

/// Kinetic viscosity for dt -> 0, d m kT/(2 [w]). @eq{NG2007,10}
double kinetic_viscosity_limit(Gas const& gas, Shardlow const& thermostat);
/// Kinetic viscosity for dt -> 0 at a fixed rate, kT/(pi b Gamma rc^d): pi b is V_d (d+1)/(d(d+2)), thus
/// b = 3/8 for d = 2 (NG2007 prints 1/2) and 16/45 for d = 3.
double kinetic_viscosity_limit(Gas const& gas, Lowe const& thermostat);

/// Collision viscosity (n^2/2) [A m r^2/(dt d (d+2))]. @eq{NG2007,12} Does not use kT.
double collision_viscosity(Gas const& gas, Shardlow const& thermostat, double dt);
/// The same for Lowe-Andersen, pi m n^2 Gamma rc^4/64 (d = 2) and pi m n^2 Gamma rc^5/75 (d = 3); it does
/// not depend on dt.
double collision_viscosity(Gas const& gas, Lowe const& thermostat);

/// Collision viscosity for dt -> 0, n^2 [w r^2]/(2 d (d+2)). @eq{NG2007,12} Does not use m and kT.
double collision_viscosity_limit(Gas const& gas, Shardlow const& thermostat);

/// Factor by which the collisions of one step multiply \f$\langle v(t)\cdot v(0)\rangle\f$, exp(-n [A]/d).
/// @eq{NG2007,17}
double velocity_retention(Gas const& gas, Shardlow const& thermostat, double dt);
/// The same for Lowe-Andersen, exp(-n V_d rc^d Gamma dt/(2 d)).
double velocity_retention(Gas const& gas, Lowe const& thermostat, double dt);

/// Self-diffusion constant (kT dt/m) (1/(1 - exp(-n [A]/d)) - 1/2). @eq{NG2007,17}
/// Unit length^2/time.
double diffusion_constant(Gas const& gas, Shardlow const& thermostat, double dt);
/// The same for Lowe-Andersen.
double diffusion_constant(Gas const& gas, Lowe const& thermostat, double dt);

/// Self-diffusion constant for dt -> 0, d kT/(n [w]). @eq{NG2007,17} Does not use m.
double diffusion_constant_limit(Gas const& gas, Shardlow const& thermostat);
/// Self-diffusion constant for dt -> 0 at a fixed rate, 2 d kT/(m n V_d rc^d Gamma).
double diffusion_constant_limit(Gas const& gas, Lowe const& thermostat);

// ---------------------------------------------------------------------------------------------------------

/// What to add to the diffusion constant measured in a periodic cube of side L to reach L -> infinity,
/// 2.837297 kT/(6 pi eta L); eta is the shear viscosity. Three dimensions only.
/// Duenweg & Kremer, J. Chem. Phys. 99 (1993) 6983; Yeh & Hummer, J. Phys. Chem. B 108 (2004) 15873.
double diffusion_finite_size_correction(double kT, double eta, double L);

}  // namespace dpd::theory
