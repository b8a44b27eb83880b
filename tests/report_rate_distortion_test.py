#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The report's section on rate and distortion: what it reads from measured lines, matched errors,
peers that are missing or stored."""
import unittest
from pathlib import Path
from unittest import mock

from report_support import FakeContext
from common import curves
from frame.cells import Missing
from frame.scans import Scan
from sections import rate_distortion as section
from sections import rate_distortion_curves

REFERENCE = Scan("kitti_raw/curl_example/0.pcd", Path("0.pcd"), "HDL-64E")
OTHER = Scan("kitti_raw/other.pcd", Path("other.pcd"), "HDL-64E")
RETURNS = 1000


def line(codec, error_m, size, **more):
    statistics = {"mean": error_m, "rms": error_m, "p95": 2 * error_m, "max": 9 * error_m}
    return {"codec": codec, "setting": f"error_nn {error_m:g}", "bytes": size,
            "points_back": RETURNS, "nearest_to_decoded": statistics,
            "nearest_to_raw": {**statistics, "mean": error_m / 2}, "encode_ms": 2.,
            "decode_ms": 1., **more}


class Context(FakeContext):
    """Remembers what was asked with its key."""

    def __init__(self, lines, quick=True, scan=REFERENCE):
        super().__init__(lines, scans=[scan], quick=quick)
        self.curlidar = Path("curlidar")

    def measure(self, _section, key, command):
        self.asked.append((key, command))
        return self.answer(key)


def answers(key):
    """Ours and one peer, another peer that was not built."""
    if key["part"] == "grid":
        return [{"failure": "the program ended with 1: no cell holds a return"}]
    if key["codec"] == section.OURS:
        bits = {.005: 3., .02: 1., .05: .5}[key["error_m"]]
        return [line(section.OURS, .99 * key["error_m"], int(RETURNS * bits / 8),
                     returns=RETURNS, effort=key["effort"])]
    return [{"returns": RETURNS, "sensor": "x"}, line("pcl-octree", .01, 1000),
            line("pcl-octree", .04, 500, points_back=300),
            {"codec": "draco-kd-tree", "skipped": "its library was not found when this was built"}]


def absent(_tool):
    return None


class CurvesTest(unittest.TestCase):
    POINTS = [{"error_m": .01, "bits": 4.}, {"error_m": .04, "bits": 2.}]

    def test_rates_are_linear_in_the_logarithm_of_the_error(self):
        self.assertAlmostEqual(curves.rate_at(self.POINTS, .02, "bits"), 3.)

    def test_a_little_less_error_than_asked_for_counts_at_its_own_rate(self):
        self.assertIsNone(curves.rate_at(self.POINTS, .041, "bits"))
        self.assertEqual(curves.rate_at(self.POINTS, .041, "bits", curves.SLACK), 2.)
        self.assertIsNone(curves.rate_at(self.POINTS, .0421, "bits", curves.SLACK))
        self.assertIsNone(curves.rate_at(self.POINTS, .0099, "bits", curves.SLACK))

    def test_nearest_is_nearest_in_the_logarithm(self):
        self.assertEqual(curves.nearest(self.POINTS, .019)["error_m"], .01)
        self.assertEqual(curves.nearest(self.POINTS, .021)["error_m"], .04)
        self.assertIsNone(curves.nearest([], .02))


@mock.patch("shutil.which", absent)
class SectionTest(unittest.TestCase):
    def table(self, scan=REFERENCE):
        return section.raw_table(Context(answers, scan=scan), scan)

    def row(self, title, scan=REFERENCE):
        return next(row for row in self.table(scan).rows if row["codec"] == title)

    def test_error_is_the_larger_direction_and_rates_count_returns(self):
        row = self.row("PCL octree")
        self.assertAlmostEqual(row["at_20mm"], 8 * 750 / RETURNS)
        self.assertEqual(row["at_5mm"], section.NOT_REACHED)
        self.assertEqual((row["back_at_5mm"], row["back_at_50mm"]), (RETURNS, 300))

    def test_ours_has_a_figure_at_every_error_asked_for(self):
        row = self.row("curlidar")
        for key, bits in (("at_5mm", 3.), ("at_20mm", 1.), ("at_50mm", .5)):
            self.assertAlmostEqual(row[key], bits, delta=.02)

    def test_a_peer_that_was_not_built_says_so(self):
        self.assertIn("not found when this was built", self.row("Draco kd-tree")["at_20mm"])
        self.assertIsInstance(self.row("Draco kd-tree")["encode_ms"], Missing)

    def test_stored_figures_belong_to_their_scan_only(self):
        row = self.row("G-PCC octree (stored)")
        self.assertEqual(row["at_5mm"].value, 9.84)
        self.assertIn("2026-11-22", self.stored_source(row["at_5mm"].source))
        others = [row["codec"] for row in self.table(OTHER).rows]
        self.assertFalse([codec for codec in others if "stored" in codec], others)
        self.assertEqual(self.row("G-PCC", OTHER)["at_5mm"], "tmc3 is not on the PATH")

    def stored_source(self, key):
        return Context(answers).published["sources"][key]

    def test_programs_on_the_path_are_measured_and_not_shown_as_stored(self):
        with mock.patch("shutil.which", lambda tool: f"/bin/{tool}" if tool == "tmc3" else None):
            context = Context(answers)
            rows = section.raw_table(context, REFERENCE).rows
        asked = [key["codec"] for key, _ in context.asked]
        self.assertEqual([codec for codec in asked if codec.startswith("gpcc")],
                         list(rate_distortion_curves.EXTERNAL["tmc3"]))
        stored = [row["codec"] for row in rows if "stored" in row["codec"]]
        self.assertIn("Cloudini zstd (stored)", stored)
        self.assertFalse([codec for codec in stored if "G-PCC" in codec], stored)

    def test_best_peer_may_be_a_stored_one(self):
        rows = {row["error"]: row for row in section.summary_rows(Context(answers))
                if row["input"] == REFERENCE.name}
        self.assertEqual(rows["5 mm"]["peer"], "G-PCC predictive, angular, lossy (stored)")
        self.assertAlmostEqual(rows["5 mm"]["share"], 100 * 3 / 4.92, delta=.5)
        self.assertEqual(rows["5 cm"]["best"].value, 1.60)

    def test_every_table_is_complete_when_nothing_could_be_measured(self):
        context = Context(lambda key: [{"failure": "the program is broken"}], quick=False)
        for table in section.tables(context):  # Table refuses empty cells
            self.assertTrue(table.rows)
        row = next(row for row in section.raw_table(context, OTHER).rows
                   if row["codec"] == "curlidar")
        self.assertEqual(row["at_20mm"], "the program is broken")

    def test_check_finds_lost_returns_and_errors_beyond_the_target(self):
        self.assertEqual(list(section.check(Context(answers), [])), [])

        def wrong(key):
            lines = answers(key)
            if key.get("codec") == section.OURS and key["error_m"] == .02:
                lines[0].update(points_back=RETURNS - 1, bytes=5000, **{
                    "nearest_to_raw": {"mean": .021, "rms": .03, "p95": .04, "max": 1.}})
            return lines
        said = " / ".join(section.check(Context(wrong), []))
        for part in ("999 of 1000", "is off by 0.021", "needs more bits"):
            self.assertIn(part, said)


if __name__ == "__main__":
    unittest.main(verbosity=2)
