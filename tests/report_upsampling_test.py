#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The report's section on upsampling: means over drives, rows that are missing."""
import tempfile
import unittest
from pathlib import Path

from report_support import KITTI, OTHER, FakeContext, by
from frame import scans
from frame.cells import Missing
from frame.scans import Scan
from sections import goals, upsampling, upsampling_goals

SECOND = Scan("kitti_object/1.bin", Path("1.bin"), "HDL-64E")
THIRD = Scan("kitti_object/2.bin", Path("2.bin"), "HDL-64E")
STATISTICS = {"count": 9, "mean": .1, "std": .1, "rms": .2, "p50": .05, "p95": .3, "max": 1.}


def lines_of(key):
    if key["part"] == "nearest":
        return [{"rings": 64, "rings_coded": 16},
                *({"method": method, "points": 9, "to_scan": STATISTICS, "from_scan": STATISTICS,
                   "to_scan_percentiles": [.1] * 101} for method in upsampling.NEAREST)]
    mae = {KITTI.name: 1., SECOND.name: 2., THIRD.name: 3.}[key["input"]]
    return [{"motion_undone": True},
            *({"method": method, "mae_m": mae, "both_valid_mae_m": .5, "chamfer_m2": .1, "iou": .4,
               "f1": .5, "p50": .05, "completeness": .9} for method in ("edge-aware", "rules"))]


class UpsamplingTest(unittest.TestCase):
    def tables(self, **options):
        context = FakeContext(lines_of, **options)
        return {table.id: table for table in upsampling.tables(context)}

    def test_every_drive_counts_the_same(self):
        tables = self.tables(scans=[KITTI, SECOND, THIRD, OTHER])
        row = by(tables["upsampling"], method=upsampling.RAW["rules"])
        self.assertEqual((row["mae_m"], row["drives"]), ((1 + 2.5) / 2, 2))
        row = by(tables["upsampling-drives"], drive="kitti_object", method=upsampling.RAW["rules"])
        self.assertEqual((row["mae_m"], row["scans"]), (2.5, 2))
        self.assertEqual(len(tables["upsampling-nearest"].rows), 3 * len(upsampling.NEAREST))
        self.assertEqual(list(upsampling.check(None, tables.values())), [])

    def test_published_rows_have_what_was_published(self):
        table = self.tables()["upsampling"]
        row = by(table, method="TULIP")
        self.assertEqual(row["iou"].value, .382)
        self.assertIsInstance(row["p50"], Missing)

    def test_without_kitti_there_are_no_figures(self):
        tables = self.tables(scans=[OTHER])
        self.assertIsInstance(by(tables["upsampling"], method=upsampling.RAW["nearest ring"])["iou"], Missing)
        self.assertNotIn("upsampling-nearest", tables)

    def test_check_finds_an_f1_below_its_iou(self):
        table = self.tables()["upsampling-drives"]
        table.rows[0]["f1"] = .3
        self.assertEqual(len(list(upsampling.check(None, [table]))), 1)

    def test_all_scans_of_the_folder_are_beside_one(self):
        with tempfile.TemporaryDirectory() as folder:
            data = Path(folder)
            names = ["a/0.pcd", "a/1.pcd", "b/0.pcd"]
            lines = ["path\tdataset\tsensor\tchannels\tpoints\tbytes\tsource\tlicence"]
            for name in names:
                (data / name).parent.mkdir(exist_ok=True)
                (data / name).touch()
                lines.append(f"{name}\tD\tS\t64\t1\t1\t-\t-")
            (data / scans.MANIFEST).write_text("\n".join(lines) + "\n", encoding="utf-8")
            beside = scans.every_scan_beside(Scan("a/1.pcd", data / "a/1.pcd", "S"))
            self.assertEqual([each.name for each in beside], names)
            alone = Scan("1.pcd", data / "elsewhere/1.pcd", "S")
            self.assertEqual(scans.every_scan_beside(alone), [alone])


class GoalsTest(unittest.TestCase):
    def test_misses_are_told_with_their_size(self):
        self.assertEqual(goals.at_most("MAE", "a", 1.1, 1.1)["met"], "yes")
        self.assertEqual(goals.at_most("MAE", "a", 1.21, 1.1)["met"], "no, 10 % over")
        self.assertEqual(goals.at_most("MAE", "a", 1.003, 1)["met"], "no, 0.3 % over")
        self.assertEqual(goals.at_most("jumps", "a", 3, 0)["met"], "no")
        self.assertEqual(goals.at_least("IoU", "a", .39, .38)["met"], "yes")
        self.assertEqual(goals.at_least("IoU", "a", .19, .38)["met"], "no, 100 % short")

    def test_what_has_no_figure_is_not_met(self):
        rows = [goals.at_most("MAE", "a", 1., 1.1), goals.no_figure("MAE", "b", "too few", 1.1)]
        row = by(goals.summary("sum", "Sum", rows), goal="MAE")
        self.assertEqual((row["judged"], row["met"], row["missed"]), (2, 1, "b"))

    def test_files_are_judged_by_what_they_lose(self):
        good = {"mae_m": 1., "chamfer_m2": .1, "iou": .4, "f1": .6}
        bad = {"mae_m": 1.05, "chamfer_m2": .1, "iou": .32, "f1": .6}
        exact, coded = "rules, tables, trees", "decoded image, 1 bit"
        rows = upsampling_goals.rows_of({
            "rules": {**good, "iou": .32}, exact: good, coded: bad, coded + upsampling.EXACT: good})
        met = {(row["goal"], row["input"]): row["met"] for row in rows}
        self.assertEqual(met["without a profile: IoU", "image rows"], "no, 3 % short")
        self.assertEqual(met["profile of other drives: IoU", "image rows"], "yes")
        self.assertEqual(met["file at 1 bit: MAE worse by", "image rows, rows as decoded"], "yes")
        self.assertEqual(met["file at 1 bit: IoU worse by", "image rows, rows as decoded"],
                         "no, 100 % over")
        self.assertEqual(met["file at 1 bit: IoU worse by", "image rows" + upsampling.EXACT], "yes")

    def test_names_of_lines_say_what_they_stand_on(self):
        said = upsampling.described("file, 1 bit, profile, given rows exact")
        self.assertEqual(said["method"], "curlidar, file at 1 bit a return, profile of other "
                                         "drives, given rows exact")
        self.assertIn("--sensor", said["what"])


if __name__ == "__main__":
    unittest.main()
