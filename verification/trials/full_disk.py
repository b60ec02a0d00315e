#!/usr/bin/env python3
"""Runs on disks that are full: one line and exit code 2, the last good file whole, and with space again the run resumes.

Usage: full_disk.py PATH_OF_DPDREF [--cases N] [--seed S] [--record FILE]. Files may grow to a random size (RLIMIT_FSIZE); as root
also on a small file system of its own, in a mount namespace of its own. And outputs that are closed or full.
"""

import os
import pathlib
import random
import resource
import subprocess
import sys
import tempfile

import harness

IN_NAMESPACE = "DPDREF_TRIAL_IN_NAMESPACE"


def left_over(program, directory, what):
    for file in directory.glob("*.part"):
        program.fail(f"{what}: left {file.name} of {file.stat().st_size} bytes")


def limited(program, size):
    """The program on a disk that takes files of `size` bytes, then on one with space. Whether it met the limit."""
    done = program.run("a.h5", preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size)))
    what = f"files of at most {size} bytes"
    if done.returncode != 0:
        program.expect_one_line(what, done)
    left_over(program, program.directory, what)
    program.expect_the_reference(f"{what}, then space", program.run("a.h5"), program.directory / "a.h5md")
    program.remove("a")
    return done.returncode != 0


def on_small_disk(program, place, size):
    """The same on a file system of `size` bytes, mounted at `place`."""
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "none", place], check=True)
    try:
        done = program.run(place / "a.h5")
        what = f"a disk of {size} bytes"
        if done.returncode != 0:
            program.expect_one_line(what, done)
        left_over(program, place, what)
        subprocess.run(["mount", "-o", "remount,size=100m", place], check=True)
        program.expect_the_reference(f"{what}, then space", program.run(place / "a.h5"), place / "a.h5md")
        return done.returncode != 0
    finally:
        subprocess.run(["umount", place], check=True)


def closed_outputs(program):
    """How many outputs that take nothing were said."""
    said = 0
    with open("/dev/full", "w", encoding="ascii") as full:
        for arguments in (["run", "scene.toml", "--out", "a.h5"], ["run", "scene.toml", "--out", "a.h5", "--json"],
                          ["theory"], ["theory", "my25", "n=3", "gamma=9"], ["convert"], ["--help"], ["--version"]):
            for how, options in (("/dev/full", {"stdout": full}), ("closed", {"preexec_fn": lambda: os.close(1)})):
                done = subprocess.run([program.path, *arguments], cwd=program.directory, stderr=subprocess.PIPE, text=True,
                                      check=False, **options)
                said += program.expect_one_line(f"{' '.join(arguments)}, output {how}", done)
    program.remove("a")
    return said


def main():
    arguments = harness.options(__doc__, 50).parse_args()
    may_mount = os.geteuid() == 0 and IN_NAMESPACE in os.environ
    if os.geteuid() == 0 and not may_mount:
        unshare = ["unshare", "--mount", "--propagation", "private"]
        if subprocess.run([*unshare, "true"], capture_output=True, check=False).returncode == 0:
            os.environ[IN_NAMESPACE] = "1"
            os.execvp("unshare", [*unshare, sys.executable, "-B", *sys.argv])
    program = harness.Program(arguments.dpdref)
    random.seed(arguments.seed)
    largest = (program.directory / "reference.h5").stat().st_size * 2 + len(program.trajectory)
    met = {"limits": 0, "disks": 0}
    place = pathlib.Path(tempfile.mkdtemp())
    for case in range(arguments.cases):
        most = (30000, largest)[case % 2]  # every other one while the files are begun
        met["limits"] += limited(program, random.randrange(0, most) if case else 0)
        if may_mount:
            met["disks"] += on_small_disk(program, place, 4096 * random.randrange(1, 2 * most // 4096))
    place.rmdir()
    met["outputs"] = closed_outputs(program) if pathlib.Path("/dev/full").exists() else 0
    print(f"{met['limits']} runs met the limit of files, {met['disks']} a full disk, {met['outputs']} outputs that take nothing; "
          f"{len(program.failures)} failures")
    if arguments.record:
        harness.record(arguments.record, "full_disk", met)
    return 1 if program.failures or not met["limits"] else 0


if __name__ == "__main__":
    sys.exit(main())
