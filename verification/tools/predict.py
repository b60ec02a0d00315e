"""What the closed forms say in the cells of a figure, before it is run.

    python3 verification/tools/predict.py map-memory --dpdref build/ci/dpdref > predictions.csv

Reads verification/work-precision/ID/figure.toml: every curve, value and criterion whose theory is a closed form becomes a
line. Nothing is simulated. The parameters are those that the program passes (src/figures/theory_arguments.cpp): those of
the thermostat, and of the box the side of the cube with the same volume."""

import argparse
import csv
import json
import math
import pathlib
import subprocess
import sys
import tomllib

KEYS = {"shardlow": {"friction": "gamma", "weight": "weight", "scheme": "scheme"}, "lowe": {"rate": "Gamma"}}


def put(scene, dotted, value):
    *tables, key = dotted.split(".")
    for table in tables:
        scene = scene.setdefault(table, {})
    scene[key] = value


def arguments(scene):
    length = scene["box"]["length"]
    result = {"d": scene["dimension"], "n": scene["particles"]["density"], "dt": scene["time"]["step"],
              "box": math.prod(length) ** (1.0 / len(length))}
    stage = next(s for s in scene["stages"] if s in KEYS)
    for key, name in KEYS[stage].items():
        if key in scene.get(stage, {}):
            result[name] = scene[stage][key]
    return [f"{name}={value}" for name, value in result.items()]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("figure")
    parser.add_argument("--dpdref", required=True, help="the program")
    options = parser.parse_args()
    root = pathlib.Path(__file__).resolve().parents[1] / "work-precision"
    figure = tomllib.loads((root / options.figure / "figure.toml").read_text())
    out = csv.writer(sys.stdout, lineterminator="\n")
    out.writerow(["curve", "x", "quantity", "theory", "predicted", "numerical_error"])
    for curve in figure["curve"]:
        for value in curve["values"]:
            scene = json.loads(json.dumps(figure["scene"]))
            for key, what in curve.get("set", {}).items():
                put(scene, key, what)
            put(scene, curve["vary"], value)
            for compared in curve["compare"]:
                if compared["theory"] in ("value", "previous") or ":" in compared["theory"]:
                    continue
                said = subprocess.run([options.dpdref, "theory", compared["theory"], "--json", *arguments(scene)],
                                      check=True, capture_output=True, text=True)
                parts = json.loads(said.stdout)
                parts = parts.get("parts", parts)
                out.writerow([curve["name"], value, compared["quantity"], compared["theory"],
                              f"{parts['value']:.6g}", f"{parts['numerical_error']:.1g}"])
                sys.stdout.flush()


if __name__ == "__main__":
    main()
