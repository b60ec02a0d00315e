#!/usr/bin/env python3
"""The still picture of the live page "One pair": the mean temperature of many pairs against time, with friction alone, noise alone, and both.

usage: pair.py PROGRAM      runs PROGRAM (dpdref), a minute, and writes figures/live/pair.dat, figures/live/pair.svg

Python's standard library and gnuplot.
"""

import json
import math
import pathlib
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENE = ROOT / "verification" / "scenes" / "live" / "pair.toml"
WAYS = {"friction alone": ["euler.sigma=0"], "noise alone": ["euler.gamma=0"], "friction and noise": []}
TIMES = (0.02, 0.5, 1, 1.5, 2, 3, 4, 5)
SEEDS = 120


def temperature(program, overrides, time, seed):
    """of one pair, over a few steps at that time"""
    given = [*overrides, "time.step=0.01", f"time.equilibration={time - 0.02:g}", "time.duration=0.04"]
    answer = subprocess.run([program, "run", SCENE, "--json", "--seed", str(seed)] + [word for each in given for word in ("--set", each)],
                            stdout=subprocess.PIPE, check=True)
    return json.loads(answer.stdout)["quantities"]["kinetic_temperature"]["value"]


def main(program):
    lines = [f"# kT of {SEEDS} pairs, each alone in its box, against time; written by verification/live/pair.py", "# columns: time, mean kT, its error"]
    for way, overrides in WAYS.items():
        lines += ["", "", f"# {way}"]
        for time in TIMES:
            values = [temperature(program, overrides, time, seed) for seed in range(1, SEEDS + 1)]
            lines.append(f"{time} {statistics.mean(values):.4g} {statistics.stdev(values) / math.sqrt(SEEDS):.2g}")
    (ROOT / "figures" / "live" / "pair.dat").write_text("\n".join(lines) + "\n", encoding="utf-8")
    subprocess.run(["gnuplot", "verification/live/pair.gp"], cwd=ROOT, check=True)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    main(pathlib.Path(sys.argv[1]).resolve())
