#!/usr/bin/env python3
"""Stated errors against the scatter of independent runs, for every estimator of the program (docs/calibration.md).

usage: calibrate.py PROGRAM [--first SEED] [--seeds N] [--jobs N]      PROGRAM is dpdref; writes
figures/calibration/{stated_errors.md,stated_errors.dat,calibration.svg}, or with --first stated_errors-SEED.{md,dat} without a picture

Each scene of this folder is run with N seeds (100), five minutes of one core in all. For each quantity that states an error: the standard
deviation of its values over the root mean square of the errors that the runs state. It is 1 where errors are right, and is itself known
within a few per cent. A row beyond two standard errors is looked at with new seeds (--first 101): if it is beyond two there too, on the
same side, the error is wrong, else it was chance. Python's standard library and gnuplot.
"""

import argparse
import concurrent.futures
import json
import math
import pathlib
import statistics
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
FIGURES = ROOT / "figures" / "calibration"
SCENES = ("gas", "gas-shear", "soft", "soft-shear", "opposed", "rescaled")
# What the mean has to be, where that is exact: S1 keeps kT and the uniform density at any step, there is no stress at rest, and
# Lees-Edwards boundaries look the same at every height.
EXACT = {("gas", "kinetic_temperature"): 1.0, ("gas", "pair_density"): 1.0, ("gas", "kinetic_stress"): 0.0, ("gas", "collision_stress"): 0.0,
         ("soft", "kinetic_stress"): 0.0, ("soft", "collision_stress"): 0.0, ("soft", "potential_stress"): 0.0,
         ("gas-shear", "profile_slope"): 1.0, ("soft-shear", "profile_slope"): 1.0}


def measured(program, scene, seed):
    answer = subprocess.run([program, "run", HERE / f"{scene}.toml", "--json", "--seed", str(seed)], stdout=subprocess.PIPE, check=True)
    return json.loads(answer.stdout)["quantities"]


def row(scene, name, runs):
    """of the table: scene, quantity, blocks, ratio, its error, mean, its error by the scatter, exact value or None"""
    values = [run["value"] for run in runs]
    squares = [run["error"] ** 2 for run in runs]
    stated, seeds = statistics.fmean(squares), len(runs)
    ratio = statistics.stdev(values) / math.sqrt(stated)
    # of a standard deviation of normal values, and of the stated errors, which scatter from run to run
    relative = math.sqrt(0.5 / (seeds - 1) + 0.25 * statistics.variance(squares) / (seeds * stated ** 2))
    return (scene, name, statistics.median(run["blocks"] for run in runs), ratio, ratio * relative, statistics.fmean(values),
            statistics.stdev(values) / math.sqrt(seeds), EXACT.get((scene, name)))


def verdict(ratio, error):
    """at two standard errors, which a right error exceeds in one case of twenty"""
    if abs(ratio - 1.0) <= 2.0 * error:
        return "right"
    return "too small" if ratio > 1.0 else "too large"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args()
    program, rows = options.program.resolve(), []
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for scene in SCENES:
            runs = list(pool.map(lambda seed: measured(program, scene, seed), range(options.first, options.first + options.seeds)))
            for name in runs[0]:
                of_name = [run[name] for run in runs]
                if all(one["blocks"] > 1 and one["error"] for one in of_name):
                    rows.append(row(scene, name, of_name))
    FIGURES.mkdir(exist_ok=True)
    table = [f"<!-- as written by verification/calibration/calibrate.py, {options.seeds} seeds from {options.first} -->",
             "| scene | quantity | blocks | scatter over error | errors are | mean | exact (deviation in standard errors) |", "|---|---|---|---|---|---|---|"]
    for scene, name, blocks, ratio, error, mean, of_mean, exact in rows:
        digits = max(0, 1 - math.floor(math.log10(of_mean)))
        deviation = f"{exact:g} ({(mean - exact) / of_mean:+.1f})" if exact is not None else ""
        table.append(f"| {scene} | {name} | {blocks:g} | {ratio:.2f} ± {error:.2f} | {verdict(ratio, error)} |"
                     f" {mean:.{digits}f} ± {of_mean:.{digits}f} | {deviation} |")
    file = "stated_errors" if options.first == 1 else f"stated_errors-{options.first}"
    (FIGURES / f"{file}.md").write_text("\n".join(table) + "\n", encoding="utf-8")
    chi2 = sum(((ratio - 1.0) / error) ** 2 for _, _, _, ratio, error, *_ in rows)
    lines = ["# columns of the summary: seeds, quantities, sum of the squares of (ratio-1)/error, quantities beyond two standard errors", "# summary",
             f"{options.seeds} {len(rows)} {chi2:.1f} {sum(verdict(r[3], r[4]) != 'right' for r in rows)}"]
    for scene in SCENES:
        lines += ["", "", f"# {scene}"]
        lines += [f'{k} {one[3]:.3f} {one[4]:.3f} "{one[1].replace("_", " ")}"' for k, one in enumerate(rows) if one[0] == scene]
    (FIGURES / f"{file}.dat").write_text("\n".join(lines) + "\n", encoding="utf-8")
    if options.first == 1:
        subprocess.run(["gnuplot", HERE / "plot.gp"], cwd=ROOT, check=True)


if __name__ == "__main__":
    main()
