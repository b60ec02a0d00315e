#!/usr/bin/env python3
"""The rooms of src/, from the includes of its files: who sees whom.

usage: rooms.py                every include goes to the room itself or to one that its room stands on, by the header's name
                               alone; header names are unique; exit code 1 with one line per mistake
       rooms.py --draw FILE    the picture of the rooms as an SVG for the book

The build enforces the same (src/CMakeLists.txt): an include from above does not compile. Python's standard library only.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
SOURCE = ROOT / "src"
# what each room says of itself in the picture
WHAT = {"base": "errors, names, files, TOML, HDF5, progress", "model": "state, box, pairs, stages and their parameters",
        "plain": "the papers as code: start reading here", "engine": "the same, fast: cells, vectors, blocks",
        "measure": "observables, recording, statistics", "scene": "what to simulate, read and checked",
        "run": "loop, checkpoints, analysis", "campaign": "jobs, shards, budgets, pictures",
        "figures": "define, run, judge, write", "studies": "stability, work and precision",
        "answers": "state points, exact cases", "interop": "LAMMPS, comparisons with other codes",
        "cli": "the command line", "theory": "the closed forms"}


def stands_on():
    """room -> rooms right below it, as src/CMakeLists.txt builds them"""
    text = (SOURCE / "CMakeLists.txt").read_text(encoding="utf-8")
    below = {}
    for name, rest in re.findall(r"^dpdref_room\((\w+)([^)]*)\)", text, flags=re.M):
        below[name] = [r.removeprefix("room_").removeprefix("dpdref_") for r in re.findall(r"room_\w+|dpdref_theory", rest)]
    below["theory"] = ["model"]
    below["cli"] = [room for room in below if not any(room in others for others in below.values())]
    return below


def all_below(room, below):
    found = set(below[room])
    for other in below[room]:
        found |= all_below(other, below)
    return found


def files():
    """(room, file) of every source"""
    for folder in sorted(path for path in SOURCE.iterdir() if path.is_dir()):
        for file in sorted(folder.rglob("*.[ch]pp")):
            yield folder.name, file
    for file in sorted((ROOT / "theory").glob("*.[ch]pp")):
        yield "theory", file


def arrows():
    """mistakes, and (room, room below) -> how many includes"""
    below, mistakes, count, home = stands_on(), [], {}, {}
    for room, file in files():
        if file.suffix == ".hpp" and room != "theory":
            if file.name in home:
                mistakes.append(f"{file.relative_to(ROOT)}: there is another {file.name} in src/{home[file.name]}")
            home[file.name] = room
    home["version.hpp"] = "base"  # made by CMake
    for room, file in files():
        for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
            match = re.match(r'\s*#include "([^"]+)"', line)
            if not match:
                continue
            header, where = match[1], f"{file.relative_to(ROOT)}:{number}"
            if header.startswith("theory/") or (room == "theory" and (ROOT / "theory" / header).exists()):
                target = "theory"
            elif "/" in header or header not in home:
                mistakes.append(f'{where}: "{header}" is no header of a room by its name alone')
                continue
            else:
                target = home[header]
            if target == room:
                continue
            count[room, target] = count.get((room, target), 0) + 1
            if target not in all_below(room, below):
                mistakes.append(f'{where}: "{header}" is in {target}, which {room} does not stand on')
    return mistakes, count


def levels(below):
    """room -> floor: one above the highest that it stands on"""
    floor = {}

    def of(room):
        if room not in floor:
            floor[room] = 1 + max((of(other) for other in below[room]), default=-1)
        return floor[room]

    for room in below:
        of(room)
    return floor


def draw(count):
    below = stands_on()
    floor = levels(below)
    width, height, gap_x, gap_y, margin = 290, 50, 40, 34, 20
    rows = {}
    for room in below:
        rows.setdefault(floor[room], []).append(room)
    columns = max(len(row) for row in rows.values())
    total_x, total_y = margin * 2 + columns * (width + gap_x) - gap_x, margin * 2 + len(rows) * (height + gap_y) - gap_y
    place = {}
    for level, row in rows.items():
        left = (total_x - len(row) * (width + gap_x) + gap_x) / 2
        for k, room in enumerate(sorted(row)):
            place[room] = (left + k * (width + gap_x), total_y - margin - height - level * (height + gap_y))
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {total_x:.0f} {total_y:.0f}" font-family="sans-serif" '
           'role="img" aria-label="The rooms of the source and the includes between them">',
           '<defs><marker id="head" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="6" markerHeight="6" orient="auto">'
           '<path d="M0 0 8 4 0 8z" fill="#667"/></marker></defs>',
           f'<rect width="{total_x:.0f}" height="{total_y:.0f}" fill="white"/>']
    for room, others in below.items():
        for other in others:
            (x1, y1), (x2, y2) = place[room], place[other]
            out.append(f'<line x1="{x1 + width / 2:.0f}" y1="{y1 + height:.0f}" x2="{x2 + width / 2:.0f}" y2="{y2 - 2:.0f}" '
                       'stroke="#667" stroke-width="1.5" marker-end="url(#head)"/>')
    for room, (x, y) in place.items():
        size = sum(len(file.read_text(encoding="utf-8").splitlines()) for r, file in files() if r == room)
        fill = "#fff3d6" if room == "plain" else "#e8eef7" if room != "theory" else "#e6f3e6"
        uses = ", ".join(f"{other} {n}" for (r, other), n in sorted(count.items()) if r == room)
        out += [f'<g><title>{room}: {size} lines; includes: {uses or "none"}</title>'
                f'<rect x="{x:.0f}" y="{y:.0f}" width="{width}" height="{height}" rx="6" fill="{fill}" stroke="#667"/>',
                f'<text x="{x + width / 2:.0f}" y="{y + 20:.0f}" text-anchor="middle" font-size="15" font-weight="bold" '
                f'fill="#223">{room} <tspan font-weight="normal" font-size="11" fill="#556">{size} lines</tspan></text>',
                f'<text x="{x + width / 2:.0f}" y="{y + 38:.0f}" text-anchor="middle" font-size="11" fill="#223">'
                f'{WHAT.get(room, "")}</text></g>']
    return "\n".join(out) + "\n</svg>\n"


def main(arguments):
    mistakes, count = arrows()
    if arguments[:1] == ["--draw"] and len(arguments) == 2:
        pathlib.Path(arguments[1]).write_text(draw(count), encoding="utf-8")
        return 0
    if arguments:
        sys.exit(__doc__)
    for mistake in mistakes:
        print(mistake)
    print(f"{len(stands_on())} rooms, {sum(count.values())} includes between them, {len(mistakes)} wrong")
    return 1 if mistakes else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
