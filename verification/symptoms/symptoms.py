#!/usr/bin/env python3
"""The mistakes of mistakes.toml, each made once in the plain engine: what becomes of the standard fluid (docs/symptoms.md).

usage: symptoms.py --build BUILD [--only ID...] [--check] [--jobs N]

Compiles all mistakes into one program, build target `mistaken`, each behind a number, runs fluid.toml at rest and in
shear for each, and writes figures/symptoms/symptoms.md. Runs are deterministic: --check runs those named by --only
(default: two) and compares with the table that is there. Ten minutes of one core. Python's standard library only.
"""
import argparse
import concurrent.futures
import math
import os
import pathlib
import re
import subprocess
import sys
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
TABLE = ROOT / "figures" / "symptoms" / "symptoms.md"
SHEAR = ["box.shear_rate=0.3"]
CHECKED = ("uniform-3", "no-noise")
COLUMNS = {"kinetic_temperature": "kT", "pressure": "pressure", "potential_energy": "energy", "diffusion_constant": "D",
           "largest_momentum": "momentum", "sheared": "kT in shear", "viscosity": "viscosity"}
SWITCH = """
#include <cstdlib>
namespace dpd::plain {
inline int const mistake_made = [] {
    char const* const which = std::getenv("DPDREF_MISTAKE");
    return which ? std::atoi(which) : -1;
}();
inline bool mistake(int which) { return which == mistake_made; }
}
"""


def with_mistakes(text, mistakes):
    """plain.hpp with all mistakes, each behind its number"""
    places = {}
    for number, mistake in enumerate(mistakes):
        for change in mistake.get("change", []):
            found = change["where"] + change["right"]
            if text.count(found) != 1:
                sys.exit(f"symptoms: {mistake['id']}: `{found}` stands {text.count(found)} times in plain.hpp; expected: once")
            begin = text.index(found) + len(change["where"])
            places.setdefault((begin, change["right"]), []).append((number, change["wrong"]))
    for (begin, right), wrong in sorted(places.items(), reverse=True):
        chosen = "".join(f"mistake({number}) ? {expression} : " for number, expression in wrong)
        text = f"{text[:begin]}({chosen}{right}){text[begin + len(right):]}"
    return text.replace("#pragma once", "#pragma once" + SWITCH, 1)


def measured(program, number, overrides):
    """{quantity: (value, error)} of one run, or what it said when it diverged"""
    run = subprocess.run([program, HERE / "fluid.toml", *overrides], env={**os.environ, "DPDREF_MISTAKE": str(number)},
                         capture_output=True, text=True, check=False)
    if run.returncode == 3:
        return None
    if run.returncode:
        sys.exit(f"symptoms: {run.stderr}")
    return {name: (float(value), float(error)) for name, value, error, _ in map(str.split, run.stdout.splitlines())}


def cell(found, name, right):
    """value(error in the last digit), and the factor to the right run where it is clear of its error"""
    if found is None:
        return "diverges"
    if name not in found:
        return ""
    value, error = found[name]
    if not error > 0.0:  # of the largest momentum
        return f"{value:.2g}"
    digits = max(0, 1 - math.floor(math.log10(error)))
    text = f"{value:.{digits}f} ± {error:.{digits}f}"
    if right and name in right:
        true, of_true = right[name]
        if abs(value - true) > 4.0 * math.hypot(error, of_true):
            text += f" (× {value / true:.3g})"
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--only", nargs="*")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args()
    mistakes = tomllib.loads((HERE / "mistakes.toml").read_text())["mistake"]
    target = options.build / "mistaken"
    target.mkdir(parents=True, exist_ok=True)
    text = with_mistakes((ROOT / "src" / "plain" / "plain.hpp").read_text(), mistakes)
    if not (target / "plain.hpp").exists() or (target / "plain.hpp").read_text() != text:
        (target / "plain.hpp").write_text(text)
    subprocess.run(["cmake", "--build", options.build, "--target", "mistaken"], check=True, stdout=subprocess.DEVNULL)
    program = options.build.resolve() / "verification" / "mistaken"
    chosen = options.only or (CHECKED if options.check else [mistake["id"] for mistake in mistakes])
    wanted = [(number, one) for number, one in enumerate(mistakes) if one["id"] in chosen]
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        runs = list(pool.map(lambda job: measured(program, *job),
                             [(number, one.get("set", []) + extra) for number, one in wanted
                              for extra in ([], SHEAR + (["time.duration=800.0"] if one.get("sharp") else []))]))
    names = list(COLUMNS)
    rows, right = [], None
    for k, (number, one) in enumerate(wanted):
        rest, shear = runs[2 * k], runs[2 * k + 1]
        found = None if rest is None else dict(rest)
        if shear is not None:
            found = {**(found or {}), "sheared": shear["kinetic_temperature"], "viscosity": shear["viscosity"]}
        right = found if number == 0 else right
        cells = [cell(None if (shear is None if name in ("sheared", "viscosity") else rest is None) else found, name, right if number else None)
                 for name in names]
        rows.append("| " + " | ".join([one["title"], *cells]) + " |")
    head = ["| mistake | " + " | ".join(COLUMNS[name] for name in names) + " |", "|---" * (len(names) + 1) + "|"]
    if options.check:
        there = re.sub(r" \(× [^)]*\)", "", TABLE.read_text()).splitlines()  # the right run is not among these
        missing = [row for row in rows if row not in there]
        print("\n".join(f"symptoms: not in {TABLE.name}: {row}" for row in missing) or f"symptoms: {len(rows)} rows are those of the table")
        return 1 if missing else 0
    if options.only:
        print("\n".join(head + rows))
        return 0
    TABLE.parent.mkdir(exist_ok=True)
    TABLE.write_text("\n".join(["<!-- as written by verification/symptoms/symptoms.py -->", *head, *rows]) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
