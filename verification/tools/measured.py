"""Numbers in the pages of the book: where each comes from. `drawn` replaces the marks by what the reader sees.

@measured{FIGURE;CURVE;QUANTITY;X;FORM}         from figures/data/FIGURE.dat, or FOLDER/FIGURE from figures/FOLDER/data
@measured{FIGURE;CURVE;QUANTITY;X;FORM;SHAPE}   FORM: `value` (0.399 ± 0.004), or `THEORY` (+50.0 ± 1.6), the deviation in
                                                per cent from what the part CURVE:QUANTITY:THEORY compares with, or
                                                `of THEORY`, what it compares with; `from value`, the deviation from a number. SHAPE, as in Python's formats, shows the number
                                                without its error; `abs SHAPE` without its sign, too. X may be A..B: from the
                                                smallest to the largest of these points, or, with `max SHAPE`, the largest size
@ratio{FIGURE;CURVE;QUANTITY;X|FIGURE;CURVE;QUANTITY;X}       of two values, errors taken as independent
@ratio{...|...;SHAPE}                           SHAPE as above; `percent` or `percent SHAPE`: the ratio less one in per cent
@data{FILE;PART;X;EXPRESSION;SHAPE}             from figures/FILE.dat: columns $1, $2 ... of the row that begins with X (`all`,
                                                or A..B: smallest to largest), sums, products, min, max, abs of them
@report{FIGURE;CURVE;QUANTITY;X;COLUMN;SHAPE}   a column of figures/report.csv, the first row of that point
@recorded{NAME;EXPRESSION;SHAPE}                from figures/recorded/NAME.json, what a command of docs/recorded.toml printed (record.py): sums and
                                                products of its numbers, a.b[0] in the order of its keys
@recorded{NAME;PLACE}                           an object with value and error: 0.399 ± 0.004
@recorded{NAME;PLACE;from NAME:EXPRESSION}      its deviation in per cent (+2.8 ± 0.5); `from NUMBER`, too
@table{FILE;ROW;COLUMN}                         a cell of a table in figures/FILE.md, as it stands: ROW is its first cells, joined by |
@table{FILE;ROW;COLUMN;SHAPE}                   the same as a number
@json{FILE;EXPRESSION;SHAPE}                    from figures/FILE.json, as above
@computed{NAME ARGUMENT...}                     from committed data by more than a product: a function of computed.py
@closed{ID ARGUMENTS;VALUE}                     a closed form; the test `numbers` asks `dpdref theory` for it
@given{VALUE}                                   of the set-up, printed by a paper, or from a formula; nobody measured it

A number that is not there is a ValueError, which fails the tests and the book. Python's standard library only.
"""

import ast
import csv
import functools
import json
import math
import operator
import pathlib
import re
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[2]
MARK = re.compile(r"@(measured|ratio|data|report|recorded|table|json|computed|closed|given)\{([^{}]*)\}")


# --- data files: parts that begin with '# NAME', rows of numbers


@functools.cache
def parts(name):
    """name of a part of figures/NAME.dat -> its rows, as text"""
    file = ROOT / "figures" / f"{name}.dat"
    if not file.is_file():
        raise ValueError(f"there is no figures/{name}.dat")
    found, part = {}, None
    for line in file.read_text(encoding="utf-8").splitlines():
        if line.startswith("# "):
            part = found.setdefault(line[2:], [])
        elif line and part is not None:
            part.append(line.split())
    return found


def rows(name, part, x):
    """of figures/NAME.dat: those that begin with x, with all numbers of x, or in the range A..B"""
    found = parts(name).get(part) or next((lines for at, lines in parts(name).items() if at.startswith(part + ": ")), None)
    if found is None:
        raise ValueError(f"figures/{name}.dat has no '{part}'")
    if x == "all":
        chosen = found
    elif ".." in x:
        low, high = map(float, x.split(".."))
        chosen = [row for row in found if low <= float(row[0]) <= high]
    else:
        wanted = [float(number) for number in x.split()]
        chosen = [row for row in found if [float(number) for number in row[:len(wanted)]] == wanted]
    if not chosen:
        raise ValueError(f"figures/{name}.dat: '{part}' has no row {x}")
    return chosen


def name_of(figure):
    folder, _, last = figure.rpartition("/")
    return f"{folder + '/' if folder else ''}data/{last}"


# --- how a number is shown


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
    return f"{text} ± {round(error, digits):.{places}f}"


def shaped(value, shape):
    text = format(value, shape)
    if match := re.fullmatch(r"([-+]?[\d.]+)e([-+])0*(\d+)", text):
        sign = "" if match[2] == "+" else "-"
        return f"\\f${match[1]}\\cdot10^{{{sign}{match[3]}}}\\f$"
    return text


def span(values, shape):
    """One number, or from the smallest to the largest"""
    if shape.startswith("max "):
        return shaped(max(abs(value) for value in values), shape.removeprefix("max "))
    if shape.startswith("abs "):
        shape, values = shape.removeprefix("abs "), [abs(value) for value in values]
    low, high = shaped(min(values), shape), shaped(max(values), shape)
    return low if low == high else f"{low} to {high}"


# --- the marks


def point(figure, curve, quantity, x, form="value"):
    """[(value, error)] of the points, and the sign that they are shown with"""
    name = name_of(figure)
    if form == "value":
        return [(float(row[1]), float(row[2])) for row in rows(name, f"all:{curve}:{quantity}", x)], ""
    chosen = rows(name, f"{curve}:{quantity}:{form.removeprefix('of ').removeprefix('from ')}", x)
    if form.startswith("of "):
        return [(float(row[3]), 0.0) for row in chosen], ""
    return [(100.0 * float(row[4]), 100.0 * float(row[5])) for row in chosen], "+"


def measured(text):
    fields = text.split(";")
    if len(fields) not in (5, 6):
        raise ValueError("needs FIGURE;CURVE;QUANTITY;X;FORM and perhaps a SHAPE")
    points, sign = point(*fields[:5])
    if len(fields) == 6:
        return span([value for value, _ in points], fields[5])
    if len(points) > 1:
        raise ValueError("several points need a SHAPE")
    return with_error(*points[0], sign)


def ratio(text):
    pair, _, shape = text.partition("|")[2].rpartition(";") if text.count(";") == 7 else (text.partition("|")[2], "", "")
    ((above, above_error),), ((below, below_error),) = (point(*of.split(";"))[0] for of in (text.partition("|")[0], pair))
    value = above / below
    error = abs(value) * math.hypot(above_error / above, below_error / below)
    if shape.startswith("percent"):
        value, error, shape = 100.0 * (value - 1.0), 100.0 * error, shape.removeprefix("percent").strip()
        return span([value], shape) if shape else with_error(value, error, "+")
    return span([value], shape) if shape else with_error(value, error)


OPERATIONS = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
              ast.Pow: operator.pow, ast.USub: operator.neg}
FUNCTIONS = {"min": min, "max": max, "abs": abs, "sqrt": math.sqrt}


def arithmetic(text, row=None, tree=None):
    """Sums and products of a row's columns $1, $2 ..., or of the numbers in a tree of JSON: a.b[0]"""
    def value(node):
        match node:
            case ast.Constant(value=number):
                return number
            case ast.Name(id=name) if row is not None and name.startswith("column"):
                return float(row[int(name.removeprefix("column")) - 1])
            case ast.Name() | ast.Attribute() | ast.Subscript() if tree is not None:
                return float(at(tree, ast.unparse(node)))
            case ast.BinOp(left=left, op=op, right=right):
                return OPERATIONS[type(op)](value(left), value(right))
            case ast.UnaryOp(op=op, operand=operand):
                return OPERATIONS[type(op)](value(operand))
            case ast.Call(func=ast.Name(id=name), args=arguments):
                return FUNCTIONS[name](*map(value, arguments))
        raise ValueError(f"cannot compute '{text}'")

    return value(ast.parse(text.replace("$", "column"), mode="eval").body)


def at(tree, place):
    """What stands at a.b[0] in a tree of JSON"""
    for name, index in re.findall(r"([A-Za-z_]\w*)|\[(\d+)\]", place):
        tree = tree[name] if name else tree[int(index)]
    return tree


def data(text):
    fields = text.split(";")
    if len(fields) != 5:
        raise ValueError("needs FILE;PART;X;EXPRESSION;SHAPE")
    name, part, x, expression, shape = fields
    return span([arithmetic(expression, row) for row in rows(name, part, x)], shape)


@functools.cache
def report_rows():
    with (ROOT / "figures" / "report.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def report(text):
    figure, curve, quantity, x, column, shape = text.split(";")
    for row in report_rows():
        if (row["figure"], row["curve"], row["quantity"]) == (figure, curve, quantity) and float(row["x"]) == float(x):
            return span([float(row[column])], shape)
    raise ValueError("figures/report.csv has no such row")


@functools.cache
def json_file(file):
    if not file.is_file():
        raise ValueError(f"there is no {file.relative_to(ROOT)}")
    return json.loads(file.read_text(encoding="utf-8"))


@functools.cache
def commands():
    """of docs/recorded.toml by name"""
    tables = tomllib.loads((ROOT / "docs" / "recorded.toml").read_text(encoding="utf-8"))
    return {name: table["command"] for name, table in tables.items()}


def recorded_file(name):
    return ROOT / "figures" / "recorded" / f"{name}.json"


def record(name):
    """What the command of docs/recorded.toml printed"""
    if name not in commands():
        raise ValueError("docs/recorded.toml has no such command")
    kept = json_file(recorded_file(name))
    if kept["command"] != commands()[name]:
        raise ValueError(f"{recorded_file(name).relative_to(ROOT)} is from another command: record.py {name}")
    return kept["printed"]


def recorded(text):
    name, place, *shape = text.split(";")
    if shape and not shape[0].startswith("from "):
        return span([arithmetic(place, tree=record(name))], shape[0])
    found = at(record(name), place)
    if not shape:
        return with_error(found["value"], found["error"])
    other, _, expression = shape[0].removeprefix("from ").rpartition(":")
    reference = arithmetic(expression, tree=record(other) if other else None)
    return with_error(100.0 * (found["value"] / reference - 1.0), 100.0 * found["error"] / abs(reference), "+")


def from_json(text):
    file, expression, shape = text.split(";")
    return span([arithmetic(expression, tree=json_file(ROOT / "figures" / f"{file}.json"))], shape)


def table(text):
    name, row, column, *shape = text.split(";")
    file = ROOT / "figures" / f"{name}.md"
    if not file.is_file():
        raise ValueError(f"there is no figures/{name}.md")
    wanted, header = row.split("|"), []
    for line in file.read_text(encoding="utf-8").splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")] if line.startswith("|") else []
        if not cells:
            header = []
        elif not header:
            header = cells
        elif cells[:len(wanted)] == wanted and column in header:
            cell = cells[header.index(column)]
            return span([float(cell)], shape[0]) if shape else cell
    raise ValueError(f"figures/{name}.md has no such cell")


def from_function(text):
    import computed  # it draws on this module

    name, *arguments = text.split()
    function = getattr(computed, name, None)
    if name.startswith("_") or getattr(function, "__module__", None) != "computed":
        raise ValueError("computed.py has no such function")
    return function(*arguments)


def closed(text):
    call, _, value = text.rpartition(";")
    if not call:
        raise ValueError("needs ID ARGUMENTS;VALUE")
    return value


SOURCES = {"measured": measured, "ratio": ratio, "data": data, "report": report, "recorded": recorded, "table": table,
           "json": from_json, "computed": from_function, "closed": closed, "given": lambda text: text}


def drawn(text):
    """A page with its numbers."""
    def one(match):
        try:
            return SOURCES[match[1]](match[2])
        except (ValueError, KeyError, IndexError, ZeroDivisionError, SyntaxError) as error:
            raise ValueError(f"@{match[1]}{{{match[2]}}}: {error}") from error

    return MARK.sub(one, text)
