#!/usr/bin/env python3
"""The picture of README.md: temperature against time step, all pairs at once and pair after pair, in one fluid.

usage: front.py PROGRAM      runs PROGRAM (dpdref), half a minute, and writes figures/front.dat, figures/front.svg

The fluid is that of MY1997, in a small box. Python's standard library and gnuplot.
"""

import json
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENE = ROOT / "verification" / "scenes" / "learn"
SET = 0.5  # kT
WAYS = {
    "Euler": ("euler.toml", (0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5)),
    "S1": ("euler_fluid_s1.toml", (0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.6, 0.7, 0.8)),
}


def main(program):
    lines = ["# kT over the set kT against the time step, MY1997's fluid at density 0.2 in a box of 80 x 80; written by verification/front/front.py",
             "# columns: step, kT over the set one, its error; of eq. 22: step, kT over the set one"]
    for way, (scene, steps) in WAYS.items():
        lines += ["", "", f"# {way}"]
        for step in steps:
            answer = subprocess.run([program, "run", SCENE / scene, "--json", "--set", f"time.step={step}", "--set", "box.length=[80.0,80.0]",
                                     "--set", "time.duration=400"], stdout=subprocess.PIPE, check=True)
            measured = json.loads(answer.stdout)["quantities"]["kinetic_temperature"]
            lines.append(f"{step} {measured['value'] / SET:.5g} {measured['error'] / SET:.2g}")
    lines += ["", "", "# eq. 22"]
    for k in range(0, 49):
        step = 0.01 * k + 0.001
        answer = subprocess.run([program, "theory", "my22", "d=2", "n=0.2", "gamma=1", "sigma=1", "rc=4", f"dt={step}", "weight=parabolic"],
                                stdout=subprocess.PIPE, text=True, check=True)
        lines.append(f"{step:.3f} {float(answer.stdout.split()[-1]) / SET:.5g}")
    (ROOT / "figures" / "front.dat").write_text("\n".join(lines) + "\n", encoding="utf-8")
    subprocess.run(["gnuplot", "verification/front/plot.gp"], cwd=ROOT, check=True)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    main(pathlib.Path(sys.argv[1]).resolve())
