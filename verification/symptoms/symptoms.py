#!/usr/bin/env python3
"""The mistakes of mistakes.toml, each made once in the plain engine: what becomes of the standard fluid (docs/symptoms.md).

usage: symptoms.py --build BUILD [--only ID...] [--check] [--jobs N]

Compiles all mistakes into one program, build target `mistaken`, each behind a number, runs fluid.toml at rest and in
shear for each, and writes figures/symptoms/symptoms.csv and .md. Runs are deterministic: --check runs those named by
--only (default: two) and compares with the values that are there. Ten minutes of one core. Python's standard library only.
"""
import argparse
import concurrent.futures
import math
import os
import pathlib
import subprocess
import sys
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
VALUES = ROOT / "figures" / "symptoms" / "symptoms.csv"
TABLE = VALUES.with_suffix(".md")
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


def rounded(value, error):
    """as text, with two digits of the error; what states none (the momentum's largest value) with two of its own"""
    if not error > 0.0:
        return f"{value:.2g}", ""
    digits = max(0, 1 - math.floor(math.log10(error)))
    return f"{value:.{digits}f}", f"{error:.{digits}f}"


def ratio(value, error, right, of_right):
    """value over right, with the error's digits in brackets"""
    factor = value / right
    error = abs(factor) * math.hypot(error / value, of_right / right)
    power = math.floor(math.log10(abs(factor))) if abs(factor) < 0.01 or error > 100.0 else 0
    factor, error = factor / 10.0 ** power, error / 10.0 ** power
    digits = max(0, -math.floor(math.log10(error)))
    return f"{factor:.{digits}f}({error * 10 ** digits:.0f})" + (f"e{power}" if power else "")


def table(values, mistakes):
    """values: {(id, quantity): (value, error) as text}, or nothing of a run that diverged; rows for the book"""
    rows = ["| mistake | " + " | ".join(COLUMNS.values()) + " |", "|---" * (len(COLUMNS) + 1) + "|"]
    for mistake in mistakes:
        cells = []
        for name in COLUMNS:
            value, error = values.get((mistake["id"], name), ("diverges", ""))
            if name == "largest_momentum" and value != "diverges":
                value = "0" if float(value) < 1e-9 else value
            elif error:
                right = values["none", name]
                if mistake["id"] == "none":
                    value = f"{value} ± {error}"
                else:
                    value = "same" if (value, error) == right else ratio(*map(float, (value, error, *right)))
            cells.append(value)
        rows.append("| " + " | ".join([mistake["title"], *cells]) + " |")
    return rows


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
    values = {}
    for k, (_, mistake) in enumerate(wanted):
        rest, shear = runs[2 * k], runs[2 * k + 1]
        found = {**(rest or {}), **({"sheared": shear["kinetic_temperature"], "viscosity": shear["viscosity"]} if shear else {})}
        values |= {(mistake["id"], name): rounded(*found[name]) for name in COLUMNS if name in found}
    lines = [",".join([*key, *value]) for key, value in values.items()]
    if options.check:
        missing = sorted(set(lines) - set(VALUES.read_text().splitlines()))
        print("\n".join(f"symptoms: not in {VALUES.name}: {line}" for line in missing) or f"symptoms: {len(lines)} values are those of {VALUES.name}")
        return 1 if missing else 0
    if options.only:
        print("\n".join(lines))
        return 0
    VALUES.parent.mkdir(exist_ok=True)
    VALUES.write_text("\n".join(["mistake,quantity,value,error", *lines]) + "\n", encoding="utf-8")
    TABLE.write_text("\n".join(["<!-- as written by verification/symptoms/symptoms.py -->", *table(values, mistakes)]) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
