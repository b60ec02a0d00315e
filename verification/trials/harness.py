"""What the trials share: scenes, runs, comparison with a run that nothing disturbed, their counts in a file."""

import argparse
import hashlib
import json
import pathlib
import random
import signal
import subprocess
import tempfile
import time

# Everything that a checkpoint has to keep: pairs and forces of a step, time origins, profiles, a trajectory.
SCENE = """title = "trial"
dimension = 3
stages = ["shardlow", "sample", "verlet"]
[box]
length = [5.0, 5.0, 5.0]
shear_rate = 0.1
[particles]
density = 3.0
[shardlow]
friction = 4.5
[verlet.soft]
strength = 25.0
[time]
step = 0.02
equilibration = 0.2
duration = {duration}
checkpoint = 0.000001
{until}
[sample]
interval = 2
observables = ["kinetic_temperature", "momentum", "pressure", "friction_stress"]
mean_square_displacement = {{ spacing = 0.04, longest = 0.4, origins = 0.08 }}
velocity_autocorrelation = {{ longest = 0.2 }}
radial_distribution = {{ range = 2.0, bins = 50, interval = 2 }}
profile = {{ bins = 10, temperature = true }}
configuration = true
[trajectory]
interval = 2
"""


class Program:
    """dpdref in a directory of its own; `failures` are lines that say what went wrong."""

    def __init__(self, path, duration=0.8, until=""):
        self.path = pathlib.Path(path).resolve()
        self.temporary = tempfile.TemporaryDirectory()
        self.directory = pathlib.Path(self.temporary.name)
        (self.directory / "scene.toml").write_text(SCENE.format(duration=duration, until=until))
        self.failures = []
        start = time.monotonic()
        done = self.run("reference.h5")
        self.seconds = time.monotonic() - start
        if done.returncode != 0:
            raise SystemExit(f"the run that nothing disturbs failed: {done.stderr}")
        self.numbers = numbers(done.stdout)
        self.trajectory = (self.directory / "reference.h5md").read_bytes()

    def command(self, out):
        return [self.path, "run", "scene.toml", "--out", out, "--json"]

    def run(self, out, **options):
        return subprocess.run(self.command(out), cwd=self.directory, capture_output=True, text=True, check=False,
                              **options)

    def start(self, out):
        return subprocess.Popen(self.command(out), cwd=self.directory, stdout=subprocess.DEVNULL,
                                stderr=subprocess.DEVNULL)

    def checkpoint(self):
        """The bytes of a checkpoint and of the trajectory that belongs to it."""
        for _ in range(100):
            self.remove("c")
            run = self.start("c.h5")
            time.sleep(self.seconds * random.uniform(0.2, 0.9))
            run.send_signal(signal.SIGTERM)
            if run.wait() == 130:
                return (self.directory / "c.h5").read_bytes(), (self.directory / "c.h5md").read_bytes()
        raise SystemExit("no run could be interrupted")

    def remove(self, stem):
        for file in self.directory.glob(stem + ".*"):
            if file.is_file():
                file.unlink()

    def fail(self, what):
        self.failures.append(what)
        print("FAILED:", what)

    def expect_the_reference(self, what, done, trajectory):
        """The run ended well, with the numbers and the trajectory of the reference, to the last byte."""
        if done.returncode != 0:
            self.fail(f"{what}: exit code {done.returncode}: {done.stderr[:300]}")
        elif numbers(done.stdout) != self.numbers:
            self.fail(f"{what}: other numbers")
        elif trajectory and trajectory.read_bytes() != self.trajectory:
            self.fail(f"{what}: another trajectory")
        else:
            return True
        return False

    def expect_one_line(self, what, done, code=2):
        """Exit code 2 and one line of complaint."""
        if done.returncode != code or done.stderr.count("\n") != 1 or not done.stderr.startswith("dpdref: "):
            self.fail(f"{what}: exit code {done.returncode}, {done.stderr[:300]!r}")
            return False
        return True


def options(what, cases):
    """The command line of a trial."""
    parser = argparse.ArgumentParser(description=what)
    parser.add_argument("dpdref")
    parser.add_argument("--cases", type=int, default=cases)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--record", help="file of counts, of which those of this trial are replaced")
    return parser


def record(file, trial, counts):
    """Puts the counts of a trial into figures/trials.dat, from which the book draws them: parts TRIAL:NAME, one number each."""
    path = pathlib.Path(file)
    text = path.read_text(encoding="ascii") if path.exists() else ""
    parts = dict(part.strip().split("\n") for part in text.split("# ")[1:])
    parts = {name: count for name, count in parts.items() if not name.startswith(f"{trial}:")}
    parts |= {f"{trial}:{name}": count for name, count in counts.items()}
    path.write_text("\n".join(f"# {name}\n{count}\n" for name, count in sorted(parts.items())), encoding="ascii")


def numbers(text):
    """What of a run's JSON must not depend on interruptions."""
    result = json.loads(text)
    for name in ("seconds", "bytes", "nanoseconds_per_particle_and_step"):
        result.pop(name, None)
    return hashlib.sha256(json.dumps(result).encode()).hexdigest()
