#!/usr/bin/env python3
"""Runs the commands of docs/recorded.toml and keeps what they print, JSON, in figures/recorded/NAME.json, with the command.

usage: record.py --build BUILD [NAME...]     all of them without a name; BUILD holds the built program

A number in a page is drawn from these files, so that running a command again moves the text. Python's standard library only.
"""

import argparse
import json
import pathlib
import shlex
import subprocess
import sys

sys.dont_write_bytecode = True  # no __pycache__ beside the sources
import measured
from measured import ROOT


def printed(command, build):
    """What a command of the book prints, run with the programs in build"""
    program, *arguments = shlex.split(command)
    program = {"dpdref": build / "dpdref", "python3": sys.executable}.get(program, build / pathlib.Path(program).name)
    found = json.loads(subprocess.run([program, *arguments], cwd=ROOT, stdout=subprocess.PIPE, check=True).stdout)
    found.pop("context", None)  # where the benchmark ran: host and path
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("names", nargs="*", metavar="NAME")
    options = parser.parse_args()
    for name in options.names or measured.commands():
        command = measured.commands()[name]
        print(f"{name}: {command}", flush=True)
        file = measured.recorded_file(name)
        file.parent.mkdir(exist_ok=True)
        file.write_text(json.dumps({"command": command, "printed": printed(command, options.build.resolve())}, indent=1) + "\n",
                        encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
