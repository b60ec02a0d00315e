#!/usr/bin/env python3
"""Writes the page of all figures: picture and caption from verification/ID/figure.toml and figures/ID.svg.

usage: gallery.py FILE.md. Python's standard library only.
"""

import collections
import csv
import pathlib
import statistics
import sys
import tomllib

ROOT = pathlib.Path(__file__).resolve().parent.parent


def plain(text):
    """gnuplot's text as Markdown"""
    return text.replace("*", "\\*")


MEANING = {
    "exact": "no tolerance but the error",
    "closed form": "within a tolerance stated beforehand",
    "bound": "a limit on one side, on the right side of which a value agrees however far",
    "consistency": "two simulations against each other",
    "description": "would notice nothing below 25 %, or set after looking: no agreement",
}


def verdicts():
    """figure -> kind -> rows of the report"""
    report = ROOT / "figures" / "report.csv"
    found = collections.defaultdict(lambda: collections.defaultdict(list))
    if report.is_file():
        with report.open(encoding="utf-8", newline="") as rows:
            for row in csv.DictReader(rows):
                found[row["figure"]][row["kind"]].append(row)
    return found


def meaning(kinds):
    """what a figure's verdicts say, kind by kind, as a Markdown table"""
    lines = ["| kind | what it says | verdicts | noticed from (median) |", "|---|---|---|---|"]
    for kind, says in MEANING.items():
        if not (rows := kinds.get(kind)):
            continue
        count = collections.Counter(row["verdict"] for row in rows)
        words = ", ".join(f"{n} {word}" for word, n in count.most_common())
        noticed = [float(row["noticeable_percent"]) for row in rows if row["noticeable_percent"] != "inf"]
        lines.append(f"| {kind} | {says} | {words} | "
                     f"{f'{statistics.median(noticed):.2g} %' if noticed else ''} |")
    return lines


def main():
    lines = [
        "# Gallery {#gallery}",
        "",
        "All figures that `dpdref figure` draws, at the papers' fidelity. How they are defined and judged: "
        "\\ref figures. What they show: \\ref findings.",
    ]
    found = verdicts()
    figures = [(file.parent.name, tomllib.loads(file.read_text(encoding="utf-8")))
               for file in (ROOT / "verification").glob("*/figure.toml")]
    # a paper's figures in their order, then what its text states
    figures.sort(key=lambda f: (f[1]["paper"], not f[1]["figure"][:1].isdigit(), f[1]["figure"]))
    for name, figure in figures:
        where = f" Fig. {figure['figure']}" if figure["figure"][:1].isdigit() else ""
        lines += ["", f"## {figure['paper']}{where}: {plain(figure['title'])} {{#figure-{name}}}", ""]
        if (ROOT / "figures" / f"{name}.svg").is_file():
            lines += [f"\\image html {name}.svg", ""]
            if name in found:
                lines += ["What its verdicts mean (`dpdref report`, \\ref figures \"verdicts\"):", "", *meaning(found[name]), ""]
        else:
            lines += ["Not yet drawn at the paper's fidelity.", ""]
        lines += [plain(figure["caption"]), "", f"Draw it: `dpdref figure {name}`"]
        if (ROOT / "figures" / f"{name}.convergence.svg").is_file():
            lines += ["", "Error against run time:", "", f"\\image html {name}.convergence.svg"]
    pathlib.Path(sys.argv[1]).write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
