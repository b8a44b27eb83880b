#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What ./dev rate-distortion computes from measured points, and what it has stored."""
import contextlib
import io
import json
import math
import sys
import unittest
import xml.etree.ElementTree
from pathlib import Path
from unittest import mock

ROOM = Path(__file__).resolve().parents[1] / "bench/rate_distortion"
sys.path.insert(0, str(ROOM))
import lines  # noqa: E402
import measure  # noqa: E402
import plot  # noqa: E402
import scans  # noqa: E402
import table  # noqa: E402


def point(codec, error_m, bits, **more):
    return {"codec": codec, "error_m": error_m, "bits_per_cell": bits, "effort": "",
            "target_m": "", "scan": scans.REFERENCE, "sensor": "HDL-64E", "rows": 64, "cols": 1024,
            "cells": 43384, "min_range": "5", "max_range": "p90", **more}


class TableTest(unittest.TestCase):
    def test_bits_are_linear_in_the_logarithm_of_the_error(self):
        points = [point("a", .01, 4.0), point("a", .04, 2.0)]
        self.assertAlmostEqual(table.bits_at(points, .02), 3.0)
        self.assertAlmostEqual(table.bits_at(points, .04), 2.0)

    def test_nothing_is_extrapolated(self):
        points = [point("a", .01, 4.0), point("a", .04, 2.0)]
        self.assertIsNone(table.bits_at(points, .009))
        self.assertIsNone(table.bits_at(points, .041))

    def test_points_that_are_beaten_do_not_count(self):
        points = [point("a", .01, 4.0), point("a", .02, 5.0), point("a", .04, 2.0)]
        self.assertAlmostEqual(table.bits_at(points, .02), 3.0)

    def test_best_peer_is_not_ours(self):
        points = [p for codec, bits in (("a", 4), ("b", 3), (measure.OURS, 1))
                  for p in (point(codec, .01, bits + 1), point(codec, .04, bits - 1))]
        bits, codec = table.best_peer(points, .02)
        self.assertEqual(codec, "b")
        self.assertAlmostEqual(bits, 3)
        self.assertEqual(table.best_peer(points, .5), (None, None))

    def test_goals_missed_are_counted(self):
        peers = [point("a", e, b) for e, b in ((.001, 9), (.1, 1))]
        ours = [point(measure.OURS, t, goal, target_m=t, effort=effort)
                for t, goals in table.GOALS.items() for effort, goal in zip(measure.EFFORTS, goals)]
        self.assertEqual(table.lines_of(peers + ours, True)[1], 0)
        self.assertEqual(table.lines_of(peers + ours[1:], True)[1], 1)
        ours[0]["bits_per_cell"] += .01
        self.assertEqual(table.lines_of(peers + ours, True)[1], 1)
        self.assertEqual(table.lines_of(peers, False)[1], 0)

    def test_other_scans_have_the_reference_share_of_the_best_peer(self):
        other = [point("a", .05, 3.32, scan="other")]
        goals = table.goals_at(other, .05, 3.32)
        self.assertTrue(all(map(math.isclose, goals, (1.24, 1.5))), goals)


class LinesTest(unittest.TestCase):
    def test_every_effort_is_measured_at_every_error_and_failures_are_told(self):
        def ours_at(_grid, _size, _program, _curlidar, target_m, effort, _folder):
            if target_m == .02 and effort == "9":
                raise RuntimeError("no way")
            return point(measure.OURS, target_m, 1., target_m=target_m, effort=effort), []
        grid = scans.Grid(scans.Scan("a", Path("a"), "b"), Path("g"), "5", "p90", 7)
        peer = {"codec": "zip", "skipped": "its library was not found when this was built"}
        said = io.StringIO()
        with mock.patch.object(measure, "ours_at", ours_at), \
                mock.patch.object(scans, "grids_of", lambda *_: [grid]), \
                mock.patch.object(measure, "output_of",
                                  lambda *_: '{"cells": 7}\n' + json.dumps(peer)), \
                contextlib.redirect_stdout(said):
            lines.main("program", "curlidar", "a.pcd", ".05,.02", "default,9", "0")
        size, skipped, *ours = map(json.loads, said.getvalue().splitlines())
        self.assertEqual((size["cells"], size["max_range"], skipped), (7, "p90", peer))
        self.assertEqual([(line["effort"], line["target_m"]) for line in ours],
                         [("default", .05), ("default", .02), ("9", .05), ("9", .02)])
        self.assertEqual(ours[-1]["skipped"], "no way")


class StoredCurvesTest(unittest.TestCase):
    def test_columns_are_those_of_the_program(self):
        header = (ROOM / "curves.csv").read_text(encoding="utf-8").split("\n", 1)[0]
        self.assertEqual(header.split(","), list(measure.COLUMNS))

    def test_picture_is_drawn_from_the_table(self):
        drawn = plot.draw(plot.read(ROOM / "curves.csv"))
        xml.etree.ElementTree.fromstring(drawn)
        self.assertEqual((ROOM / "curves.svg").read_text(encoding="utf-8"), drawn)

    def test_scans_are_named_without_the_folders_of_a_machine(self):
        points = plot.read(ROOM / "curves.csv")
        self.assertEqual([p["scan"] for p in points if p["scan"].startswith(("/", ".", "~"))], [])
        self.assertEqual(points[0]["scan"], scans.REFERENCE)


if __name__ == "__main__":
    unittest.main(verbosity=2)
