#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The report's section on what is told between the samples: tables, goals, confidence."""
import tempfile
import unittest
from pathlib import Path

from report_support import KITTI, OTHER, ROOM, STREET, FakeContext, by
from frame.cells import Missing
from sections import (continuous, continuous_borders, continuous_confidence, continuous_equal,
                      continuous_goals, continuous_uses, goals, profiles)

LIMITS = {"min_range_m": 5., "max_range_m": 20.}
FIGURES = {"points": 9, "mean": .1, "rms": .2, "p50": .05, "p95": .3, "max": 1.,
           "within_5cm": .5, "completeness": .9, "no_surface": 1}
EQUAL = {"completeness": .8, "p50": .02, "p95": .28, "other_p50": .03, "other_p95": .3}
TRADES = [{"min_confidence": each, "completeness": .9 - each / 2, "p50": .05, "p95": .3,
           "within_5cm": .5} for each in (0, .5, .9)]
CONFIDENCE = [{"count": 1000 * i, "told": .05 + i / 10, "observed": .04 + i / 10}
              for i in range(10)]
JUMPS = {"pairs": 90, "nothing": 10, "one_surface": 60, "mean_m": .02, "mean_of_step": .2,
         "p95_m": .1, "max_m": .5, "no_jump": 70, "untrue": 0, "untrue_share": 0.}
METHODS = [("baseline", "degree 64"), ("paper", "S 1x1"), ("paper", "S 2x1"), ("paper", "S 2x2"),
           ("compact", "1 bit a point"), ("compact-fine", "5 mm"), ("compact-field", "1 bit a point"),
           ("linear", "raw samples"), ("edge-aware", "raw samples"),
           ("edge-aware-calibrated", "raw samples")]


def told(method, setting, **more):
    line = {"method": method, "setting": setting, **FIGURES, "whole": {**FIGURES, "equal": EQUAL}}
    if method in ("compact", "compact-fine"):
        line.update(bits_per_point=1., confidence=CONFIDENCE, trades=TRADES,
                    half={**TRADES[0], "completeness": .5})
    return {**line, **more}


def lines_of(key):
    """What the programs print."""
    if key["part"] == "borders":
        return [{"method": method, "step_m": .1, "borders": JUMPS, "insides": JUMPS}
                for method in continuous_borders.METHODS]
    if key["part"] == "truth":
        return [{"returns": 9, **LIMITS}, *(told(*each, factor=float(factor))
                                            for each in METHODS[:-1] for factor in (2, 4, 8))]
    if key["part"] == "sparse":
        return [{"rings_coded": 64 // key["every"], "rows": rows, "bits_per_point": 1., **FIGURES,
                 "from_held_out": {"p50": .05, "p95": .3}} for rows in (64, 128)]
    if key["part"] == "as sensor":
        return [{"setting": "5 mm", "bits_per_point": 2., **FIGURES, "all_completeness": .6}]
    if key["input"] == OTHER.name:
        return [{"skipped": "the rings of the scan cannot be told"}]
    return [{"preset": "outdoor", "rings": 64, "rings_coded": 32, "returns_coded": 90,
             "returns_held_out": 80, **LIMITS}, *(told(*each) for each in METHODS[1:])]


class ContinuousTest(unittest.TestCase):
    def tables(self, answer=lines_of, **options):
        return {table.id: table for table in continuous.tables(FakeContext(answer, **options))}

    def test_tables_of_truth_and_of_rings_held_out(self):
        tables = self.tables()
        truth = tables["continuous-truth-room-os1-64-gen1"]
        self.assertEqual(len(truth.rows), 3 * (len(METHODS) - 1))
        self.assertIn("continuous-truth-room-vlp16", tables)
        held_out = tables["continuous-held-out-kitti_raw-a"]
        self.assertEqual([row["every"] for row in held_out.rows if row["method"] == "curlidar"],
                         [2, 4])
        self.assertEqual(list(continuous.check(None, tables.values())), [])

    def test_scans_without_rings_are_listed_with_the_reason(self):
        tables = self.tables(scans=[OTHER])
        self.assertEqual({row["why"] for row in tables["continuous-left-out"].rows},
                         {"the rings of the scan cannot be told"})
        self.assertNotIn("continuous-held-out-velodyne-b", tables)
        self.assertNotIn("continuous-equal-held-out", tables)

    def test_our_runs_of_the_papers_method_stand_beside_its_own(self):
        table = self.tables()["continuous-published"]
        row = by(table, dataset="INDOOR", method="paper S=2x1")
        self.assertEqual((row["mean_2_m"].value, row["ours_2"]), (.0042, .1))
        self.assertEqual(by(table, dataset="INDOOR", method="baseline")["ours_8"], .1)
        self.assertIsInstance(by(table, dataset="Newer College", method="paper S=2x1")["ours_2"],
                              Missing)

    def test_quick_runs_measure_less(self):
        context = FakeContext(lines_of, quick=True)
        continuous.measure_lines(context)
        self.assertEqual(len(context.asked), 2 + 2 + 1 + 2 + 1)  # K = 2 asked again
        self.assertIn("2,8", context.asked[0])
        self.assertNotIn("--baseline", context.asked[0])

    def test_scenes_are_not_those_that_anything_was_trained_on(self):
        context = FakeContext(lines_of)
        continuous.measure_lines(context)
        for command in context.asked[:3]:
            self.assertEqual(command[command.index("--seed") + 1], str(continuous.SEED))

    def test_a_measurement_that_failed_has_its_row(self):
        tables = self.tables(lambda _key: [{"failure": "it ended with 1"}])
        self.assertEqual(tables["continuous-truth-room-os1-64-gen1"].rows[0]["mean"],
                         Missing("it ended with 1"))
        self.assertIsInstance(tables["continuous-equal-truth"].rows[0]["p50"], Missing)

    def test_check_finds_methods_that_are_missing(self):
        tables = self.tables()
        table = tables["continuous-held-out-kitti_raw-a"]
        table.rows = [row for row in table.rows if row["method"] != "curlidar"]
        self.assertEqual(len(list(continuous.check(None, [table]))), 1)


TAUGHT = "taught by these scans too"


def held_out_lines():
    return lines_of({"part": "held out", "input": KITTI.name})


class EqualTest(unittest.TestCase):
    def test_figures_at_equal_completeness_stand_beside_the_raw_ones(self):
        table = continuous_equal.held_out({(KITTI.name, 2): held_out_lines()}, TAUGHT)
        row = by(table, method="curlidar")
        self.assertEqual((row["edge_p50"], row["equal_edge_p50"]), (.05, .03))
        self.assertEqual(row["half_p50"], .05)
        self.assertIn(TAUGHT, table.title)

    def test_a_profile_has_a_row_of_its_own_and_bins_of_its_own(self):
        lines = held_out_lines()
        lines.append({**by_method(lines, "compact"), "method": "compact-profile"})
        measured = {(KITTI.name, 4): lines}
        rows = continuous_equal.held_out(measured, TAUGHT).rows
        self.assertEqual([row["method"] for row in rows],
                         ["curlidar", "curlidar, profile of other drives", "curlidar at 5 mm"])
        bins = continuous_confidence.tables({}, measured, TAUGHT)[0]
        self.assertEqual(len({row["kind"] for row in bins.rows}), 2)

    def test_half_that_is_not_told_has_no_figures(self):
        lines = held_out_lines()
        by_method(lines, "compact")["half"]["completeness"] = .4
        row = by(continuous_equal.held_out({(KITTI.name, 2): lines}, TAUGHT), method="curlidar")
        self.assertEqual(row["half_p95"], Missing("40 % are told"))


def by_method(lines, method):
    return next(line for line in lines if line.get("method") == method)


class GoalsTest(unittest.TestCase):
    def rows(self, lines=None, every=4):
        lines = held_out_lines() if lines is None else lines
        return continuous_goals.rows_of(
            {("room", "vlp16"): lines_of({"part": "truth"})}, {(KITTI.name, every): lines},
            {"room": lines_of({"part": "borders"}), "xt16": [{"skipped": "out of reach"}]})

    def of(self, rows, start):
        return [row for row in rows if row["goal"].startswith(start)]

    def test_what_is_missed_is_told_with_its_size(self):
        met = [row["met"] for row in self.of(self.rows(), "held-out rings, 1 bit")]
        self.assertEqual(met, ["yes", "no, 4 % over"])  # .02 of .03, .28 of .9 * .3

    def test_against_truth_the_p95_itself_is_wanted(self):
        rows = self.of(self.rows(), "simulated")
        self.assertEqual(len(rows), 2 * 3)
        self.assertTrue(all(map(goals.is_met, rows)))

    def test_four_times_is_judged_by_all_that_is_told_and_by_half(self):
        rows = self.of(self.rows(), "KITTI held-out 4x, 1 bit")
        self.assertEqual([row["met"] for row in rows],
                         ["no, 8 % short", "no, 35 % over", "no, 100 % over", "no, 50 % over"])
        self.assertEqual(self.of(self.rows(every=2), "KITTI held-out 4x"), [])

    def test_confidence_and_borders_are_goals(self):
        rows = self.rows()
        self.assertEqual({row["met"] for row in self.of(rows, "confidence, simulated")}, {"yes"})
        borders = self.of(rows, "borders")
        self.assertEqual([row["met"] for row in borders], ["yes", "yes"] + 2 * ["no figure"])
        self.assertEqual(borders[2]["measured"], Missing("out of reach"))

    def test_scans_that_could_not_be_measured_are_not_left_out(self):
        rows = self.rows([{"skipped": "16 rings are too few"}])
        self.assertEqual([row["met"] for row in self.of(rows, "held-out rings, 1 bit")],
                         2 * ["no figure"])
        lines = [line for line in held_out_lines() if line.get("method") != "compact"]
        rows = self.of(self.rows([*lines, {"method": "compact", "setting": "1 bit a point",
                                           "skipped": "1 bit is out of reach"}]), "held-out rings")
        self.assertEqual({row["measured"] for row in rows}, {Missing("1 bit is out of reach")})

    def test_sums_name_who_misses(self):
        table = goals.summary("sum", "Sum", self.rows())
        row = by(table, goal="held-out rings, 1 bit: p95 at most 0.9 of edge-aware's")
        self.assertEqual((row["met"], row["judged"], row["missed"]), (0, 1, f"{KITTI.name}, K = 4"))

    def test_the_title_says_what_taught_confidence(self):
        context = FakeContext(lines_of)
        self.assertEqual(profiles.confidence_taught(context), TAUGHT)
        with tempfile.TemporaryDirectory() as folder:
            context.left_out = Path(folder)
            self.assertIsNone(profiles.confidence_without(context, KITTI))
            (context.left_out / "kitti_raw.toml").touch()
            (context.left_out / "rings-2-kitti_raw.toml").touch()
            self.assertEqual(profiles.confidence_taught(context),
                             "taught without the scan's own group")
            continuous.held_out_of(context, KITTI, 2)
        command = context.asked[-1]
        self.assertTrue(command[command.index("--confidence") + 1].endswith("/kitti_raw.toml"))
        self.assertTrue(command[command.index("--profile") + 1].endswith("/rings-2-kitti_raw.toml"))


class ConfidenceTest(unittest.TestCase):
    def tables(self):
        lines = lines_of({"part": "truth"})[1:]
        return continuous_confidence.tables({("room", "vlp16"): lines}, {}, TAUGHT)

    def test_bins_are_pooled(self):
        table = self.tables()[0]
        self.assertEqual(len(table.rows), 9)  # the first bin is empty
        row = by(table, bin="0.3 .. 0.4")
        self.assertEqual(row["count"], 3 * 3000)
        self.assertAlmostEqual(row["off"], .01)
        self.assertEqual(row["met"], "yes")

    def test_check_finds_bins_and_trades_that_do_not_ascend(self):
        tables = self.tables()
        self.assertEqual(list(continuous_confidence.check(tables)), [])
        tables[0].rows.reverse()
        tables[1].rows[1]["completeness"] = 1.
        self.assertEqual(len(list(continuous_confidence.check(tables))), 2)


class UsesTest(unittest.TestCase):
    def tables(self, **options):
        context = FakeContext(lines_of, **options)
        return continuous_uses.tables(context, continuous.own_scenes(context))

    def test_sparse_scans_come_from_sensors_of_many_rings(self):
        rows = self.tables(scans=[KITTI, OTHER])[0].rows
        self.assertEqual([(row["input"], row["rings_coded"], row["rows"]) for row in rows],
                         [(KITTI.name, 16, 64), (KITTI.name, 16, 128), (KITTI.name, 32, 64),
                          (KITTI.name, 32, 128), (OTHER.name, 32, 64), (OTHER.name, 32, 128)])
        self.assertEqual(rows[0]["from_p95"], .3)

    def test_only_scans_of_the_wide_sensor_are_seen_as_others(self):
        self.assertIsInstance(self.tables()[1].rows[0]["p50"], Missing)
        rows = self.tables(scenes=[STREET])[1].rows
        self.assertEqual([row["other"] for row in rows], list(continuous_uses.OTHERS))

    def test_check_finds_a_median_above_its_p95(self):
        tables = self.tables()
        self.assertEqual(list(continuous_uses.check(tables)), [])
        tables[0].rows[0]["p50"] = .4
        self.assertEqual(len(list(continuous_uses.check(tables))), 1)


class BordersTest(unittest.TestCase):
    def test_what_is_not_as_wanted_is_told(self):
        jumps = {**JUMPS, "mean_of_step": .3, "untrue": 7, "untrue_share": .1}
        line = {"method": "paper", "step_m": .1, "borders": jumps, "insides": JUMPS}
        table = continuous_borders.table({"room": [line]})
        self.assertEqual([row["met"] for row in table.rows],
                         ["no: mean 0.30 D, 7 untrue", "yes"])
        self.assertEqual(len(list(continuous_borders.check([table]))), 1)  # ours is not there

    def test_scans_out_of_reach_have_their_row(self):
        table = continuous_borders.table({"xt16": [{"skipped": "1 bit is out of reach"}]})
        self.assertEqual(table.rows[0]["mean_m"], Missing("1 bit is out of reach"))
        self.assertEqual(list(continuous_borders.check([table])), [])

    def test_check_finds_parts_beyond_the_whole(self):
        lines = [{"method": method, "step_m": .1, "borders": {**JUMPS, "untrue": 71},
                  "insides": JUMPS} for method in continuous_borders.METHODS]
        table = continuous_borders.table({"room": lines})
        self.assertEqual(len(list(continuous_borders.check([table]))), 3)


if __name__ == "__main__":
    unittest.main()
