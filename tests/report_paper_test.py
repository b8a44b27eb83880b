#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The report's sections of the paper's comparisons: what their tables make of measured lines, of
codecs that are missing and of scans that cannot be taken."""
import unittest

from report_support import KITTI, OTHER, ROOM, FakeContext, by
from frame.cells import Missing
from sections import one_to_one, timing

STATISTICS = {"count": 9, "mean": .1, "std": .1, "rms": .2, "p50": .05, "p95": .3, "max": 1.}


def coded(codec, setting, **more):
    line = {"codec": codec, "setting": setting, "points_in": 100, "points_out": 90, "bytes": 300,
            "bits_per_point": 24., "percent_of_float32": 25., "percent_of_float64": 12.5}
    for direction in one_to_one.DIRECTIONS:
        line[direction] = STATISTICS
        line[f"{direction}_percentiles"] = [.01] * 101
    return {**line, **more}


def one_to_one_lines(_key):
    lines = [{"preset": "outdoor", "returns": 120, "returns_in_range": 110, "grid_points": 100,
              "min_range_m": 5., "max_range_m": 20.}]
    for bits, (codec, setting) in enumerate(one_to_one.METHODS):
        if codec == "pcl":
            lines.append({"codec": codec, "setting": setting, "skipped": "PCL was not found"})
        elif codec == "compact":
            lines.append(coded(codec, setting, bits_per_point=20. - bits))
        else:
            lines.append(coded(codec, setting, cp_paper_percent=15.))
    return lines


class OneToOneTest(unittest.TestCase):
    def test_means_stand_beside_what_the_paper_published_of_the_dataset(self):
        row = by(one_to_one.means(FakeContext(one_to_one_lines)), dataset="KITTI",
                 method="paper, default")
        self.assertEqual((row["inputs"], row["mean_m"], row["cp_percent"]), (1, .1, 15.))
        self.assertEqual(row["published_mean_m"].value, .053)
        self.assertEqual(row["published_cp_percent"].value, 19.29)

    def test_a_dataset_that_is_not_in_the_run_says_so(self):
        table = one_to_one.means(FakeContext(one_to_one_lines, scans=[OTHER]))
        kitti = by(table, dataset="KITTI", method="paper, default")
        self.assertIsInstance(kitti["mean_m"], Missing)
        self.assertEqual(by(table, dataset="INDOOR", method="paper, default")["inputs"], 1)

    def test_codecs_that_were_not_built_have_their_rows(self):
        table = one_to_one.table_of(FakeContext(one_to_one_lines), KITTI)
        self.assertEqual(by(table, method="PCL low online")["bytes"], Missing("PCL was not found"))
        self.assertEqual(len(table.rows), len(one_to_one.METHODS))

    def test_simulated_scans_are_taken_as_they_were_made_real_ones_as_they_look(self):
        context = FakeContext(one_to_one_lines)
        one_to_one.measure(context)
        self.assertNotIn("--sensor", context.asked[0])
        self.assertEqual(context.asked[1][-4:], ["--sensor", "os1-64-gen1", "--preset", "indoor"])

    def test_a_scan_that_cannot_be_taken_says_why(self):
        for line in ({"skipped": "limited field"}, {"failure": "limited field"}):
            table = one_to_one.table_of(FakeContext(lambda _key, each=line: [each]), KITTI)
            self.assertEqual(table.rows[0]["bytes"], Missing("limited field"))

    def test_check_finds_bits_that_grow_with_the_error(self):
        good = one_to_one.tables(FakeContext(one_to_one_lines))
        self.assertEqual(list(one_to_one.check(None, good)), [])
        by(good[1], method="curlidar, 5 cm")["bits_per_point"] = 99.
        self.assertEqual(len(list(one_to_one.check(None, good))), 1)

    def test_titles_of_panels_are_short(self):
        self.assertEqual(one_to_one.short("street"), "street")
        self.assertEqual(one_to_one.short("kitti_raw/a/0.pcd"), "kitti_raw\na/0")
        longest = max(one_to_one.short(f"ouster/{'x' * 90}.pcd").split("\n"), key=len)
        self.assertLessEqual(len(longest), 30)

    def test_check_finds_codecs_that_are_missing(self):
        tables = one_to_one.tables(FakeContext(one_to_one_lines))
        tables[1].rows.pop(0)
        self.assertEqual(len(list(one_to_one.check(None, tables))), 1)


def timing_lines(pcl=True):
    lines = [{"kind": "input", "runs": 3, "returns": 120, "grid_points": 100}]
    for codec, setting in (("paper-1to1", "S 1x1, P_r 4"), ("pcl", "low online"),
                           ("compact", "5 cm, effort 1")):
        line = {"kind": "codec", "codec": codec, "setting": setting}
        lines.append({**line, "skipped": "PCL was not found"} if codec == "pcl" and not pcl else
                     {**line, "encode_ms": 30., "encode_grid_ms": 20. if codec == "pcl" else 10.,
                      "decode_ms": 5.})
    lines += [{"kind": "stage", "stage": stage, "ms": 1.}
              for stage in ("upsampling", "extraction", "decoding")]
    lines += [{"kind": "stage", "stage": "reconstruction", "factor": factor, "points": 9, "ms": 2.}
              for factor in (1, 2, 4, 6, 8)]
    return [*lines, {"kind": "copy", "bytes": 1200, "ms": .01}]


class TimingTest(unittest.TestCase):
    def test_ratios_are_to_pcl_and_to_a_copy_of_the_same_run(self):
        codecs, stages = timing.tables(FakeContext(lambda _key: timing_lines()))
        row = by(codecs, method="paper, tuned for 1:1")
        self.assertEqual((row["encode_ratio"], row["decode_ratio"], row["total"]), (.5, 1., 15.))
        self.assertAlmostEqual(row["copy_ratio"], 500)
        self.assertEqual(row["published_extraction_s"].value, 44.4)
        self.assertEqual(by(stages, factor=4)["total"], 5.)
        self.assertEqual(by(stages, factor=4)["published_total_s"].value, 430.)
        self.assertEqual(list(timing.check(None, [codecs, stages])), [])

    def test_without_pcl_there_are_no_ratios_to_it(self):
        codecs = timing.tables(FakeContext(lambda _key: timing_lines(pcl=False)))[0]
        row = by(codecs, method="paper, tuned for 1:1")
        self.assertEqual(row["encode_ratio"], Missing("PCL was not found"))
        self.assertEqual(row["decode"], 5.)

    def test_a_kitti_scan_is_timed_if_there_is_one(self):
        self.assertEqual(timing.chosen(FakeContext(None, scans=[OTHER, KITTI])), [KITTI])
        self.assertEqual(timing.chosen(FakeContext(None, scans=[])), [ROOM])


if __name__ == "__main__":
    unittest.main()
