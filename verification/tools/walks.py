#!/usr/bin/env python3
"""How much too small the error of a diffusion constant is where displacements are longer than a block (docs/measuring.md).

Random walks of normal steps, eight blocks of B steps each and 1500 of them: the scatter of D over the error that the blocks
give, for several longest lags L. D is the slope of the mean-square displacement from L/2 to L. Prints JSON. Python's standard
library only.
"""

import itertools
import json
import math
import random
import statistics

WALKS, BLOCKS, LAG = 1500, 8, 40
RATIOS = (0.25, 0.5, 1.0, 2.0, 4.0, 4.6)  # L/B; 4.6 is that of figures ng1a-inset, ng4, ng-schmidt


def slopes(block, source):
    """D of each block of one walk: a displacement belongs to the block of its origin"""
    at = [0.0, *itertools.accumulate(source.gauss(0.0, 1.0) for _ in range(BLOCKS * block + LAG))]
    of_origin = [((at[t + LAG] - at[t]) ** 2 - (at[t + LAG // 2] - at[t]) ** 2) / LAG for t in range(BLOCKS * block)]
    return [statistics.fmean(of_origin[b * block:(b + 1) * block]) for b in range(BLOCKS)]


def scatter_over_error(block, source):
    """of the mean of the blocks, over many walks"""
    walks = [slopes(block, source) for _ in range(WALKS)]
    error = math.sqrt(statistics.fmean(statistics.variance(walk) / BLOCKS for walk in walks))
    return statistics.stdev(statistics.fmean(walk) for walk in walks) / error


def main():
    source = random.Random(1)
    found = [scatter_over_error(round(LAG / ratio), source) for ratio in RATIOS]
    print(json.dumps({"longest_lag_over_block": RATIOS, "scatter_over_error": found, "relative_error": 1.0 / math.sqrt(2.0 * WALKS)}))


if __name__ == "__main__":
    main()
