#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The report's sections of the paper's comparisons: what their tables make of measured lines, of
codecs that are missing and of scans that cannot be taken."""
import sys
import tomllib
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "bench/report"), str(ROOT / "bench")]
from frame.cells import Missing, Published  # noqa: E402
from frame.scans import Scan, Scene  # noqa: E402
from sections import continuous, one_to_one, timing  # noqa: E402

KITTI = Scan("kitti_raw/a.pcd", Path("a.pcd"), "HDL-64E")
OTHER = Scan("velodyne/b.pcd", Path("b.pcd"), "HDL-32E")
ROOM = Scene("room", "os1-64-gen1", "indoor")
STATISTICS = {"count": 9, "mean": .1, "std": .1, "rms": .2, "p50": .05, "p95": .3, "max": 1.}


class FakeContext:
    """Answers with lines instead of running anything."""

    def __init__(self, answer, scans=(KITTI,), scenes=(ROOM,), quick=False):
        self.answer, self.scans, self.scenes, self.quick = answer, list(scans), list(scenes), quick
        self.bin, self.asked = Path("bin"), []
        text = (ROOT / "bench/report/published.toml").read_text(encoding="utf-8")
        self.published = tomllib.loads(text)

    @property
    def inputs(self):
        return [*self.scans, *self.scenes]

    def cloud(self, item):
        return Path(item.id)

    def published_rows(self, table, **wanted):
        return [{key: Published(value, row["source"]) if isinstance(value, (int, float)) else value
                 for key, value in row.items()} for row in self.published[table]
                if all(row.get(key) == value for key, value in wanted.items())]

    def measure(self, _section, key, command):
        self.asked.append([str(part) for part in command])
        return self.answer(key)


def by(table, **wanted):
    found = [row for row in table.rows if all(row[key] == value for key, value in wanted.items())]
    assert len(found) == 1, f"{len(found)} rows are {wanted}"
    return found[0]


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


def told(method, setting, **more):
    return {"method": method, "setting": setting, "points": 9, "mean": .1, "rms": .2, "p50": .05,
            "p95": .3, "max": 1., "within_5cm": .5, "completeness": .9, **more}


METHODS = [("baseline", "degree 64"), ("paper", "S 1x1"), ("paper", "S 2x1"),
           ("paper", "S 2x2"), ("compact", "5 cm"), ("linear", "raw samples"),
           ("edge-aware", "raw samples")]
LIMITS = {"min_range_m": 5., "max_range_m": 20.}


def continuous_lines(key):
    skipped = {"method": "compact", "setting": "1 bit a point", "skipped": "out of reach"}
    if key["part"] == "truth":
        return [{"returns": 9, **LIMITS}, skipped,
                *(told(*each, factor=float(factor), no_surface=1, bits_per_point=1.)
                  for each in METHODS for factor in (2, 4, 8))]
    if key["input"] == OTHER.name:
        return [{"skipped": "the rings of the scan cannot be told"}]
    common = {**STATISTICS, "count": 1000 if key["every"] == 2 else 10}
    return [{"preset": "outdoor", "rings": 64, "rings_coded": 32, "returns_coded": 90,
             "returns_held_out": 80, **LIMITS}, skipped,
            *(told(*each, common=common) for each in METHODS)]


class ContinuousTest(unittest.TestCase):
    def tables(self, **options):
        context = FakeContext(continuous_lines, **options)
        return {table.id: table for table in continuous.tables(context)}

    def test_tables_of_truth_and_of_rings_held_out(self):
        tables = self.tables()
        truth = tables["continuous-truth-room-os1-64-gen1"]
        self.assertEqual(len(truth.rows), 1 + 3 * len(METHODS))
        self.assertEqual(by(truth, setting="1 bit a point")["mean"], Missing("out of reach"))
        held_out = tables["continuous-held-out-kitti_raw-a"]
        self.assertEqual([row["every"] for row in held_out.rows if row["setting"] == "5 cm"],
                         [2, 4, 8])
        self.assertEqual(list(continuous.check(None, tables.values())), [])

    def test_means_over_a_few_common_returns_are_not_shown(self):
        rows = self.tables()["continuous-held-out-kitti_raw-a"].rows
        shown = {row["every"]: row["common_mean"] for row in rows if row["setting"] == "5 cm"}
        self.assertEqual(shown[2], .1)
        self.assertIsInstance(shown[8], Missing)

    def test_scans_without_rings_are_listed_with_the_reason(self):
        tables = self.tables(scans=[OTHER])
        self.assertEqual({row["why"] for row in tables["continuous-left-out"].rows},
                         {"the rings of the scan cannot be told"})
        self.assertNotIn("continuous-held-out-velodyne-b", tables)

    def test_our_runs_of_the_papers_method_stand_beside_its_own(self):
        table = self.tables()["continuous-published"]
        row = by(table, dataset="INDOOR", method="paper S=2x1")
        self.assertEqual((row["mean_2_m"].value, row["ours_2"]), (.0042, .1))
        self.assertEqual(by(table, dataset="INDOOR", method="baseline")["ours_8"], .1)
        self.assertIsInstance(by(table, dataset="Newer College", method="paper S=2x1")["ours_2"],
                              Missing)

    def test_quick_runs_measure_fewer_factors(self):
        context = FakeContext(continuous_lines, quick=True)
        continuous.measure(context)
        self.assertEqual(len(context.asked), 3)
        self.assertIn("2,8", context.asked[0])
        self.assertNotIn("--baseline", context.asked[0])

    def test_a_measurement_that_failed_has_its_row(self):
        context = FakeContext(lambda _key: [{"failure": "it ended with 1"}])
        for table in continuous.tables(context)[:2]:
            self.assertEqual(table.rows[0]["mean"], Missing("it ended with 1"))


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
