#!/usr/bin/env python3
"""The engine of the live pages against the native one: the example scenes run in node, and final positions and velocities are compared
bit by bit. EXCEPTIONS lists the scenes that differ, and why; one that is equal all the same is a failure, too.

usage: bits.py BUILD     where the target live_engine was built once it is brought up to date first. Exit code 0, 1 with a difference that
                         is not listed (or the reverse), 77 without that target, emscripten or node. Python's standard library only.
"""

import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENES = ROOT / "verification" / "scenes"
SMALL = ["box.length=[5,5,5]"]
# scene and what else names the case -> steps, overrides
CASES = {
    "coarse_grained": (60, SMALL + ["sample.radial_distribution.range=2"]),
    "ideal_gas_rest": (60, SMALL),
    "ideal_gas_shear": (60, ["box.length=[5,10,5]"]),
    "ideal_gas_rest exponential": (60, SMALL + ["shardlow.scheme=exponential"]),
    "lennard_jones": (60, ["box.length=[5,5,5]"]),
    "lowe_gas": (60, ["box.length=[5,10,5]"]),
    "marsh_yeomans": (60, ["box.length=[40,40]"]),
    "poiseuille": (30, ["coarse_graining.length=[10,20,10]"]),
    "rescaling": (30, SMALL),
    "soft_fluid": (30, ["box.length=[5,10,5]"]),
    "learn/channel": (30, []),
    "live/fluid": (30, []),
    "live/step": (30, []),
    "live/step_s1": (30, []),
    "live/shear": (30, []),
    "live/freeze": (20, []),
    "live/rescale": (20, []),
    "live/pair": (200, []),
}
# scene -> why its bits differ
EXCEPTIONS = {
    "ideal_gas_rest exponential": "expm1 of the C library",
    "poiseuille": "cbrt of the C library, in the sides of the box",
}

IN_NODE = r"""
const [engine, text, steps, overrides] = process.argv.slice(2)
require(engine)().then(module => {
    const call = (name, result, types) => module.cwrap("live_" + name, result, types)
    const scene = call("begin", "number", ["string", "string"])(require("fs").readFileSync(text, "utf8"), overrides)
    const fail = () => { console.error(call("message", "string", [])()); process.exit(1) }
    if (!scene) fail()
    if (call("advance", "number", ["number", "number"])(scene, Number(steps)) > 1) fail()
    const { particles, dimension } = JSON.parse(call("state", "string", ["number"])(scene))
    for (const name of ["positions", "velocities"]) {
        const at = call(name, "number", ["number"])(scene)
        const words = new BigUint64Array(module.HEAPF64.buffer, at, particles * dimension)
        let lines = ""
        for (const word of words) lines += word.toString(16).padStart(16, "0") + "\n"
        process.stdout.write(lines)
    }
})
"""


def main(build):
    node = shutil.which("node") or shutil.which("nodejs")
    engine, native = build / "live" / "live_engine.js", build / "verification" / "live_bits"
    if not node or not shutil.which("emcc") or not engine.is_file():
        print("live bits: skipped, no emscripten, node or engine, which `cmake --build BUILD --target live_engine` makes", file=sys.stderr)
        return 77
    subprocess.run(["cmake", "--build", build, "--target", "live_engine"], check=True, stdout=subprocess.DEVNULL)
    wrong, equal = [], 0
    with tempfile.TemporaryDirectory() as folder:
        script = pathlib.Path(folder) / "bits.js"
        script.write_text(IN_NODE, encoding="utf-8")
        for name, (steps, overrides) in CASES.items():
            scene = SCENES / f"{name.split()[0]}.toml"
            ours = subprocess.run([native, scene, str(steps), *overrides], check=True, stdout=subprocess.PIPE, text=True).stdout.split()
            theirs = subprocess.run([node, script, engine, scene, str(steps), "\n".join(overrides)], check=True, stdout=subprocess.PIPE,
                                    text=True).stdout.split()
            if len(ours) != len(theirs):
                wrong.append(f"{name}: {len(ours)} numbers natively, {len(theirs)} in node")
                continue
            differing = sum(a != b for a, b in zip(ours, theirs))
            print(f"{name}: {len(ours)} numbers, {differing} differ" + (f" ({EXCEPTIONS[name]})" if name in EXCEPTIONS else ""))
            equal += differing == 0
            if (differing > 0) != (name in EXCEPTIONS):
                wrong.append(f"{name}: {differing} of {len(ours)} numbers differ" if differing else f"{name}: equal, but listed as an exception")
    for line in wrong:
        print(f"live bits: {line}", file=sys.stderr)
    print(f"{equal} of {len(CASES)} scenes end with the native bits")
    return 1 if wrong else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(pathlib.Path(sys.argv[1]).resolve()))
