#!/usr/bin/env python3
"""The index of the book's search, from its pages: what docs/reader.js looks through.

usage: search_index.py FOLDER     FOLDER of HTML pages as Doxygen made them; writes FOLDER/search_index.js

One entry per page, per section with an anchor and per word of the glossary: address, kind (KINDS), title, title of its page, its text (of code
the names and first words only), and how many links of the book lead to it. Python's standard library only.
"""

import collections
import html.parser
import json
import pathlib
import re
import sys

HEADINGS = ("h1", "h2", "h3", "h4")
# lists that Doxygen makes of what stands elsewhere, and listings of sources
LISTS = re.compile(r"(.*_source|annotated|classes|files|functions.*|globals.*|hierarchy|pages|namespace.*|dir_.*)\.html")
CODE = re.compile(r"(struct|class|union|namespace).*\.html|.*_8[a-z]+\.html")
CODE_TEXT = 200  # characters
LINK = re.compile(r' href="([^":]+)"')
KINDS = (("figure-", "figure"), ("eq_", "equation"), ("word-", "word"), ("claim-", "claim"))  # by the anchor


class Sections(html.parser.HTMLParser):
    """[anchor, title, text] of a page; the first is the page itself"""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.found, self.anchor = [["", "", ""]], ""
        self.heading, self.inside, self.title, self.skip, self.word = None, 0, False, 0, False
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        of = dict(attributes)
        kind = of.get("class") or ""
        if tag in ("script", "style", "object") or self.skip:
            self.skip += tag not in ("br", "img", "input", "hr", "meta", "link")
        elif tag == "div":
            if self.inside:
                self.inside += 1
            elif kind == "contents":
                self.inside = 1
            if kind in ("title", "headertitle"):
                self.title = True
            if kind in ("path", "toc interactive", "toc", "fragment") and self.inside:
                self.skip, self.inside = 1, self.inside - 1
        elif tag == "a" and (of.get("id") or of.get("name")) and self.inside:
            self.anchor = of.get("id") or of.get("name")
            if self.anchor.startswith("word-"):
                self.found.append([self.anchor, "", ""])
                self.word = True
        elif tag in HEADINGS and self.inside and kind != "groupheader":
            self.heading = ""
            self.anchor = of.get("id") or self.anchor

    def handle_endtag(self, tag):
        if self.skip:
            self.skip -= 1
        elif tag == "div":
            self.inside = max(0, self.inside - 1)
            self.title = False
        elif tag == "dt":
            self.word = False
        elif tag in HEADINGS and self.heading is not None:
            title = " ".join(self.heading.replace("\u25c6", "").split())
            if title and self.anchor:
                self.found.append([self.anchor, title, ""])
            self.heading, self.anchor = None, ""

    def handle_data(self, text):
        if self.skip:
            return
        if self.title:
            self.found[0][1] += text
        elif self.heading is not None:
            self.heading += text
        elif self.word:
            self.found[-1][1] += text
        elif self.inside:
            self.found[-1][2] += text + " "


def kind_of(file, anchor):
    if CODE.fullmatch(file.name):
        return "code"
    if file.name.startswith("definition-"):
        return "definition"
    return next((kind for start, kind in KINDS if anchor.startswith(start)), "section" if anchor else "page")


def entries(file):
    sections = Sections(file.read_text(encoding="utf-8", errors="replace")).found
    page = " ".join(sections[0][1].split())
    for anchor, title, text in sections:
        kind = kind_of(file, anchor)
        text = " ".join(re.sub(r"\\[\[(].*?\\[\])]", " ", text, flags=re.DOTALL).split())
        if kind == "code":
            text = text[:CODE_TEXT]
        if title:
            yield file.name + (f"#{anchor}" if anchor else ""), kind, " ".join(title.split()), page, text


def main(folder):
    files = [file for file in sorted(folder.glob("*.html")) if not LISTS.fullmatch(file.name)]
    links = collections.Counter(link for file in files for link in set(LINK.findall(file.read_text(encoding="utf-8", errors="replace"))))
    found = [[*entry, links[entry[0]]] for file in files for entry in entries(file)]
    (folder / "search_index.js").write_text("bookIndex = " + json.dumps(found, ensure_ascii=False, separators=(",", ":")) + "\n",
                                            encoding="utf-8")
    print(f"{len(found)} entries in the index of the search")
    return 0


if __name__ == "__main__":
    if len(sys.argv) != 2 or not pathlib.Path(sys.argv[1]).is_dir():
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    sys.exit(main(pathlib.Path(sys.argv[1])))
