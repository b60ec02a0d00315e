#!/usr/bin/env python3
"""Writes the page of all figures, and for each a page with its definition, from verification/ID/figure.toml and figures/ID.svg.

usage: gallery.py DIR      writes DIR/gallery.md and DIR/definition-ID.md. Python's standard library only.
"""

import collections
import csv
import pathlib
import statistics
import sys
import tomllib

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.append(str(ROOT / "verification" / "tools"))
import page


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
        words = ", ".join(f"{n} {word if n == 1 or not word.endswith('agrees') else word.removesuffix('s')}" for word, n in count.most_common())
        noticed = [float(row["noticeable_percent"]) for row in rows if row["noticeable_percent"] != "inf"]
        lines.append(f"| {kind} | {says} | {words} | "
                     f"{f'{statistics.median(noticed):.2g} %' if noticed else ''} |")
    return lines


def again(name):
    """The command that draws a figure with another parameter"""
    return f"dpdref figure {name} --set '{page.captions()[name]['change']}'"


def definition(name, figure):
    """The page that holds figure.toml, and says how to change it"""
    folder = ROOT / "verification" / name
    lines = [f"# Definition of {page.named(name)} {{#definition-{name}}}", "",
             f"*What does `dpdref figure {name}` simulate, and with what does it compare?* The first of the two files below says so, "
             f"the second how it is drawn; they stand in verification/{name}. "
             f"The picture: \\ref figure-{name} \"{figure['title']}\". What the keys mean: \\ref figures.", "",
             "**Another parameter.** `--set` changes a key of the scenes in every curve that has its table; the picture goes to figures/changed. "
             "Only runs that are new are made. For example:", "",
             f"    {again(name)}", ""]
    for file, language in (("figure.toml", "toml"), ("plot.gp", "gnuplot")):
        lines += [f"## {file}", "", f"```{language}", (folder / file).read_text(encoding="utf-8").rstrip(), "```", ""]
    return "\n".join(lines)


def main():
    lines = [
        "# Gallery {#gallery}",
        "",
        "*What do all the figures look like, and how far may each be believed?* These are the figures that `dpdref figure` draws, at the "
        "papers' fidelity. Under each stands what is seen, and what its verdicts mean: how many comparisons of which kind it holds, how they "
        "came out, and from what deviation on one would have been noticed. *Agrees* is as strong as that last number. A point far from a line can "
        "agree: where the line is a bound the verdict says that the point is on the right side of it.",
        "",
        "| kind | what it says |", "|---|---|",
        *(f"| {kind} | {says} |" for kind, says in MEANING.items()),
        "",
        "How figures are defined and judged: \\ref figures. What they show: \\ref findings.",
    ]
    found = verdicts()
    figures = [(file.parent.name, tomllib.loads(file.read_text(encoding="utf-8")))
               for file in (ROOT / "verification").glob("*/figure.toml")]
    # a paper's figures in their order, then what its text states
    figures.sort(key=lambda f: (f[1]["paper"], not f[1]["figure"][:1].isdigit(), f[1]["figure"]))
    folder = pathlib.Path(sys.argv[1])
    for name, figure in figures:
        where = f" Fig. {figure['figure']}" if figure["figure"][:1].isdigit() else ""
        lines += ["", f"## {figure['paper']}{where}: {plain(figure['title'])} {{#figure-{name}}}", ""]
        if (ROOT / "figures" / f"{name}.svg").is_file():
            lines += [f"@figure{{{name}}}", ""]
            if name in found:
                lines += ["What its verdicts mean (`dpdref report`):", "", *meaning(found[name]), ""]
        else:
            lines += ["Not yet drawn at the paper's fidelity.", ""]
        lines += [f"Set-up: {plain(figure['caption'])}", "",
                  f"Draw it: `dpdref figure {name}`. With another parameter: `{again(name)}`. All of it: "
                  f"\\subpage definition-{name} \"the definition\"."]
        if (ROOT / "figures" / f"{name}.convergence.svg").is_file():
            lines += ["", "Error against run time:", "", f"\\image html {name}.convergence.svg"]
        (folder / f"definition-{name}.md").write_text(definition(name, figure), encoding="utf-8")
    (folder / "gallery.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
