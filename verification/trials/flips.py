#!/usr/bin/env python3
"""Flips bits in results and checkpoints: each flip is noticed, said, and changes no number.

Usage: flips.py PATH_OF_DPDREF [--cases N] [--seed S] [--record FILE]. N flips in a finished result, as many in a checkpoint, a
tenth in files that are cut.
"""

import random
import sys

import harness


def main():
    arguments = harness.options(__doc__, 100).parse_args()
    program = harness.Program(arguments.dpdref)
    random.seed(arguments.seed)
    whole = (program.directory / "reference.h5").read_bytes(), program.trajectory
    result, trajectory = program.directory / "a.h5", program.directory / "a.h5md"
    counts = {}
    for name, (good, frames) in (("result", whole), ("checkpoint", program.checkpoint())):
        noticed = again = 0
        for _ in range(arguments.cases):
            bad = bytearray(good)
            at, bit = random.randrange(len(bad)), random.randrange(8)
            bad[at] ^= 1 << bit
            result.write_bytes(bad)
            trajectory.write_bytes(frames)
            done = program.run("a.h5")
            said = done.stderr.count("\n") == 1 and "damaged" in done.stderr
            # without its last words, those of the digest, a file is no one's, and not made again
            refused = done.returncode == 2 and "digest is gone" in done.stderr
            if not said:
                program.fail(f"{name}: bit {bit} of byte {at} was not noticed: {done.stderr[:300]}")
                continue
            noticed += 1
            if not refused:
                again += program.expect_the_reference(f"{name}: bit {bit} of byte {at}", done, trajectory)
            program.remove("a")
        for _ in range(max(1, arguments.cases // 10)):
            result.write_bytes(good[: random.randrange(len(good))])
            trajectory.write_bytes(frames)
            program.expect_one_line(f"{name}, cut", program.run("a.h5"))
            program.remove("a")
        print(f"{arguments.cases} flips in a {name}: {noticed} noticed, {again} times made again with the same numbers")
        counts |= {f"{name}_flips": arguments.cases, f"{name}_noticed": noticed, f"{name}_again": again}
    print(f"{len(program.failures)} failures")
    if arguments.record:
        harness.record(arguments.record, "flips", counts)
    return 1 if program.failures else 0


if __name__ == "__main__":
    sys.exit(main())
