#!/usr/bin/env python3
"""Feeds the program inputs that were damaged at random: scenes, outputs of other codes, files of results, parameters.

Usage: fuzz.py PATH_OF_DPDREF [--seconds S | --cases N] [--seed S] [--keep DIRECTORY] [--record FILE]. Allowed are the documented
exit codes; one line of complaint, "dpdref: ...", with every code but 0 and 1; no signal; no line of a library. A scene that turned
out long is stopped, and is no failure. Every other damaged result has a right digest, so that what reads it is reached. Inputs that
fail are kept, with the command in a file beside.
"""

import json
import pathlib
import random
import re
import resource
import shlex
import subprocess
import sys
import tempfile
import time

import harness

HERE = pathlib.Path(__file__).resolve().parent.parent
LONGEST, MEMORY = 5, 3 << 30  # seconds of processor, bytes of address space
DIGEST = b"dpdref digest crc64 "
NUMBERS = ["0", "-1", "1e308", "1e155", "1e-155", "1e-308", "-1e-320", "1e12", "nan", "inf", "-inf", "18446744073709551616", "0x10", "1_000",
           "9223372036854775807", "", "3 ", "[1,2]", "{}", "''", "\u00e9", "\udcff", "a\nb", "true"]


def damaged(data, rng):
    """Some bytes changed, lost, doubled, put in."""
    data = bytearray(data)
    for _ in range(rng.choice((1, 1, 1, 2, 4, 16))):
        if not data:
            return bytes(data)
        at, length = rng.randrange(len(data)), min(rng.choice((1, 1, 2, 8, 64)), len(data))
        kind = rng.randrange(6)
        if kind == 0:
            data[at] ^= 1 << rng.randrange(8)
        elif kind == 1:
            del data[at:at + length]
        elif kind == 2:
            data[at:at] = data[at:at + length]
        elif kind == 3:
            data[at:at] = rng.choice((b"\n", b"\0", b"\xff\xfe", b"[", b"]", b'"', b"=", b",", b"e", b"-", b"9" * 30))
        elif kind == 4:
            data[at:] = b""
        else:
            word = rng.choice(NUMBERS).encode("utf-8", "surrogateescape")
            end = at
            while end < len(data) and chr(data[end]) in "0123456789.e+-":
                end += 1
            data[at:end] = word
    return bytes(data)


def crc64(data):
    """CRC-64/XZ."""
    if not crc64.table:
        for byte in range(256):
            for _ in range(8):
                byte = (byte >> 1) ^ (0xC96C5795D7870F42 if byte & 1 else 0)
            crc64.table.append(byte)
    crc = (1 << 64) - 1
    for byte in data:
        crc = crc64.table[(crc ^ byte) & 0xFF] ^ (crc >> 8)
    return crc ^ ((1 << 64) - 1)


crc64.table = []


def damaged_result(data, rng):
    if rng.random() < 0.5:
        return damaged(data, rng)
    data = damaged(data[:data.rindex(DIGEST)], rng)
    return data + DIGEST + b"%016x\n" % crc64(data)


def sources(program):
    """The inputs that are damaged: name, bytes, command of a file."""
    directory = program.directory
    for scene in sorted((HERE / "scenes").glob("*.toml")):
        yield scene.name, scene.read_bytes(), lambda f: ["run", f, "--set", "time.duration=0.1", "--set",
                                                         "time.equilibration=0"]
        yield scene.name, scene.read_bytes(), lambda f: ["export", "lammps", f, "--out", f + ".deck"]
    for name in ("log.lammps", "scalars.dat", "rdf.dat"):
        yield name, (HERE / "data" / "lammps" / name).read_bytes(), lambda f: ["compare", f, "--answer", "gw-0.04"]
    for file in sorted((HERE / "data" / "outputs").iterdir()):
        yield file.name, file.read_bytes(), lambda f: ["compare", f, "--answer", "gw-0.04", "--run", "all"]
    for file in (directory / "reference.h5", directory / "reference.h5md"):
        yield file.name, file.read_bytes(), lambda f: ["compare", f, "--answer", "gw-0.04"]
        yield file.name, file.read_bytes(), lambda f: ["compare", str(HERE / "data/lammps/scalars.dat"), "--reference", f]
    yield "checkpoint.h5", program.checkpoint()[0], lambda f: ["run", str(directory / "scene.toml"), "--out", f]
    answers = (HERE.parent / "figures" / "answers" / "answers.json").read_bytes()
    yield "answers.json", answers, lambda f: ["answer", "n=3", "a=25", "gamma=4.5", "dt=0.04", "--answers", f]
    yield "answers.json", answers, lambda f: ["compare", str(HERE / "data/lammps/scalars.dat"), "--answer", "gw-0.04",
                                              "--answers", f]


def vocabulary(program):
    """Parameters of each closed form, and keys of each code."""
    def said(*arguments):
        return subprocess.run([program.path, *arguments], capture_output=True, text=True, check=True).stdout
    forms = {form["id"]: form["parameters"] for form in json.loads(said("theory", "--json"))}
    codes, keys = {}, []
    for line in said("convert").splitlines():
        if line.startswith(" "):
            keys.append(re.split(r"[=\] ]", line.strip().lstrip("["))[0])
        else:
            keys = codes.setdefault(line.split(":")[0], [])
    return forms, codes


def command_lines(rng, forms, codes):
    """Parameters at random: theory, convert, answer, --set."""
    plain = ["1", "2", "3", "0.5", "0.01", "9", "linear", "constant"]
    def some(names, extreme):
        return [f"{name}={rng.choice(NUMBERS if rng.random() < extreme else plain)}" for name in names if rng.random() < 0.9]
    kind = rng.randrange(4)
    if kind == 0:
        form = rng.choice(list(forms))
        return ["theory", form, *some(forms[form], 0.3), *rng.choice(([], ["--json"]))]
    if kind == 1:
        code = rng.choice(list(codes))
        return ["convert", code, rng.choice(list(codes)), *some(codes[code], 0.3)]
    if kind == 2:
        return ["answer", *some(["n", "a", "gamma", "dt", "kT", "integrator", "N", "d"], 0.3)]
    keys = ["box.length", "particles.number", "particles.density", "time.step", "time.duration", "time.checkpoint",
            "shardlow.friction", "sample.interval", "sample.radial_distribution.bins", "stages", "dimension", "seed"]
    return ["run", str(HERE / "scenes" / "ideal_gas_rest.toml"), "--set", "time.duration=0.1", *(
        word for setting in some(rng.sample(keys, 3), 0.7) for word in ("--set", setting))]


def limits(memory):
    if memory:
        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    resource.setrlimit(resource.RLIMIT_CPU, (LONGEST, LONGEST + 1))


def problem(program, command, directory, memory):
    """What is wrong with how the command ended, or nothing."""
    try:
        done = subprocess.run([program.path, *command], cwd=directory, stdin=subprocess.DEVNULL, capture_output=True,
                              timeout=4 * 3600, preexec_fn=lambda: limits(memory), check=False)
    except subprocess.TimeoutExpired:
        return None
    except (ValueError, OSError):  # no command line can hold this
        return None
    complaint = done.stderr.decode("utf-8", "replace")
    if done.returncode in (-24, -9):  # out of its time
        return None
    if done.returncode not in (0, 1, 2, 3, 4):
        return f"exit code {done.returncode}: {complaint[:300]!r}"
    lines = complaint.splitlines()
    if any(not line.startswith("dpdref: ") for line in lines):
        return f"a line that is not the program's: {complaint[:300]!r}"
    errors = [line for line in lines if not line.startswith("dpdref: warning: ")]
    if len(errors) != (1 if done.returncode > 1 else 0):
        return f"exit code {done.returncode} with {len(errors)} lines: {complaint[:300]!r}"
    if command[0] in ("theory", "convert") and re.search(rb"\b(inf|nan|null)\b", done.stdout):
        return f"no number: {done.stdout[-300:]!r}"
    return None


def main():
    parser = harness.options(__doc__, None)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--keep", default="fuzz-failures")
    arguments = parser.parse_args()
    program = harness.Program(arguments.dpdref)
    rng = random.Random(arguments.seed)
    inputs, words = list(sources(program)), vocabulary(program)
    version = subprocess.run([program.path, "--version"], capture_output=True, text=True, check=True).stdout
    memory = 0 if "sanitize" in version else MEMORY  # the address checks reserve terabytes
    counts = {}
    start = time.monotonic()
    failures = cases = 0
    while cases < arguments.cases if arguments.cases else time.monotonic() - start < arguments.seconds:
        cases += 1
        with tempfile.TemporaryDirectory() as directory:
            if rng.random() < 0.4:
                name, data, command = "command line", b"", command_lines(rng, *words)
            else:
                name, data, how = inputs[rng.randrange(len(inputs))]
                data = damaged_result(data, rng) if DIGEST in data else damaged(data, rng)
                (pathlib.Path(directory) / name).write_bytes(data)
                command = how(name)
            counts[name] = counts.get(name, 0) + 1
            wrong = problem(program, command, directory, memory)
            if wrong:
                failures += 1
                keep = pathlib.Path(arguments.keep) / f"{arguments.seed}-{cases}"
                keep.mkdir(parents=True, exist_ok=True)
                if data:
                    (keep / name).write_bytes(data)
                line = " ".join(shlex.quote(word) for word in ["dpdref", *command])
                (keep / "command").write_text(f"{line}\n{wrong}\n", encoding="utf-8", errors="surrogateescape")
                print(f"FAILED: {line.encode('utf-8', 'replace').decode()}\n  {wrong}")
    for name, count in sorted(counts.items()):
        print(f"{name:24} {count:7}")
    print(f"{cases} cases in {time.monotonic() - start:.0f} s, {failures} failures")
    if arguments.record:
        harness.record(arguments.record, "fuzz", {"cases": cases, "failures": failures})
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
