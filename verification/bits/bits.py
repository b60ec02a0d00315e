#!/usr/bin/env python3
"""The bits of a revision: every example scene runs for some steps, and what it ends with is compared with bits.json beside this script:
the hash of all final positions and velocities (program `bits_of_state`), and that of all that `dpdref run --json` measures, less
run times. They are the same on every machine. A change that moves them raises a revision (src/base/version.hpp.in), so that no cached result is taken for
a new one, and calls --write, which refuses without.

usage: bits.py BUILD [--under COMMAND] [--node | --write]
    BUILD      a folder of a build; its program and bits_of_state are run, by COMMAND where another processor is emulated
               ("qemu-x86_64 -cpu Nehalem", "qemu-aarch64 -L ROOT")
    --node     the engine of the live pages in node, in place of them: states alone
Exit code 0, 1 with a difference, 77 where --node finds no engine, emscripten or node. Python's standard library only.
"""

import argparse
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
SCENES = HERE.parent / "scenes"
HASHES = HERE / "bits.json"
SMALL = ["box.length=[5,5,5]"]
# scene and what else names the case -> steps, overrides, overrides of what is measured
CASES = {
    "coarse_grained": (60, SMALL + ["sample.radial_distribution.range=2"],
                       ["sample.mean_square_displacement={spacing=0.1,longest=0.4,origins=0.2}", "sample.bond_order.interval=20"]),
    "ideal_gas_rest": (60, SMALL, ["sample.mean_square_displacement.longest=3"]),
    "ideal_gas_rest exponential": (60, SMALL + ["shardlow.scheme=exponential"], ["sample.mean_square_displacement.longest=3"]),
    "ideal_gas_shear": (60, ["box.length=[5,10,5]"], []),
    "lennard_jones": (60, ["box.length=[5,5,5]"], []),
    "lowe_gas": (60, ["box.length=[5,10,5]"], []),
    "marsh_yeomans": (60, ["box.length=[40,40]"], []),
    "poiseuille": (30, ["coarse_graining.length=[10,20,10]"], []),
    "rescaling": (30, SMALL, ["sample.mean_square_displacement={spacing=0.5,longest=1,origins=0.5}"]),
    "rescaling monte_carlo": (30, SMALL + ["rescale.mode=monte_carlo"],
                              ["sample.mean_square_displacement={spacing=0.5,longest=1,origins=0.5}"]),
    "soft_fluid": (30, ["box.length=[5,10,5]"], []),
    "learn/channel": (30, [], []),
    "learn/euler": (60, [], []),
    "learn/euler_fluid_s1": (60, [], []),
    "learn/gas": (60, [], []),
    "learn/opposed": (30, [], []),
    "learn/pair": (200, [], []),
    "learn/shear": (60, [], []),
    "learn/soft": (30, [], ["sample.mean_square_displacement={spacing=0.1,longest=0.4,origins=0.2}"]),
    "live/fluid": (30, [], []),
    "live/freeze": (20, [], ["sample.mean_square_displacement={spacing=0.1,longest=0.2,origins=0.1}", "sample.bond_order.interval=10"]),
    "live/pair": (200, [], []),
    "live/rescale": (20, [], []),
    "live/shear": (30, [], []),
    "live/step": (30, [], []),
    "live/step_s1": (30, [], []),
}

IN_NODE = r"""
const [engine, text, steps, overrides] = process.argv.slice(2)
const files = require("fs")
require(engine)({ wasmBinary: files.readFileSync(engine.replace(/js$/, "wasm")) }).then(module => {
    const call = (name, result, types) => module.cwrap("live_" + name, result, types)
    const scene = call("begin", "number", ["string", "string"])(files.readFileSync(text, "utf8"), overrides)
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


def output_of(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"bits: {shlex.join(map(str, command))}: exit code {done.returncode}: {done.stderr.strip()}")
    return done.stdout


def hash_of(text):
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def scene_of(case):
    return SCENES / f"{case.split()[0]}.toml"


def natively(build, under):
    """Hashes of a case by the programs of a build."""
    def both(case):
        steps, overrides, measured = CASES[case]
        state = output_of(*under, build / "verification" / "bits_of_state", scene_of(case), steps, *overrides)
        step = tomllib.loads(scene_of(case).read_text(encoding="utf-8"))["time"]["step"]
        keys = [*overrides, *measured, f"time.equilibration={2 * step!r}", f"time.duration={steps * step!r}"]
        result = json.loads(output_of(*under, build / "dpdref", "run", scene_of(case), "--json", *[w for key in keys for w in ("--set", key)]))
        measured = {name: result[name] for name in ("counters", "quantities", "curves") if name in result}
        return {"state": hash_of(state), "results": hash_of(json.dumps(measured, sort_keys=True))}
    return both


def revision_of(build, under):
    return re.search(r"revision ([\d.]+):", output_of(*under, build / "dpdref", "--version"))[1]


def in_node(build):
    engine, node = build / "live" / "live_engine.js", shutil.which("node") or shutil.which("nodejs")
    if not node or not shutil.which("emcc") or not engine.is_file():
        print("bits: skipped, no emscripten, node or engine, which `cmake --build BUILD --target live_engine` makes", file=sys.stderr)
        sys.exit(77)
    subprocess.run(["cmake", "--build", build, "--target", "live_engine"], check=True, stdout=subprocess.DEVNULL)
    folder = tempfile.TemporaryDirectory()
    script = pathlib.Path(folder.name) / "bits.js"
    script.write_text(IN_NODE, encoding="utf-8")

    def state(case, _kept=folder):
        steps, overrides, _ = CASES[case]
        return {"state": hash_of(output_of(node, script, engine, scene_of(case), steps, "\n".join(overrides)))}
    return state


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--under", type=shlex.split, default=[])
    mode = parser.add_mutually_exclusive_group()
    for flag in ("--node", "--write"):
        mode.add_argument(flag, action="store_true")
    options = parser.parse_args()
    build = options.build.resolve()
    hashes = in_node(build) if options.node else natively(build, options.under)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        found = dict(zip(CASES, pool.map(hashes, CASES)))
    expected = json.loads(HASHES.read_text(encoding="utf-8"))
    before = expected.pop("revision")
    revision = before if options.node else revision_of(build, options.under)
    wrong = [f"{case}: {what}" for case, both in found.items() for what, value in both.items() if expected.get(case, {}).get(what) != value]
    if options.write:
        if revision == before and any(line.partition(": ")[0] in expected for line in wrong):
            sys.exit(f"bits: not written: {', '.join(wrong)} moved, and the revision is still {before}: raise it in src/base/version.hpp.in")
        HASHES.write_text(json.dumps({**found, "revision": revision}, indent=1, sort_keys=True) + "\n", encoding="utf-8")
        return 0
    wrong += [f"{case}: no case" for case in expected.keys() - CASES.keys()]
    for line in wrong:
        print(f"bits: {line} differs from {HASHES.name}", file=sys.stderr)
    if revision != before:
        print(f"bits: {HASHES.name} is of revision {before}, the program of {revision}: --write", file=sys.stderr)
    count = sum(map(len, found.values()))
    print(f"{count - len(wrong)} of {count} hashes of {len(found)} scenes are those of {HASHES.name}")
    return 1 if wrong or revision != before else 0


if __name__ == "__main__":
    sys.exit(main())
