#!/usr/bin/env python3
"""The same scene by dpdref and by LAMMPS (packages DPD-BASIC and DPD-REACT), in turn: ratio of whole-process CPU times.

usage: race.py DPDREF [--lmp lmp] [--repetitions 5] [--only dpd|shardlow|lennard_jones]

LAMMPS runs what `dpdref export lammps` writes, from the same positions and velocities, with the best of its neighbour
settings: skins of 0.2 to 0.8, checked every step or every second one. Settings with dangerous builds do not count. Exit
code 77 where there is no lmp. Python's standard library only.
"""

import argparse
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

SCENES = pathlib.Path(__file__).resolve().parents[1] / "scenes" / "race"
NAMES = sorted(scene.stem for scene in SCENES.glob("*.toml"))
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


def race(program, lmp, name, repetitions, directory):
    scene, deck = str(SCENES / f"{name}.toml"), directory / name
    cpu_seconds([program, "export", "lammps", scene, "--out", str(deck)], directory)
    text = (deck / "in.dpdref").read_text()
    steps = int(re.search(r"^run (\d+)$", text, re.MULTILINE)[1])
    particles = int(re.search(r"^(\d+) atoms$", (deck / "particles.data").read_text(), re.MULTILINE)[1])
    trials = [(lammps(lmp, deck, skin, every, steps // 10), skin, every) for skin in SKINS for every in (1, 2)]
    (_, skin, every) = min(((seconds, skin, every) for (seconds, safe), skin, every in trials if safe))
    theirs, ours = [], []
    for _ in range(repetitions):
        theirs.append(lammps(lmp, deck, skin, every, steps)[0])
        ours.append(cpu_seconds([program, "run", scene], directory)[0])
    ratios = [a / b for a, b in zip(theirs, ours)]
    unit = 1e9 / (particles * steps)
    return (f"| {name} | {skin}, every {every} | {unit * statistics.median(theirs):.0f} | {unit * statistics.median(ours):.0f} "
            f"| {statistics.median(ratios):.2f} | {min(ratios):.2f} to {max(ratios):.2f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", help="dpdref")
    parser.add_argument("--lmp", default="lmp")
    parser.add_argument("--repetitions", type=int, default=5)
    parser.add_argument("--only", choices=NAMES)
    arguments = parser.parse_args()
    program, lmp = os.path.abspath(arguments.program), shutil.which(arguments.lmp)
    if lmp is None:
        print(f"no {arguments.lmp} on the PATH")
        sys.exit(77)
    print("| scene | LAMMPS's skin | LAMMPS, ns | dpdref, ns | ratio | range |\n|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        for scene in [arguments.only] if arguments.only else NAMES:
            print(race(program, lmp, scene, arguments.repetitions, pathlib.Path(name)), flush=True)


if __name__ == "__main__":
    main()
