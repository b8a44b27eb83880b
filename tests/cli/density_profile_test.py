# SPDX-License-Identifier: BSD-3-Clause
"""decode with density profiles: of a sensor of 31 rows of which a VLP-16 has every other one."""

import json
import math
import unittest

from support import INPUT, USAGE, CommandTest

ROWS = 31  # at 15, 14, .. -15 degrees, of which the VLP-16 has the first, the third, ..


def profile(**tables):
    """Text of a profile; tables of one number for each row."""
    tables = {"elevation_mdeg": [15000 - 1000 * row for row in range(ROWS)],
              "return_permille": [1000] * ROWS, **tables}
    lines = ['name = "test"', f"rows = {ROWS}", "given_first = 0", "given_every = 2", "[tables]"]
    lines += [f"{key} = {[[number] for number in numbers]}" for key, numbers in tables.items()]
    return "\n".join(lines) + "\n"


def elevations(path):
    """Of the points of a .csv file, degrees, with their ranges."""
    lines = path.read_text().splitlines()
    names = lines[0].replace("#", "").replace(",", " ").split()
    points = []
    for line in lines[1:]:
        p = dict(zip(names, map(float, line.replace(",", " ").split())))
        flat = math.hypot(p["x"], p["y"])
        points.append((math.degrees(math.atan2(p["z"], flat)), math.hypot(flat, p["z"])))
    return points


class DensityProfileTest(CommandTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.simulate("scan.pcd")
        cls.report = json.loads(cls.execute("encode", "scan.pcd", "--effort", 1, "--json").stdout)

    def decode(self, name, *arguments):
        self.run_json("decode", "scan.curl", *arguments, "--attributes", "none", "-o", name)
        return elevations(self.path(name))

    def write(self, name, **tables):
        self.path(name).write_text(profile(**tables))

    def test_one_without_rows_fits_every_file(self):
        plain = self.decode("plain.csv", "--rows", 2)
        self.assertEqual(self.decode("own.csv", "--rows", 2, "--density-profile", "generic"), plain)
        self.path("mine.toml").write_text('name = "mine"\n')
        self.assertEqual(self.decode("mine.csv", "--rows", 2, "--density-profile", "mine.toml"), plain)

    def test_what_cannot_be_used_is_refused(self):
        self.run_fail(INPUT, "decode", "scan.curl", "--density-profile", "kitti-rings-32", "-o",
                      "k.pcd", says=["kitti-rings-32", "32 rings, not for 16"])
        self.write("beside.toml", elevation_mdeg=[15900 - 1000 * row for row in range(ROWS)])
        self.run_fail(INPUT, "decode", "scan.curl", "--density-profile", "beside.toml", "-o",
                      "b.pcd", says=["ring 0", "beside row 0"])
        self.write("bad.toml", bias_mm=[2000] * ROWS)
        self.run_fail(USAGE, "decode", "scan.curl", "--density-profile", "bad.toml", "-o", "b.pcd",
                      says=["bad.toml", "bias_mm"])
        self.run_fail(USAGE, "decode", "scan.curl", "--density-profile", "nobody", says="nobody")

    def test_rows_that_hardly_return_leave_no_points(self):
        def near_row(points, row):
            return sum(abs(up - (15 - row)) < 0.3 for up, _ in points)

        self.write("rare.toml", return_permille=[50 if row == 17 else 1000 for row in range(ROWS)])
        plain = self.decode("plain.csv", "--rows", 2)
        rare = self.decode("rare.csv", "--rows", 2, "--density-profile", "rare.toml")
        self.assertGreater(near_row(plain, 17), 100)
        self.assertEqual(near_row(rare, 17), 0)
        for row in (16, 18):  # given
            self.assertEqual(near_row(rare, row), near_row(plain, row))

    def test_rows_measure_what_theirs_do_if_rows_are_asked_for(self):
        def ranges(points, row):
            return sorted(r for up, r in points if abs(up - (15 - row)) < 0.3)

        self.write("far.toml", bias_mm=[200 if row == 21 else 0 for row in range(ROWS)])
        # At jumps a row measures one of two surfaces, and nothing is added.
        for rows, least, most in (2, 0.1, 0.21), (4, 0, 0):
            plain = ranges(self.decode("plain.csv", "--rows", rows, "--no-masks"), 21)
            far = ranges(self.decode("far.csv", "--rows", rows, "--no-masks", "--density-profile",
                                     "far.toml"), 21)
            self.assertEqual(len(far), len(plain))
            self.assertGreater(len(far), 100)
            by = sorted(b - a for a, b in zip(plain, far))[len(far) // 2]
            self.assertTrue(least <= by <= most, by)


if __name__ == "__main__":
    unittest.main()
