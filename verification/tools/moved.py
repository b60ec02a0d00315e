#!/usr/bin/env python3
"""What a rerun of the figures moved: values in figures/data now against those of an older commit, as a Markdown table.

usage: moved.py COMMIT [--revision 2] [--without FIGURE/QUANTITY]... [FIGURE...]     all figures where none is named; `answers` is the reference answers

A value has moved if it is off by more than three of the errors of both. Figures whose data are of another engine
revision than --revision are named and left out, and so are rows that one of the two does not have. --without leaves out a quantity of a
figure whose definition has changed so that it must move (a faster flow heats more). With no effect
and right errors one value in 370 moves. Python's standard library only.
"""

import argparse
import json
import math
import pathlib
import subprocess

FIGURES = pathlib.Path(__file__).resolve().parents[2] / "figures"
DATA = FIGURES / "data"
ANSWERS = FIGURES / "answers" / "answers.json"


def values(text):
    """Engine revision, and by curve, x and quantity: value, error; the state points of the answers are curves"""
    figure = json.loads(text)
    if "states" in figure:
        rows = {(state["id"], None, name): (found["value"], found["error"])
                for state in figure["states"] for name, found in state["quantities"].items()}
        return figure["engine_revision"], rows
    rows = {(row["curve"], row["x"], row["quantity"]): (row["value"], row["error"]) for row in figure["comparisons"]}
    return figure["engine_revision"], rows


def older(commit, file):
    shown = subprocess.run(["git", "show", f"{commit}:./{file.name}"], cwd=file.parent, capture_output=True, text=True)
    return values(shown.stdout) if shown.returncode == 0 else (None, {})


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("commit")
    parser.add_argument("--revision", type=int, default=2)
    parser.add_argument("--without", action="append", default=[], metavar="FIGURE/QUANTITY")
    parser.add_argument("figures", nargs="*", metavar="FIGURE")
    arguments = parser.parse_args()
    files = [ANSWERS if name == "answers" else DATA / f"{name}.json" for name in arguments.figures] or sorted(DATA.glob("*.json"))
    compared, moved, others = 0, [], []
    for file in files:
        revision, now = values(file.read_text())
        before, then = older(arguments.commit, file)
        if revision != arguments.revision:
            others.append(file.stem)
            continue
        if not then or before == revision:
            continue
        for (curve, x, quantity), (value, error) in now.items():
            was, its_error = then.get((curve, x, quantity), (math.nan, 0.0))
            both = math.hypot(error, its_error)
            if not both > 0.0 or math.isnan(was) or f"{file.stem}/{quantity}" in arguments.without:
                continue
            compared += 1
            if abs(value - was) > 3.0 * both:
                moved.append(f"| {file.stem} | {curve} | {'' if x is None else f'{x:g}'} | {quantity} | {was:.5g} | {its_error:.2g} | {value:.5g} | {error:.2g} | "
                             f"{(value - was) / both:+.1f} |")
    print(f"<!-- as printed by: python3 verification/tools/moved.py {' '.join([arguments.commit, *(f'--without {name}' for name in arguments.without), *arguments.figures])} -->")
    print(f"{len(moved)} of {compared} values moved." + (f" Not run again yet: {', '.join(others)}." if others else "") + "\n")
    print("| figure | curve | x | quantity | was | error | is | error | z |\n|---|---|---|---|---|---|---|---|---|")
    print("\n".join(moved))


if __name__ == "__main__":
    main()
