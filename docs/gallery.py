#!/usr/bin/env python3
"""Writes the page of all figures: picture and caption from verification/ID/figure.toml and figures/ID.svg.

usage: gallery.py FILE.md. Python's standard library only.
"""

import collections
import csv
import pathlib
import sys
import tomllib

ROOT = pathlib.Path(__file__).resolve().parent.parent


def plain(text):
    """gnuplot's text as Markdown"""
    return text.replace("*", "\\*")


def verdicts():
    """figure -> how many comparisons agree, disagree, are undecided"""
    report = ROOT / "figures" / "report.csv"
    counts = collections.defaultdict(collections.Counter)
    if report.is_file():
        with report.open(encoding="utf-8", newline="") as rows:
            for row in csv.DictReader(rows):
                counts[row["figure"]][row["verdict"]] += 1
    return counts


def main():
    lines = [
        "# Gallery {#gallery}",
        "",
        "All figures that `dpdref figure` draws, at the papers' fidelity. How they are defined and judged: "
        "\\ref figures. What they show: \\ref findings.",
    ]
    counts = verdicts()
    figures = [(file.parent.name, tomllib.loads(file.read_text(encoding="utf-8")))
               for file in (ROOT / "verification").glob("*/figure.toml")]
    # a paper's figures in their order, then what its text states
    figures.sort(key=lambda f: (f[1]["paper"], not f[1]["figure"][:1].isdigit(), f[1]["figure"]))
    for name, figure in figures:
        where = f" Fig. {figure['figure']}" if figure["figure"][:1].isdigit() else ""
        lines += ["", f"## {figure['paper']}{where}: {plain(figure['title'])} {{#figure-{name}}}", ""]
        if (ROOT / "figures" / f"{name}.svg").is_file():
            lines += [f"\\image html {name}.svg", ""]
            if counts[name]:
                count = ", ".join(f"{word} {n} times" for word, n in counts[name].most_common())
                lines += [f"Verdicts of `dpdref report`: {count}.", ""]
        else:
            lines += ["Not yet drawn at the paper's fidelity.", ""]
        lines += [plain(figure["caption"]), "", f"Draw it: `dpdref figure {name}`"]
        if (ROOT / "figures" / f"{name}.convergence.svg").is_file():
            lines += ["", "Error against run time:", "", f"\\image html {name}.convergence.svg"]
    pathlib.Path(sys.argv[1]).write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
