# SPDX-License-Identifier: BSD-3-Clause
"""Profiles found in scans: calibrate."""

import random
import unittest

from support import INPUT, USAGE, CommandTest, write_kitti


class CalibrateTest(CommandTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        for seed in (1, 2):
            cls.simulate(f"{seed}.pcd", "--seed", seed, "--range-unit", 0.002)

    def test_a_sensor_is_found_in_its_scans(self):
        report = self.run_json("calibrate", "1.pcd", "2.pcd", "-o", "mine.toml")
        self.assertEqual(report["name"], "mine")
        self.assertEqual(report["output"], "mine.toml")
        self.assertEqual(report["slots"], 1808)
        self.assertEqual(report["range_unit_m"], 0.002)
        self.assertEqual(len(report["rings"]), 16)
        for k, ring in enumerate(report["rings"]):
            self.assertAlmostEqual(ring["elevation_deg"], 15 - 2 * k, 5)
            self.assertAlmostEqual(ring["horizontal_offset_m"], 0, 5)
        self.assertEqual([scan["input"] for scan in report["scans"]], ["1.pcd", "2.pcd"])
        for scan in report["scans"]:
            self.assertTrue(scan["on_lattice"])
            self.assertEqual(scan["share"], 1)
            self.assertEqual(scan["placed"], scan["returns"])
            self.assertLess(scan["across_m"]["p95"], 1e-5)
            self.assertLess(scan["range_m"]["p95"], 1e-5)
            self.assertIsNone(scan["motion"])
        # The profile is one: it can be read, listed and calibrated from.
        self.assertEqual(self.run_json("sensors", "mine.toml")["rings"], 16)
        again = self.run_json("calibrate", "1.pcd", "--sensor", "mine.toml", "--name", "other")
        self.assertEqual((again["name"], again["slots"], again["output"]), ("other", 1808, None))

    def test_report_for_people_and_profile_on_standard_output(self):
        text = self.run_ok("calibrate", "1.pcd").decode()
        for part in ["1,808 positions", "2 mm", "100.00 %", "1.pcd"]:
            self.assertIn(part, text)
        result = self.execute("calibrate", "1.pcd", "-o", "-")
        self.assertEqual(result.returncode, 0)
        self.assertIn(b"slots = 1808\n", result.stdout)
        self.assertIn(b"1,808 positions", result.stderr)
        self.assertEqual(self.run_ok("calibrate", "1.pcd", "-o", "-", "-q"), result.stdout)

    def test_scans_without_a_lattice_are_an_error(self):
        uniform = random.Random(1)
        write_kitti(self.path("noise.bin"),
                    [[uniform.uniform(-20, 20) for _ in range(3)] + [0] for _ in range(5000)])
        self.run_fail(INPUT, "calibrate", "noise.bin", "-o", "noise.toml",
                      says=["noise.bin", "no lattice", "uniform columns"])
        self.assertFalse(self.path("noise.toml").exists())

    def test_scans_of_different_sensors_are_an_error(self):
        self.run_ok("simulate", "--sensor", "os1-32", "-o", "os1.pcd", "-q")
        self.run_fail(INPUT, "calibrate", "1.pcd", "os1.pcd", says="32 rings")

    def test_wrong_usage(self):
        self.run_fail(USAGE, "calibrate", "1.pcd", "-o", "1.pcd", says="replace")
        self.run_fail(USAGE, "calibrate", "1.pcd", "-o", "-", "--json", says="--json")
        self.run_fail(USAGE, "calibrate", says="inputs")


if __name__ == "__main__":
    unittest.main()
