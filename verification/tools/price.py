#!/usr/bin/env python3
"""What the figures of the papers cost (docs/performance.md): all of them at the papers' budget, two runs at a time and nothing of them cached, with
one run for each point of PK2006.

usage: price.py DPDREF        prints JSON, in seconds; definitions, runs and figures stay in price/ beside the program, which must not be there

Python's standard library only.
"""

import json
import pathlib
import re
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
JOBS = 2


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    program = pathlib.Path(sys.argv[1]).resolve()
    place = program.parent / "price"
    if place.exists():
        sys.exit(f"price.py: {place} is there: its runs would cost nothing")
    shutil.copytree(ROOT / "verification", place / "verification")
    for definition in (place / "verification").glob("pk*/figure.toml"):
        text = definition.read_text(encoding="utf-8")
        definition.write_text(re.sub(r"(?m)^(seeds|paper_seeds) = .*$", r"\1 = 1", text), encoding="utf-8")
    began = time.monotonic()
    ended = subprocess.run([program, "figure", "all", "--budget", "paper", "--jobs", str(JOBS), "--verification", place / "verification",
                            "--cache", place / "cache", "--out", place / "figures"], stdout=sys.stderr)
    if ended.returncode > 1:  # 1: a comparison disagrees, which costs the same
        return ended.returncode
    run_time = json.loads((place / "figures/run_time.json").read_text(encoding="utf-8"))
    print(json.dumps({"runs": run_time["runs"], "jobs": JOBS, "processor": run_time["seconds"], "elapsed": time.monotonic() - began}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
