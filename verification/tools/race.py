#!/usr/bin/env python3
"""The same scene by dpdref and by LAMMPS (packages DPD-BASIC and DPD-REACT), in turn: ratio of whole-process CPU times.

usage: race.py DPDREF [--lmp lmp] [--repetitions 5] [--only dpd|shardlow|lennard_jones]
       race.py DPDREF --digits [--lmp lmp] [--repetitions 5]: CPU seconds until kT, pressure, D and viscosity are known to 1 %

LAMMPS runs what `dpdref export lammps` writes, from the same positions and velocities, with the best of its neighbour
settings: skins of 0.2 to 0.8, checked every step or every second one. Settings with dangerous builds do not count. Exit
code 77 where there is no lmp. Python's standard library only.
"""

import argparse
import json
import math
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

VERIFICATION = pathlib.Path(__file__).resolve().parents[1]
SCENES = VERIFICATION / "scenes" / "race"
FLUID_SCENES = VERIFICATION / "lammps"
NAMES = sorted(scene.stem for scene in SCENES.glob("*.toml"))
# The standard fluid of the reference answers, at rest and in shear, and what is measured there.
FLUIDS = {
    "gw": (["time.duration=400.0"], ("kinetic_temperature", "pressure", "diffusion_constant")),
    "shear": (["time.duration=400.0", "box.shear_rate=0.3"], ("viscosity",)),
}
SKINS = (0.2, 0.3, 0.4, 0.5, 0.6, 0.8)


def cpu_seconds(command, directory):
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    with subprocess.Popen(command, cwd=directory, stdout=subprocess.PIPE, text=True, env=environment) as process:
        output = process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"{' '.join(command)} failed:\n{output}")
    return usage.ru_utime + usage.ru_stime, output


def lammps(lmp, deck, skin, every, steps):
    """CPU seconds of so many steps, and whether LAMMPS is sure that no particle came near unnoticed"""
    lines = (deck / "in.dpdref").read_text()
    for word, value in (("neighbor", f"{skin} bin"), ("neigh_modify", f"delay 0 every {every} check yes"),
                        ("thermo", steps), ("run", steps)):
        lines = re.sub(rf"^{word} .*$", f"{word} {value}", lines, flags=re.MULTILINE)
    (deck / "in.race").write_text(lines)
    seconds, output = cpu_seconds([lmp, "-in", "in.race", "-log", "none"], deck)
    return seconds, re.search(r"Dangerous builds = 0\b", output) is not None


def export(program, scene, deck, settings=()):
    """The deck's number of steps and of particles"""
    words = [word for setting in settings for word in ("--set", setting)]
    cpu_seconds([program, "export", "lammps", str(scene), *words, "--out", str(deck)], deck.parent)
    steps = [int(number) for number in re.findall(r"^run (\d+)$", (deck / "in.dpdref").read_text(), re.MULTILINE)]
    return steps, int(re.search(r"^(\d+) atoms$", (deck / "particles.data").read_text(), re.MULTILINE)[1])


def best_neighbours(lmp, deck, steps):
    """Skin, and how often it is checked"""
    trials = [(lammps(lmp, deck, skin, every, steps), skin, every) for skin in SKINS for every in (1, 2)]
    return min((seconds, skin, every) for (seconds, safe), skin, every in trials if safe)[1:]


def race(program, lmp, name, repetitions, directory):
    scene, deck = str(SCENES / f"{name}.toml"), directory / name
    [steps], particles = export(program, scene, deck)
    skin, every = best_neighbours(lmp, deck, steps // 10)
    theirs, ours = [], []
    for _ in range(repetitions):
        theirs.append(lammps(lmp, deck, skin, every, steps)[0])
        ours.append(cpu_seconds([program, "run", scene], directory)[0])
    ratios = [a / b for a, b in zip(theirs, ours)]
    unit = 1e9 / (particles * steps)
    return (f"| {name} | {skin}, every {every} | {unit * statistics.median(theirs):.0f} | {unit * statistics.median(ours):.0f} "
            f"| {statistics.median(ratios):.2f} | {min(ratios):.2f} to {max(ratios):.2f} |")


def seconds_to_a_percent(program, lmp, name, repetitions, directory):
    """Per quantity: CPU seconds of LAMMPS and of dpdref until its error is 1 %, by the inverse-root law, and their ratio.

    LAMMPS runs the deck as it is, whose neighbour settings are the best ones for this fluid. Both errors are compare's, by
    blocking. Squares of errors are averaged over runs with other seeds; the ratio's error is that of its logarithm.
    """
    settings, quantities = FLUIDS[name]
    scene = FLUID_SCENES / f"{name}.toml"
    costs = {quantity: ([], []) for quantity in quantities}
    for seed in range(1, repetitions + 1):
        deck = directory / f"{name}-{seed}"
        export(program, scene, deck, [*settings, f"seed={seed}"])
        theirs, _ = cpu_seconds([lmp, "-in", "in.dpdref", "-log", "none"], deck)
        ours, _ = cpu_seconds([program, "run", str(deck / "scene.toml"), "--out", "reference.h5"], deck)
        files = [file for file in ("scalars.dat", "msd.dat") if (deck / file).exists()]
        done = subprocess.run([program, "compare", *files, "--reference", "reference.h5", "--json"], cwd=deck, capture_output=True, text=True)
        if done.returncode not in (0, 1):  # 1: one disagrees, which is no matter here
            sys.exit(done.stderr)
        for row in json.loads(done.stdout)["comparisons"]:
            if row["quantity"] in costs:
                of_theirs, of_ours = costs[row["quantity"]]
                of_theirs.append(theirs * (row["error"] / (0.01 * row["value"]))**2)
                of_ours.append(ours * (row["reference_error"] / (0.01 * row["reference"]))**2)
    for quantity, (theirs, ours) in costs.items():
        ratios = [math.log(a / b) for a, b in zip(theirs, ours)]
        spread = statistics.stdev(ratios) / math.sqrt(len(ratios)) if len(ratios) > 1 else math.nan
        ratio = statistics.fmean(theirs) / statistics.fmean(ours)
        print(f"| {quantity} | {statistics.fmean(theirs):.2g} | {statistics.fmean(ours):.2g} | {ratio:.2g} | {ratio * spread:.1g} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", help="dpdref")
    parser.add_argument("--lmp", default="lmp")
    parser.add_argument("--repetitions", type=int, default=5)
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--only", choices=NAMES)
    what.add_argument("--digits", action="store_true", help="seconds to an error of one per cent")
    arguments = parser.parse_args()
    program, lmp = os.path.abspath(arguments.program), shutil.which(arguments.lmp)
    if lmp is None:
        print(f"no {arguments.lmp} on the PATH")
        sys.exit(77)
    if arguments.digits:
        print("| quantity | LAMMPS, s | dpdref, s | ratio | error |\n|---|---|---|---|---|")
        with tempfile.TemporaryDirectory() as name:
            for fluid in FLUIDS:
                seconds_to_a_percent(program, lmp, fluid, arguments.repetitions, pathlib.Path(name))
        return
    print("| scene | LAMMPS's skin | LAMMPS, ns | dpdref, ns | ratio | range |\n|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        for scene in [arguments.only] if arguments.only else NAMES:
            print(race(program, lmp, scene, arguments.repetitions, pathlib.Path(name)), flush=True)


if __name__ == "__main__":
    main()
