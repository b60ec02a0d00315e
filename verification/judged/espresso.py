"""ESPResSo as a whole program on the standard fluid, in columns that `dpdref compare` reads.

usage: pypresso espresso.py rest|shear FOLDER [--steps N] [--seed N]
       pypresso espresso.py boundary

rest      writes samples.csv, msd.csv and rdf.csv: outputs/espresso-whole
shear     Lees-Edwards at the rate 0.25: writes samples.csv and ahead.csv
boundary  prints the potential energy of random positions whose boundary is displaced: with all pairs, with its cells, by a sum of ours

ESPResSo needs the features DPD and HAT, and for shear the signs of its pull request 5081 (docs/judged.md).
"""
import argparse
import math
import pathlib

import espressomd
import espressomd.lees_edwards
import espressomd.observables
import numpy as np

LENGTH, NUMBER, STEP, RATE, REPULSION = 10.0, 3000, 0.04, 0.25, 25.0
EQUILIBRATION = 1000        # steps; from random positions
SAMPLE, FRAME = 20, 25      # steps between samples, between positions
LAGS = 10                   # frames of an origin of the mean square displacement
FRAMES_OF_RDF = 2           # frames from one g(r) to the next: 50 steps
BLOCKS = 20                 # of g(r), for its error


def displace(system, offset, velocity):
    """Lees-Edwards along x, across y."""
    protocol = espressomd.lees_edwards.LinearShear(initial_pos_offset=offset, shear_velocity=velocity, time_0=0.0)
    system.lees_edwards.set_boundary_conditions(shear_direction="x", shear_plane_normal="y", protocol=protocol)


def fluid(seed, sheared):
    """The system, equilibrated."""
    generator = np.random.default_rng(seed)
    system = espressomd.System(box_l=3 * [LENGTH])
    system.time_step = STEP
    system.cell_system.skin = 0.4
    if sheared:
        # all pairs, in a list for some steps: in a step the offset of the boundary moves by 0.1, which counts as a displacement
        system.cell_system.skin = 1.5
        system.cell_system.set_n_square(use_verlet_lists=True)
        displace(system, 0.0, RATE * LENGTH)
    positions = LENGTH * generator.random((NUMBER, 3))
    velocities = generator.normal(size=(NUMBER, 3))
    velocities -= velocities.mean(axis=0)
    if sheared:
        velocities += flow(positions)
    particles = system.part.add(pos=positions, v=velocities)
    system.thermostat.set_dpd(kT=1.0, seed=seed)
    system.non_bonded_inter[0, 0].dpd.set_params(weight_function=1, k=1, gamma=4.5, r_cut=1.0)
    system.non_bonded_inter[0, 0].hat.set_params(F_max=REPULSION, cutoff=1.0)
    system.integrator.run(EQUILIBRATION)
    return system, list(particles.id)


def flow(positions):
    """The linear profile at the folded heights, without momentum in the mean."""
    profile = np.zeros_like(positions)
    profile[:, 0] = RATE * (positions[:, 1] % LENGTH - LENGTH / 2)
    return profile - profile.mean(axis=0)


def write(path, header, rows):
    lines = [header, *(",".join(f"{value:.7g}" for value in row) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def temperature(velocities):
    """Twice the kinetic energy over 3(N-1), as dpdref has it."""
    velocities = velocities - velocities.mean(axis=0)
    return np.sum(velocities**2) / (3 * (NUMBER - 1))


def rest(system, ids, steps, folder):
    observables = espressomd.observables
    positions = observables.ParticlePositions(ids=ids)
    velocities = observables.ParticleVelocities(ids=ids)
    pairs = observables.RDF(ids1=ids, n_r_bins=100, min_r=0.0, max_r=2.0)
    friction = observables.DPDStress()
    start, origin, samples, displacements, curves = system.time, positions.calculate(), [], [], []
    stride = math.gcd(SAMPLE, FRAME)
    for step in range(stride, steps + 1, stride):
        system.integrator.run(stride)
        if step % SAMPLE == 0:
            samples.append((system.time - start, temperature(velocities.calculate()), system.analysis.energy()["non_bonded"] / NUMBER,
                            system.analysis.pressure()["total"], np.trace(friction.calculate()) / 3))
        if step % FRAME == 0:
            frame = step // FRAME
            here = positions.calculate()
            lag = (frame - 1) % LAGS + 1
            displacements.append((lag * FRAME * STEP, np.mean(np.sum((here - origin)**2, axis=1))))
            if lag == LAGS:
                origin = here
            if frame % FRAMES_OF_RDF == 0:
                curves.append(pairs.calculate())
    write(folder / "samples.csv", "time,kinetic_temperature,potential_energy,pressure,dpd_pressure", samples)
    write(folder / "msd.csv", "lag,mean_square_displacement", displacements)
    number = min(BLOCKS, len(curves))
    blocks = np.array([block.mean(axis=0) for block in np.array_split(np.array(curves), number)])
    errors = blocks.std(axis=0, ddof=1) / np.sqrt(number)
    write(folder / "rdf.csv", "r,radial_distribution,error,blocks",
          [(r, g, e, number) for r, g, e in zip(pairs.bin_centers(), blocks.mean(axis=0), errors)])


def stress(system, friction):
    """xy of pressure_tensor, which has no friction in 2024, and dpd_stress, by its sign a pressure: their sum, and the second."""
    dissipative = friction.calculate()[0, 1]
    return system.analysis.pressure_tensor()["total"][0, 1] + dissipative, dissipative


def shear(system, ids, steps, folder):
    """The stress twice: as ESPResSo gives it after a step, when the boundary is a step ahead of the forces, and with the boundary where it was for them."""
    positions = espressomd.observables.ParticlePositions(ids=ids)
    velocities = espressomd.observables.ParticleVelocities(ids=ids)
    friction = espressomd.observables.DPDStress()
    start, samples, ahead = system.time, [], []
    for _ in range(steps // SAMPLE):
        system.integrator.run(SAMPLE, reuse_forces=True)  # to set the time would else have the forces calculated again
        now = system.time
        ahead.append((now - start, *stress(system, friction)))
        system.time = now - STEP
        peculiar = velocities.calculate() - flow(positions.calculate())
        samples.append((now - start, temperature(peculiar), *stress(system, friction)))
        system.time = now
    write(folder / "samples.csv", "time,kinetic_temperature,pressure_xy,dpd_stress_xy", samples)
    write(folder / "ahead.csv", "time,pressure_xy,dpd_stress_xy", ahead)


def energy(positions, offset):
    """Of the repulsion, by a sum over all pairs: what crosses the boundary upwards is moved by -offset."""
    total = 0.0
    for i in range(NUMBER - 1):
        distance = positions[i] - positions[i + 1:]
        distance[:, 0] -= offset * np.round(distance[:, 1] / LENGTH)
        distance -= LENGTH * np.round(distance / LENGTH)
        r = np.sqrt(np.sum(distance**2, axis=1))
        total += REPULSION / 2 * np.sum((1 - r[r < 1])**2)
    return total


def boundary():
    system = espressomd.System(box_l=3 * [LENGTH])
    system.time_step = STEP
    system.cell_system.skin = 0.4
    system.non_bonded_inter[0, 0].hat.set_params(F_max=REPULSION, cutoff=1.0)
    displace(system, 0.0, 0.0)
    positions = LENGTH * np.random.default_rng(1).random((NUMBER, 3))
    system.part.add(pos=positions)
    print("offset,all_pairs,cells,sum,sum_of_reversed_offset")
    for offset in (0.0, 0.1, 1.3, 3.7, 8.9):
        displace(system, offset, 0.0)
        system.cell_system.set_n_square(use_verlet_lists=False)
        energies = [system.analysis.energy()["non_bonded"]]
        system.cell_system.set_regular_decomposition(use_verlet_lists=False, fully_connected_boundary={"boundary": "y", "direction": "x"})
        energies.append(system.analysis.energy()["non_bonded"])
        print(offset, *(f"{value:.4f}" for value in (*energies, energy(positions, offset), energy(positions, -offset))), sep=",")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("state", choices=["rest", "shear", "boundary"])
    parser.add_argument("folder", type=pathlib.Path, nargs="?", default=pathlib.Path("."))
    parser.add_argument("--steps", type=int, default=12500)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    espressomd.assert_features(["DPD", "HAT"])
    if given.state == "boundary":
        boundary()
        return
    given.folder.mkdir(parents=True, exist_ok=True)
    system, ids = fluid(given.seed, given.state == "shear")
    (rest if given.state == "rest" else shear)(system, ids, given.steps, given.folder)


main()
