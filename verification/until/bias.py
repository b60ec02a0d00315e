#!/usr/bin/env python3
"""How much stopping when the error looks small moves a result, and the error itself (docs/measuring.md).

usage: bias.py PROGRAM [--runs N]     PROGRAM is dpdref

Runs fluid.toml until the error of one quantity is reached, with many seeds, and with as many other seeds at one fixed duration, which
no error decides. Prints JSON, for each quantity: the difference of the two means over the error that was wanted, its standard error,
the scatter of the stopped values over the error wanted, and how many runs ended after how many times the least duration. The aim
is a bias below a fifth of the error. Python's standard library only.
"""

import argparse
import collections
import concurrent.futures
import json
import math
import os
import pathlib
import statistics
import subprocess

SCENE = pathlib.Path(__file__).parent / "fluid.toml"
FIXED = 16  # duration of the fixed runs over the least one
# quantity, relative error wanted, settings of the scene
CASES = (("viscosity", 0.03, ()),
         ("green_kubo_diffusion_constant", 0.03, ("box.shear_rate=0",)),
         ("kinetic_temperature", 0.005, ("box.shear_rate=0",)))


def printed(program, seed, settings, more):
    """What a run prints, JSON"""
    command = [program, "run", SCENE, "--json", "--seed", str(seed), *more]
    for setting in settings:
        command += ["--set", setting]
    return json.loads(subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=True).stdout)


def measured(program, runs, quantity, wanted, settings):
    def stopped(seed):
        return printed(program, seed, settings, ("--until", f"{quantity}={wanted}"))

    def fixed(seed):
        return printed(program, seed, (*settings, f"time.duration={10 * FIXED}"), ())

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        ends = list(pool.map(stopped, range(1, runs + 1)))
        others = [run["quantities"][quantity]["value"] for run in pool.map(fixed, range(runs + 1, 2 * runs + 1))]
    values = [run["quantities"][quantity]["value"] for run in ends]
    truth = statistics.fmean(others)
    error = wanted * abs(truth)
    lengths = collections.Counter(round(run["until"]["duration"] / 10) for run in ends)
    return {"quantity": quantity, "wanted": wanted, "fixed": truth, "stopped": statistics.fmean(values),
            "bias_over_error": (statistics.fmean(values) - truth) / error,
            "error_of_bias": math.sqrt((statistics.variance(values) + statistics.variance(others)) / runs) / error,
            "scatter_over_error": statistics.stdev(values) / error,
            "not_reached": sum(not run["until"]["errors"][quantity]["reached"] for run in ends),
            "ended_after": {str(length): lengths[length] for length in sorted(lengths)}}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--runs", type=int, default=300)
    options = parser.parse_args()
    print(json.dumps({"runs": options.runs, "cases": [measured(options.program, options.runs, *case) for case in CASES]}))


if __name__ == "__main__":
    main()
