#!/usr/bin/env python3
"""Runs the exact answers that LAMMPS can give: those without noise, which it draws from generators of its own.

usage: lammps_exact.py [PROGRAM]     PROGRAM: a LAMMPS with the packages DPD-BASIC and DPD-REACT; default lmp

One line per case with the largest deviation; exit code 1 if one is above its limit, 77 (skipped) without the program or
its packages. Python's standard library only.
"""

import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
from check_exact import deviation

ANSWERS = pathlib.Path(__file__).resolve().parents[2] / "figures" / "answers" / "exact.json"


def pair_dpd(case):  # friction weight (1-r/cutoff)^2, friction seen at the half-kicked velocities: lambda = 1/2
    p = case["modified_verlet"]
    return [f"pair_style dpd 0.0 {p['cutoff']} 1", f"pair_coeff * * {p['soft']['strength'] / p['soft']['cutoff']} {p['gamma']}",
            "fix move all nve"]


def fix_shardlow(case):  # divides by the temperature: friction sigma^2/(2kT) with a noise far below the limit
    p, kT = case["shardlow"], 1e-30
    return [f"pair_style dpd/fdt {kT} {p['cutoff']} 1",
            f"pair_coeff * * {case['verlet']['soft']['strength']} {(2 * p['friction'] * kT) ** 0.5}",
            "fix thermostat all shardlow", "fix move all nve"]


def lj_cut(case):
    p = case["verlet"]["lennard_jones"]
    return [f"pair_style lj/cut {p['cutoff']}", f"pair_coeff * * {p['epsilon']} {p['sigma']}", "fix move all nve"]


CASES = {"modified-verlet-two-friction-only": (pair_dpd, 1e-13), "modified-verlet-friction-only": (pair_dpd, 1e-13),
         "shardlow-verlet-two-friction-only": (fix_shardlow, 1e-13), "verlet-lennard-jones": (lj_cut, 1e-13)}


def deck(case, interaction):
    sides, start = case["box"]["length"], case["initial"]
    lines = ["units lj", "atom_style atomic", "atom_modify map array", "comm_modify vel yes", "newton on",
             "region box block " + " ".join(f"0 {side}" for side in sides), "create_box 1 box", f"mass 1 {case['mass']}"]
    for k, (r, v) in enumerate(zip(start["position"], start["velocity"]), 1):
        lines += [f"create_atoms 1 single {' '.join(map(repr, r))}",
                  f"set atom {k} vx {v[0]!r} vy {v[1]!r} vz {v[2]!r}"]
    return "\n".join([*lines, *interaction(case), f"timestep {case['time_step']}",
                      "dump state all custom 1 state.dump id x y z vx vy vz",
                      "dump_modify state sort id format float %.17g", f"run {len(case['steps'])}", ""])


def run(program, case, interaction):
    """Per step the positions and velocities."""
    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / "in.case").write_text(deck(case, interaction))
        done = subprocess.run([program, "-in", "in.case", "-log", "none"], cwd=folder, capture_output=True, text=True)
        if "package is not enabled" in done.stdout + done.stderr or "Unrecognized" in done.stdout + done.stderr:
            print(f"skipped: {program} lacks DPD-BASIC or DPD-REACT")
            sys.exit(77)
        if done.returncode:
            sys.exit(f"{case['id']}: LAMMPS failed:\n{done.stdout}{done.stderr}")
        frames = (pathlib.Path(folder) / "state.dump").read_text().split("ITEM: TIMESTEP")[2:]
    rows = [[list(map(float, line.split()[1:])) for line in frame.split("vz")[1].split("\n") if line.strip()] for frame in frames]
    return [([row[:3] for row in frame], [row[3:] for row in frame]) for frame in rows]


def main(program):
    if not shutil.which(program):
        print(f"skipped: no program {program}")
        return 77
    cases = {case["id"]: case for case in json.loads(ANSWERS.read_text())["cases"]}
    worst = 0.0
    for name, (interaction, limit) in CASES.items():
        found = run(program, cases[name], interaction)
        value = max(max(deviation(r, step["position"]), deviation(v, step["velocity"]))
                    for (r, v), step in zip(found, cases[name]["steps"], strict=True))
        worst = max(worst, value / limit)
        print(f"{name:<48} {value:.1e}{'' if value <= limit else '  ABOVE THE LIMIT'}")
    return 0 if worst <= 1 else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1] if len(sys.argv) > 1 else "lmp"))
