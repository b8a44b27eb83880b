# SPDX-License-Identifier: BSD-3-Clause
"""Sequences: encode --sequence, decode --scan, info, verify; damage and interruption."""

import json
import signal
import subprocess
import unittest

from support import CURLIDAR, FILE, INPUT, OK, USAGE, CommandTest

SCANS = 5
GROUP = 2
SENSOR = """name = "small"
columns = 240
fov_up_deg = 10
fov_down_deg = -20
max_range_m = 100
[rings]
elevation_deg = [10, 6, 3, 1, -1, -3, -6, -10, -14, -18]
"""
QUICK_OPTIONS = ("--sensor", "small.toml", "--attributes", "none", "--effort", 1, "--step", 0.2)


class SequenceTest(CommandTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        (cls.folder / "scans").mkdir()
        (cls.folder / "small.toml").write_text(SENSOR)
        for i in range(SCANS):
            cls.ok("simulate", "--sensor", "small.toml", "--seed", i + 1, "-q",
                   "-o", f"scans/{i:03}.pcd")
        (cls.folder / "times.txt").write_text("".join(f"{0.1 * i + 1e9:.6f}\n" for i in range(SCANS)))
        (cls.folder / "poses.txt").write_text(
            "".join(f"1 0 0 {i / 2} 0 1 0 -2.25 0 0 1 {i}\n" for i in range(SCANS)))
        cls.ok("encode", "scans", "--sequence", "--group", GROUP, "--static", *QUICK_OPTIONS,
               "--times", "times.txt", "--poses", "poses.txt", "-o", "drive.curl", "-q")
        cls.ok("encode", "scans", "--sequence", "--group", 3, "--sensor", "small.toml",
               "--lossless", "--effort", 1, "-o", "exact.curl", "-q")

    @classmethod
    def ok(cls, *arguments):
        result = cls.execute(*arguments)
        assert result.returncode == OK, result.stderr.decode()
        return result.stdout

    def info(self, file="drive.curl"):
        return self.run_json("info", file)

    def test_info_tells_every_scan(self):
        info = self.info()
        self.assertEqual(info["kind"], "sequence")
        self.assertEqual((info["scans"], info["groups"], info["group"]), (SCANS, 3, GROUP))
        self.assertTrue(info["static"])
        self.assertEqual(info["bytes"], self.path("drive.curl").stat().st_size)
        for i, frame in enumerate(info["frames"]):
            self.assertEqual(frame["scan"], i)
            self.assertEqual(frame["group"], i // GROUP)
            self.assertEqual(frame["kind"] == "first", i % GROUP == 0)
            self.assertAlmostEqual(frame["time_s"], 1e9 + 0.1 * i, places=6)
            self.assertEqual([row[3] for row in frame["T_map_sensor"]], [i / 2, -2.25, i])

    def test_poses_and_times_come_back(self):
        self.run_ok("info", "drive.curl", "--poses-out", "back.txt", "--times-out", "back.times",
                    "-q")
        lines = self.path("back.txt").read_text().splitlines()
        self.assertEqual([[float(x) for x in line.split()] for line in lines],
                         [[1, 0, 0, i / 2, 0, 1, 0, -2.25, 0, 0, 1, i] for i in range(SCANS)])
        self.assertEqual([float(x) for x in self.path("back.times").read_text().split()],
                         [float(x) for x in self.path("times.txt").read_text().split()])
        self.run_fail(INPUT, "info", "exact.curl", "--poses-out", "none.txt", says=["pose"])
        self.run_fail(USAGE, "info", "scans/000.pcd", "--poses-out", "none.txt", says=["sequence"])

    def test_every_scan_decodes_alone_as_with_the_others(self):
        self.run_ok("decode", "drive.curl", "-o", "all/", "-q")
        self.assertEqual(sorted(file.name for file in self.path("all").iterdir()),
                         [f"{i:06}.pcd" for i in range(SCANS)])
        for i in (3, 0, 4, 1):
            self.run_ok("decode", "drive.curl", "--scan", i, "-o", f"one{i}.pcd", "-q")
            self.assertEqual(self.path(f"one{i}.pcd").read_bytes(),
                             self.path(f"all/{i:06}.pcd").read_bytes())

    def test_ranges_end_before_their_end(self):
        report = self.run_json("decode", "drive.curl", "--scan", "1:3", "-o", "some/")
        self.assertEqual([r["scan"] for r in report], [1, 2])
        self.assertEqual(len(list(self.path("some").iterdir())), 2)
        self.run_ok("decode", "drive.curl", "--scan", "4:", "-q")
        self.assertTrue(self.path("drive.decoded/000004.pcd").exists())
        self.run_fail(INPUT, "decode", "drive.curl", "--scan", SCANS, says=[str(SCANS)])
        self.run_fail(USAGE, "decode", "drive.curl", "--scan", "3:1", says=["--scan"])
        self.run_fail(USAGE, "decode", "drive.curl", "--scan", "x", says=["--scan"])
        self.run_fail(USAGE, "decode", "drive.curl", "--scan", "0:2", "-o", "times.txt")

    def test_scans_of_any_density_and_in_part(self):
        plain = self.run_json("decode", "drive.curl", "--scan", 1, "-o", "plain.pcd")
        dense = self.run_json("decode", "drive.curl", "--scan", 1, "--rows", 2, "-o", "dense.pcd")
        part = self.run_json("decode", "drive.curl", "--scan", "1:3", "--rings", "0:4", "-o", "p/")
        self.assertGreater(dense["points"], 1.4 * plain["points"])
        for report in part:
            self.assertLess(report["points"], plain["points"])

    def test_promises_hold_for_every_scan(self):
        report = self.run_json("verify", "exact.curl", "scans")
        self.assertTrue(report["ok"])
        self.assertTrue(all(scan["bit_exact"] for scan in report["scans"]))
        self.assertEqual(len(report["scans"]), SCANS)
        self.ok("encode", "scans", "--sequence", "--sensor", "small.toml",
                "--max-error", 0.02, "--effort", 1, "-o", "bound.curl", "-q")
        report = self.run_json("verify", "bound.curl", "scans")
        self.assertLessEqual(max(scan["max_error_m"] for scan in report["scans"]), 0.02)
        self.run_fail(INPUT, "verify", "exact.curl", "scans/000.pcd", says=["5"])
        self.run_ok("verify", "exact.curl", "scans/002.pcd", "--scan", 2)

    def test_what_needs_one_scan_asks_for_it(self):
        self.run_fail(INPUT, "compare", "scans/001.pcd", "drive.curl", says=["--scan"])
        report = self.run_json("compare", "scans/001.pcd", "drive.curl", "--scan", 1)
        self.assertLess(report["a_to_b"]["mean"], 0.2)
        self.run_ok("render", "drive.curl", "--scan", 1, "-o", "one.png", "--size", "64x48", "-q")
        self.run_fail(USAGE, "render", "scans/001.pcd", "--scan", 1, "-o", "x.png", says=["--scan"])
        self.run_fail(USAGE, "decode", "one.curl", "--scan", 1, says=["--scan"])

    def test_maps_and_sequences_are_told_apart(self):
        self.ok("map", "build", "drive.curl", "-o", "map.curl", "-q")
        for words in (("decode", "map.curl"), ("render", "map.curl", "-o", "x.png"),
                      ("compare", "scans/001.pcd", "map.curl"),
                      ("verify", "map.curl", "scans/001.pcd")):
            self.run_fail(INPUT, *words, says=["map.curl", "this is a map", "map extract"])
        self.assertEqual(self.run_json("info", "map.curl")["scans"], SCANS)
        self.run_fail(INPUT, "map", "info", "drive.curl", says=["sequence", "curlidar decode"])
        self.run_fail(USAGE, "map", "build", "exact.curl", "-o", "x.curl", says=["--poses"])
        self.run_fail(INPUT, "decode", "-", stdin=self.path("drive.curl").read_bytes(),
                      says=["sequence"])

    def test_threads_do_not_change_bytes(self):
        self.ok("encode", "scans", "--sequence", "--group", GROUP, "--static", *QUICK_OPTIONS,
                "--times", "times.txt", "--poses", "poses.txt", "-o", "threads.curl", "-q",
                "--threads", 3)
        self.assertEqual(self.path("threads.curl").read_bytes(),
                         self.path("drive.curl").read_bytes())

    def test_wrong_usage(self):
        self.run_fail(USAGE, "encode", "scans", "--sequence", says=["-o"])
        self.run_fail(USAGE, "encode", "scans/000.pcd", "--group", 3, says=["--sequence"])
        self.run_fail(USAGE, "encode", "scans/000.pcd", "--times", "times.txt", says=["--sequence"])
        self.run_fail(USAGE, "encode", "drive.curl", "--sequence", "-o", "x.curl", says=["encoded"])
        self.path("few.txt").write_text("1\n2\n")
        self.run_fail(INPUT, "encode", "scans", "--sequence", "-o", "x.curl", "--times", "few.txt",
                      says=["few.txt"])
        self.run_fail(FILE, "encode", "nowhere.pcd", "--sequence", "-o", "x.curl")
        self.assertFalse(self.path("x.curl").exists())

    def test_a_scan_that_cannot_be_coded_leaves_no_file(self):
        self.path("broken.pcd").write_text("# .PCD v0.7\nVERSION 0.7\nFIELDS x y\n")
        self.run_fail(INPUT, "encode", "scans/000.pcd", "broken.pcd", "--sequence",
                      "-o", "none.curl", *QUICK_OPTIONS, "-q", says=["broken.pcd"])
        self.assertEqual([f for f in self.folder.iterdir()
                          if f.name == "none.curl" or f.name.endswith(".tmp")], [])

    def test_an_interrupted_command_leaves_no_file(self):
        command = subprocess.Popen(
            [CURLIDAR, "encode", *["scans"] * 40, "--sequence", *map(str, QUICK_OPTIONS),
             "-o", "late.curl"],
            cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        command.stdout.readline()  # the first scan is written
        command.send_signal(signal.SIGTERM)
        command.communicate()
        self.assertNotEqual(command.returncode, OK)
        self.assertEqual([f for f in self.folder.iterdir()
                          if f.name == "late.curl" or f.name.endswith(".tmp")], [])

    def test_cut_off_it_decodes_as_far_as_it_goes(self):
        data = self.path("drive.curl").read_bytes()
        self.path("cut.curl").write_bytes(data[:len(data) * 2 // 3])
        self.run_fail(INPUT, "decode", "cut.curl", "-o", "c/", says=["--allow-truncated"])
        result = self.execute("decode", "cut.curl", "--allow-truncated", "-o", "cut/", "--json")
        self.assertEqual(result.returncode, INPUT)
        self.assertIn(b"cut.curl", result.stderr)
        listed = self.execute("info", "cut.curl", "--allow-truncated", "--json")
        self.assertEqual(listed.returncode, INPUT)
        self.assertGreater(len(json.loads(listed.stdout)["missing"]), 0)
        done = sorted(self.path("cut").iterdir())
        self.assertEqual(json.loads(listed.stdout)["scans"], len(done))
        self.assertTrue(GROUP <= len(done) < SCANS, done)
        for file in done:
            self.run_ok("decode", "drive.curl", "--scan", int(file.stem), "-o", "w.pcd", "-q")
            self.assertEqual(file.read_bytes(), self.path("w.pcd").read_bytes())

    def test_a_damaged_group_harms_no_other(self):
        data = bytearray(self.path("drive.curl").read_bytes())
        sizes = [frame["bytes"] for frame in self.info()["frames"]]
        data[60 + sum(sizes[:2]) + sizes[2] // 2] ^= 0x10
        self.path("damaged.curl").write_bytes(data)
        result = self.execute("decode", "damaged.curl", "-o", "damaged/", "-q")
        self.assertEqual(result.returncode, INPUT)
        self.assertIn(b"group 1 with scans 2 to 3", result.stderr)
        self.assertEqual(sorted(int(f.stem) for f in self.path("damaged").iterdir()), [0, 1, 4])
        result = self.execute("info", "damaged.curl", "--json")
        self.assertEqual(result.returncode, INPUT)
        self.assertEqual(json.loads(result.stdout)["damaged"][0]["first_scan"], 2)


if __name__ == "__main__":
    unittest.main()
