"""Numbers of the book that are computed from committed data by more than a product: one function each, for @computed{NAME ARGUMENT...} of
measured.py. Python's standard library only.
"""

import csv
import functools
import math
import statistics

from measured import ROOT, json_file, parts, record, span, table, with_error

# --- 23 unseen cells of figures/work-precision/map-memory against their predictions (docs/tune.md)


@functools.cache
def _unseen():
    """[(curve, friction, deviation)]"""
    comparisons = json_file(ROOT / "figures/work-precision/data/map-memory.json")["comparisons"]
    return [(c["curve"], c["x"], c["quantity"], c["value"] / c["theory_value"] - 1.0) for c in comparisons if c["theory"].startswith("memory")]


def _cell(curve, key):
    return float(next((word.partition("=")[2] for word in curve.split() if word.startswith(key + "=")), "nan"))


def _sizes(chosen):
    return [100.0 * abs(deviation) for curve, x, quantity, deviation in _unseen() if chosen(curve, x, quantity)]


def _strong(curve, x, _):
    return "lowe" not in curve and x * _cell(curve, "dt") > 3.0


def _domain(curve, x, quantity):
    return _cell(curve, "n") >= 1.0 and not _strong(curve, x, quantity)


def _usual(curve, x, quantity):
    return _domain(curve, x, quantity) and _cell(curve, "d") == 3 and ("linear" in curve or "quadratic" in curve)


def unseen_cells():
    return str(len({(curve, x) for curve, x, _, _ in _unseen()}))


def unseen_numbers():
    return str(len(_sizes(_domain)))


def unseen_median():
    return span([statistics.median(_sizes(_domain))], ".1f")


def unseen_largest():
    return span([max(_sizes(_domain))], ".1f")


def unseen_usual():
    return span([max(_sizes(_usual))], ".1f")


def unseen_D():
    return span([max(_sizes(lambda *at: _domain(*at) and at[2] == "diffusion_constant"))], ".1f")


def unseen_dilute():
    return span([max(_sizes(lambda *at: _cell(at[0], "n") < 1.0 and at[2] == "collision_viscosity"))], ".1f")


def unseen_dilute_D():
    return span([max(_sizes(lambda *at: _cell(at[0], "n") < 1.0 and at[2] == "diffusion_constant"))], ".1f")


def unseen_strong():
    return span([max(_sizes(_strong))], ".1f")


# --- diffusion in three boxes, corrected to an infinite one (docs/openmm.md)


def _row(file, part, x):
    return next([float(word) for word in row] for row in parts(file)[part] if float(row[0]) == x)


@functools.cache
def _infinite(friction):
    """D, error, chi^2 of the weighted mean of three boxes. Each D has T 2.837297/(6 pi (eta + n m D) L) added: Yeh and Hummer for a gas."""
    file, density = "work-precision/data/openmm", 3.0
    viscosity = _row(file, "all:shear:viscosity", friction)[1]
    boxes = {"exponential": (1000.0 / density) ** (1.0 / 3.0), "L=10": 10.0, "L=14.42": 14.42}
    corrected = []
    for curve, side in boxes.items():
        _, D, error = _row(file, f"all:{curve}:diffusion_constant", friction)[:3]
        corrected.append((D + 2.837297 / (6.0 * math.pi * (viscosity + density * D) * side), error))
    weight = sum(error ** -2 for _, error in corrected)
    mean = sum(D * error ** -2 for D, error in corrected) / weight
    chi2 = sum(((D - mean) / error) ** 2 for D, error in corrected)
    return mean, weight ** -0.5 * max(1.0, math.sqrt(chi2 / 2.0)), chi2


def infinite(friction):
    return with_error(*_infinite(float(friction))[:2])


def infinite_chi2():
    *first, last = (f"{_infinite(friction)[2]:.1f}" for friction in (3.375, 6.75, 13.5, 27.0))
    return ", ".join(first) + " and " + last


# --- figures pk-anchor, pk3 (docs/findings.md)


def anchor_temperature():
    """where a straight line through the viscosities of figure pk-anchor, weighted by their errors, has the printed value"""
    points = [[float(word) for word in row[:3]] for row in parts("data/pk-anchor")["all:shear:viscosity"]]
    weights = [error ** -2 for _, _, error in points]
    total = sum(weights)
    x0 = sum(w * x for w, (x, _, _) in zip(weights, points)) / total
    y0 = sum(w * y for w, (_, y, _) in zip(weights, points)) / total
    spread = sum(w * (x - x0) ** 2 for w, (x, _, _) in zip(weights, points))
    slope = sum(w * (x - x0) * (y - y0) for w, (x, y, _) in zip(weights, points)) / spread
    distance = (1.97 - y0) / slope
    return with_error(x0 + distance, math.sqrt(1.0 / total + distance ** 2 / spread) / abs(slope))


def _peaks(atoms):
    """distances of the largest values of g(r) inside the cutoff, where it is above one"""
    g = [(float(row[0]), float(row[1])) for row in parts("data/pk3")[f"all:Nm={atoms}:radial_distribution"]]
    return [x for (_, below), (x, value), (_, above) in zip(g, g[1:], g[2:]) if below < value > above and value > 1.0 and x < 1.0]


def peak(atoms, index):
    """the first, or the second"""
    return f"{_peaks(int(atoms))[int(index) - 1]:.2f}"


# --- limits of step zero: ten times the friction against the standard fluid (docs/work_precision.md)


def distance_of_limits(quantity):
    """of two limits, in standard errors of their difference"""
    part = "limit of step zero: observable, value, error, chi^2, degrees of freedom"
    (value, error), (other, other_error) = (
        next((float(row[1]), float(row[2])) for row in parts(f"work-precision/data/{fluid}")[part] if row[0] == quantity)
        for fluid in ("standard", "stiff-friction"))
    return f"{abs(value - other) / math.hypot(error, other_error):.1f}"


# --- bisections done again (docs/stability.md)

GRID = 1.02746  # of the steps: ratio of neighbours


def _edges(file):
    """(integrator, friction, repulsion, density, edge) -> the largest good step of each edge that was found"""
    points = json_file(ROOT / f"figures/stability/data/{file}.json")["points"]
    return {(*(p[key] for key in ("integrator", "friction", "repulsion", "density")), edge): p[edge]["below"]
            for p in points for edge in ("usable", "bounded") if p[edge]["below"] and p[edge]["above"]}


@functools.cache
def _shifts(file):
    """in per cent, of the edges that both have"""
    before, again = _edges("friction"), _edges(file)
    return [100.0 * math.log(again[at] / before[at]) for at in again if at in before]


def _rms(file):
    return math.sqrt(statistics.fmean(shift ** 2 for shift in _shifts(file)))


def edges():
    return str(len(_shifts("longer")))


def edges_moved(file, steps):
    """how many moved by so many steps of the grid"""
    return str(sum(round(abs(shift) / (100.0 * math.log(GRID))) == int(steps) for shift in _shifts(file)))


def edges_rms(file):
    return f"{_rms(file):.1f}"


def edges_mean(file):
    return f"{statistics.fmean(_shifts(file)):.1f}"


def edges_are_good_to():
    """the grid and the larger of the two shifts, in squares"""
    return f"{math.hypot(100.0 * math.log(GRID), max(_rms('longer'), _rms('seed'))):.0f}"


# --- the largest usable step against the repulsion, from a = 25 on (the picture's caption)


def _usable():
    """integrator -> [(step, the step at which a density wave blows up)]"""
    return {part.removesuffix(":4.5"): [(float(row[3]), float(row[10])) for row in rows if float(row[1]) >= 25.0]
            for part, rows in parts("stability/data/repulsion").items() if part.endswith(":4.5")}


def of_the_density_wave():
    """with one force per step, and the new momentum"""
    return span([step / wave for integrator, steps in _usable().items() if integrator not in ("Euler, old", "S1-MTS")
                 for step, wave in steps], ".2f")


def gain_of_substeps():
    usable = _usable()
    return span([ten / one for (ten, _), (one, _) in zip(usable["S1-MTS"], usable["S1"])], ".1f")


# --- LAMMPS (docs/lammps.md)


def friction_in_the_pressure():
    """what g(r) explains of the pressure that LAMMPS has besides, in per cent, over the states of pair dpd"""
    states = ("Groot-Warren, step 0.04", "Groot-Warren, step 0.02", "linear weight", "gamma 45", "mass 2", "two dimensions")
    cells = [[float(table(f"lammps/own_columns;{state}|lammps_pressure;{column}")) for column in ("expected from g(r)", "difference")]
             for state in states]
    return span([100.0 * expected / difference for expected, difference in cells], ".0f")


def stress_on_lammps():
    """viscosity times rate, state `in shear`"""
    return f"{0.2 * float(table('lammps/averages;in shear|viscosity;LAMMPS')):.3f}"


# --- reference answers (docs/answers.md)


def heated(state=None):
    """by how many per cent kT in shear is above kT at rest: of a state point, or the largest"""
    with (ROOT / "figures/answers/answers.csv").open(encoding="utf-8", newline="") as file:
        values = {(row["state"], row["quantity"]): float(row["value"]) for row in csv.DictReader(file)}
    found = {at: 100.0 * (value / values[at, "kinetic_temperature"] - 1.0) for (at, quantity), value in values.items()
             if quantity == "sheared_kinetic_temperature"}
    return f"{found[state] if state else max(found.values()):.1f}"


# --- collision viscosity with a potential at density 1 against the theory with memory (theory/memory.md)


@functools.cache
def _soft(a, friction):
    """the point of ng3a or ng3b, and the theory there as recorded under the same a and friction"""
    figure, x = ("ng3a", friction) if a == "25" and friction != "4.5" else ("ng3b", a)
    comparisons = json_file(ROOT / f"figures/data/{figure}.json")["comparisons"]
    point = next(c for c in comparisons if c["quantity"] == "collision_viscosity" and c["curve"].startswith("n=1") and c["x"] == float(x))
    weak = {"4.5": "", "0.5": "-weak"}.get(friction, f"-{friction}")
    return point, record(f"soft-{a}{weak}")


def soft_over_eq12(a, friction):
    """theory over eq. 12 with the measured g at the step of the figure, less one, per cent"""
    point, theory = _soft(a, friction)
    return f"{100.0 * (theory['value'] / point['theory_value'] - 1.0):+.0f}"


def soft_deviation(a, friction):
    """simulation over theory, less one, per cent"""
    point, theory = _soft(a, friction)
    return with_error(100.0 * (point["value"] / theory["value"] - 1.0), 100.0 * point["error"] / theory["value"], "+")


def soft_part(a, friction, part):
    """a part of the theory over its eq. 12 for a step of zero, per cent"""
    _, theory = _soft(a, friction)
    return f"{100.0 * theory[part] / theory['at_once']:+.0f}"


# --- dpdref_benchmark (docs/performance.md)


def benchmark(name, counter, shape, *unit):
    """the fastest of the repetitions; a time or a rate by the name of its counter"""
    runs = [run for run in record("benchmark")["benchmarks"] if run["run_type"] == "iteration" and run["run_name"] == name]
    if not runs:
        raise ValueError(f"no benchmark {name}")
    fastest = min(runs, key=lambda run: run["cpu_time"])
    return span([fastest[counter] * float(*unit or (1.0,))], shape)


def _per_particle(name, counter):
    """as a number, ns"""
    return float(benchmark(name, counter, ".6g", 1e9))


def transfer_of_the_list():
    """48 bytes per pair, written once and read twice, ns per particle"""
    pairs, rate = float(benchmark("skin_pick/fluid", "pairs", ".6f")), float(benchmark("memory", "bytes_per_second", ".0f"))
    return f"{1e9 * 3.0 * 48.0 * pairs / rate:.0f}"


def unavoidable_per_particle():
    return f"{_per_particle('unavoidable', 'per_pair') * float(benchmark('skin_pick/fluid', 'pairs', '.6f')):.0f}"


def fifteenth_of_lammps():
    """ns per particle and step with fix shardlow, over 15"""
    return f"{float(table('performance/race;shardlow;LAMMPS, ns')) / 15.0:.0f}"


# --- what the figures of the papers cost (docs/performance.md)


def further_seeds_hours():
    """Processor time of what the figures of PK2006 have beside one run per point, by what their data record: that share of each point's
    runs, which together are more than the figure's, since it counts shared runs once"""
    total = 0.0
    for file in sorted((ROOT / "figures/data").glob("pk*.json")):
        figure = json_file(file)
        points = {c["seconds"]: c["runs"] for c in figure["comparisons"]}
        total += figure["seconds"] * (1.0 - sum(s / runs for s, runs in points.items()) / sum(points))
    return f"{total / 3600.0:.1f}"
