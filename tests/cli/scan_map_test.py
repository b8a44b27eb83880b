# SPDX-License-Identifier: BSD-3-Clause
"""map build --kind scans: keyframes with poses, and dense clouds of them; map build --still."""

import unittest

from support import FILE, INPUT, OK, USAGE, CommandTest, ply_header, read_kitti


def pose(x, y=0):
    return f"1 0 0 {x} 0 1 0 {y} 0 0 1 0\n"


class ScanMapTest(CommandTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        for i in range(4):
            cls.simulate(f"{i}.pcd", "--seed", i + 1)
        cls.scans = [f"{i}.pcd" for i in range(4)]
        (cls.folder / "poses.txt").write_text("".join(pose(100 + 2 * i) for i in range(4)))
        result = cls.execute("map", "build", *cls.scans, "--poses", "poses.txt", "--kind", "scans",
                             "--columns", 256, "--effort", 1, "--every", 2, "-o", "map.curl")
        assert result.returncode == OK, result.stderr.decode()

    def points(self, *arguments):
        report = self.run_json("map", "extract", "map.curl", *arguments, "-o", "out.bin",
                               "--to-format", "kitti")
        points = read_kitti(self.path("out.bin"))
        self.assertEqual(report["points"], len(points))
        return points

    def test_info_counts_keyframes_and_sizes(self):
        info = self.run_json("map", "info", "map.curl")
        self.assertEqual((info["map"], info["keyframes"], info["scans"]), ("scans", 2, 2))
        size = self.path("map.curl").stat().st_size
        self.assertEqual(info["bytes"], size)
        self.assertEqual(size, info["bytes_parts"] + info["bytes_index"] + info["bytes_other"])
        self.assertAlmostEqual(info["bytes_per_metre"], size / 6, 6)
        self.assertAlmostEqual(info["bits_per_point"], size * 8 / info["points"], 6)

    def test_every_keyframe_lies_where_it_was_taken(self):
        # Of one row and column each: what decode gives for the scan alone, moved.
        info = self.run_json("map", "info", "map.curl")
        points = self.points()
        self.assertEqual(len(points), info["points"])
        near = self.points("--radius", "100,0,0,20")
        self.assertTrue(0 < len(near) < len(points))
        for x, y, z, _ in near:
            self.assertLess((x - 100) ** 2 + y * y + z * z, 400.1)
        self.assertEqual(self.execute("map", "extract", "map.curl", "--box", "900,0,0,901,1,1",
                                      "-o", "none.ply").returncode, OK)
        self.assertEqual(ply_header(self.path("none.ply"))["vertex"], 0)

    def test_rows_make_it_denser_and_cubes_thinner(self):
        coded = len(self.points())
        dense = self.points("--rows", 8)
        self.assertGreater(len(dense), 5 * coded)
        thin = self.points("--rows", 8, "--dedupe", 0.25)
        self.assertTrue(coded < len(thin) < len(dense))
        wider = self.points("--rows", 8, "--dedupe", 1)
        self.assertLess(len(wider), len(thin))
        self.assertLessEqual(set(thin), set(dense))

    def test_options_of_the_other_kind_are_refused(self):
        build = ["map", "build", *self.scans, "--poses", "poses.txt", "-o", "other.curl"]
        for option in (["--quality", "fine"], ["--footprint", 0.125], ["--still"], ["--curves"]):
            self.run_fail(USAGE, *build, "--kind", "scans", *option, says=[option[0], "surface maps"])
        for option in (["--error", 0.05], ["--columns", 512], ["--effort", 2]):
            self.run_fail(USAGE, *build, *option, says=[option[0], "maps of scans"])
        self.run_fail(USAGE, *build, "--kind", "scans", "--error", 0.05, "--step", 0.1,
                      says="give one")
        self.run_fail(USAGE, *build, "--kind", "points", says="surface or scans")
        for option in (["--spacing", 0.1], ["--lod", 1], ["--normals"]):
            self.run_fail(USAGE, "map", "extract", "map.curl", *option, "-o", "x.ply",
                          says="map of scans")
        self.assertNotIn("other.curl", self.files())

    def test_append_and_damage(self):
        self.path("more.txt").write_text(pose(106))
        self.run_ok("map", "append", "map.curl", "3.pcd", "--poses", "more.txt", "--columns", 256,
                    "--effort", 1, "-o", "longer.curl")
        self.assertEqual(self.run_json("map", "info", "longer.curl")["keyframes"], 3)
        old, longer = (self.path(n).read_bytes() for n in ("map.curl", "longer.curl"))
        self.assertIn(old[200:400], longer)
        self.path("cut.curl").write_bytes(longer[:-200])
        self.run_fail(INPUT, "map", "info", "cut.curl")
        cut = self.execute("map", "extract", "cut.curl", "--allow-truncated", "-o", "cut.ply")
        self.assertEqual(cut.returncode, OK, cut.stderr.decode())
        self.assertGreater(ply_header(self.path("cut.ply"))["vertex"], 1000)
        self.run_fail(FILE, "map", "extract", "nowhere.curl", "-o", "x.ply")


if __name__ == "__main__":
    unittest.main(verbosity=2)
