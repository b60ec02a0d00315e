#!/usr/bin/env python3
"""Outputs of other codes, kept in outputs/, each judged by `dpdref compare`: the table of docs/judged.md.

usage: judged.py PROGRAM [--check]      PROGRAM: dpdref

Writes figures/judged/judged.csv and .md; which file is of which code, and against what it is judged, is in judged.toml.
--check compares the verdicts with those of judged.csv instead, and exports, runs and judges the decks of LAMMPS again
where an `lmp` with the package DPD-BASIC is on the PATH. Python's standard library only.
"""
import argparse
import csv
import io
import json
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
TABLE = HERE.parents[1] / "figures" / "judged" / "judged.csv"
COLUMNS = ["output", "code", "version", "ran", "quantity", "value", "error", "reference", "reference_error", "z", "verdict", "against", "note"]


def call(*command, codes=(0,), directory=None):
    done = subprocess.run([str(part) for part in command], cwd=directory, capture_output=True, text=True, check=False)
    if done.returncode not in codes:
        sys.exit(f"judged: {' '.join(map(str, command))}: exit code {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done.stdout


def judge(program, files, output):
    """What compare says of files of an output, a table of judged.toml."""
    renamed = [word for name in output.get("as", []) for word in ("--as", name)]
    discard = ["--discard", output["discard"]] if "discard" in output else []
    sheared = ["--sheared"] if output.get("sheared") else []
    return json.loads(call(program, "compare", *files, *output["against"], *renamed, *discard, *sheared, "--json", codes=(0, 1)))


def rows(program, outputs):
    """The table, each row a dictionary of text; digits by the error."""
    table = []
    for output in outputs:
        folder = HERE / "outputs" / output["output"]
        report = judge(program, sorted(folder.iterdir()), output)
        if report["differences"]:
            sys.exit(f"judged: {output['output']}: another fluid: {report['differences']}")
        notes = [line.split(": ", 1) for line in report["hints"] + report["notes"]]
        for c in report["comparisons"] + report["without_reference"]:
            known = "reference" in c
            error = min(e for e in (c["error"], c.get("reference_error", math.inf)) if e > 0.0)
            digits = max(0, 1 - math.floor(math.log10(error)))
            numbers = {name: f"{c[name]:.{digits}f}" if name in c else "" for name in ("value", "error", "reference", "reference_error")}
            table.append({"output": output["output"], "code": output["code"], "version": output["version"], "ran": output["ran"],
                          "quantity": c["quantity"], **numbers, "z": f"{c['z']:.2f}" if known else "",
                          "verdict": c["verdict"] if known else "no reference", "against": report["reference"].removeprefix("answer "),
                          "note": "; ".join(note for name, note in notes if name == c["quantity"])})
    return table


def page(table):
    lines = ["<!-- as written by verification/judged/judged.py -->",
             "| code | quantity | verdict | its value | reference | z | state point |", "|---" * 7 + "|"]
    notes, previous = [], None
    for row in table:
        new = row["output"] != previous
        previous = row["output"]
        code = f"{row['code']} ({row['version']}; {row['ran']})" if new else ""
        values = [f"{row[name]}&nbsp;±&nbsp;{row[error]}" if row[name] else "" for name, error in (("value", "error"), ("reference", "reference_error"))]
        lines.append("| " + " | ".join([code, row["quantity"], row["verdict"], *values, row["z"], f"`{row['against']}`" if new else ""]) + " |")
        note = f"- {row['code']}, {row['quantity']}: {row['note']}"
        if row["note"] and note not in notes:
            notes.append(note)
    return "\n".join([*lines, "", "What `compare` says beside these:", "", *notes]) + "\n"


def changed(table):
    """Rows whose verdict is not the one in judged.csv, either way."""
    key = ("output", "quantity", "verdict", "against")
    with TABLE.open(encoding="utf-8", newline="") as file:
        kept = {tuple(row[name] for name in key) for row in csv.DictReader(file)}
    return sorted(kept ^ {tuple(row[name] for name in key) for row in table})


def on_the_path(program, outputs):
    """The decks on the `lmp` of the PATH, short; number of decks, and what disagrees. None: it cannot run any."""
    lmp = shutil.which("lmp")
    packages = set(call(lmp, "-h").split()) if lmp else set()
    decks = [output for output in outputs if "deck" in output and output["deck"]["package"] in packages]
    wrong = []
    for output in decks:
        with tempfile.TemporaryDirectory() as folder:
            deck, scene = pathlib.Path(folder) / "deck", pathlib.Path(folder) / "scene.toml"
            scene.write_text(call(program, "answer", output["deck"]["answer"], "--scene", output["deck"]["scene"]))
            call(program, "export", "lammps", scene, "--set", "time.duration=40.0", "--set", "sample.interval=10", "--out", deck)
            call(lmp, "-in", "in.dpdref", "-screen", "none", codes=(0, 1), directory=deck)
            log = (deck / "log.lammps").read_text(encoding="utf-8")
            if "ERROR" in log:
                line = next(line for line in log.splitlines() if "ERROR" in line)
                if "Lost atoms" in line and output["deck"]["scene"] == "shear":
                    print("judged: this lmp loses particles when it flips a sheared box: see Releases in docs/lammps.md")
                else:
                    wrong.append(f"{output['deck']['answer']}, {output['deck']['scene']}: {line}")
                continue
            files = [deck / file.name for file in sorted((HERE / "outputs" / output["output"]).iterdir())]
            for c in judge(program, files, output)["comparisons"]:
                if c["verdict"] == "disagrees":
                    wrong.append(f"{output['deck']['answer']}, {output['deck']['scene']}: {c['quantity']} {c['value']:.6g}, reference {c['reference']:.6g}")
    return (len(decks), wrong) if decks else None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--check", action="store_true")
    given = parser.parse_args()
    program = given.program.resolve()
    outputs = tomllib.loads((HERE / "judged.toml").read_text(encoding="utf-8"))["judged"]
    table = rows(program, outputs)
    if not given.check:
        text = io.StringIO()
        writer = csv.DictWriter(text, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)
        TABLE.parent.mkdir(exist_ok=True)
        TABLE.write_text(text.getvalue(), encoding="utf-8")
        TABLE.with_suffix(".md").write_text(page(table), encoding="utf-8")
        print(f"judged: {len(table)} verdicts on {len(outputs)} kept outputs written")
        return 0
    wrong = [f"not in both judged.csv and what compare says: {', '.join(row)}" for row in changed(table)]
    if TABLE.with_suffix(".md").read_text(encoding="utf-8") != page(table):
        wrong.append("judged.md is not what compare says now; write it again: judged.py PROGRAM")
    print(f"judged: {len(table)} verdicts on {len(outputs)} kept outputs")
    live = on_the_path(program, outputs)
    if live is None:
        print("judged: no lmp with the package DPD-BASIC on the PATH: the decks were not run")
    else:
        print(f"judged: {live[0]} decks run on the lmp of the PATH")
        wrong += live[1]
    for text in wrong:
        print(f"judged: {text}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
