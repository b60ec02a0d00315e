/// @file
/// Closed forms of the theory of dissipative particle dynamics at finite time step, one function per
/// equation.
///
/// Units are the caller's, as long as they agree: length, time, mass and energy (kT, with k_B = 1) are free.
/// `[f]` is the integral of f over d-dimensional space. The derivations are in theory/MY1997.md,
/// theory/NG2007.md and theory/PK2006.md.
///
/// Every function throws std::invalid_argument when d is neither 2 nor 3 or when a quantity it uses is not
/// positive and finite, and std::domain_error when the equation has no answer there; none returns NaN.
#pragma once

#include <functional>
#include <limits>
#include <optional>

#include "scheme.hpp"
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
/// dt, averaged over all degrees of freedom. kT = A3/(2 m A1) (1 + n A1 dt/2). Derived in theory/MY1997.md,
/// not in the paper; for matched weights (w_R^2 = w_D) only. Throws std::domain_error for a random_weight.
double temperature_with_frozen_neighbours(ExplicitDpd const& fluid, double dt);

/// A lower bound on kT of both limits at any dt, neighbours that never change and neighbours that are new at
/// every step (eq. 22): A3/(2 m A1 (1 - n A1 dt/2)), what one mode of the mean rate n A1 would have, as the
/// temperature of a mode is convex in its rate. For a fluid between the limits it is a heuristic. Derived in
/// theory/MY1997.md, not in the paper; matched weights only. Throws std::domain_error for a random_weight,
/// and for n A1 dt >= 2, where the mean mode itself is unstable.
double temperature_of_the_mean_mode(ExplicitDpd const& fluid, double dt);

/// Step at which eq. 22 diverges, 2 A1 / (n A1^2 + A2). @eq{MY1997,25}
/// Unit time. Uses d, n, m, gamma, rc, weight.
double critical_step(ExplicitDpd const& fluid);

/// Density at which that temperature diverges for a step dt, (2 A1 - A2 dt) / (A1^2 dt). @eq{MY1997,26}
/// Unit 1/length^d. Uses d, m, gamma, rc, weight. Throws std::domain_error for dt >= 2 A1/A2, where no
/// density, however small, is stable.
double critical_density(ExplicitDpd const& fluid, double dt);

// ---------------------------------------------------------------------------------------------------------
// Noguchi & Gompper 2007: transport coefficients of the ideal gas under pairwise thermostats

/// Density, mass, temperature and range: all that the thermostat's formulas need to know of a fluid.
struct Gas {
    int d = 3;        ///< dimension of space
    double n = 0.0;   ///< number density, 1/length^d
    double m = 1.0;   ///< mass of a particle
    double kT = 1.0;  ///< energy
    double rc = 1.0;  ///< range of the thermostat and of the soft potential
};

/// Pairwise thermostat of the generalized Lowe family with friction w(r) = gamma weight(r/rc), mass/time. Its
/// A(r) and B(r) at a = w(r) dt/m are update_a and update_b of scheme.hpp. @eq{NG2007,5}
/// With Scheme::linear, A = a, a form at finite step throws std::domain_error for gamma dt/m > 1.
struct Shardlow {
    double gamma = 0.0;                ///< friction where the weight is 1
    Weight weight = Weight::linear;    ///< of the friction
    Scheme scheme = Scheme::shardlow;  ///< the limits dt -> 0 do not depend on it
};

/// Lowe-Andersen thermostat: a pair within range draws a new relative velocity with probability Gamma dt per
/// step. Gamma dt = k + p above 1 stands for k whole sweeps over all pairs and one more in which each pair is
/// updated with probability p, all at the same positions. The forms go on with Gamma dt in their exponents as
/// if every update were with a new partner: that is the line of NG2007 fig. 2. A second sweep meets the same
/// partners, so above 1 collision_viscosity comes out too large and velocity_retention too small (bounds in
/// theory/NG2007.md); for stress_retention the same is expected, not proved.
struct Lowe {
    double Gamma = 0.0;  ///< rate, 1/time
};

/// Pair distribution g(r), a function of the distance in (0, rc). An empty one stands for g = 1, the ideal
/// gas.
///
/// It may have steps (a histogram): the integrals with a g use a fixed rule, 7 Gauss points in each of 1000
/// equal parts of the range, thus 7000 calls. Relative error below 1e-8 for a smooth g and gamma dt/m up to
/// 100 (1e-5 with the root weight, whose slope at rc is infinite), also with steps at multiples of rc/1000; a
/// step elsewhere adds less than that step over 1/1000 of the range. Without a g the error is 1e-12. Throws
/// std::invalid_argument where g is negative or not finite.
using PairDistribution = std::function<double(double)>;

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

/// Collision viscosity (n^2/2) [A m r^2 g/(dt d (d+2))]. @eq{NG2007,12} Does not use kT.
double collision_viscosity(Gas const& gas, Shardlow const& thermostat, double dt,
                           PairDistribution const& g = {});
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

/// Velocity autocorrelation \f$\langle v_x(t)v_x(0)\rangle\f$ of the ideal gas under molecular chaos,
/// (kT/m) velocity_retention^(t/dt): exact there at whole steps, an exponential through them between.
/// @eq{NG2007,17} (the line above it). Unit length^2/time^2. t >= 0.
double velocity_autocorrelation(Gas const& gas, Shardlow const& thermostat, double dt, double t);

/// Self-diffusion constant (kT dt/m) (1/(1 - exp(-n [A]/d)) - 1/2). @eq{NG2007,17}
/// Unit length^2/time.
double diffusion_constant(Gas const& gas, Shardlow const& thermostat, double dt);
/// The same for Lowe-Andersen.
double diffusion_constant(Gas const& gas, Lowe const& thermostat, double dt);

/// Self-diffusion constant for dt -> 0, d kT/(n [w]). @eq{NG2007,17} Does not use m.
double diffusion_constant_limit(Gas const& gas, Shardlow const& thermostat);
/// Self-diffusion constant for dt -> 0 at a fixed rate, 2 d kT/(m n V_d rc^d Gamma).
double diffusion_constant_limit(Gas const& gas, Lowe const& thermostat);

/// Schmidt number of the ideal gas, (kinetic + collision viscosity)/(n m D). @eq{NG2007,17}
/// Where the kinetic part rules and dt -> 0 it is 1/2, see theory/NG2007.md.
double schmidt_number(Gas const& gas, Shardlow const& thermostat, double dt);
/// The same for Lowe-Andersen; there that limit is (d+2)/(2(d+1)), 2/3 or 5/8.
double schmidt_number(Gas const& gas, Lowe const& thermostat, double dt);

// ---------------------------------------------------------------------------------------------------------
// Noguchi & Gompper 2007: the fluid with a soft potential

/// Soft repulsion U = (a kT/2)(1 - r/rc)^2 of a pair within the range rc of the gas. @eq{NG2007,3}
struct Soft {
    double a = 0.0;  ///< strength in units of kT
};

/// phi_DPD = n [w g]/(d m), the rate at which the thermostat takes away a velocity for dt -> 0; the stress
/// \f$\langle v_xv_y\rangle\f$ decays twice as fast. @eq{NG2007,13} (below it). Unit 1/time. Does not use kT.
double relaxation_rate(Gas const& gas, Shardlow const& thermostat, PairDistribution const& g = {});

/// Kinetic viscosity n kT/(2 (phi_pot + phi_dpd)) from the two relaxation rates. @eq{NG2007,14}
/// The rates may be any two numbers whose sum is positive (a phi_pot fitted to noisy data may be negative);
/// otherwise throws std::domain_error.
double kinetic_viscosity(double n, double kT, double phi_pot, double phi_dpd);

/// Potential viscosity of forces that act like a friction of rate phi_pot (any finite number),
/// n m phi_pot [|f| r^2 g]/(2 (d+2) [|f| g]), f = -dU/dr. @eq{NG2007,16}
/// The strength a must be positive, but has no other effect than the one it has on g; kT has none.
/// Throws std::domain_error when no pair is in range ([|f| g] = 0).
double potential_viscosity(Gas const& gas, Soft const& potential, double phi_pot,
                           PairDistribution const& g = {});
/// phi_pot that gives the potential viscosity eta_pot (any finite number): the equation above solved for it.
/// @eq{NG2007,16} Unit 1/time.
double potential_relaxation_rate(Gas const& gas, Soft const& potential, double eta_pot,
                                 PairDistribution const& g = {});

// ---------------------------------------------------------------------------------------------------------

/// What to add to the diffusion constant measured in a periodic cube of side L to reach L -> infinity,
/// 2.837297 kT/(6 pi eta L); eta is the shear viscosity. Three dimensions only.
/// For liquids, D << eta/(n m); in a gas pass eta + n m D for eta, see theory/NG2007.md.
/// Duenweg & Kremer, J. Chem. Phys. 99 (1993) 6983; Yeh & Hummer, J. Phys. Chem. B 108 (2004) 15873.
double diffusion_finite_size_correction(double kT, double eta, double L);

/// Velocity autocorrelation \f$\langle v_x(t)v_x(0)\rangle\f$ of a particle at long times, infinite fluid:
/// ((d-1)/d) (kT/(n m)) (4 pi (eta/(n m) + D) t)^(-d/2), the momentum it has given to the fluid around it.
/// Unit length^2/time^2. Alder & Wainwright, Phys. Rev. A 1 (1970) 18; Ernst, Hauge & van Leeuwen, Phys. Rev.
/// Lett. 25 (1970) 1254. Uses d, n, m, kT. In two dimensions eta and D themselves grow slowly with time, so
/// that it is no limit but holds while they can be taken as constant.
double velocity_autocorrelation_tail(Gas const& gas, double eta, double D, double t);
/// The same in a periodic square or cube of side L at zero total momentum:
/// ((d-1)/d) (kT/(n m L^d)) sum over wave vectors k != 0 of exp(-(eta/(n m) + D) k^2 t).
double velocity_autocorrelation_tail_in_box(Gas const& gas, double eta, double D, double L, double t);

// ---------------------------------------------------------------------------------------------------------
// Stability (docs/stability.md)

/// Frequency of a density wave k of the fluid with the soft repulsion a (1 - r/rc), g = 1 (random phases,
/// zero temperature): sqrt(n k^2 U_k/m), U_k the Fourier transform of U = (a rc/2)(1 - r/rc)^2. Unit 1/time;
/// a in energy/length, k in 1/length. Uses d, n, m, rc. Derived in docs/stability.md.
double random_phase_frequency(Gas const& gas, double a, double k);

/// 2/omega, the step beyond which velocity-Verlet or symplectic Euler blows up an oscillator, for the largest
/// random_phase_frequency. Unit time; it scales as (m/(n a rc^(d-1)))^(1/2).
double harmonic_limit(Gas const& gas, double a);

// ---------------------------------------------------------------------------------------------------------
// Pivkin & Karniadakis 2006: coarse graining. What is of the atoms is in their units (length sigma, mass m,
// time tau, energy m sigma^2/tau^2), what is of the DPD fluid in its own: length rc, mass of a particle, and
// the time unit that @eq{PK2006,4} defines. Three dimensions.

/// A fluid of atoms and the DPD fluid that stands for it, Nm atoms to a particle. The defaults are the
/// paper's.
struct CoarseGraining {
    double Nm = 1.0;                         ///< atoms per particle, any positive number
    double n = 3.0;                          ///< number density of the particles, 1/rc^3
    double n_md = 0.8;                       ///< number density of the atoms, 1/sigma^3
    double eta_md = 1.97;                    ///< viscosity of the atoms, m/(sigma tau)
    double inverse_compressibility = 15.36;  ///< (1/kT) dp/dn of the atoms
    double alpha = 0.101;                    ///< Groot and Warren's constant, see groot_warren_pressure
};

/// The channel of PK2006 sect. IV, in the atoms' units: its width (sigma) and the force on each atom
/// (m sigma/tau^2).
struct Channel {
    double width = 34.2;    ///< sigma
    double force = 0.0085;  ///< on each atom, m sigma/tau^2
};

/// Mass of a particle, m Nm. @eq{PK2006,1} Unit that of m, the mass of an atom.
double particle_mass(CoarseGraining const& map, double m = 1.0);

/// rc in units of sigma, (Nm n/n_md)^(1/3): both fluids have the same mass density. @eq{PK2006,2}
double cutoff_radius(CoarseGraining const& map);

/// A length of the atoms' world, in sigma, as a multiple of rc; 34.2 sigma is Table I. @eq{PK2006,2}
double length_in_dpd_units(CoarseGraining const& map, double length);

/// Conservative coefficient a, the force of a pair at r = 0, in DPD units: kT (kappa^-1 Nm - 1)/(2 alpha n)
/// with kT in DPD units. @eq{PK2006,3} In the terms of Soft, a = Soft::a kT/rc. Throws std::domain_error
/// when kappa^-1 Nm < 1, where the force would have to attract.
double conservative_coefficient(CoarseGraining const& map, double kT);
/// The equation above solved for Nm (map.Nm does not count). @eq{PK2006,3}
double atoms_per_particle(CoarseGraining const& map, double a, double kT);

/// DPD unit of time in tau, (nu/nu_md) rc^2, nu = eta/n with eta the viscosity of the DPD fluid in DPD units.
/// @eq{PK2006,4}
double time_unit(CoarseGraining const& map, double eta);

/// Body force on a particle in DPD units when each of its atoms feels `force` (m sigma/tau^2):
/// force time_unit^2/rc. @eq{PK2006,4} (sect. IV)
double force_in_dpd_units(CoarseGraining const& map, double eta, double force);

/// kT of the DPD fluid in the atoms' units of energy, kT Nm (rc/time_unit)^2. @eq{PK2006,4} The map fixes
/// length, mass and time, so that it fixes this too; nothing makes it the temperature of the atoms.
double temperature_in_md_units(CoarseGraining const& map, double eta, double kT);

/// Mach number at the centre of a channel of width L (sigma) in which `force` (m sigma/tau^2) drives each
/// atom: the Poiseuille maximum over groot_warren_sound_speed with a from conservative_coefficient,
/// n_md force L^2/(8 eta_md) (nu/nu_md) rc/sqrt(kappa^-1 Nm kT). @eq{PK2006,7} (sect. IV)
double mach_number(CoarseGraining const& map, double eta, double kT, double force, double L);

/// How much faster than molecular dynamics of water, 1000 Nm^(8/3). PK2006 sect. I prints the exponent 5/3
/// beside numbers that have 8/3, see theory/PK2006.md.
double speed_up(double Nm);

/// Friction that keeps kT with a noise of strength sigma, sigma^2/(2 kT). PK2006 sect. I.
double matched_friction(double sigma, double kT);

/// Groot and Warren's alpha of a pair distribution, [(1 - r/rc) (r/rc) g]/(2 d rc^d); for g = 1 pi/30 (d = 3)
/// and pi/24 (d = 2). @eq{PK2006,8} Uses d and rc.
double repulsion_constant(Gas const& gas, PairDistribution const& g = {});

/// Pressure of the soft repulsion a (1 - r/rc), n kT + (n^2/(2 d)) [F r g]. @eq{PK2006,8} Unit
/// energy/length^d; a in energy/length.
double virial_pressure(Gas const& gas, double a, PairDistribution const& g = {});
/// sqrt((kT + (n/d) [F r g])/m), dp/dn at a g that does not change with n. @eq{PK2006,7} Unit length/time.
double virial_sound_speed(Gas const& gas, double a, PairDistribution const& g = {});

/// Pressure by Groot and Warren's fit n kT + alpha a rc^4 n^2, d = 3, n rc^3 > 2. @eq{PK2006,8}
/// R. D. Groot and P. B. Warren, J. Chem. Phys. 107 (1997) 4423. Throws std::domain_error for d = 2.
double groot_warren_pressure(Gas const& gas, double a, double alpha);
/// (1/kT) dp/dn = 1 + 2 alpha a rc^4 n/kT of that fit. @eq{PK2006,3}
double groot_warren_inverse_compressibility(Gas const& gas, double a, double alpha);
/// Isothermal speed of sound sqrt(dp/dn/m) of that fit; with eq. 3 for a it is sqrt(kappa^-1 Nm kT/m).
/// @eq{PK2006,7}
double groot_warren_sound_speed(Gas const& gas, double a, double alpha);

/// Diffusion constant msd/(2 d t) from a mean-square displacement at time t. @eq{PK2006,5}
double diffusion_from_displacement(int d, double msd, double t);

/// g between r_min and r_max from the mean number of neighbours of a particle there, neighbours/(n V), V the
/// volume of the shell. @eq{PK2006,6} r_min may be 0. Throws std::invalid_argument unless r_min < r_max.
double pair_distribution_in_shell(int d, double n, double neighbours, double r_min, double r_max);

/// Velocity of the plane Poiseuille flow, n force/(2 eta) z (L - z), 0 <= z <= L; force on a particle.
/// Navier-Stokes, incompressible; PK2006 sect. IV. Throws std::invalid_argument for z outside.
double poiseuille_velocity(double n, double force, double eta, double L, double z);
/// The same at the centre, n force L^2/(8 eta).
double poiseuille_maximum_velocity(double n, double force, double eta, double L);

/// Velocity of a power-law fluid (stress = K shear_rate^index) in the same channel,
/// u_max (1 - |1 - 2 z/L|^(1/index + 1)); index = 1 is the parabola. PK2006 sect. IV.
double power_law_velocity(double u_max, double index, double L, double z);

/// Schmidt number eta/(n m D) from measured values. PK2006 sect. VI.
double schmidt_number(double eta, double n, double m, double D);

// ---------------------------------------------------------------------------------------------------------
// The Lennard-Jones fluid

/// What is done at the cut-off rc of a pair energy u(r).
enum class Truncation {
    none,          ///< u(r) as it is, up to rc: it jumps there. Its force inside is that of the next
    energy_shift,  ///< u(r) - u(rc): what molecular dynamics with the plain force inside rc simulates
    linear_force,  ///< u(r) - u(rc) - (r - rc) u'(rc): energy and force both vanish at rc
};

/// u(r) = 4 epsilon ((sigma/r)^12 - (sigma/r)^6) up to the cut-off; without one by default.
struct LennardJones {
    double epsilon = 1.0;                                 ///< energy
    double sigma = 1.0;                                   ///< length
    double rc = std::numeric_limits<double>::infinity();  ///< cut-off
    Truncation truncation = Truncation::none;             ///< what happens at the cut-off
};

/// Energy of a pair at the distance r > 0; 0 at and beyond rc.
double lennard_jones_energy(LennardJones const& lj, double r);
/// Its force -du/dr inside rc, positive when it repels. The pulse that Truncation::none has at rc is left
/// out.
double lennard_jones_force(LennardJones const& lj, double r);
/// d2u/dr2 inside rc.
double lennard_jones_curvature(LennardJones const& lj, double r);

/// Energy per particle from beyond rc with g = 1, three dimensions:
/// (8 pi/3) n epsilon sigma^3 ((1/3)(sigma/rc)^9 - (sigma/rc)^3). To be added to the energy with
/// Truncation::none. The truncation of `lj` does not count; rc must be finite.
double lennard_jones_tail_energy(LennardJones const& lj, double n);
/// Pressure from beyond rc with g = 1, three dimensions:
/// (16 pi/3) n^2 epsilon sigma^3 ((2/3)(sigma/rc)^9 - (sigma/rc)^3). To be added to the pressure from the
/// forces inside rc.
double lennard_jones_tail_pressure(LennardJones const& lj, double n);
/// Pressure of the pulse of force at rc with g = 1, (8 pi/3) n^2 epsilon sigma^3 ((sigma/rc)^9 -
/// (sigma/rc)^3): what the fluid with Truncation::none has more than its forces inside rc show.
double lennard_jones_jump_pressure(LennardJones const& lj, double n);

/// Pressure of the Lennard-Jones fluid without cut-off by the equation of state of J. Kolafa and I. Nezbeda,
/// Fluid Phase Equilib. 100 (1994) 1, in reduced units (epsilon, sigma). A fit: near n = 0.8 it is within
/// 0.02 of simulation (theory/PK2006.md). Throws std::domain_error when the packing fraction would reach 1.
double lennard_jones_pressure(double n, double kT);
/// Potential energy per particle by the same equation of state.
double lennard_jones_internal_energy(double n, double kT);
/// (1/kT) dp/dn by the same equation of state.
double lennard_jones_inverse_compressibility(double n, double kT);

}  // namespace dpd::theory
