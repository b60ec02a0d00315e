"""Measured numbers in the pages of the book, drawn from the committed data of the figures.

In a page stands @measured{FIGURE;CURVE;QUANTITY;X;FORMAT}, and the book shows what figures/data/FIGURE.dat has there.
FORMAT: `value` (0.399 +- 0.004), or `THEORY` (+50.0 +- 1.6), the deviation in per cent from what the part of the
file CURVE:QUANTITY:THEORY compares with. A number that is not there is a ValueError, which fails the tests and the book.
Python's standard library only.
"""

import functools
import math
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]
MARK = re.compile(r"@measured\{([^{}]*)\}")


@functools.cache
def parts(figure):
    """name of a part of the data file -> x -> the row's numbers, as text"""
    file = ROOT / "figures" / "data" / f"{figure}.dat"
    if not file.is_file():
        raise ValueError(f"@measured: there is no figure {figure}")
    found, part = {}, None
    for line in file.read_text(encoding="utf-8").splitlines():
        if line.startswith("# "):
            part = found.setdefault(line[2:], {})
        elif line and part is not None:
            row = line.split()
            part[float(row[0])] = row
    return found


def with_error(value, error, sign=""):
    """Value and error: of the error one digit, or two where the first is 1."""
    if not (math.isfinite(error) and error > 0.0):
        return f"{value:{sign}g}"
    digits = -math.floor(math.log10(error))
    if f"{error:e}"[0] == "1":
        digits = 1 - math.floor(math.log10(error))
    shown = round(value, digits)
    places = max(0, digits)
    text = f"{shown:{sign}.{places}f}" if shown else f"{0:.{places}f}"
    return f"{text} +- {round(error, digits):.{places}f}"


def number(figure, curve, quantity, x, form):
    name = f"all:{curve}:{quantity}" if form == "value" else f"{curve}:{quantity}:{form}"
    rows = parts(figure).get(name)
    if rows is None or float(x) not in rows:
        raise ValueError(f"@measured: figures/data/{figure}.dat has no '{name}' at {x}")
    row = rows[float(x)]
    if form == "value":
        return with_error(float(row[1]), float(row[2]))
    return with_error(100.0 * float(row[4]), 100.0 * float(row[5]), "+")


def drawn(text):
    """A page with its numbers."""
    def one(match):
        fields = match[1].split(";")
        if len(fields) != 5:
            raise ValueError(f"@measured{{{match[1]}}}: needs FIGURE;CURVE;QUANTITY;X;FORMAT")
        return number(*fields)

    return MARK.sub(one, text)
