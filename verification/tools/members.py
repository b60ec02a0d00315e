#!/usr/bin/env python3
"""Every public member of every struct and class in the headers of src and theory has a comment of its own: /// above it or ///<
behind it.

usage: members.py        one line per member without one; exit code 1 if there is any

Not asked for: constructors, destructors and operators that are deleted or defaulted; members of the stages that are explained
once, at WithoutParameters and StageKind. Python's standard library only.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
OPENS = re.compile(r"^\s*(?:template\s*<[^;{]*>\s*)?(?:requires[^;{]*)?(struct|class)\s+(?:\[\[\w+\]\]\s*)?([\w:]+)[^;()=]*\{")
ACCESS = re.compile(r"^\s*(public|private|protected):")
STAGES = {"kind", "read", "range", "temperature", "set_arguments"}  # WithoutParameters says what they are


def without_texts(line):
    """No strings, characters and comments, so that braces count; comments are looked at before."""
    line = re.sub(r'"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])\'', '""', line)
    return line.partition("//")[0]


def name_of(declaration):
    """of a member: the word before its parameters, its value or its end"""
    text = re.sub(r"^\s*template\s*<[^;{]*?>\s", "", declaration)
    if pointer := re.search(r"\(\*(\w+)\)\(", text):
        return pointer[1]
    if "operator" in text:
        return "operator"
    head = re.split(r"[({=;]", text, maxsplit=1)[0]
    words = re.findall(r"\w+", re.sub(r"<[^<>]*>|\[[^\]]*\]", "", head))
    return words[-1] if words else ""


def unexplained(file):
    """[(line, struct, member)]"""
    depth, open_types, declaration, start, explained, comment = 0, [], "", 0, False, False
    for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
        code = without_texts(line)
        here = open_types[-1] if open_types and open_types[-1]["depth"] == depth else None
        if line.strip().startswith("///") and not line.strip().startswith("///<"):
            comment = True
            continue
        if not code.strip():
            if line.strip() and "///<" in line:
                explained = True
            elif not line.strip() and not declaration:
                comment = False
            continue
        if here and (access := ACCESS.match(code)):
            here["public"] = access[1] == "public"
            comment = False
            continue
        opens = OPENS.match(code)
        if opens and code.rstrip().endswith("{"):
            depth += code.count("{") - code.count("}")
            hidden = bool(open_types) and not open_types[-1]["public"]
            local = here is None and bool(open_types)  # within a function
            open_types.append({"depth": depth, "name": opens[2], "public": opens[1] == "struct" and not hidden and not local})
            declaration, comment = "", False
            continue
        if here and here["public"] and not declaration.strip():
            start, explained = number, comment
        inside = here is not None
        depth += code.count("{") - code.count("}")
        if inside:
            declaration += code + "\n"
            explained = explained or "///<" in line
        while open_types and depth < open_types[-1]["depth"]:
            open_types.pop()
            declaration = ""
        if declaration.strip() and open_types and depth == open_types[-1]["depth"] and re.search(r"[;}]\s*$", code):
            owner = open_types[-1]
            # a comment may follow on the next lines
            if owner["public"] and not explained:
                yield start, owner["name"], declaration
            declaration, comment = "", False
        elif not inside:
            comment = False


def mistakes():
    for folder in ("src", "theory"):
        for file in sorted((ROOT / folder).rglob("*.hpp")):
            for line, owner, declaration in unexplained(file):
                name = name_of(declaration)
                flat = " ".join(declaration.split())
                special = re.search(r"= (?:delete|default);|^~|^(?:friend|using|static_assert|class|struct|enum)\b", flat)
                if special or name in STAGES or f"~{owner}" in flat or not name:
                    continue
                yield f"{file.relative_to(ROOT)}:{line}: {owner}::{name} has no comment"


def main():
    found = list(mistakes())
    for mistake in found:
        print(f"members: {mistake}", file=sys.stderr)
    print(f"{len(found)} members without a comment")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
