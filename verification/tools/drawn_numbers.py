#!/usr/bin/env python3
"""No number in the book comes from nowhere.

In every page of the book and every caption of its pictures every number with a decimal point, a per cent sign, an error, a power of ten behind it, or a unit of time or memory must be drawn by a
mark of measured.py (@measured, @ratio, @data, @report, @recorded, @table, @json, @computed, @closed, @given), or be of one of the kinds in EXEMPT. README.md, which
is read as it stands, has the mark in a comment right behind the number, and the number must be what the mark gives.

usage: drawn_numbers.py                       one line per number that comes from nowhere
       drawn_numbers.py --dpdref PROGRAM      the closed forms are evaluated, too: @closed{ID ARGUMENTS;VALUE}
       drawn_numbers.py --set-after           where a criterion was set after looking: every place so marked

Exit code 1 with one line per mistake. Python's standard library only.
"""

import argparse
import math
import re
import subprocess
import sys

sys.dont_write_bytecode = True  # no __pycache__ beside the sources
import equations
import measured
from equations import ROOT, read

# In a derivation the numbers of a formula are its constants. What was measured stands beside it and is drawn.
FORMULAS = (r"\\f\$.*?\\f\$|\\f\[.*?\\f\]", "formulas of a derivation")

NUMBER = r"[-+]?\d+(?:[ ,]\d{3})*(?:\.\d+)?"
LIST = rf"{NUMBER}(?:(?:\s*,\s*|\s*,?\s+(?:and|to|or|against|instead of|than|x|with|in)\s+){NUMBER})*"
NAMES = (r"n\*?|a|c|d|m|g|A|D|L|N|T|r|q|u|x|kT|dt|Gamma\*?'?|gamma\*?|sigma|lambda|N_m|Nm|Sc|rc|alpha|b|k|t\*?|eta|"
         r"\\gamma(?:\^\*)?|\\Delta t(?:\^\*)?|\\lambda|\\sigma(?:_R)?|n\^\*|N_m|k_BT|a/k_BT|\\Gamma'?|w|q")
WORDS = (r"steps?|substeps?|frictions?|densit(?:y|ies)|rates?|shear rates?|lags?|box(?:es)?|cutoffs?|sides?|range|weight|durations?|repulsions?|strengths?|"
         r"noise|temperatures?|forces?|accelerations?|amplitude|windows?|thickness|seeds?|runs?|blocks?|times?|factors?|units?|inner step|outer step|"
         r"length|width|volume|distance|size|skin|coefficient|multipl\w+|index|level|version|GW|density of|friction x step")
EXEMPT = (  # (pattern, why)
    (r"```.*?```|^    .*?$|`[^`]*`", "code"),
    (r"\\(?:skip|until|dontinclude|snippet|include\S*|image)\b.*?$", "code that a page shows"),
    (r"\\ref\s+\S+(?:\s+\"[^\"]*\")?|@eq\{[^}]*\}|@figure\{[^}]*\}|\]\([^)]*\)|\{#[^}]*\}", "links"),
    (r"^#.*?$", "headings"),
    (r"<!--.*?-->", "comments"),
    (r"^(?:again|change|folder) = .*?$", "commands beside a caption"),
    (r"^\|(?:[^|@\n]*\|)+(?=[^|\n]*@(?:measured|ratio|data|report|recorded|table|json|computed)\{)", "cells left of the first number that is drawn: where it was measured"),
    (r"\b(?:eqs?|Eqs?|Figs?|fig|sects?|Sects?|Table|Phys|Lett|Chem|Comput|ref|refs|issue|request|point|points|exercise|Version|version|g\+\+|Highway|LAMMPS)\.?\s+"
     r"[\dIVX]+[a-z]?(?:(?:\s*,\s*|\s+(?:and|to)\s+|-)\d+[a-z]?)*", "numbers of equations, figures, versions"),
    (r"(?:Europhys\. Lett\.|Phys\. Rev\. E|J\. Chem\. Phys\.|J\. Comput\. Phys\.|SIAM J\. Sci\. Comput\.) \d+, \w?\d+", "literature"),
    (rf"(?<![\w\\])(?:{NAMES})\s*(?:=|\\le|\\ge|<|>|\\approx)\s*{LIST}", "parameters by name"),
    (rf"\b(?:{WORDS})(?:\s+(?:of|is|at|from|to|between|up to|above|below|over|x))*\s+{LIST}", "parameters of a set-up, by the word before"),
    (rf"{NUMBER}\s*(?:x|\^)\s*\d+(?:\s*x\s*\d+)*", "boxes"),
    (r"\\frac\d\d|\\frac\{?\d+\}?\{?\d+\}?|\d+/\d+", "fractions"),
)
MARKED = measured.MARK
SUSPECT = re.compile(
    r"(?<![\w.#^_{])[-+]?(?:\d+\.\d+|\d+(?=\s*%|\s*per cent|\s*(?:\+-|±)|\s*(?:ns|ms|GB|MB|kB)\b|\s+(?:s|min|h)\b|\\cdot10|\s*times\b))")
AFTER = "set after looking"


def blanked(text, derivation=False):
    """The text without what is marked or exempt, lines and columns kept"""
    def blank(match):
        return re.sub(r"[^\n]", " ", match[0])

    for pattern, _ in (*EXEMPT, FORMULAS) if derivation else EXEMPT:
        text = re.sub(pattern, lambda match: match[0] if MARKED.search(match[0]) else blank(match), text,
                      flags=re.MULTILINE | (re.DOTALL if "```" in pattern or pattern == FORMULAS[0] else 0))
    return MARKED.sub(blank, text)


def texts():
    return [*equations.pages(), ROOT / "docs/captions.toml"]


def from_nowhere():
    for file in texts():
        for number, line in enumerate(blanked(read(file), derivation=file.parent.name == "theory").splitlines(), 1):
            for match in SUSPECT.finditer(line):
                yield f"{file.relative_to(ROOT)}:{number}: {match[0]} comes from nowhere: mark it (verification/tools/measured.py)"


def undrawable():
    """marks whose number is not there"""
    for file in texts():
        for mark in measured.MARK.finditer(read(file)):
            try:
                measured.drawn(mark[0])
            except ValueError as error:
                yield f"{file.relative_to(ROOT)}: {error}"


def readme():
    """README.md: 49 %<!-- @measured{...} -->, and none without"""
    text = read(ROOT / "README.md")
    for match in re.finditer(r"(\S+(?: ± \S+)?)( ?%| ?\w+)?<!-- (@\w+\{[^{}]*\}) -->", text):
        drawn = measured.drawn(match[3])
        if match[1].strip("(") != drawn:
            yield f"README.md: {match[1]} stands before {match[3]}, which gives {drawn}"


def closed_forms(program):
    """what the pages say that a closed form is, and what the program says"""
    cache = {}
    for file in equations.pages():
        for call, value in re.findall(r"@closed\{([^{};]*);([^{}]*)\}", read(file)):
            if call not in cache:
                answer = subprocess.run([program, "theory", *call.split()], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                        check=False)
                cache[call] = answer.stdout.strip().splitlines()[-1] if answer.returncode == 0 else None
            if cache[call] is None:
                yield f"{file.relative_to(ROOT)}: dpdref theory {call} fails"
                continue
            digits = len(value.partition(".")[2])
            if abs(float(cache[call]) - float(value)) > 0.5000001 * 10.0 ** -digits and not (
                    digits == 0 and math.isclose(float(cache[call]), float(value), rel_tol=5e-3)):
                yield f"{file.relative_to(ROOT)}: @closed{{{call};{value}}}: the program says {cache[call]}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--dpdref", metavar="PROGRAM")
    parser.add_argument("--set-after", action="store_true")
    options = parser.parse_args()
    if options.set_after:
        for file in [*equations.pages(), *sorted((ROOT / "verification").glob("*/figure.toml"))]:
            for number, line in enumerate(read(file).splitlines(), 1):
                if AFTER in line:
                    print(f"{file.relative_to(ROOT)}:{number}: {line.strip()}")
        return 0
    mistakes = [*from_nowhere(), *undrawable(), *readme(), *(closed_forms(options.dpdref) if options.dpdref else [])]
    for mistake in mistakes:
        print(f"numbers: {mistake}", file=sys.stderr)
    marks = sum(len(MARKED.findall(read(file))) for file in [*texts(), ROOT / "README.md"])
    print(f"{marks} numbers are drawn, {len(mistakes)} come from nowhere or are wrong")
    return 1 if mistakes else 0


if __name__ == "__main__":
    sys.exit(main())
