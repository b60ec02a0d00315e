#!/usr/bin/env python3
"""Scenes on LAMMPS and on dpdref: exports, runs both, compares, writes the tables of docs/lammps.md.

Needs `lmp` with the packages DPD-BASIC and DPD-REACT on the PATH; Python's standard library only. Finished runs are
kept in the working directory; the same command again goes on where it was stopped.
Usage: prove.py --dpdref PATH --work DIR [--write FOLDER] [STATE...]: the tables go to FOLDER, averages.md and own_columns.md.
"""
import argparse
import json
import math
import pathlib
import statistics
import subprocess
import tomllib

WRITTEN = "<!-- written by verification/lammps/prove.py -->"
HERE = pathlib.Path(__file__).resolve().parent

# name of the state: scene, and what is set on top of it
STATES = {
    "Groot-Warren, step 0.04": ("gw", ["time.duration=400.0"]),
    "Groot-Warren, step 0.02": ("gw", ["time.step=0.02"]),
    "linear weight": ("gw", ["modified_verlet.weight=linear"]),
    "gamma 45": ("gw", ["modified_verlet.gamma=45.0", f"modified_verlet.sigma={math.sqrt(90.0)}", "time.step=0.01",
                        "time.duration=100.0"]),
    "mass 2": ("gw", ["particles.mass=2.0"]),
    "two dimensions": ("gw", ["dimension=2", "box.length=[22.0, 22.0]"]),
    "in shear": ("shear", ["time.duration=800.0"]),
    "in shear, rate 1": ("shear", ["box.shear_rate=1.0"]),
    "S1, soft": ("shardlow", []),
    "S1, gas": ("gas", []),
    "Lennard-Jones, NVE": ("lj", []),
    "Lennard-Jones, thermostat": ("lj_thermostat", []),
}


def call(*command, codes=(0,)):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode not in codes:
        raise SystemExit(f"{' '.join(map(str, command))}:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done.stdout


def run_state(dpdref, directory, scene, overrides):
    """Both programs; what compare says of their results."""
    log = directory / "log.lammps"
    if not (log.exists() and "Total wall time" in log.read_text()):
        settings = [word for override in overrides for word in ("--set", override)]
        call(dpdref, "export", "lammps", HERE / f"{scene}.toml", *settings, "--out", directory)
        subprocess.run(["lmp", "-in", "in.dpdref", "-log", "log.lammps", "-screen", "none"], cwd=directory, check=True)
    reference = directory / "reference.h5"
    call(dpdref, "run", directory / "scene.toml", "--seed", 1, "--out", reference)
    results = [directory / name for name in ("scalars.dat", "msd.dat", "rdf.dat") if (directory / name).exists()]
    return json.loads(call(dpdref, "compare", *results, "--reference", reference, "--json", codes=(0, 1)))


def columns(file):
    """Those of scalars.dat by name, without the first row: it belongs to the setup of the run."""
    lines = file.read_text().splitlines()
    rows = [[float(word) for word in line.split()] for line in lines[3:]]
    return dict(zip(lines[1].lstrip("# ").split(), zip(*rows)))


def mean(values, blocks=32):
    """Mean and its standard error from block averages."""
    size = len(values) // blocks
    means = [statistics.fmean(values[k * size:(k + 1) * size]) for k in range(blocks)]
    return statistics.fmean(values), statistics.stdev(means) / math.sqrt(blocks)


def friction_pressure(directory, kT):
    """What friction adds to the pressure at finite step: forces at the end of a drift see velocities from its middle.

    -(gamma dt kT/(m d)) (n^2/2) times the integral over space of g div(w r), the latter exact in each bin of g.
    """
    scene = tomllib.loads((directory / "scene.toml").read_text())
    friction, particles, d = scene["modified_verlet"], scene["particles"], scene["dimension"]
    power = {"linear": 1, "quadratic": 2}[friction["weight"]]
    lines = [line.split() for line in (directory / "rdf.dat").read_text().splitlines()[3:]]
    bins = int(lines[0][1])
    g = [statistics.fmean(float(line[2]) for line in lines if len(line) == 3 and int(line[0]) == b + 1)
         for b in range(bins)]
    edges = [b * scene["sample"]["radial_distribution"]["range"] / bins for b in range(bins + 1)]
    carried = [r**d * max(0.0, 1.0 - r / friction.get("cutoff", 1.0)) ** power for r in edges]
    sphere = {2: 2.0, 3: 4.0}[d] * math.pi
    integral = sphere * sum(g[b] * (carried[b + 1] - carried[b]) for b in range(bins))
    strength = friction["gamma"] * scene["time"]["step"] * kT / (particles.get("mass", 1.0) * d)
    return -strength * 0.5 * particles["density"] ** 2 * integral


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--dpdref", type=pathlib.Path, required=True)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("--write", type=pathlib.Path)
    parser.add_argument("states", nargs="*", metavar="STATE")
    given = parser.parse_args()
    version = next(line for line in call("lmp", "-h").splitlines() if "Massively Parallel Simulator" in line)
    version = "LAMMPS" + version.split("Simulator", 1)[1].replace(" - ", " ", 1)
    lines = [f"{version} and {call(given.dpdref, '--version').split(' (')[0]}; errors are one standard error.", "",
             "| state | quantity | LAMMPS | error | dpdref | error | z | verdict |", "|---|---|---|---|---|---|---|---|"]
    own = ["| state | column | difference | error | expected from g(r) |", "|---|---|---|---|---|"]
    for name in given.states or STATES:
        directory = given.work / name.replace(" ", "_").replace(",", "")
        report = run_state(given.dpdref.resolve(), directory, *STATES[name])
        for c in report["comparisons"]:
            lines.append(f"| {name} | {c['quantity']} | {c['value']:.6g} | {c['error']:.2g} | {c['reference']:.6g} | "
                         f"{c['reference_error']:.2g} | {c['z']:.2f} | {c['verdict']} |")
            print(lines[-1], flush=True)
        scalars = columns(directory / "scalars.dat")
        for column in scalars:
            if not column.startswith("lammps_"):
                continue
            difference = [a - b for a, b in zip(scalars[column], scalars[column.removeprefix("lammps_")])]
            value, error = mean(difference)
            expected = ""
            if column == "lammps_pressure" and (directory / "rdf.dat").exists():
                expected = f"{friction_pressure(directory, statistics.fmean(scalars['kinetic_temperature'])):.4f}"
            own.append(f"| {name} | {column} | {value:.4f} | {error:.4f} | {expected} |")
            print(own[-1], flush=True)
    if given.write:
        for name, table in (("averages", lines), ("own_columns", own)):
            (given.write / f"{name}.md").write_text("\n".join([WRITTEN, *table]) + "\n")


if __name__ == "__main__":
    main()
