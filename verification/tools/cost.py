#!/usr/bin/env python3
"""What a scene costs, feature by feature: time, counters and memory per particle, as a Markdown table.

usage: cost.py DPDREF              the table
       cost.py DPDREF --scaling    the soft fluid with S1 from 3000 to 3 million particles, and at three densities
       cost.py OLD NEW             two builds, run in turn: NEW's time over OLD's, and whether they did the same
       cost.py OLD NEW --instructions   the same once, NEW's instructions over OLD's: no noise, where times cannot decide

Instructions are counted by valgrind, which stands for a processor with AVX2; their count says nothing about waiting for memory.
Times are CPU times of whole processes, the median of the repetitions and their range. All scenes take their turn
before one is repeated, so that a slow minute of the machine falls on all. The counters are exact. Python's
standard library only.
"""

import argparse
import json
import os
import pathlib
import re
import statistics
import subprocess
import sys

SCENE = pathlib.Path(__file__).resolve().parents[1] / "scenes" / "cost" / "gas.toml"


def scene(stages, *assignments, steps=1000):
    """--set arguments; the tables of stages with their parameters"""
    parameters = {"shardlow": "{friction=4.5}", "lowe": "{rate=4.5}", "euler": "{gamma=4.5, sigma=3}",
                  "verlet": "{soft={strength=25}}", "body_force": "{acceleration=0.05}",
                  "modified_verlet": "{gamma=4.5, sigma=3, soft={strength=25}}"}
    own = {assignment.partition("=")[0] for assignment in assignments}
    tables = [f"{stage}={parameters[stage]}" for stage in stages.split() if stage in parameters and stage not in own]
    names = ", ".join(f'"{stage}"' for stage in stages.split())
    return [f"stages=[{names}]", f"time.duration={0.02 * steps:g}", *tables, *assignments]


GAS, FLUID, CHANNEL = "shardlow sample drift", "shardlow sample verlet", "modified_verlet body_force sample"
WALLS = ("walls.thickness=1", "box.length=[10, 12, 10]")
OBSERVABLES = "sample.observables=[%r]"
TEN = ("verlet={substeps=10, soft={strength=25}}", "time.step=0.1", "time.duration=10", "time.equilibration=0.1")
# (what, arguments of --set)
LADDER = [
    ("free flight", scene("drift", steps=20000)),
    ("free flight, sheared", scene("drift", "box.shear_rate=0.1", steps=20000)),
    ("S1", scene("shardlow drift")),
    ("S1, sheared", scene("shardlow drift", "box.shear_rate=0.1")),
    ("S1, random order", scene("shardlow drift", "pairs.order=random")),
    ("Lowe-Andersen", scene("lowe drift")),
    ("Euler", scene("euler kick drift")),
    ("S1, kinetic temperature", scene(GAS, OBSERVABLES % "kinetic_temperature")),
    ("S1, stress", scene(GAS, OBSERVABLES % "stress")),
    ("S1, profile", scene(GAS, "sample.profile={bins=40}")),
    ("S1, g(r) every 100 steps", scene(GAS, "sample.radial_distribution={}")),
    ("S1, mean-square displacement, 10 origins, every 5 steps",
     scene(GAS, "sample.mean_square_displacement={spacing=0.1, longest=5, origins=0.5}")),
    ("soft", scene("verlet")),
    ("soft, S1", scene("shardlow verlet")),
    ("soft, S1, ten substeps", scene("shardlow verlet", *TEN, steps=100)),
    ("soft, S1, stress", scene(FLUID, OBSERVABLES % "stress")),
    ("soft, S1, configurational temperature", scene(FLUID, OBSERVABLES % "configurational_temperature")),
    ("soft, modified velocity-Verlet", scene("modified_verlet")),
    ("the same, between walls, with a body force", scene(CHANNEL, *WALLS)),
    ("the same, with a profile", scene(CHANNEL, *WALLS, "sample.profile={bins=40}")),
    ("Lennard-Jones", scene("verlet", "verlet={lennard_jones={}}", "particles.density=0.8", "particles.start=lattice",
                            "time.step=0.005", "time.duration=5", "time.equilibration=0.005")),
]


def fluid(number, density, steps):
    side = round((number / density) ** (1 / 3), 6)
    return scene("shardlow verlet", f"box.length=[{side}, {side}, {side}]", f"particles.density={number / side ** 3:.12g}",
                 steps=steps)


# (what, particles, density); what it costs to start and to settle from random positions is left out: the difference of
# two runs counts, of which the short one is a unit of time
SETTLED = 50  # steps
SCALING = [(f"{number:,} particles", number, 3) for number in (3000, 30000, 300000, 3000000)] + \
          [(f"24,000 particles, density {density}", 24000, density) for density in (1, 3, 10)]


def command_of(program, assignments):
    return [program, "run", str(SCENE), "--json", *(word for a in assignments for word in ("--set", a))]


def count(program, assignments):
    """(what --json prints, instructions); nothing where the program does not know the scene"""
    valgrind = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"]
    done = subprocess.run(valgrind + command_of(program, assignments), capture_output=True, text=True)
    if done.returncode != 0:
        return None
    return json.loads(done.stdout), int(re.search(r"Collected : (\d+)", done.stderr)[1])


def run(program, assignments):
    """(what --json prints, CPU seconds); nothing where the program does not know the scene"""
    command = command_of(program, assignments)
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        output = process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        return None
    return json.loads(output), usage.ru_utime + usage.ru_stime


def middle_and_range(values, digits):
    return f"{statistics.median(values):.{digits}f} | {min(values):.{digits}f} to {max(values):.{digits}f}"


def row(name, runs):
    result = runs[0][0]
    counters = result["counters"]
    steps = counters["steps"]
    visits = round(1e9 * result["seconds"] / result["nanoseconds_per_particle_and_step"])  # particles x steps
    cost = middle_and_range([1e9 * seconds / visits for _, seconds in runs], 0)
    per_visit = [counters[key] / visits
                 for key in ("pairs_found", "pair_updates", "random_draws", "potential_evaluations")]
    numbers = " | ".join("0" if x == 0 else f"{x:.3g}" for x in (counters["searches"] / steps, *per_visit))
    return f"| {name} | {cost} | {numbers} | {result['bytes'] * steps / visits:.0f} |"


def ratio_row(name, runs, older):
    if not all(older):
        return f"| {name} | not known to the older build | | |"
    ratios = [new[1] / old[1] for new, old in zip(runs, older)]
    same = all(new[0][key] == old[0][key] for new, old in zip(runs, older) for key in ("counters", "bytes"))
    return f"| {name} | {middle_and_range(ratios, 3)} | {'same' if same else 'differ'} |"


def scaling_row(program, name, number, density, repetitions):
    steps = max(50, 6000000 // number)
    costs = []
    for _ in range(repetitions):
        (result, long), (start, short) = (run(program, fluid(number, density, SETTLED + more)) for more in (steps, 0))
        costs.append(1e9 * (long - short) / (steps * number))
    found = (result["counters"]["pairs_found"] - start["counters"]["pairs_found"]) / (steps * number)
    per_pair = statistics.median(costs) / found
    return f"| {name} | {middle_and_range(costs, 0)} | {found:.2f} | {per_pair:.1f} | {result['bytes'] / number:.0f} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", nargs="+", help="dpdref; or two builds of it, the older first")
    parser.add_argument("--repetitions", type=int, default=3)
    parser.add_argument("--only", default="", metavar="TEXT", help="scenes whose name contains it")
    parser.add_argument("--scaling", action="store_true")
    parser.add_argument("--instructions", action="store_true")
    arguments = parser.parse_args()
    if arguments.scaling:
        print("| scene | ns | range | pairs | ns per pair | bytes |\n|---|---|---|---|---|---|")
        for name, number, density in SCALING:
            if arguments.only in name:
                print(scaling_row(arguments.program[-1], name, number, density, arguments.repetitions), flush=True)
        return
    chosen = [(name, assignments) for name, assignments in LADDER if arguments.only in name]
    results = [{name: [] for name, _ in chosen} for _ in arguments.program]
    measure = count if arguments.instructions else run
    for _ in range(1 if arguments.instructions else arguments.repetitions):
        for name, assignments in chosen:
            for program, runs in zip(arguments.program, results):
                runs[name].append(measure(program, assignments))
    *older, last = results
    if refused := [name for name, runs in last.items() if None in runs]:
        sys.exit(f"refused: {'; '.join(refused)}")
    if older:
        what = "instructions" if arguments.instructions else "CPU time"
        print(f"| scene | {what}, ratio | range | counters and bytes |\n|---|---|---|---|")
        for name, runs in last.items():
            print(ratio_row(name, runs, older[0][name]))
        return
    print("| scene | ns | range | searches | pairs found | pairs updated | draws | potential | bytes |\n"
          "|---|---|---|---|---|---|---|---|---|")
    for name, runs in last.items():
        print(row(name, runs))


if __name__ == "__main__":
    main()
