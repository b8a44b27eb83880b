# SPDX-License-Identifier: BSD-3-Clause
"""map sample, map compare and map render, on a map of one simulated scan."""

import json
import unittest

from support import FILE, INPUT, OK, USAGE, CommandTest, png_size


class MapViewTest(CommandTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.simulate("scan.pcd")
        (cls.folder / "poses.txt").write_text("1 0 0 0 0 1 0 0 0 0 1 0\n")
        built = cls.execute("map", "build", "scan.pcd", "--poses", "poses.txt", "-o", "map.curl")
        assert built.returncode == OK, built.stderr.decode()

    def test_a_sensor_sees_the_map_from_where_it_was_made(self):
        report = self.run_json("map", "sample", "map.curl", "--sensor", "vlp16", "--pose", "0,0,0",
                               "-o", "seen.pcd")
        self.assertEqual(report["rows"], 16)
        self.assertGreater(report["returns"], 1000)
        self.assertEqual(report["tiles_damaged"], 0)
        report = self.run_json("map", "sample", "map.curl", "--along", "scan.pcd", "--poses",
                               "poses.txt", "-o", "along.pcd")
        self.assertGreater(report["along"]["met"], 0.5 * report["along"]["returns"])
        self.assertLess(report["along"]["range_error"]["p50"], 0.3)

    def test_only_tiles_within_reach_are_read(self):
        result = self.execute("map", "sample", "map.curl", "--sensor", "vlp16", "--pose",
                              "9000,0,0", "-o", "far.pcd", "--json")
        self.assertEqual(result.returncode, OK, result.stderr.decode())
        self.assertIn(b"no line of sight met the map", result.stderr)
        report = json.loads(result.stdout)
        self.assertEqual(report["tiles_read"], 0)
        self.assertEqual(report["returns"], 0)

    def test_the_map_is_near_its_scan(self):
        report = self.run_json("map", "compare", "map.curl", "scan.pcd", "--poses", "poses.txt",
                               "-o", "errors.ply")
        self.assertLess(report["completeness"]["p50"], 0.1)
        self.assertGreater(report["completeness"]["within"][2]["share"], 0.5)
        self.assertIn("--crop", report["notes"][0])
        self.assertIn(b"property float error", self.path("errors.ply").read_bytes()[:1000])
        itself = self.run_json("map", "compare", "map.curl", "map.curl")
        self.assertLess(itself["accuracy"]["max"], 1e-3)

    def test_pictures(self):
        for view in ["top", "perspective"]:
            self.run_ok("map", "render", "map.curl", "--view", view, "--colour", "normal", "-o",
                        "map.png", "--size", "320x200")
            self.assertEqual(png_size(self.path("map.png")), (320, 200))

    def test_wrong_use(self):
        sample = ["map", "sample", "map.curl", "-o", "no.pcd"]
        self.run_fail(USAGE, *sample, "--sensor", "vlp16", says="--pose")
        self.run_fail(USAGE, *sample, "--pose", "0,0,0", says="--sensor")
        self.run_fail(USAGE, *sample, "--sensor", "vlp16", "--pose", "1,2", says="1,2")
        self.run_fail(INPUT, *sample, "--sensor", "vlp16", "--poses", "poses.txt", "--index", 1,
                      says="no pose 1")
        self.run_fail(FILE, "map", "compare", "none.curl", "scan.pcd", says="none.curl")
        self.run_fail(USAGE, "map", "render", "map.curl", "--colour", "error", says="--reference")
        self.assertFalse(self.path("no.pcd").exists())


if __name__ == "__main__":
    unittest.main(verbosity=2)
