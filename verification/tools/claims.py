#!/usr/bin/env python3
"""The ledger of claims: what the papers print about results, what dpdref finds, and how to run it again.

docs/claims.toml holds the claims; its head explains the keys. A verdict is not written there where comparisons of
figures/report.json or a closed form decide: it is derived from them here.

usage: claims.py --check                 every claim has its evidence: rows of the report, tests, figures, sections
       claims.py --out FILE              the same, then writes the pages of the ledger: FILE and, beside it, one per paper
       claims.py ... --dpdref PROGRAM    also evaluates the closed forms that claims name

Exit code 1 with one line per mistake. Python's standard library only.
"""

import argparse
import functools
import collections
import json
import math
import pathlib
import re
import subprocess
import sys
import tomllib

sys.dont_write_bytecode = True  # no __pycache__ beside the sources
import equations
from equations import ROOT, read

YES, NO, OPEN, PENDING = "reproduced", "not reproduced", "cannot tell", "pending"
VERDICTS = (YES, NO, OPEN, PENDING)
PAPERS = ("MY1997", "NG2007", "PK2006")
SELECTOR = ("figure", "curve", "quantity", "x", "theory")
CRITERIA = ("inverts", "side", "within", "trend", "across", "level", "follows", "claimed", "divided_by")
EVIDENCE = ("comparison", "theory", "test", "finding", "derivation", "figure")
KEYS = {"id", "paper", "place", "claim", "verdict", "expected", "note", *CRITERIA, *EVIDENCE}
LATER = re.compile(r"pk[1-8]|pk-anchor")  # figures that claims may wait for
SIGMAS = 3  # a criterion is decided at this many standard errors
SAME = 5e-4  # how closely the program must give the value of a closed form that the ledger holds


# --- rows of the report


def as_list(value):
    return value if isinstance(value, list) else [value]


def same(a, b):
    return math.isclose(a, b, rel_tol=1e-9) if isinstance(a, (int, float)) else a == b


def selectors(claim):
    return as_list(claim.get("comparison", [])) + as_list(claim.get("divided_by", []))


def select(rows, selector):
    """Rows in the order of the report that have, for every key of the selector, its value or one of its values."""
    return [row for row in rows
            if all(any(same(value, row[key]) for value in as_list(wanted)) for key, wanted in selector.items())]


def unmatched(rows, selector):
    """What in a selector finds nothing: a whole selector, or one value of a list."""
    found = select(rows, selector)
    if not found:
        yield str(selector)
    for key, wanted in selector.items():
        for value in as_list(wanted):
            if found and not any(same(value, row[key]) for row in found):
                yield f"{key} = {value!r} in {selector}"


class Point:
    """A measured value, its reference, and the standard errors of both."""

    def __init__(self, row, claim, rows):
        self.x, self.value, self.error = row["x"], row["value"], row["error"]
        self.reference, self.reference_error = row["theory_value"], row["theory_error"]
        if "divided_by" in claim:
            below = next(r for r in select(rows, claim["divided_by"]) if same(r["x"], row["x"]))
            relative = math.hypot(row["error"] / row["value"], below["error"] / below["value"])
            self.value = row["value"] / below["value"]
            self.error = abs(self.value) * relative
        if "claimed" in claim:
            self.reference, self.reference_error = claim["claimed"], 0.0


def series(claim, rows):
    """One list of points per selector, along x; a single one in the order of the selectors if `across`."""
    found = []
    for selector in as_list(claim["comparison"]):
        points = [Point(row, claim, rows) for row in select(rows, selector)]
        found.append(sorted(points, key=lambda point: point.x))
    return [[point for points in found for point in points]] if claim.get("across") else found


# --- verdicts


def beyond(difference, error):
    """Is a number positive?"""
    return YES if difference > SIGMAS * error else NO if difference < -SIGMAS * error else OPEN


def worst(verdicts):
    verdicts = list(verdicts)
    return NO if NO in verdicts else OPEN if OPEN in verdicts else YES


def change(points, attribute="value"):
    first, last = points[0], points[-1]
    error = "error" if attribute == "value" else "reference_error"
    return getattr(last, attribute) - getattr(first, attribute), math.hypot(getattr(first, error), getattr(last, error))


def criteria(claim, rows):
    for points in series(claim, rows):
        if "side" in claim:
            sign = {"above": 1, "below": -1}[claim["side"]]
            for p in points:
                yield beyond(sign * (p.value - p.reference), math.hypot(p.error, p.reference_error))
        if "within" in claim:
            for p in points:
                relative = abs(p.value / p.reference - 1)
                error = math.hypot(p.error, p.value / p.reference * p.reference_error) / abs(p.reference)
                yield beyond(claim["within"] / 100 - relative, error)
        if "trend" in claim:
            sign = {"rises": 1, "falls": -1}[claim["trend"]]
            difference, error = change(points)
            yield beyond(sign * difference, error)
            for pair in zip(points, points[1:]):
                difference, error = change(pair)
                yield NO if beyond(sign * difference, error) == NO else YES
        if "level" in claim:
            low, high = min(points, key=lambda p: p.value), max(points, key=lambda p: p.value)
            mean = sum(p.value for p in points) / len(points)
            yield beyond(claim["level"] / 100 * mean - (high.value - low.value), math.hypot(low.error, high.error))
        if "follows" in claim:
            measured, theory = change(points), change(points, "reference")
            yield beyond(measured[0] * math.copysign(1, theory[0]), measured[1])


def verdict_of_rows(claim, rows):
    found = [row["verdict"] for selector in as_list(claim["comparison"]) for row in select(rows, selector)]
    # where the claim has a number of its own, the row's verdict is about another
    verdict = YES if "claimed" in claim else NO if "disagrees" in found else OPEN if "undecided" in found else YES
    if claim.get("inverts"):
        return {YES: NO, NO: YES, OPEN: OPEN}[verdict]
    return worst([verdict, *criteria(claim, rows)]) if verdict == YES else verdict


def decides(form):
    return "printed" in form


def verdict_of_forms(claim):
    return worst(YES if abs(form["value"] / form["printed"] - 1) <= form.get("within", 0.1) / 100 else NO
                 for form in claim["theory"] if decides(form))


def is_derived(claim):
    return "comparison" in claim or any(decides(form) for form in claim.get("theory", []))


def verdict(claim, rows):
    if "comparison" in claim:
        return verdict_of_rows(claim, rows)
    return verdict_of_forms(claim) if is_derived(claim) else claim["verdict"]


# --- the check


def findings():
    """Sections of docs/findings.md, and their parts that begin in bold: "NG2007 Fig. 1: Visiting order"."""
    section = ""
    for line in read(ROOT / "docs" / "findings.md").splitlines():
        if line.startswith("## "):
            section = line[3:].strip()
            yield section
        elif match := re.match(r"\*\*([^*,(]+?)[.,(*]", line):
            yield f"{section}: {match[1].strip()}"


def sections_of_theory():
    """"MY1997: Memory" -> label of the section"""
    return {f"{paper}: {title}": equations.label_of(paper, title)
            for paper in PAPERS for _, title in equations.headings(ROOT / "theory" / f"{paper}.md")}


def mistakes_of(claim, rows, tests, known_findings, known_sections):
    for key in ("id", "paper", "place", "claim"):
        if key not in claim:
            yield f"no '{key}'"
            return
    if not re.fullmatch(r"[a-z][a-z0-9-]*", claim["id"]):
        yield "an id has small letters, digits and '-' only: it becomes an anchor of the page"
    if claim["paper"] not in PAPERS:
        yield f"paper '{claim['paper']}'; allowed: {', '.join(PAPERS)}"
    for key in sorted(claim.keys() - KEYS):
        yield f"key '{key}'; allowed: {', '.join(sorted(KEYS))}"
    if not claim.keys() & set(EVIDENCE):
        yield f"no evidence ({', '.join(EVIDENCE)})"
        return
    for test in claim.get("test", []):
        if test not in tests:
            yield f"no test '{test}' in verification/unit"
    if "finding" in claim and claim["finding"] not in known_findings:
        yield f"no section '{claim['finding']}' in docs/findings.md"
    if "derivation" in claim and claim["derivation"] not in known_sections:
        yield f"no section '{claim['derivation']}' in theory/"
    for form in claim.get("theory", []):
        if not form.keys() <= {"id", "with", "value", "printed", "within"} or not form.keys() >= {"id", "value"}:
            yield f"theory {form}: id and value, and with, printed, within where needed"
            return
    for selector in selectors(claim):
        if not selector.keys() <= set(SELECTOR) or "figure" not in selector:
            yield f"selector {selector}: figure, and any of {', '.join(SELECTOR[1:])}"
            return
        for figure in as_list(selector["figure"]):
            if not (ROOT / "verification" / figure / "figure.toml").is_file():
                yield f"no figure '{figure}' in verification"
        for what in unmatched(rows, selector):
            yield f"no row of figures/report.json for {what}"
            return
    if "divided_by" in claim:
        below = [row["x"] for row in select(rows, claim["divided_by"])]
        for selector in as_list(claim["comparison"]):
            for row in select(rows, selector):
                if not any(same(row["x"], x) for x in below):
                    yield f"divided_by has no row at x = {row['x']}"
                    return
    if claim.keys() & set(CRITERIA) and "comparison" not in claim:
        yield "a criterion without comparison"
    elif claim.get("inverts") and len(claim.keys() & set(CRITERIA)) > 1:
        yield "inverts goes with no other criterion"
    if claim.keys() & {"trend", "level", "follows"} and not claim.get("across"):
        for points in series(claim, rows):
            if len({point.x for point in points}) < len(points) or len(points) < 2:
                yield "a selector of trend, level or follows needs one row at each x, and two x"
                return
    if "figure" in claim:
        if claim.get("verdict") != PENDING or "comparison" in claim:
            yield "figure is for what waits for one: verdict = \"pending\", and no comparison"
        elif not LATER.fullmatch(claim["figure"]):
            yield f"no figure '{claim['figure']}' is awaited"
        return
    if is_derived(claim) == ("verdict" in claim):
        yield "the verdict is derived; remove it" if "verdict" in claim else "no verdict"
        return
    if claim.get("verdict", YES) not in (YES, NO, OPEN):
        yield f"verdict '{claim['verdict']}'; allowed: {YES}, {NO}, {OPEN}"
        return
    now = verdict(claim, rows)
    if is_derived(claim) and claim.get("expected", YES) != now:
        yield f"the verdict is now '{now}', expected '{claim.get('expected', YES)}': read its note again"
    if now != YES and "note" not in claim:
        yield f"'{now}' needs a note"


def evaluated(claims, program):
    for claim in claims:
        for form in claim.get("theory", []):
            command = [program, "theory", form["id"], *form.get("with", "").split()]
            run = subprocess.run(command, capture_output=True, text=True, check=False)
            try:
                value = float(run.stdout.split()[-1])
            except (IndexError, ValueError):
                yield f"{claim['id']}: {' '.join(command[1:])}: {run.stderr.strip() or 'no value'}"
                continue
            if abs(value - form["value"]) > SAME * abs(value):
                yield f"{claim['id']}: dpdref {' '.join(command[1:])} gives {value:.6g}, not {form['value']}"


def collect(program):
    claims = tomllib.loads(read(ROOT / "docs" / "claims.toml"))["claim"]
    rows = json.loads(read(ROOT / "figures" / "report.json"))
    tests, known_findings, known_sections = equations.all_tests(), set(findings()), sections_of_theory()
    mistakes = []
    for claim in claims:
        for mistake in mistakes_of(claim, rows, tests, known_findings, known_sections):
            mistakes.append(f"{claim.get('id', claim)}: {mistake}")
    for name, count in collections.Counter(claim.get("id") for claim in claims).items():
        if count > 1:
            mistakes.append(f"{name}: {count} claims of this id")
    modules = {test.split(": ")[0] for test in tests}
    for module, name in re.findall(r"`(\w+): (\w+)`", read(ROOT / "docs" / "errata.md")):
        if module in modules and f"{module}: {name}" not in tests:
            mistakes.append(f"docs/errata.md: no test '{module}: {name}' in verification/unit")
    if program and not mistakes:
        mistakes += evaluated(claims, program)
    return claims, rows, tests, known_sections, mistakes


# --- the page


def plain(text):
    """Text as Doxygen's Markdown shows it unchanged"""
    return re.sub(r"([*<>|])", r"\\\1", text)


@functools.cache
def formulas():
    """[(text, TeX)], the longest first"""
    table = tomllib.loads(read(ROOT / "docs" / "claims.toml"))["formulas"]
    return sorted(table.items(), key=lambda pair: -len(pair[0]))


def in_tex(text):
    """A sentence with its formulas set: those of docs/claims.toml, and N_m alone or with a number"""
    known = "|".join(rf"(?<![\w^]){re.escape(plain_text)}(?![\w^])" for plain_text, _ in formulas())
    pieces = re.split(rf"({known}|\bNm (?:=|>) \d+|\bNm\b(?!\^))", text)
    tex = dict(formulas())

    def one(piece):
        if piece in tex:
            return rf"\f${tex[piece]}\f$"
        return rf"\f${piece.replace('Nm', 'N_m')}\f$" if re.fullmatch(r"Nm(?: [=>] \d+)?", piece) else plain(piece)

    return "".join(map(one, pieces))


def noted(claim, titles):
    """What the ledger says of a claim; another claim that it names is shown by its heading"""
    ids = "|".join(sorted(map(re.escape, titles), key=len, reverse=True))
    return re.sub(rf"(?<![\w`-])(?:{ids})(?![\w`-])", lambda match: f'\\ref claim-{match[0]} "{titles[match[0]]}"', in_tex(claim.get("note", "")))


def number(value, error):
    if not error:
        return f"{value:.5g}"
    digits = max(0, 1 - math.floor(math.log10(error)))
    return f"{value:.{digits}f} +- {error:.{digits}f}"


def duration(seconds):
    if seconds < 100:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 6000 else f"{seconds / 3600:.1f} h"


def reference(theory):
    kind, _, name = theory.partition(":")
    return {"curve": f"the curve '{name}'", "quantity": f"`{name}`", "previous": "the point before it",
            "value": "the given value"}.get(kind, f"`{theory}`")


RELATION = {"equal": "", "at_most": "at most ", "at_least": "at least ", "differs": "other than "}


def percent(shares):
    largest = max(abs(share) for share in shares)
    digits = 0 if largest >= 1000 else 1 if largest >= 1 else 2
    low, high = (f"{share:+.{digits}f}" for share in (min(shares), max(shares)))
    return f"{low} %" if low == high else f"{low} to {high} %"


def measured(claim, rows):
    """One line per figure, quantity and what it is compared with."""
    groups = {}
    for selector in as_list(claim["comparison"]):
        for row in select(rows, selector):
            groups.setdefault((row["figure"], row["quantity"], row["theory"], row["relation"]), []).append(row)
    for (figure, quantity, theory, relation), group in groups.items():
        points = [Point(row, claim, rows) for row in group]
        values = [point.value for point in points]
        over = f" over `{claim['divided_by']['quantity']}`" if "divided_by" in claim else ""
        text = f"\\ref figure-{figure} \"{figure}\", `{quantity}`{over}: "
        if len(points) == 1:
            text += number(points[0].value, points[0].error)
        else:
            text += f"{min(values):.5g} to {max(values):.5g} ({len(points)} values, errors up to " \
                    f"{max(point.error for point in points):.2g})"
        if "claimed" in claim or not over:
            of = RELATION[relation] + reference(theory)
            if theory == "value" and len({point.reference for point in points}) == 1:
                of = f"{RELATION[relation]}{points[0].reference:g}"
            if "claimed" in claim:
                of = f"the claimed {claim['claimed']}"
            text += f"; {plain(of)}: {percent([100 * (point.value / point.reference - 1) for point in points])}"
        yield text
    counts = collections.Counter(row["verdict"] for group in groups.values() for row in group)
    tolerances = sorted({row["tolerance"] for group in groups.values() for row in group} - {0.0})
    stated = f"; tolerance {', '.join(f'{100 * tolerance:g} %' for tolerance in tolerances)}" if tolerances else ""
    words = [f"{n} {word if n == 1 or word == 'undecided' else word.removesuffix('s')}" for word, n in counts.items()]
    yield f"Comparisons: {', '.join(words)}{stated}"


def criterion(claim):
    parts = []
    if claim.get("inverts"):
        parts.append("where these comparisons agree, the claim does not hold")
    of = f"the claimed {claim['claimed']}" if "claimed" in claim else "the reference"
    if "side" in claim:
        parts.append(f"every value {claim['side']} {of}")
    if "within" in claim:
        parts.append(f"every value within {claim['within']} % of {of}")
    if "trend" in claim:
        parts.append(f"the value {claim['trend']}" + (" in this order" if claim.get("across") else " along x"))
    if "level" in claim:
        parts.append(f"the value varies by at most {claim['level']} %")
    if "follows" in claim:
        parts.append("value and reference change in the same direction along x")
    return "; ".join(parts)


def run_time(claim, rows):
    """Of the runs behind the rows; points that share all their runs have the same time and count once."""
    return sum({row["seconds"] for selector in selectors(claim) for row in select(rows, selector)})


def commands(claim):
    found = []
    for selector in selectors(claim):
        found += [f"dpdref figure {figure} --budget paper" for figure in as_list(selector["figure"])]
    found += [f"dpdref theory {form['id']} {form.get('with', '')}".strip() for form in claim.get("theory", [])]
    # double quotes: Doxygen ends `...` at a single one
    found += [f'ctest -R "^{test.split(": ")[0]}$"' for test in claim.get("test", [])]
    if "figure" in claim:
        found.append(f"dpdref figure {claim['figure']} --budget paper")
    return list(dict.fromkeys(found))


def clause(text, longest):
    """The first clause of a text, or as many of its words as fit"""
    for ends in (";.", ":;."):
        first = re.split(rf"(?<!\b[Ee]q)(?<!\b[Ee]qs)(?<!\bFig)(?<!\bFigs)(?<!\bsect)(?<!\bref)[{ends}](?:\s|$)", text.strip())[0]
        if len(first) <= longest:
            return first
    return first[:first.rindex(" ", 0, longest)] + " ..."


def headings(claims):
    """id -> the claim as a heading. What begins with 'The same' needs what it is the same as"""
    found, before = {}, ""
    for claim in claims:
        text = claim["claim"].strip()
        if match := re.match(r"The same,? ?", text):
            found[claim["id"]] = plain(f"{clause(before, 80)}: the same {clause(text[match.end():], 80)}")
        else:
            found[claim["id"]], before = plain(clause(text, 130)), text
    # a \\ref takes its text as it stands
    for sign, entity in (("\\|", "∣"), ("\\*", "∗"), ("\\<", "&lt;"), ("\\>", "&gt;")):
        found = {name: title.replace(sign, entity) for name, title in found.items()}
    return found


def details(claim, titles, rows, tests, known_sections):
    now, title = verdict(claim, rows), titles[claim["id"]]
    yield f"### {title} {{#claim-{claim['id']}}}"
    yield ""
    yield f"**{now[0].upper()}{now[1:]}**" + (f". {noted(claim, titles)}" if "note" in claim else ".")
    yield ""
    yield "\\htmlonly <details class=\"solution\" open><summary>Evidence</summary> \\endhtmlonly"
    yield ""
    yield in_tex(claim["claim"])
    yield ""
    yield f"- In the paper: {plain(claim['place'])}; id `{claim['id']}`"
    for form in claim.get("theory", []):
        printed = ""
        if decides(form):
            printed = f"; printed {form['printed']:g}, {100 * (form['value'] / form['printed'] - 1):+.2f} %"
        yield f"- Closed form: `{form['id']} {form.get('with', '')}`: {form['value']:g}{printed}"
    if "comparison" in claim:
        for line in measured(claim, rows):
            yield f"- {line}"
        if criterion(claim):
            yield f"- Criterion: {criterion(claim)}"
    for test in claim.get("test", []):
        file, line = tests[test]
        name = test.split(": ")[1].replace("_", " ")
        yield f"- Test: [{name}]({equations.page_of(file)}#l{line:05d}) (`{file.stem}`)"
    if "finding" in claim:
        yield f"- Section of \\ref findings : {plain(claim['finding'])}"
    if "derivation" in claim:
        paper, _, title = claim["derivation"].partition(": ")
        yield f"- Derivation: \\ref {known_sections[claim['derivation']]} \"{paper}, {title.split(' (eq')[0]}\""
    if "figure" in claim:
        yield f"- Waits for figure `{claim['figure']}`"
    again = ", ".join(f"`{command}`" for command in commands(claim))
    if again:
        yield f"- Again: {again}" + (f" ({duration(run_time(claim, rows))})" if "comparison" in claim else "")
    yield ""
    yield "\\htmlonly </details> \\endhtmlonly"
    yield ""


def page(claims, rows):
    """The overview"""
    titles = headings(claims)
    lines = [
        "# Ledger of claims {#claims}",
        "",
        "*What do the three papers say about results, and what becomes of it?* Most is reproduced; what is not stands first below. Each paper has a page of its own, with the evidence for every "
        "claim. The pages are generated: where numbers decide, the verdict is derived from the comparisons of the committed figures or from a closed form. Claims are in our words. What does "
        "not follow from the papers' own equations, and what they leave open: \\ref errata.",
        "",
        "| paper | " + " | ".join(VERDICTS) + " | all |",
        "|---|" + "---|" * (len(VERDICTS) + 1),
    ]
    for paper in PAPERS:
        counts = collections.Counter(verdict(claim, rows) for claim in claims if claim["paper"] == paper)
        lines.append(f"| \\subpage claims-{paper.lower()} \"Claims of {paper}\" | "
                     + " | ".join(str(counts[word]) for word in VERDICTS) + f" | {counts.total()} |")
    used = {id(row) for claim in claims for selector in selectors(claim) for row in select(rows, selector)}
    lines += [
        "",
        f"{len(used)} of the {len(rows)} comparisons of the report stand behind a claim. The others check the simulations: temperature, flow profile, another shear rate or order of the pairs.",
        "",
        "## What is not reproduced", "",
        "| paper | claim | why |", "|---|---|---|",
        *(f"| {claim['paper']} | \\ref claim-{claim['id']} \"{titles[claim['id']]}\" | {' '.join(noted(claim, titles).split())} |"
          for claim in claims if verdict(claim, rows) == NO),
        "",
        "## How to read a verdict", "",
        "- *Reproduced*: all comparisons behind the claim agree, and its criterion, if it has one, is met by "
        f"{SIGMAS} standard errors. *Not reproduced*: it is missed by as much. *Cannot tell*: neither, or the paper does not say enough.",
        "- A word without a number (well, good, small) is read as 10 %. The measured deviation stands beside it, for a reader with another measure.",
        "- A value is followed by what the figure compares it with, and by its deviation from that. A bound (at most, at least) agrees if the value is on the right side of it, however far.",
        "- A run time is that of one core, for all runs behind the claim at the budget of the committed figures. `ctest` is to be run in the build folder.",
    ]
    return "\n".join(lines) + "\n"


def page_of_paper(paper, claims, rows, tests, known_sections):
    own, titles = [claim for claim in claims if claim["paper"] == paper], headings(claims)
    lines = [f"# Claims of {paper} {{#claims-{paper.lower()}}}", "",
             f"*What does {paper} say about results, and what becomes of it?* How to read a verdict: \\ref claims.", "", "| claim | verdict |", "|---|---|"]
    lines += [f"| \\ref claim-{claim['id']} \"{titles[claim['id']]}\" | {verdict(claim, rows)} |" for claim in own]
    lines += ["", "## One by one", ""]
    for claim in own:
        lines += details(claim, titles, rows, tests, known_sections)
    return "\n".join(lines) + "\n"


def stale_table():
    """README.md shows what `dpdref report` says of each kind of comparison"""
    table = read(ROOT / "figures" / "report.md").strip()
    shown = re.search(r"<!-- figures/report.md -->\n(.*?)<!-- end -->", read(ROOT / "README.md"), flags=re.DOTALL)
    if not shown or shown[1].strip() != table:
        yield "README.md: the table of kinds is not that of figures/report.md: copy it"


def stale_count(claims, rows):
    """README.md says how many claims have which verdict"""
    counts = collections.Counter(verdict(claim, rows) for claim in claims)
    line = (f"Of {len(claims)} statements in three papers {counts[YES]} are reproduced, {counts[NO]} are not, {counts[OPEN]} cannot be "
            "decided")
    if line not in read(ROOT / "README.md"):
        yield f"README.md: does not say '{line}'"


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="check only")
    parser.add_argument("--out", metavar="FILE", help="write the page, and beside it one for each paper")
    parser.add_argument("--dpdref", metavar="PROGRAM", help="evaluate closed forms with this program")
    options = parser.parse_args(arguments)
    if not options.check and not options.out:
        parser.error("--check or --out FILE")
    claims, rows, tests, known_sections, mistakes = collect(options.dpdref)
    mistakes = [*mistakes, *stale_table(), *(stale_count(claims, rows) if not mistakes else [])]
    for mistake in mistakes:
        print(f"claims: {mistake}", file=sys.stderr)
    if mistakes:
        return 1
    if options.out:
        out = pathlib.Path(options.out)
        out.write_text(page(claims, rows), encoding="utf-8")
        for paper in PAPERS:
            (out.parent / f"claims-{paper.lower()}.md").write_text(page_of_paper(paper, claims, rows, tests, known_sections),
                                                                   encoding="utf-8")
    counts = collections.Counter(verdict(claim, rows) for claim in claims)
    print(f"{len(claims)} claims: " + ", ".join(f"{counts[word]} {word}" for word in VERDICTS))
    drawn = {row["figure"] for row in rows}
    for figure in sorted({claim["figure"] for claim in claims if "figure" in claim} & drawn):
        print(f"{figure} is in the report: its pending claims can be given comparisons")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
