#!/usr/bin/env python3
"""What the error of a diffusion constant from displacements is worth (docs/measuring.md).

Random walks of normal steps, RUNS of them, each P steps long with displacements over up to LAG steps: the scatter of D over the
error that is stated, for several P/LAG; D is the slope of the mean-square displacement from LAG/2 to LAG, a displacement belongs to
the block of its origin. Once with the eighths of the run as blocks, once as src/run/transport.cpp does it: blocks joined until
each has as many origins as fit into LAG, and divided by the root of 1 - 5/32 LAG/block. Prints JSON. Python's standard library only.
"""

import itertools
import json
import math
import random
import statistics

RUNS, BLOCKS, LAG = 4000, 8, 40
LENGTHS = (4, 6, 8, 16, 32)  # P/LAG


def squares(steps, source):
    """the slope's part of each origin: D is their mean"""
    at = [0.0, *itertools.accumulate(source.gauss(0.0, 1.0) for _ in range(steps))]
    return [((at[t + LAG] - at[t]) ** 2 - (at[t + LAG // 2] - at[t]) ** 2) / LAG for t in range(steps - LAG)]


def eighths(values, steps):
    """blocks of a run; the last displacements leave the last of them without origins"""
    return [block for b in range(BLOCKS) if (block := values[b * steps // BLOCKS:(b + 1) * steps // BLOCKS])]


def joined(blocks):
    """neighbours joined until each has LAG origins; what is left over goes to the last"""
    result, left = [[]], sum(map(len, blocks))
    for block in blocks:
        result[-1] += block
        left -= len(block)
        if len(result[-1]) >= LAG and left >= LAG:
            result.append([])
    return result


def estimate(blocks):
    """mean, and the square of its error"""
    means = [statistics.fmean(block) for block in blocks]
    return statistics.fmean(means), statistics.variance(means) / len(means)


def scatter_over_error(estimates, factor=1.0):
    """over many runs; the root mean square of the errors counts"""
    values, errors = zip(*estimates)
    return statistics.stdev(values) / math.sqrt(factor * statistics.fmean(errors))


def main():
    source = random.Random(1)
    plain, stated, blocks = [], [], []
    for length in LENGTHS:
        runs = [eighths(squares(length * LAG, source), length * LAG) for _ in range(RUNS)]
        blocks.append(len(joined(runs[0])))
        shared = 5.0 / 32.0 * LAG * blocks[-1] / sum(map(len, runs[0]))
        plain.append(scatter_over_error([estimate(run) for run in runs]))
        stated.append(scatter_over_error([estimate(joined(run)) for run in runs], 1.0 / (1.0 - shared)))
    print(json.dumps({"runs": RUNS, "length_over_longest_lag": LENGTHS, "blocks": blocks, "scatter_over_error_of_eighths": plain,
                      "scatter_over_error": stated, "relative_error": math.sqrt(0.5 / RUNS)}))


if __name__ == "__main__":
    main()
