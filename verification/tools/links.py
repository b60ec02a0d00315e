#!/usr/bin/env python3
"""Broken links and pictures in a folder of HTML pages, without a network.

usage: links.py FOLDER. Exit code 1 with one line per broken link: a missing file, a missing anchor, or a script, style
or picture that would be fetched from elsewhere. Python's standard library only.
"""

import html.parser
import pathlib
import sys
import urllib.parse

FETCHED = {("img", "src"), ("script", "src"), ("link", "href"), ("object", "data"), ("iframe", "src"), ("source", "src")}


class Page(html.parser.HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.links, self.anchors = [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        for key, value in attributes:
            if key == "id" or (tag == "a" and key == "name"):
                self.anchors.add(value)
            elif value and (key == "href" or (tag, key) in FETCHED):
                self.links.append((tag, key, value))


def main(folder):
    pages = {file.resolve(): Page(file.read_text(encoding="utf-8", errors="replace")) for file in folder.rglob("*.html")}
    broken, count = [], 0
    for file, page in sorted(pages.items()):
        for tag, key, link in page.links:
            url = urllib.parse.urlsplit(link)
            where = f"{file.relative_to(folder.resolve())}: {link}"
            if url.scheme == "javascript":
                continue
            if url.scheme or url.netloc:
                if (tag, key) in FETCHED and url.scheme != "data":
                    broken.append(f"{where}: fetched from elsewhere")
                continue
            count += 1
            target = (file.parent / urllib.parse.unquote(url.path)).resolve() if url.path else file
            if not target.exists():
                broken.append(f"{where}: no such file")
            elif url.fragment and target in pages and urllib.parse.unquote(url.fragment) not in pages[target].anchors:
                broken.append(f"{where}: no such anchor")
    for line in dict.fromkeys(broken):
        print(line)
    print(f"{len(pages)} pages, {count} links, {len(broken)} broken", file=sys.stderr)
    return 1 if broken or not pages else 0


if __name__ == "__main__":
    if len(sys.argv) != 2 or not pathlib.Path(sys.argv[1]).is_dir():
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    sys.exit(main(pathlib.Path(sys.argv[1])))
