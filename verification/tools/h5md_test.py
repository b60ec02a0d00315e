#!/usr/bin/env python3
"""Files as others read them: the H5MD layout of trajectory and results, through h5py.

Usage: h5md_test.py PATH_OF_DPDREF. Exit code 77 (skipped) without h5py or numpy.
"""

import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import h5py
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

DPDREF = pathlib.Path(sys.argv.pop(1)).resolve()

PARTICLES, STEP, STEPS, INTERVAL = 40, 0.05, 60, 4
LENGTH = [3.0, 4.0, 5.0]

SCENE = """
dimension = {dimension}
stages = [{stages}]
[box]
length = {length}
shear_rate = {shear_rate}
[particles]
number = {particles}
kT = 4.0
{thermostat}
[time]
step = {step}
equilibration = 0.5
duration = 2.5
[sample]
interval = 3
observables = ["kinetic_temperature", "momentum"]
[sample.radial_distribution]
range = 1.0
bins = 7
interval = 5
[trajectory]
interval = {interval}
"""


def scene(dimension=3, stages='"sample", "drift"', shear_rate=0.0, thermostat="", interval=INTERVAL):
    return SCENE.format(dimension=dimension, stages=stages, length=LENGTH[:dimension], shear_rate=shear_rate,
                        particles=PARTICLES, thermostat=thermostat, step=STEP, interval=interval)


class Files(unittest.TestCase):
    def setUp(self):
        self.directory = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.directory.name)

    def tearDown(self):
        self.directory.cleanup()

    def run_scene(self, text):
        """Runs a scene; returns its open trajectory and results."""
        (self.path / "scene.toml").write_text(text)
        subprocess.run([DPDREF, "run", self.path / "scene.toml", "--out", self.path / "a.h5"], check=True,
                       stdout=subprocess.DEVNULL)
        trajectory = h5py.File(self.path / "a.h5md", "r")
        results = h5py.File(self.path / "a.h5", "r")
        self.addCleanup(trajectory.close)
        self.addCleanup(results.close)
        return trajectory, results

    def check_metadata(self, file):
        h5md = file["h5md"]
        self.assertEqual(list(h5md.attrs["version"]), [1, 1])
        self.assertEqual(h5md.attrs["version"].dtype.kind, "i")
        self.assertTrue(h5md["author"].attrs["name"])
        self.assertEqual(h5md["creator"].attrs["name"], "dpdref")
        self.assertRegex(h5md["creator"].attrs["version"], r"^\d+\.\d+\.\d+")

    def test_layout_of_the_trajectory(self):
        for dimension in (2, 3):
            for shear_rate in (0.0, 0.3):
                with self.subTest(dimension=dimension, shear_rate=shear_rate):
                    self.check_layout(dimension, shear_rate)
                    (self.path / "a.h5").unlink()
                    (self.path / "a.h5md").unlink()

    def check_layout(self, dimension, shear_rate):
        trajectory, _ = self.run_scene(scene(dimension, shear_rate=shear_rate))
        self.check_metadata(trajectory)
        frames = STEPS // INTERVAL
        group = trajectory["particles/all"]
        for element, kind in (("position", "f"), ("velocity", "f"), ("image", "i")):
            with self.subTest(element=element):
                self.assertEqual(group[element]["value"].shape, (frames, PARTICLES, dimension))
                self.assertEqual(group[element]["value"].dtype.kind, kind)
        for element in ("position", "velocity", "image", "box/edges"):
            with self.subTest(element=element):
                steps = group[element]["step"][:]
                self.assertIn(steps.dtype.kind, "iu")
                np.testing.assert_array_equal(steps, INTERVAL * np.arange(1, frames + 1))
                np.testing.assert_allclose(group[element]["time"][:], steps * STEP, rtol=1e-14)
        np.testing.assert_array_equal(group["id"][:], np.arange(PARTICLES))
        box = group["box"]
        self.assertEqual(box.attrs["dimension"], dimension)
        self.assertEqual([str(b) for b in box.attrs["boundary"]], ["periodic"] * dimension)
        # box vectors by row; in shear the one along y leads to the displaced image
        edges = np.tile(np.diag(LENGTH[:dimension]), (frames, 1, 1))
        edges[:, 1, 0] = np.fmod(shear_rate * LENGTH[1] * box["edges/time"][:], LENGTH[0])
        np.testing.assert_allclose(box["edges/value"][:], edges, rtol=1e-14)
        self.assertEqual(box.attrs["shear_rate"], shear_rate)
        position = group["position/value"][:]
        self.assertTrue(np.all(position >= 0.0) and np.all(position < LENGTH[:dimension]))
        self.assertTrue(np.any(group["image/value"][:] != 0))  # else the boundaries go untested
        trajectory.close()

    def test_unwrapped_positions_follow_the_velocities(self):
        trajectory, _ = self.run_scene(scene(interval=1))
        group = trajectory["particles/all"]
        unwrapped = group["position/value"][:] + group["image/value"][:] * np.array(LENGTH)
        velocity, time = group["velocity/value"][:], group["position/time"][:]
        moved = np.diff(unwrapped, axis=0)
        np.testing.assert_allclose(moved, velocity[:-1] * np.diff(time)[:, None, None], atol=1e-12)
        # free flight: the velocities stay, and every particle keeps its place in the arrays
        np.testing.assert_array_equal(velocity, np.broadcast_to(velocity[0], velocity.shape))
        self.assertGreater(np.abs(moved).max(), 0.01)

    def test_particles_keep_their_place_when_the_state_is_sorted(self):
        trajectory, _ = self.run_scene(scene(stages='"shardlow", "sample", "drift"', interval=1,
                                             thermostat="[shardlow]\nfriction = 4.0"))
        group = trajectory["particles/all"]
        unwrapped = group["position/value"][:] + group["image/value"][:] * np.array(LENGTH)
        # the frame is taken after the drift, whose velocities the thermostat changes before the next drift
        np.testing.assert_allclose(np.diff(unwrapped, axis=0), group["velocity/value"][1:] * STEP, atol=1e-12)
        self.assertGreater(np.abs(np.diff(group["velocity/value"][:], axis=0)).max(), 0.1)

    def test_sheared_images_change_velocity(self):
        rate = 0.7
        trajectory, _ = self.run_scene(scene(shear_rate=rate, interval=1))
        group = trajectory["particles/all"]
        velocity, image = group["velocity/value"][:], group["image/value"][:]
        crossed = np.diff(image[:, :, 1], axis=0)
        self.assertTrue(np.any(crossed != 0))
        np.testing.assert_allclose(np.diff(velocity[:, :, 0], axis=0), -crossed * rate * LENGTH[1], atol=1e-12)
        np.testing.assert_array_equal(np.diff(velocity[:, :, 1:], axis=0), 0.0)

    def test_observables_of_the_results(self):
        _, results = self.run_scene(scene())
        self.check_metadata(results)
        samples = np.arange(10, 60, 3)  # after the equilibration, every third step
        for name in ("kinetic_temperature", "momentum"):
            with self.subTest(observable=name):
                observable = results["observables"][name]
                self.assertEqual(observable["value"].shape, samples.shape)
                # H5MD: a scalar increment, and the offset as an attribute
                for axis, unit in (("step", 1), ("time", STEP)):
                    increment, offset = observable[axis][()], observable[axis].attrs["offset"]
                    np.testing.assert_allclose(offset + increment * np.arange(samples.size), samples * unit)
        kT = results["observables/kinetic_temperature/value"][:]
        np.testing.assert_allclose(kT, kT[0], rtol=1e-12)  # free flight
        self.assertTrue(2.0 < kT[0] < 6.0)
        np.testing.assert_allclose(results["observables/momentum/value"][:], 0.0, atol=1e-10)
        g = results["observables/radial_distribution"]
        np.testing.assert_allclose(g["x"][:], (np.arange(7) + 0.5) / 7.0)
        self.assertEqual(g["sum"].shape[1], 7)
        self.assertEqual(g["sum"].shape, g["weight"].shape)
        mean = g["sum"][:].sum() / g["weight"][:].sum()
        self.assertTrue(0.5 < mean < 1.5, mean)

    def test_temperature_is_that_of_the_trajectory(self):
        trajectory, results = self.run_scene(scene(interval=3))
        velocity = trajectory["particles/all/velocity/value"][-1]
        kT = (velocity**2).sum() / (3 * (PARTICLES - 1))
        self.assertAlmostEqual(results["observables/kinetic_temperature/value"][-1], kT, places=12)

    def test_provenance(self):
        _, results = self.run_scene(scene())
        for name in ("key", "scene", "program", "compiler", "status"):
            self.assertTrue(results["dpdref"][name][()])
        self.assertEqual(results["dpdref/status"][()], b"complete")
        self.assertEqual(results["dpdref/seed"][0], 1)
        self.assertEqual(results["dpdref/counters/steps"][0], STEPS)


if __name__ == "__main__":
    unittest.main()
