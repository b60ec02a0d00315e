#!/usr/bin/env python3
"""Which orders of the pairs keep the exact state (docs/orders.md).

usage: orders.py PROGRAM [--check] [--soft] [--old OLD] [--jobs N]    PROGRAM is dpdref
    without an option     pairs of an ideal gas for every order and thermostat, and pressure and pairs of a soft fluid for two orders:
                          figures/orders/{pairs.md,soft.md}, six minutes of one core
    --soft                the soft fluid alone
    --old OLD             the same gas against friction, by PROGRAM and by OLD, a program of engine revision 1, whose order knew
                          velocities: figures/orders/{forgetful.dat,orders.svg}
    --check               four of the gases, without the slow order of ids; exit code 1 if one differs from the ideal number

The number of pairs within the cutoff over that of a uniform gas must be 1. A run passes if it is within 0.1 % of it. The errors are about
0.03 %, so that a true deviation of 0.2 % is seen with a probability of 99.9 %, and a right order is called wrong once in a thousand.
Python's standard library and gnuplot.
"""

import argparse
import concurrent.futures
import json
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
FIGURES = ROOT / "figures" / "orders"
ALLOWED, RESOLVED = 0.001, 0.0004
S1 = ["stages=['shardlow','sample','drift']"]
# linear needs a friction times step of at most 1
THERMOSTATS = {"S1, friction 90": [*S1, "shardlow.friction=90"],
               "exponential, friction 90": [*S1, "shardlow.scheme=exponential", "shardlow.friction=90"],
               "linear, friction 9": [*S1, "shardlow.scheme=linear", "shardlow.friction=9"],
               "Lowe, rate 10": ["stages=['lowe','sample','drift']", "lowe.rate=10"]}
ORDERS = ("cell", "id", "random")
CHECKED = [("S1, friction 90", "cell"), ("S1, friction 90", "random"), ("exponential, friction 90", "cell"), ("Lowe, rate 10", "cell")]
HEAD = "<!-- as written by verification/orders/orders.py -->"
FRICTIONS = (3, 9, 30, 90, 200)


def measured(program, scene, keys):
    command = [program, "run", HERE / f"{scene}.toml", "--json"] + [word for key in keys for word in ("--set", key)]
    return json.loads(subprocess.run(command, stdout=subprocess.PIPE, check=True).stdout)["quantities"]


def gas(program, thermostat, order):
    # the order of ids is eight times as dear, and gets a quarter of the time
    keys = [*THERMOSTATS[thermostat], f"pairs.order='{order}'"] + (["time.duration=1500"] if order == "id" else [])
    pairs = measured(program, "gas", keys)["pair_density"]
    right = abs(pairs["value"] - 1.0) <= ALLOWED and pairs["error"] <= RESOLVED
    return (thermostat, order, pairs["value"], pairs["error"], right)


def with_error(value, error, digits=4):
    return f"{value:.{digits}f} ± {error:.{digits}f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--soft", action="store_true")
    parser.add_argument("--old", type=pathlib.Path)
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args()
    program = options.program.resolve()
    pool = concurrent.futures.ThreadPoolExecutor(options.jobs)
    FIGURES.mkdir(exist_ok=True)
    if options.old:
        runs = list(pool.map(lambda case: measured(case[0], "gas", [*S1, f"shardlow.friction={case[1]}"])["pair_density"],
                             [(which, friction) for which in (options.old.resolve(), program) for friction in FRICTIONS]))
        lines = ["# columns: friction, pairs over those of a uniform gas, their error"]
        for name, part in (("revision 1", runs[:len(FRICTIONS)]), ("revision 2", runs[len(FRICTIONS):])):
            lines += [f"# {name}", *(f"{f} {one['value']:.6f} {one['error']:.6f}" for f, one in zip(FRICTIONS, part)), "", ""]
        (FIGURES / "forgetful.dat").write_text("\n".join(lines[:-2]) + "\n", encoding="utf-8")
        subprocess.run(["gnuplot", HERE / "plot.gp"], cwd=ROOT, check=True)
        return 0
    if not options.soft:
        cases = CHECKED if options.check else [(thermostat, order) for thermostat in THERMOSTATS for order in ORDERS]
        rows = list(pool.map(lambda case: gas(program, *case), cases))
        for thermostat, order, value, error, right in rows:
            print(f"{thermostat:<26} {order:<7} {with_error(value, error)}  {'' if right else 'differs from 1 or is not known well enough'}")
        if options.check:
            return 0 if all(row[-1] for row in rows) else 1
        table = [HEAD, "| thermostat | " + " | ".join(f"`{order}`" for order in ORDERS) + " |", "|---|---|---|---|"]
        for thermostat in THERMOSTATS:
            table.append(f"| {thermostat} | " + " | ".join(with_error(*row[2:4]) for row in rows if row[0] == thermostat) + " |")
        (FIGURES / "pairs.md").write_text("\n".join(table) + "\n", encoding="utf-8")
    names = {"kinetic_temperature": "kT", "pressure": "pressure", "pair_density": "pairs within 1.5"}
    fluids = dict(zip(("cell", "random"), pool.map(lambda order: measured(program, "soft", [f"pairs.order='{order}'"]), ("cell", "random"))))
    table = [HEAD, "| quantity | `cell` | `random` | difference in standard errors |", "|---|---|---|---|"]
    for quantity, name in names.items():
        a, b = (fluids[order][quantity] for order in ("cell", "random"))
        sigma = (a["error"] ** 2 + b["error"] ** 2) ** 0.5
        table.append(f"| {name} | {with_error(a['value'], a['error'], 5)} | {with_error(b['value'], b['error'], 5)} | {(a['value'] - b['value']) / sigma:+.1f} |")
    (FIGURES / "soft.md").write_text("\n".join(table) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
