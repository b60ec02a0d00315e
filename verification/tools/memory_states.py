#!/usr/bin/env python3
"""What the theory with memory costs, and how well it converges: figures/memory/states.md, which theory/memory.md shows.

usage: memory_states.py DPDREF [--jobs N]     every state that the table has, anew; a new one is a new row with its first five columns

Errors are the stated ones over the coefficient, times the processor time of one command, which computes all three. Five
minutes of one core. Python's standard library only.
"""

import argparse
import concurrent.futures
import json
import os
import pathlib
import subprocess

TABLE = pathlib.Path(__file__).resolve().parents[2] / "figures" / "memory" / "states.md"
COEFFICIENTS = ("D", "kinetic", "collision")


def evaluated(program, state):
    """Row of the table"""
    d, density, friction, step, weight = state
    words = [f"d={d}", f"n={density}", f"dt={step}"]
    words += [f"Gamma={friction}"] if weight == "lowe" else [f"gamma={friction}", f"weight={weight}"]
    words += ["box=20"] if d == "2" else []  # in two dimensions transport diverges with the box
    errors, seconds = [], []
    for coefficient in COEFFICIENTS:
        identity = f"memory-{coefficient}" + ("-lowe" if weight == "lowe" else "")
        with subprocess.Popen([program, "theory", identity, *words, "--json"], stdout=subprocess.PIPE) as process:
            found = json.load(process.stdout)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            raise SystemExit(f"{identity} {' '.join(words)} failed")
        errors.append(abs(found["numerical_error"] / found["value"]))
        seconds.append(usage.ru_utime + usage.ru_stime)
    return "| " + " | ".join([*state, f"{min(seconds):.2f}", *(f"{error:.1e}" for error in errors)]) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args()
    head, lines, *rows = TABLE.read_text(encoding="utf-8").splitlines()
    states = [[cell.strip() for cell in row.split("|")[1:6]] for row in rows]
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        made = list(pool.map(lambda state: evaluated(options.program.resolve(), state), states))
    TABLE.write_text("\n".join([head, lines, *made]) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
