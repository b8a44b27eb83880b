#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The command `register`: poses found and refined, formats, errors that name the file."""
import math
import unittest

from support import FILE, INPUT, USAGE, CommandTest


def rows(text):
    return [[float(word) for word in line.split()] for line in text.splitlines()
            if line and not line.startswith("#")]


class RegisterTest(CommandTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        (cls.folder / "scans").mkdir()
        # One world seen twice from one place, with other noise: the sensor stands still.
        for k in range(3):
            cls.simulate(f"scans/{k}.pcd", "--noise", "0.01", "--dropout", f"0.0{k + 1}")
        cls.identity = "1 0 0 0 0 1 0 0 0 0 1 0\n"

    def test_a_sensor_that_stands_still_does_not_move(self):
        report = self.run_json("register", "scans", "-o", "p.txt")
        self.assertEqual([scan["input"] for scan in report["scans"]],
                         [f"scans/{k}.pcd" for k in range(3)])
        self.assertEqual(report["format"], "kitti")
        self.assertLess(report["length_m"], 0.02)
        for scan in report["scans"]:
            self.assertIsNone(scan["doubt"])
            self.assertGreater(scan["matched_share"], 0.6)
            self.assertIsNone(scan["correction_m"])
        poses = rows(self.path("p.txt").read_text())
        self.assertEqual(len(poses), 3)
        for pose in poses:
            self.assertLess(math.dist(pose[3::4], (0, 0, 0)), 0.02)

    def test_given_poses_are_refined(self):
        given = self.identity + "1 0 0 0.3 0 1 0 0 0 0 1 0\n" + self.identity
        self.path("given.txt").write_text(given)
        report = self.run_json("register", "scans", "--poses", "given.txt", "-o", "p.txt")
        self.assertGreater(report["scans"][1]["correction_m"], 0.25)
        for pose in rows(self.path("p.txt").read_text()):
            self.assertLess(math.dist(pose[3::4], (0, 0, 0)), 0.02)

    def test_formats_and_streams(self):
        self.path("times.txt").write_text("0\n0.1\n0.2\n")
        arguments = ["register", "scans/0.pcd", "scans/1.pcd", "scans/2.pcd", "--times", "times.txt"]
        tum = self.execute(*arguments, "--out-format", "tum", "-o", "-")
        self.assertEqual(tum.returncode, 0, tum.stderr)
        poses = rows(tum.stdout.decode())
        self.assertEqual([pose[0] for pose in poses], [0, .1, .2])
        self.assertTrue(all(len(pose) == 8 for pose in poses))
        self.run_ok(*arguments, "--out-format", "matrix", "-o", "m.txt")
        self.assertEqual(len(rows(self.path("m.txt").read_text())), 12)
        # What one run wrote another reads.
        self.path("p.tum").write_bytes(tum.stdout)
        self.run_ok("register", "scans", "--poses", "p.tum", "--out-format", "csv", "-o", "p.csv")
        self.assertTrue(self.path("p.csv").read_text().startswith("time,x,y,z,qx,qy,qz,qw\n"))

    def test_threads_change_nothing(self):
        for threads in (1, 3):
            self.run_ok("register", "scans", "--threads", threads, "-o", f"t{threads}.txt")
        self.assertEqual(self.path("t1.txt").read_bytes(), self.path("t3.txt").read_bytes())

    def test_errors_say_what_to_do(self):
        self.path("two.txt").write_text(2 * self.identity)
        self.run_fail(INPUT, "register", "scans", "--poses", "two.txt", "-o", "p.txt",
                      says=("two.txt", "2 poses for 3 scans"))
        self.path("bad.txt").write_text(self.identity + "2 0 0 0 0 2 0 0 0 0 2 0\n")
        self.run_fail(INPUT, "register", "scans", "--poses", "bad.txt", "-o", "p.txt",
                      says=("bad.txt: line 2", "no rotation"))
        self.run_fail(USAGE, "register", "scans", "--calib", "c.txt", "-o", "p.txt", says="--poses")
        self.run_fail(USAGE, "register", "scans", "--out-format", "tum", "-o", "p.txt",
                      says="--times")
        self.run_fail(USAGE, "register", "scans", "--out-format", "xml", "-o", "p.txt", says="kitti")
        self.run_fail(FILE, "register", "none.bin", "-o", "p.txt", says="none.bin")
        self.path("empty").mkdir()
        self.run_fail(FILE, "register", "empty", "-o", "p.txt", says="no scan in this directory")
        self.path("few.xyz").write_text("3 0 0\n0 3 0\n")
        self.run_fail(INPUT, "register", "scans/0.pcd", "few.xyz", "-o", "none.txt",
                      says=("few.xyz", "2 returns"))
        self.assertFalse(self.path("none.txt").exists())

    def test_a_match_in_doubt_is_an_error(self):
        self.simulate("room.pcd", "--scene", "room")
        arguments = ["register", "scans/0.pcd", "room.pcd", "-o", "doubt.txt"]
        self.run_fail(INPUT, *arguments, says=("room.pcd", "in doubt", "--keep-going"))
        self.assertFalse(self.path("doubt.txt").exists())
        result = self.execute(*arguments, "--keep-going")
        self.assertEqual(result.returncode, 0)
        self.assertIn(b"warning: room.pcd", result.stderr)
        self.assertTrue(self.path("doubt.txt").exists())


if __name__ == "__main__":
    unittest.main()
