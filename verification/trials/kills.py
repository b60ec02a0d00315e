#!/usr/bin/env python3
"""Kills runs, then runs them to the end: the numbers and the trajectory must be those of a run without a kill.

Usage: kills.py PATH_OF_DPDREF [--cases KILLS] [--seed S] [--record FILE]. Checkpoints come as often as the program lets them.
Every other kill waits for a file that is being written. Between kill and resumption the trajectory must be readable (with h5py,
where that is installed), frame by frame that of the reference.
"""

import random
import signal
import sys
import time

import harness

try:
    import h5py
    import numpy as np
except ImportError:
    h5py = None


def begins_like_the_reference(program, file):
    with h5py.File(file, "r") as mine, h5py.File(program.directory / "reference.h5md", "r") as theirs:
        counts = set()
        for element in ("position", "velocity", "image", "box/edges"):
            for name in ("step", "time", "value"):
                a, b = mine[f"particles/all/{element}/{name}"], theirs[f"particles/all/{element}/{name}"]
                counts.add(len(a))
                if not np.array_equal(a[:], b[: len(a)]):
                    return False
        return len(counts) == 1


def kill(program, run, aimed):
    """Whether it was killed, rather than done before; and whether while a file was being written."""
    time.sleep(random.uniform(0.0, program.seconds))
    while aimed and run.poll() is None and not list(program.directory.glob("*.part")):
        pass
    run.send_signal(signal.SIGKILL)
    killed = run.wait() == -signal.SIGKILL
    return killed, killed and bool(list(program.directory.glob("*.part")))


def main():
    arguments = harness.options(__doc__, 100).parse_args()
    # a run that looks at its errors once on the way has more to get wrong than one of a fixed duration
    program = harness.Program(arguments.dpdref, duration=0.44, until="until = { kinetic_temperature = 1e-6 }\nlongest = 0.88")
    random.seed(arguments.seed)
    kills = writing = runs = survived = read = unreadable = 0
    file = program.directory / "a.h5md"
    while kills < arguments.cases:
        for _ in range(random.randint(1, 3)):
            killed, in_write = kill(program, program.start("a.h5"), aimed=kills % 2 == 0)
            kills += killed
            writing += in_write
            if killed and h5py and file.exists():
                read += 1
                try:
                    good = begins_like_the_reference(program, file)
                except (OSError, KeyError):
                    good = False
                if not good:
                    unreadable += 1
                    program.fail(f"kill {kills}: the trajectory does not begin like the reference")
        runs += 1
        survived += program.expect_the_reference(f"resumed after kill {kills}", program.run("a.h5"), file)
        left = [f.name for f in program.directory.glob("*.part")] + [f.name for f in program.directory.glob("*.lock")]
        if left:
            program.fail(f"after kill {kills} and the end of the run there is {left}")
        program.remove("a")
    print(f"{kills} kills of {runs} runs, {writing} of them while a file was written; {survived} resumed to the bytes of the "
          f"reference; {unreadable} of {read} trajectories were unreadable in between; {len(program.failures)} failures")
    if arguments.record:
        harness.record(arguments.record, "kills", {"kills": kills, "writing": writing, "runs": runs, "survived": survived,
                                                   "read": read, "unreadable": unreadable})
    return 1 if program.failures else 0


if __name__ == "__main__":
    sys.exit(main())
