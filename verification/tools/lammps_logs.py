#!/usr/bin/env python3
"""How many LAMMPS logs `dpdref compare` reads right.

    python3 verification/tools/lammps_logs.py --dpdref build/release/dpdref DIRECTORY

takes every file log.* below the directory, finds the columns and rows of its last thermo table by a rule of its own, and
holds against them what `compare --json` says that it read. Prints those that differ and the count; exit code 1 if any does.
Python's standard library only.
"""

import argparse
import json
import pathlib
import re
import subprocess
import sys


def number(word):
    try:
        float(word)
        return True
    except ValueError:
        return False


def columns(names):
    """With one column of steps or times, the others of them go."""
    return len(names) - max(0, sum(name.lower() in ("step", "time", "timestep") for name in names) - 1)


def last_table(text):
    """The header follows the line of memory, or begins with Step; rows have as many numbers. Of multi the blocks, of yaml the lists."""
    found, names, waits = None, None, False
    lines = text.split("\n")
    for k, line in enumerate(lines):
        words = line.split()
        if not words:
            continue
        follows = (lines[k + 1].split() or ["-"])[0] if k + 1 < len(lines) else "-"
        if line.startswith(("Per MPI rank memory", "Memory usage per processor")):
            waits, names = True, None
        elif words[0] == "Loop":
            names = None
        elif re.match("-+ Step ", line):
            if waits or names is None:
                names, waits, rest = ["Step"], False, k + 1
                while "=" in lines[rest] and " Step " not in lines[rest]:
                    names += re.findall(r"(\S+)\s+=", lines[rest])
                    rest += 1
                found = [columns(names), 0]
            found[1] += 1
        elif line.startswith("keywords:"):
            names, waits = re.findall(r"[^'\[\], ]+", line[9:]), False
            found = [columns(names), 0]
        elif line.strip().startswith("- [") and names:
            found[1] += 1
        elif (waits and words[0][0] != "-" or names is None and words[0] == "Step") and (number(follows) or follows == "Loop"):
            names, waits, found = words, False, [columns(words), 0]
        elif names and len(words) == len(names) and all(map(number, words)):
            found[1] += 1
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory", type=pathlib.Path)
    parser.add_argument("--dpdref", default="build/release/dpdref")
    options = parser.parse_args()
    tables, right = 0, 0
    for path in sorted(path for path in options.directory.rglob("log.*") if path.is_file()):
        table = last_table(path.read_text(errors="replace"))
        if not table or table[1] == 0:
            continue
        tables += 1
        run = subprocess.run([options.dpdref, "compare", path, "--answer", "gw-0.04", "--json"],
                             capture_output=True, text=True, check=False)
        read = [[file["columns"], file["samples"]] for file in json.loads(run.stdout)["files"]] if run.stdout else []
        right += table in read[:1]
        if table not in read[:1]:
            print(f"{path}: columns and rows {table}, read {read} {run.stderr.strip()}")
    print(f"{right} of {tables} logs with a table are read right")
    return int(right != tables)


if __name__ == "__main__":
    sys.exit(main())
