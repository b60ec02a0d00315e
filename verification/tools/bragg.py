#!/usr/bin/env python3
"""Reciprocal lattice of a kept configuration: the strongest reflections of its structure factor, and the
angles between them. Usage: bragg.py figures/data/pk7.dat runs:5

S(q) = |sum exp(i q r)|^2/N for the wave vectors q of the periodic box up to --longest; N for a perfect crystal.
"""
import argparse
import cmath
import itertools
import math
import sys


def read_configuration(file, name):
    blocks = open(file).read().split("\n\n\n")
    for block in blocks:
        lines = block.strip().splitlines()
        if lines and lines[0] == f"# configuration:{name}":
            box = [float(side) for side in lines[1].split()[2:]]
            return box, [[float(x) for x in line.split()] for line in lines[2:]]
    sys.exit(f"{file}: has no configuration {name}")


def reflections(box, positions, longest):
    """(S, index, q) of half of all wave vectors, strongest first."""
    counts = [int(longest * side / (2 * math.pi)) for side in box]
    # exp(i 2 pi k x/side) for each axis, k and particle
    phases = [
        [[cmath.exp(2j * math.pi * k * p[axis] / side) for p in positions] for k in range(-counts[axis], counts[axis] + 1)]
        for axis, side in enumerate(box)
    ]
    found = []
    for h in range(0, counts[0] + 1):
        for k in range(-counts[1], counts[1] + 1):
            if h == 0 and k < 0:
                continue
            plane = [a * b for a, b in zip(phases[0][h + counts[0]], phases[1][k + counts[1]])]
            for l in range(-counts[2], counts[2] + 1):
                if h == 0 and k == 0 and l <= 0:
                    continue
                q = [2 * math.pi * n / side for n, side in zip((h, k, l), box)]
                if math.hypot(*q) > longest:
                    continue
                amplitude = sum(a * b for a, b in zip(plane, phases[2][l + counts[2]]))
                found.append((abs(amplitude) ** 2 / len(positions), (h, k, l), q))
    return sorted(found, reverse=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("data")
    parser.add_argument("configuration", help="CURVE:X")
    parser.add_argument("--longest", type=float, default=11.0, help="longest wave vector, 1/length (11)")
    options = parser.parse_args()
    box, positions = read_configuration(options.data, options.configuration)
    strongest = reflections(box, positions, options.longest)[:4]
    print(f"{len(positions)} particles, S(q) of a perfect crystal {len(positions)}")
    for s, index, q in strongest:
        print(f"S = {s:6.1f}  index {index!s:>14}  |q| = {math.hypot(*q):.3f}")
    for (i, a), (j, b) in itertools.combinations(enumerate(strongest, 1), 2):
        cosine = sum(x * y for x, y in zip(a[2], b[2])) / (math.hypot(*a[2]) * math.hypot(*b[2]))
        print(f"angle {i}-{j}: {math.degrees(math.acos(abs(cosine))):.1f} degrees")


if __name__ == "__main__":
    main()
