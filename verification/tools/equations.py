#!/usr/bin/env python3
"""The index of equations: every numbered equation of the papers, with its derivation, code, test and figure.

Code names its equation in a comment, @eq{PAPER,N}; docs/equations.toml says the rest by hand.

usage: equations.py                every equation has code and a test, or a reason why not; every name exists; every
                                   test that a page cites exists; every line of code that it asks for is there; every
                                   measured number of a page is in the data (measured.py)
       equations.py --write DIR    the same, then writes the page DIR/equations.md

Exit code 1 with one line per mistake. Python's standard library only.
"""

import pathlib
import re
import sys
import tomllib

import measured

ROOT = pathlib.Path(__file__).resolve().parents[2]
MARK = re.compile(r"@eq\{\s*(\w+)\s*,\s*(\d+)\s*\}")
KEYS = {"what", "code", "tests", "figures", "none", "untested"}


def read(file):
    return file.read_text(encoding="utf-8")


def pages():
    """the written pages of the book"""
    return sorted([*(ROOT / "docs").glob("*.md"), *(ROOT / "theory").glob("*.md")])


def numbers(text):
    """The numbers in "eqs. 1, 2 and 4", "eqs. 13 to 16", "eqs. 17-20"."""
    found = []
    for first, last in re.findall(r"(\d+)(?:\s*(?:-|to)\s*(\d+))?", text):
        found += range(int(first), int(last or first) + 1)
    return found


# --- derivations: sections of theory/PAPER.md


def label_of(paper, title):
    words = re.sub(r"\\f\$.*?\\f\$", "", title).lower()
    return f"{paper.lower()}-" + re.sub(r"[^a-z0-9]+", "-", words).strip("-")


def headings(file):
    """(line number from 0, title) of every heading that has no label yet."""
    for number, line in enumerate(read(file).splitlines()):
        match = re.fullmatch(r"#{2,4} (.*)", line)
        if match and not line.endswith("}"):
            yield number, match[1]


def labelled(file):
    """The text of a page, with labels on the headings of derivations"""
    lines = read(file).splitlines()
    if file.parent.name == "theory":
        for number, title in headings(file):
            lines[number] += f" {{#{label_of(file.stem, title)}}}"
    text = "\n".join(lines) + "\n"
    # Doxygen expands aliases in `...` and knows no **...** around a formula
    text = re.sub(r"`@eq\{([^}`]*)\}`", r"<code>\@eq{\1}</code>", text)

    def bold(match):
        return f"<b>{match[1]}</b>" if "\\f$" in match[1] else match[0]

    return re.sub(r"\*\*((?:(?!\n\n).)+?)\*\*", bold, text, flags=re.DOTALL)


def derivations(paper):
    """equation -> labels and titles of the sections that derive it: named in the heading, or marked."""
    file = ROOT / "theory" / f"{paper}.md"
    lines = read(file).splitlines()
    found = {}
    sections = list(headings(file))
    for (start, title), (end, _) in zip(sections, sections[1:] + [(len(lines), "")]):
        text = "\n".join(lines[start:end])
        inside = [int(n) for p, n in MARK.findall(text) if p == paper]
        named = re.search(r"\(eqs?\. ([^)]*)\)", title)
        for n in dict.fromkeys((numbers(named[1]) if named else []) + inside):
            found.setdefault(n, []).append((label_of(paper, title), title))
    return found


# --- code: @eq{...} in the comments of src/ and theory/


def page_of(file):
    """Doxygen's name for the page that shows a source file."""
    return re.sub(r"_", "__", file.name).replace(".", "_8") + "_source.html"


def name_of(line):
    match = re.search(r"\b(?:struct|class|enum class|enum) (\w+)", line) or re.search(r"(\w+)\(", line)
    return match[1] if match else None


def is_comment(line):
    return line.lstrip().startswith("//")


def marked_code():
    """(paper, equation) -> [(name, file, line)] of what follows each marked comment."""
    found = {}
    for folder in ("src", "theory"):
        for file in sorted((ROOT / folder).rglob("*.[ch]pp")):
            lines = read(file).splitlines()
            for number, line in enumerate(lines):
                for paper, n in MARK.findall(line):
                    at = number
                    while at < len(lines) and (is_comment(lines[at]) or lines[at].startswith("template")):
                        at += 1
                    name = name_of(lines[at]) if at < len(lines) else None
                    if not name:  # of a file, or of a section
                        at, name = number, file.name
                    places = found.setdefault((paper, int(n)), [])
                    if (name, file, at + 1) not in places:
                        places.append((name, file, at + 1))
    return found


def named_code(place):
    """(name, file, line) of "FILE: text in a line"."""
    path, _, text = place.partition(": ")
    file = ROOT / path
    if text and file.is_file():
        for number, line in enumerate(read(file).splitlines()):
            if text in line:
                return (name_of(line) or file.name, file, number + 1)
    return None


def all_tests():
    """"soft: two_steps_by_hand" -> (file, line)"""
    found = {}
    for file in sorted((ROOT / "verification" / "unit").glob("*_test.cpp")):
        for number, line in enumerate(read(file).splitlines()):
            match = re.match(r"BOOST_(?:AUTO|DATA|FIXTURE)_TEST_CASE\((\w+)", line)
            if match:
                found[f"{file.stem.removesuffix('_test')}: {match[1]}"] = (file, number + 1)
    return found


# --- tests that the pages cite: `MODULE: name` anywhere, or `name` in a paragraph or item "Tests: ..."


def lost_tests(tests):
    names = {test.split(": ")[1] for test in tests}
    for page in pages():
        text = read(page)
        cited = re.finditer(r"`([a-z]\w*: \w+)`", text)
        cited = [(match.start(1), match[1]) for match in cited if match[1] not in tests]
        for list_of_tests in re.finditer(r"^(?:- )?Tests?\b.*?(?=\n\n|\n- |\Z)", text, re.MULTILINE | re.DOTALL):
            # names of tests are sentences: two underscores and more
            for match in re.finditer(r"`(\w+_\w+_\w+)`", list_of_tests[0]):
                if match[1] not in names:
                    cited.append((list_of_tests.start() + match.start(1), match[1]))
        for at, test in sorted(cited):
            line = text.count("\n", 0, at) + 1
            yield f"{page.relative_to(ROOT)}:{line}: no test '{test}' in verification/unit"


# --- code that the pages show: Doxygen is silent about \skip and \until that find nothing


def lost_listings():
    folders = [ROOT / "src", ROOT / "theory", ROOT / "verification" / "unit", ROOT / "verification" / "scenes"]
    for page in pages():
        text, at = "", 0
        for number, line in enumerate(read(page).splitlines()):
            match = re.match(r"\\(dontinclude|skip|until) (.*)", line)
            if not match:
                continue
            command, wanted = match[1], match[2].strip()
            if command == "dontinclude":
                files = [file for folder in folders for file in folder.rglob(wanted)]
                text, at = (read(files[0]) if files else ""), 0
                found = bool(files)
            else:
                place = text.find(wanted, at)
                found = place >= 0
                at = text.find("\n", place) if found and command == "until" else max(place, at)
            if not found:
                yield f"{page.relative_to(ROOT)}:{number + 1}: \\{command} finds no '{wanted}'"


# --- the check and the page


def lost_numbers():
    """measured numbers of the pages that no data file has"""
    for page in pages():
        try:
            measured.drawn(read(page))
        except ValueError as error:
            yield f"{page.relative_to(ROOT)}: {error}"


def collect():
    code, tests = marked_code(), all_tests()
    mistakes = [*lost_listings(), *lost_tests(tests), *lost_numbers()]
    book = tomllib.loads(read(ROOT / "docs" / "equations.toml"))
    for (paper, n), places in code.items():
        if paper not in book or not 1 <= n <= book[paper]["equations"]:
            _, file, line = places[0]
            mistakes.append(f"{file.relative_to(ROOT)}:{line}: @eq{{{paper},{n}}}: no such equation")
    for paper, entries in book.items():
        total = entries["equations"]
        for key in entries:
            if key.isdigit() and not 1 <= int(key) <= total:
                mistakes.append(f"{paper} eq. {key}: the paper has {total}")
        for n in range(1, total + 1):
            entry = entries.setdefault(str(n), {})

            def wrong(problem):
                mistakes.append(f"{paper} eq. {n}: {problem}")

            for key in entry.keys() - KEYS:
                wrong(f"key '{key}'; allowed: {', '.join(sorted(KEYS))}")
            if "what" not in entry:
                wrong("docs/equations.toml does not say what it is")
            places = list(code.get((paper, n), []))
            for place in entry.get("code", []):
                found = named_code(place)
                if not found:
                    wrong(f"no line as in code '{place}'")
                else:
                    places.append(found)
            if not places and "none" not in entry:
                wrong("neither code (@eq in a comment, or code = [...]) nor a reason (none = ...)")
            if places and "none" in entry:
                wrong(f"has code ({places[0][0]}) and a reason why it has none")
            for test in entry.get("tests", []):
                if test not in tests:
                    wrong(f"no test '{test}' in verification/unit")
            if places and not entry.get("tests") and "untested" not in entry:
                wrong("neither a test nor a reason (untested = ...)")
            for figure in entry.get("figures", []):
                if not (ROOT / "verification" / figure / "figure.toml").is_file():
                    wrong(f"no figure '{figure}' in verification")
            entry["places"] = places
    return book, tests, mistakes


def source_link(name, file, line):
    return f"[{name}]({page_of(file)}#l{line:05d}) ({file.relative_to(ROOT)})"


def page(book, tests):
    lines = [
        "# Index of equations {#equations}",
        "",
        "*Where is an equation of the papers derived, which code computes it, and what proves it?* Below stands for every numbered one its "
        "derivation, its code, its tests and the figures that show it, or the reason why it needs none. The page is generated; a test "
        "(`equations`) fails when an equation is missing. Names of code and tests lead to the source.",
        "",
        "Go to: " + ", ".join(f"\\ref equations-{p.lower()} \"{p}\"" for p in book) + ".",
    ]
    for paper, entries in book.items():
        derived = derivations(paper)
        lines += ["", f"## {paper}: {entries['title']} {{#equations-{paper.lower()}}}", "", entries["source"], ""]
        for n in range(1, entries["equations"] + 1):
            entry = entries[str(n)]
            lines += [f"### {paper} eq. {n} {{#eq_{paper}_{n}}}", "", entry["what"], ""]
            if n in derived:
                links = [f"\\ref {label} \"{title.split(' (eq')[0]}\"" for label, title in derived[n]]
                lines.append(f"- Derivation: {'; '.join(links)}")
            if entry["places"]:
                lines.append(f"- Code: {', '.join(source_link(*place) for place in entry['places'])}")
            if entry.get("tests"):
                links = []
                for test in entry["tests"]:
                    module, name = test.split(": ")
                    file, line = tests[test]
                    links.append(f"[{name.replace('_', ' ')}]({page_of(file)}#l{line:05d}) (`{module}_test`)")
                lines.append(f"- Tests: {', '.join(links)}")
            if entry.get("figures"):
                lines.append("- Figures: " + ", ".join(f"\\ref figure-{f} \"{f}\"" for f in entry["figures"]))
            if "none" in entry:
                lines.append(f"- No code of its own: {entry['none']}")
            if "untested" in entry:
                lines.append(f"- No test of its own: {entry['untested']}")
            lines.append("")
    return "\n".join(lines) + "\n"


def main(arguments):
    if arguments and (len(arguments) != 2 or arguments[0] != "--write"):
        print(__doc__, file=sys.stderr)
        return 2
    book, tests, mistakes = collect()
    for mistake in mistakes:
        print(f"equations: {mistake}", file=sys.stderr)
    if mistakes:
        return 1
    if arguments:
        folder = pathlib.Path(arguments[1])
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "equations.md").write_text(page(book, tests), encoding="utf-8")
    print(f"{sum(paper['equations'] for paper in book.values())} equations")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
