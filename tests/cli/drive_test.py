#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""simulate --drive: a folder of scans, poses and the exact surface."""
import unittest

from support import FILE, USAGE, CommandTest, read_kitti


class DriveTest(CommandTest):
    OPTIONS = ("--drive", "--sensor", "vlp16", "--scans", "3", "--step", "5")

    def test_scans_poses_times_and_truth(self):
        said = self.run_json("simulate", *self.OPTIONS, "--truth", "-o", "drive")
        self.assertEqual(self.files("drive"), ["poses.txt", "times.txt", "truth.ply"])
        self.assertEqual(self.files("drive/scans"), ["000000.bin", "000001.bin", "000002.bin"])
        self.assertEqual(said["scans"], 3)
        scans = [read_kitti(self.path(f"drive/scans/{i:06}.bin")) for i in range(3)]
        self.assertEqual(sum(map(len, scans)), said["points"])
        self.assertGreater(said["truth_points"], 1000)
        poses = [list(map(float, line.split()))
                 for line in self.path("drive/poses.txt").read_text().splitlines()]
        self.assertEqual([len(pose) for pose in poses], [12] * 3)
        step = sum((poses[1][i] - poses[0][i]) ** 2 for i in (3, 7, 11)) ** .5
        self.assertAlmostEqual(step, 5, delta=.2)
        self.assertEqual(len(self.path("drive/times.txt").read_text().split()), 3)

    def test_a_drive_is_the_same_again(self):
        for name, threads in (("a", "1"), ("b", "3")):
            self.run_ok("simulate", *self.OPTIONS, "--threads", threads, "-q", "-o", name)
        for name in ("poses.txt", "scans/000002.bin"):
            self.assertEqual(self.path(f"a/{name}").read_bytes(),
                             self.path(f"b/{name}").read_bytes())

    def test_scans_say_what_moves(self):
        self.run_ok("simulate", *self.OPTIONS, "--moving", "--to-format", "csv", "-q", "-o", "m")
        self.assertEqual(self.files("m/scans"), ["000000.csv", "000001.csv", "000002.csv"])
        shares = []
        for name in self.files("m/scans"):
            names, *lines = self.path(f"m/scans/{name}").read_text().splitlines()
            column = names.split(",").index("moving")
            marks = [line.split(",")[column] for line in lines]
            self.assertLessEqual(set(marks), {"0", "1"})
            shares.append(marks.count("1") / len(marks))
        self.assertGreater(max(shares), 0)
        self.assertLess(max(shares), .3)
        self.run_fail(USAGE, "simulate", *self.OPTIONS, "--moving", "-o", "n", says="--to-format")

    def test_true_poses_need_no_refinement(self):
        self.run_ok("simulate", "--drive", "--sensor", "vlp16", "--scans", "3", "-q", "-o", "r")
        refined = self.run_json("register", "r/scans", "--poses", "r/poses.txt", "-o", "r.txt")
        for scan in refined["scans"]:
            self.assertIsNone(scan["doubt"])
            self.assertLess(scan["correction_m"], .05)

    def test_drives_need_a_folder(self):
        self.run_fail(USAGE, "simulate", *self.OPTIONS, "-o", "-", says="directory")
        self.path("file").write_text("x")
        self.run_fail(FILE, "simulate", *self.OPTIONS, "-o", "file/drive", says="file/drive")


if __name__ == "__main__":
    unittest.main()
