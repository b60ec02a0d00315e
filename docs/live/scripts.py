#!/usr/bin/env python3
"""The scripts of the live pages that are made: live_scenes.js, the scenes of verification/scenes/live, and live_engine.js, their
engine: its script as text, which the page runs and gives to its workers, and its WebAssembly, packed by gzip, so that both come from the
file system.

usage: scripts.py FOLDER [ENGINE]     FOLDER as Doxygen made it; without ENGINE the pages stand still, and the script says so.
Python's standard library only.
"""

import base64
import gzip
import json
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


def main(folder, engine=None):
    folder = pathlib.Path(folder)
    text = "// this book was built without emscripten: its live pages stand still\n"
    if engine:
        engine = pathlib.Path(engine)
        packed = base64.b64encode(gzip.compress(engine.with_suffix(".wasm").read_bytes(), mtime=0)).decode()
        parts = {"script": engine.read_text(encoding="utf-8"), "packed": packed}
        (folder / "live_engine.js").write_text(f"window.liveEngine = {json.dumps(parts)}\n", encoding="utf-8")
        scenes = {file.stem: file.read_text(encoding="utf-8") for file in sorted((ROOT / "verification/scenes/live").glob("*.toml"))}
        text = f"window.liveScenes = {json.dumps(scenes, indent=1)}\n"
    (folder / "live_scenes.js").write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
