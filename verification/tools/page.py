#!/usr/bin/env python3
"""A page of the book as Doxygen reads it: its filter for *.md, and the order of the pages.

usage: page.py FILE        prints the page with
                           labels on the headings of derivations (equations.py),
                           measured numbers (measured.py),
                           @figure{ID}: the picture, with its caption from docs/captions.toml and a link to its definition,
                           @live{NAME}: what docs/live/live_pages.js has under that name (in a comment, so that README.md hides it),
                           \\solution ... \\endsolution: what a reader unfolds,
                           the groups of docs/book.md as pages between the book and its pages, which make the sidebar a tree,
                           previous, contents and next at its end, in the order of docs/book.md; of a page below one of these, that one
       page.py --check     every page is in the contents and opens with a question, every picture has a caption; exercises and their
                           commands are counted

Python's standard library only.
"""

import functools
import pathlib
import re
import sys
import tomllib

sys.dont_write_bytecode = True  # no __pycache__ beside the sources
import equations
import measured
from equations import ROOT, read

EXERCISES = 30  # at least, each with a solution by command
MARK = re.compile(r"@figure\{([\w-]+)\}")
LIVE = re.compile(r"^(?:<!-- )?@live\{(\w+)\}(?: -->)?$", flags=re.MULTILINE)
LABEL = re.compile(r"# [^\n]*\{#([\w-]+)\}")
WRITTEN = {"equations", "gallery", "claims"}  # pages that scripts make
BELOW = {"definition": "gallery", "claims": "claims"}  # pages that are not in the contents, by their first word, and the page above


@functools.cache
def contents():
    """[(label, title)] in the order of docs/book.md"""
    return re.findall(r'\\subpage ([\w-]+) "([^"]+)"', read(ROOT / "docs" / "book.md"))


@functools.cache
def captions():
    return tomllib.loads(read(ROOT / "docs" / "captions.toml"))


def named(name):
    """A figure as the papers call it"""
    figure = tomllib.loads(read(ROOT / "verification" / name / "figure.toml"))
    number = figure["figure"]
    return f"{figure['paper']} Fig. {number}" if number[:1].isdigit() else f"{figure['paper']}, {number}"


def picture(name):
    """file, what it is, where more is said"""
    entry = captions()[name]
    if "folder" in entry:
        return f"figures/{entry['folder']}/{name}.svg", "", f"`{entry['again']}` draws it."
    return (f"figures/{name}.svg", f"<b>{named(name)}.</b> ",
            f"\\ref figure-{name} \"Verdicts\", \\ref definition-{name} \"definition, and how to change a parameter\".")


def shown(name):
    """A picture in a page: Doxygen's Markdown"""
    if name not in captions():
        raise ValueError(f"@figure{{{name}}}: docs/captions.toml has no such picture")
    file, title, more = picture(name)
    text = " ".join(captions()[name]["caption"].split())
    return (f"\\image html {pathlib.Path(file).name}\n\n"
            f"<div class=\"seen\">\n{title}{text}\n<span class=\"more\">{more}</span>\n</div>\n")


def live(name):
    """A live part: an empty place for docs/live/live.js, and its scripts"""
    scripts = "".join(f"<script src=\"{file}\"></script>" for file in ("live_scenes.js", "live.js", "live_pages.js"))
    return (f"\\htmlonly <div class=\"live\" data-live=\"{name}\"><noscript><p>Here the fluid would move; your browser runs no "
            f"scripts, and the page stands still.</p></noscript></div>{scripts} \\endhtmlonly")


def ends(text):
    """Previous, contents, next"""
    label = LABEL.match(text)
    title = dict(contents())
    labels = [None, *title, None]
    if not label or label[1] == "book":  # README.md and the contents, before the first
        around = None, labels[1]
    elif label[1] in title:
        at = labels.index(label[1])
        around = labels[at - 1], labels[at + 1]
    elif above := BELOW.get(label[1].partition("-")[0]):
        around = above, None
    else:
        return ""
    links = [f"<span class=\"{kind}\">" + (f"\\ref {here} \"{title[here]}\"" if here else "") + "</span>"
             for kind, here in zip(("previous", "next"), around)]
    links.insert(1, "<span class=\"contents-link\">" + ("" if label and label[1] == "book" else "\\ref book \"Contents\"") + "</span>")
    return "\n\n<div class=\"path\">\n" + "\n".join(links) + "\n</div>\n"


def grouped(text):
    """docs/book.md with a page for each group of its pages"""
    groups = []

    def group(match):
        title, said, entries = match.groups()
        label = "part-" + re.sub(r"\W+", "-", title.lower())
        groups.append(f"\n\\page {label} {title}\n\n{entries}\n<div class=\"path\"><span class=\"contents-link\">\\ref book \"Contents\"</span></div>\n")
        return f"<b>\\subpage {label} \"{title}\"</b>{said}\n\n" + entries.replace("\\subpage", "\\ref")

    text = re.sub(r"^\*\*(.+?)\*\*(.*)\n\n?((?:(?:\d+\.|-) \\subpage .*\n)+)", group, text, flags=re.MULTILINE)
    return text + "".join(groups)


def words(text):
    """The table of the glossary as a list, which fits a phone, each word with an anchor, which the search leads to"""
    head, _, rows = text.partition("| word | meaning | more |\n|---|---|---|\n")
    lines = [head + '<dl class="words">']
    for row in rows.strip().splitlines():
        if not (match := re.fullmatch(r"\| (.+?) \| (.+) \| (\\ref \S+) \|", row)):
            raise ValueError(f"docs/glossary.md: no word, meaning and page in {row}")
        word, meaning, more = match.groups()
        anchor = re.sub(r"[^a-z0-9]+", "-", word.lower()).strip("-")
        lines.append(f"<dt>\\anchor word-{anchor} {word}</dt>\n<dd>{meaning} ({more})</dd>")
    return "\n".join(lines) + "\n</dl>\n"


@functools.cache
def labels():
    """{file: label} of the written pages"""
    return {str(file.relative_to(ROOT)): label[1] for file in equations.pages() if (label := LABEL.match(read(file)))}


def linked(text):
    """The name of a page's file, which is what one sees on GitHub, becomes the page's title, a figure's id the paper's number, a claim's id a word"""
    title = {**dict(contents()), "book": "The book"}

    def link(match):
        label = labels().get(match[2] or match[3])
        return f'\\ref {label} "{title[label]}"' if label in title else match[0]

    text = re.sub(r'\\ref figure-([\w-]+) "\1"', lambda match: f'\\ref figure-{match[1]} "{named(match[1])}"', text)
    text = re.sub(r'\\ref claim-([\w-]+) "\1"', r'\\ref claim-\1 "claim"', text)
    return re.sub(r"\[(((?:docs|theory)/\w+\.md))\]\(\1\)|(?<![\w`(/\[\"])((?:docs|theory)/\w+\.md)(?![\w`\"])", link, text)


def for_doxygen(text):
    """Pages by title, numbers that stay with their signs; its Markdown makes nothing bold that begins or ends with code or a quotation mark, and
    takes an apostrophe within code for the end of a quotation"""
    parts = re.split(r"(^```.*?^```$|^    .*?$)", text, flags=re.DOTALL | re.MULTILINE)
    for at in range(0, len(parts), 2):
        parts[at] = linked(parts[at])
        parts[at] = re.sub(r"(?<=[\d)]) (±|\+-) (?=\d)", "\u00a0±\u00a0", parts[at])
        parts[at] = re.sub(r"(?<![\w.])\d(?:\.\d+)?e\+0\d(?=\s)", lambda number: f"{float(number[0]):g}", parts[at])
        parts[at] = re.sub(r"(?<=[\d)]) %", "\u00a0%", parts[at])
        parts[at] = re.sub(r"\*\*([`\"][^*\n]+|[^*\n]+[`\"])\*\*", r"<b>\1</b>", parts[at])
        parts[at] = re.sub(r"(?<!`)`((?:[^`\n]|\n(?!\n))+)`(?!`)", lambda code: f"`{code[0]}`" if "'" in code[1] else code[0], parts[at])
    return "".join(parts)


def made(file):
    text = equations.labelled(file)
    if file.name == "glossary.md":
        text = words(text)
    text = LIVE.sub(lambda match: live(match[1]), text)
    text = re.sub(r"<!-- @\w+\{[^{}]*\} -->", "", text)  # README.md has its numbers in the text, and the marks beside them
    text = measured.drawn(MARK.sub(lambda match: shown(match[1]), text))
    text = for_doxygen(text)
    # open where scripts are off and on paper; the head of the pages closes them
    text = re.sub(r"^\\solution$", "\\\\htmlonly <details class=\"solution\" open><summary>Solution</summary> \\\\endhtmlonly", text,
                  flags=re.MULTILINE)
    text = re.sub(r"^\\endsolution$", r"\\htmlonly </details> \\endhtmlonly", text, flags=re.MULTILINE)
    text = text.rstrip() + ends(text) + "\n"
    return grouped(text) if file.name == "book.md" else text  # the end of the contents before the pages that follow it


def mistakes():
    labels = [label for label, _ in contents()]
    found = {}
    for file in equations.pages():
        text = read(file)
        where = file.relative_to(ROOT)
        if not (label := LABEL.match(text)):
            yield f"{where}: begins with no heading that has a label"
            continue
        found[label[1]] = text
        if "?" not in text.split("\n\n")[1]:
            yield f"{where}: does not open with its question"
        for name in re.findall(r"\\ref ([\w:-]+:)(?![\w:])", text):
            yield f"{where}: Doxygen takes the colon of \\ref {name} for a part of the name"
        if label[1] != "book" and label[1] not in labels:
            yield f"{where}: docs/book.md has no \\subpage {label[1]}"
        for name in MARK.findall(text):
            if name not in captions():
                yield f"{where}: docs/captions.toml has no picture {name}"
    for label in labels:
        if label not in found and label not in WRITTEN:
            yield f"docs/book.md: no page {label}"
    for name in captions():
        file, _, _ = picture(name)
        if not (ROOT / file).is_file():
            yield f"docs/captions.toml: no picture {file}"
    for name in sorted(file.parent.name for file in (ROOT / "verification").glob("*/figure.toml")):
        if name not in captions():
            yield f"docs/captions.toml: nothing on the figure {name}"
        elif "change" not in captions()[name]:
            yield f"docs/captions.toml: {name}: no change, a parameter to try"
        elif sum(f"@figure{{{name}}}" in text for text in found.values()) < 1:
            yield f"the figure {name} stands in no page: @figure{{{name}}}"
    described = set(re.findall(r"Live\.pages\.(\w+) = ", read(ROOT / "docs" / "live" / "live_pages.js")))
    shown_live = [name for text in [*found.values(), read(ROOT / "README.md")] for name in LIVE.findall(text)]
    if sorted(shown_live) != sorted(described):
        yield f"live_pages.js describes {sorted(described)}; the pages show {sorted(shown_live)}"
    solutions = 0
    for label, text in found.items():
        for exercise in re.split(r"^\*\*\d+\. ", text.partition("\n## Exercises\n")[2], flags=re.MULTILINE)[1:]:
            solution = re.search(r"^\\solution\n(.*?)^\\endsolution$", exercise, flags=re.DOTALL | re.MULTILINE)
            if solution and re.search(r"^    dpdref ", solution[1], flags=re.MULTILINE):
                solutions += 1
            else:
                yield f"{label}: no solution by command to '{exercise.partition('*')[0]}'"
    if solutions < EXERCISES:
        yield f"{solutions} exercises, {EXERCISES} are asked"


def main(arguments):
    if len(arguments) != 1:
        print(__doc__, file=sys.stderr)
        return 2
    if arguments[0] != "--check":
        sys.stdout.write(made(pathlib.Path(arguments[0]).resolve()))
        return 0
    found = list(mistakes())
    for mistake in found:
        print(f"page: {mistake}", file=sys.stderr)
    print(f"{len(contents())} pages in the contents, {len(captions())} pictures")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
