#!/usr/bin/env python3
"""Recomputes the exact answers from the papers' formulas, without dpdref: the example for authors of other codes.

usage: check_exact.py [FILE]      FILE: figures/answers/exact.json, or what `dpdref exact --json` prints

One line per case with the largest deviation, relative to the largest component of the same quantity. Exit code 1 if one
is above 1e-13. docs/exact.md explains the file and the formulas. Python's standard library only.
"""

import itertools
import json
import math
import pathlib
import sys

LIMIT = 1e-13
WEIGHT = {"constant": lambda x, s: 1.0, "linear": lambda x, s: 1 - x, "quadratic": lambda x, s: (1 - x) ** 2,
          "parabolic": lambda x, s: 1 - x * x, "root": lambda x, s: math.sqrt(1 - x), "power": lambda x, s: (1 - x) ** s}
SCHEME = {"shardlow": lambda a: a / (1 + a), "exponential": lambda a: -math.expm1(-2 * a) / 2, "linear": lambda a: a}


def weight(name, x, exponent=None):
    return WEIGHT[name](x, exponent) if x < 1 else 0.0


def noise_strength(A, mass):  # NG2007, below eq. 5
    return math.sqrt(A * (1 - A) / mass)


def soft(r, strength, cutoff):  # energy and force
    return strength / 2 * (1 - r / cutoff) ** 2, strength / cutoff * (1 - r / cutoff)


def lennard_jones(r, epsilon, sigma, cutoff, shifted):
    x = (sigma / r) ** 6
    zero = lennard_jones(cutoff, epsilon, sigma, cutoff, False)[0] if shifted else 0.0
    return 4 * epsilon * (x * x - x) - zero, 24 * epsilon / r * (2 * x * x - x)


def potential_force(r, table):
    ((name, parameters),) = ((name, table[name]) for name in ("soft", "lennard_jones") if name in table)
    return {"soft": soft, "lennard_jones": lennard_jones}[name](r, **parameters)[1] if r < parameters["cutoff"] else 0.0


class System:
    """Positions, velocities and images of a case, and the stages that change them."""

    def __init__(self, case):
        self.case, self.d, self.m, self.dt = case, case["dimension"], case["mass"], case["time_step"]
        self.L, self.shear = case["box"]["length"], case["box"]["shear_rate"]
        self.r, self.v, self.image = ([list(row) for row in case["initial"][key]] for key in ("position", "velocity", "image"))
        self.time, self.noise, self.seen = case["initial"]["time"], case["initial"]["noise"], []
        self.waiting = self.force = None

    def relative(self, i, j):
        """Distance, unit vector and approach of i and the nearest image of j: r, e, v.e. In shear the image that is
        n boxes up lies at n*shear*Ly*t more along x and moves faster by n*shear*Ly."""
        r, v = [a - b for a, b in zip(self.r[i], self.r[j])], [a - b for a, b in zip(self.v[i], self.v[j])]
        n = round(r[1] / self.L[1])
        r[0] -= n * self.shear * self.L[1] * self.time
        v[0] -= n * self.shear * self.L[1]
        r = [x - side * round(x / side) for x, side in zip(r, self.L)]
        length = math.sqrt(sum(x * x for x in r))
        e = [x / length for x in r]
        return length, e, sum(a * b for a, b in zip(v, e))

    def draws(self, stage):
        """The stage's noise: i, j, r/cutoff and what is drawn, in the order of the file. Its pairs must be those within
        the cutoff."""
        cutoff, draws = self.case[stage]["cutoff"], [draw for draw in self.noise if draw["stage"] == stage]
        near = {pair for pair in self.pairs() if self.relative(*pair)[0] < cutoff}
        if {tuple(sorted(draw["pair"])) for draw in draws} != near or len(draws) % max(1, len(near)):
            raise ValueError(f"{self.case['id']}: the file's pairs of {stage} are not those within the cutoff")
        for draw in draws:
            distance = self.relative(*draw["pair"])[0]
            self.seen.append((distance, draw["distance"]))
            yield *draw["pair"], distance / cutoff, draw

    def pairs(self):
        return itertools.combinations(range(len(self.r)), 2)

    def kick(self, rows, factor):
        self.v = [[v + factor * f for v, f in zip(*both)] for both in zip(self.v, rows)]

    def push(self, rows, i, j, amount, e):
        for axis in range(self.d):
            rows[i][axis] += amount * e[axis]
            rows[j][axis] -= amount * e[axis]

    def nothing(self):
        return [[0.0] * self.d for _ in self.r]

    def move(self, span):
        """r += v span, and back into the box; what leaves a sheared box comes back as its image."""
        self.time += span
        for r, v, image in zip(self.r, self.v, self.image):
            r[:] = [x + u * span for x, u in zip(r, v)]
            up = math.floor(r[1] / self.L[1])
            r[0] -= up * self.shear * self.L[1] * self.time
            v[0] -= up * self.shear * self.L[1]
            for axis, side in enumerate(self.L):
                boxes = math.floor(r[axis] / side)
                r[axis] -= boxes * side
                image[axis] += boxes

    def conservative(self, table):
        total = self.nothing()
        for i, j in self.pairs():
            r, e, _ = self.relative(i, j)
            self.push(total, i, j, potential_force(r, table), e)
        return total

    # --- the stages

    def pair_update(self, i, j, A, kT, xi):  # NG2007 eq. 4, with <xi^2> = 1
        _, e, u = self.relative(i, j)
        self.push(self.v, i, j, -A * u + noise_strength(A, self.m) * math.sqrt(2 * kT) * xi, e)

    def shardlow(self, p):  # NG2007 eq. 5
        for i, j, x, draw in self.draws("shardlow"):
            a = p["friction"] * weight(p["weight"], x, p.get("exponent")) * self.dt / self.m
            self.pair_update(i, j, SCHEME[p["scheme"]](a), p["kT"], draw.get("normal", 0.0))

    def lowe(self, p):  # NG2007 eq. 6
        for i, j, _, draw in self.draws("lowe"):
            if draw.get("uniform", 0.0) < p["rate"] * self.dt - draw["sweep"]:
                self.pair_update(i, j, 0.5, p["kT"], draw.get("normal", 0.0))

    def euler(self, p):  # MY1997 eq. 2
        self.waiting = self.nothing()
        for i, j, x, draw in self.draws("euler"):
            _, e, u = self.relative(i, j)
            w_d = weight(p["weight"], x, p.get("exponent"))
            w_r = weight(p["random_weight"], x) if "random_weight" in p else math.sqrt(w_d)
            impulse = -p["gamma"] * w_d * u * self.dt + p["sigma"] * w_r * math.sqrt(self.dt) * draw.get("normal", 0.0)
            self.push(self.waiting, i, j, impulse, e)

    def force_impulses(self, p):
        self.waiting = [[w + f * self.dt for w, f in zip(*both)] for both in zip(self.waiting, self.conservative(p))]

    def verlet(self, p):
        span = self.dt / p["substeps"]
        for _ in range(p["substeps"]):
            self.kick(self.conservative(p), span / 2 / self.m)
            self.move(span)
            self.kick(self.conservative(p), span / 2 / self.m)

    def all_forces(self, p):
        """Conservative, dissipative and random force (PK2006, sect. III) from the present positions and velocities."""
        total = self.conservative(p)
        for i, j, x, draw in self.draws("modified_verlet"):
            _, e, u = self.relative(i, j)
            w_d = weight(p["weight"], x, p.get("exponent"))
            thermal = p["sigma"] * math.sqrt(w_d / self.dt) * draw.get("normal", 0.0)
            self.push(total, i, j, -p["gamma"] * w_d * u + thermal, e)
        return total

    def modified_verlet(self, p):  # Groot & Warren 1997
        kick = self.dt / 2 / self.m
        self.kick(self.force, kick)
        self.move(self.dt)
        after_half = [list(row) for row in self.v]
        self.kick(self.force, (2 * p["lambda"] - 1) * kick)  # the prediction v + lambda dt F/m
        self.force, self.v = self.all_forces(p), after_half
        self.kick(self.force, kick)
        if p["friction_again"]:  # DPD-VV
            self.force = self.all_forces(p)

    def rescale(self, p):  # NG2007, "Other Thermostats"; Hecht et al. 2005
        (draw,) = (draw for draw in self.noise if draw["stage"] == "rescale")
        sides = [round(side / p["cell"]) for side in self.L]
        cells = {}
        for k, r in enumerate(self.r):
            place = [math.floor((x + s) / p["cell"]) % n for x, s, n in zip(r, draw["shift"], sides)]
            cells.setdefault(tuple(place), []).append(k)
        groups = {}  # of cells that share a factor
        for place in cells:
            group = {"global": 0, "layers": place[1] // p["thickness"], "monte_carlo": place}[p["mode"]]
            groups.setdefault(group, []).append(place)
        for places in groups.values():
            mean = {c: [sum(self.v[k][axis] for k in cells[c]) / len(cells[c]) for axis in range(self.d)] for c in places}
            square = sum((self.v[k][axis] - mean[c][axis]) ** 2 for c in places for k in cells[c] for axis in range(self.d))
            free = self.d * sum(len(cells[c]) - 1 for c in places)
            factor = 1.0
            if free and p["mode"] == "monte_carlo":
                (c,) = places
                index = (c[1] * sides[0] + c[0]) * (sides[2] if self.d == 3 else 1) + (c[2] if self.d == 3 else 0)
                size, direction, acceptance = draw["lots"][index]
                tried = 1 + p["amplitude"] * size
                tried = tried if direction < 0.5 else 1 / tried
                accept = tried**free * math.exp(-self.m * square * (tried**2 - 1) / 2 / p["kT"])
                factor = tried if 1 - acceptance < accept else 1.0
            elif free:
                factor = math.sqrt(free * p["kT"] / self.m / square)
            for c in places:
                for k in cells[c]:
                    self.v[k] = [mean[c][axis] + factor * (self.v[k][axis] - mean[c][axis]) for axis in range(self.d)]

    def body_force(self, p):
        for r, v in zip(self.r, self.v):
            v[0] += p["acceleration"] * self.dt * (-1 if p["opposed"] and r[1] >= self.L[1] / 2 else 1)

    def advance(self, noise):
        if "modified_verlet" in self.case["stages"] and self.force is None:  # its first forces have a noise of their own
            self.force = self.all_forces(self.case["modified_verlet"])
        self.noise = noise
        plain = {"drift": lambda: self.move(self.dt), "half_drift": lambda: self.move(self.dt / 2),
                 "kick": lambda: self.kick(self.waiting, 1 / self.m),
                 "half_kick": lambda: self.kick(self.conservative(self.case["half_kick"]), self.dt / 2 / self.m),
                 "force": lambda: self.force_impulses(self.case["force"])}
        for stage in self.case["stages"]:
            plain[stage]() if stage in plain else getattr(self, stage)(self.case[stage])


def flat(value):
    return [x for row in value for x in flat(row)] if isinstance(value, list) else [value]


def deviation(found, expected):
    found, expected = flat(found), flat(expected)
    scale = max(map(abs, expected), default=0.0) or 1.0
    return max((abs(a - b) / scale for a, b in zip(found, expected, strict=True)), default=0.0)


def check_case(case):
    system, worst = System(case), 0.0
    for step in case["steps"]:
        system.advance(step["noise"])
        worst = max(worst, deviation(system.r, step["position"]), deviation(system.v, step["velocity"]))
        if system.image != step["image"]:
            raise ValueError(f"{case['id']}: a particle is in another box")
    return max([worst, *(deviation(*seen) for seen in system.seen)])


def check_functions(functions):
    exponent = functions["power"]["exponent"]
    pairs = [(weight(name, row["x"], exponent), row[name]) for row in functions["weight"] for name in WEIGHT]
    for row in functions["update"]:
        for name, scheme in SCHEME.items():
            A = scheme(row["a"])
            pairs += [(A, row[name]["A"]), (noise_strength(A, row["mass"]), row[name]["B"])]
    for row in functions["potential"]:
        for name, (energy, force) in {
                "soft": soft(row["r"], **functions["soft"]),
                "lennard_jones": lennard_jones(row["r"], **functions["lennard_jones"], shifted=False),
                "lennard_jones_shifted": lennard_jones(row["r"], **functions["lennard_jones"], shifted=True)}.items():
            pairs += [(energy, row[name]["energy"]), (force, row[name]["force"])]
    return max(deviation(*pair) for pair in pairs)


def main(file):
    answers = json.loads(file.read_text())
    deviations = {"functions": check_functions(answers["functions"])}
    for case in answers["cases"]:
        try:
            deviations[case["id"]] = check_case(case)
        except ValueError as error:
            print(error)
            deviations[case["id"]] = math.inf
    for name, value in deviations.items():
        print(f"{name:<44} {value:.1e}{'' if value <= LIMIT else '  ABOVE THE LIMIT'}")
    return 0 if all(value <= LIMIT for value in deviations.values()) else 1


if __name__ == "__main__":
    default = pathlib.Path(__file__).resolve().parents[2] / "figures" / "answers" / "exact.json"
    sys.exit(main(pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else default))
