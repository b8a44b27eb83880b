#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The report's section on sequences and maps: rows from what commands say, goals, failures."""
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from report_support import KITTI, ROOT, FakeContext, by
from frame.cells import Missing
from frame.context import Made
from sections import goals, maps, maps_drive, maps_inputs, maps_keyframes, maps_sequences, \
    maps_surface

TOLD = ROOT / "bench/report/frame/told.py"
STATISTICS = {"count": 9, "mean": .04, "std": .1, "rms": .2, "p50": .05, "p95": .3, "max": 1.}
COMPARED = {"a_to_b": STATISTICS, "b_to_a": STATISTICS, "points_b": 500, "symmetric": {"mean": .05},
            "matches": [{"threshold": each, "precision": .9, "recall": .96, "f_score": .93}
                        for each in (.05, .1, .2)],
            "accuracy": {"mean": .05, "within": [{"threshold": each, "share": .9}
                                                 for each in (.05, .1, .2)]},
            "completeness": {"mean": .04, "within": [{"threshold": each, "share": .96}
                                                     for each in (.05, .1, .2)]},
            "f_scores": [{"threshold": each, "f_score": .93} for each in (.05, .1, .2)]}
SINGLE, PREDICTED = 1000, 700
MAP_BYTES = {"lap one": 5000, "lap two appended": 5400, "both laps at once": 6000}


def answer(key):
    if "way" in key and "distances of scan" not in key:
        size = SINGLE if key["way"] == "one by one" else PREDICTED
        scans = [{"points_in": 10000, "bytes": size if i else SINGLE, "mean_error_m": .049}
                 for i in range(4)]
        return [{"said": scans if key["way"] == "one by one" else [{"scans": len(scans), "frames": scans}],
                 "cpu_s": 2., "peak_rss_bytes": 1e8,
                 "files": {"f": sum(each["bytes"] for each in scans)}}]
    if "poses of" in key:
        return [{"scans": key["poses of"], "length_m": 10. * key["poses of"]}]
    if "built" in key or "laps" in key:
        return [{"said": [{}], "cpu_s": 2., "peak_rss_bytes": 1e8,
                 "files": {"map.curl": MAP_BYTES.get(key.get("built"), 5000)}}]
    return [COMPARED]


class MapsContext(FakeContext):
    """One that names what would be made."""
    curlidar, scratch = Path("curlidar"), Path("scratch")

    def made(self, ending, command):
        return Made(Path(str(abs(hash(tuple(map(str, command))))) + ending), tuple(command))


class MapsTest(unittest.TestCase):
    def tables(self, answer_=answer, **options):
        context = MapsContext(answer_, quick=True, **options)
        return {table.id: table for table in maps.tables(context)}

    def test_every_table_is_there_without_real_scans(self):
        tables = self.tables(scans=[])
        self.assertEqual(set(tables), set(maps.TABLES))
        self.assertIsInstance(tables["maps-surface"].rows[0]["bytes"], Missing)
        self.assertEqual(list(maps.check(None, tables.values())), [])

    def test_savings_count_all_bytes_and_those_after_the_first_scan(self):
        row = by(self.tables(scans=[])["maps-sequences"], input="simulated, still, vlp16")
        self.assertAlmostEqual(row["saving"], 900 / 4000)
        self.assertAlmostEqual(row["later_saving"], .3)
        self.assertAlmostEqual(row["sequence_bits"], 8 * 3100 / 40000)

    def test_second_laps_are_counted_beside_the_first(self):
        table = self.tables(scans=[])["maps-goals"]
        row = by(table, goal="second lap: bytes beside the first's", input="appended")
        self.assertEqual((round(row["measured"], 3), row["met"]), (.08, "yes"))
        row = by(table, goal="second lap: bytes beside the first's", input="built together")
        self.assertEqual(row["met"], "no, 100 % over")
        for row in table.rows:
            self.assertTrue(row["command"].startswith("curlidar "), row["goal"])

    def test_failures_are_in_the_tables(self):
        tables = self.tables(lambda key: [{"failure": "it broke"}] if "built" in key else answer(key),
                             scans=[])
        self.assertEqual(by(tables["maps-drive"], map="lap one")["bytes"], "it broke")

    def test_what_is_checked(self):
        tables = self.tables(scans=[])
        tables["maps-sequences"].rows[0]["saving"] = -.1
        tables["maps-drive"].rows[0]["f10"] = .99
        self.assertEqual(len(list(maps.check(None, tables.values()))), 2)

    def test_goals_of_real_scans(self):
        row = {"map": "small", "bytes": 15400, "mean_m": .04, "within_10": .96}
        met = {each["goal"]: each["met"] for each in maps_surface.goals_of([row])}
        self.assertEqual(met["smallest map: bytes"], "no, 10 % over")
        self.assertEqual(met["smallest map: raw within 10 cm"], "yes")
        row = {"map": "x", "bytes": 29000, "times": 6., "within_10": .8}
        met = {each["goal"]: each["met"] for each in maps_keyframes.goals_of([row])}
        self.assertEqual(sum(goals.is_met({"met": each}) for each in met.values()), 2)

    def test_without_scenes_there_is_no_drive(self):
        context = MapsContext(answer, scans=[KITTI], scenes=[])
        self.assertIsNone(maps_drive.drive_of(context))
        self.assertEqual(maps_sequences.inputs(context), [])
        self.assertIsNone(maps_inputs.kitti(context))


class ToldTest(unittest.TestCase):
    """What runs a command and keeps what it said."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def told(self, *words):
        return subprocess.run([sys.executable, "-B", TOLD, *words], capture_output=True, text=True,
                              check=False)

    def test_files_and_words_are_kept(self):
        copied = self.folder / "before"
        copied.write_text("abc", encoding="utf-8")
        code = "import sys; open(sys.argv[1], 'a').write('d'); print('{\"a\": \"%s\"}' % sys.argv[1])"
        made = self.folder / "made"
        done = self.told("make", made, "--copy", copied, "file", "--", sys.executable, "-c", code,
                         "{}/file")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual((made / "file").read_text(encoding="utf-8"), "abcd")
        told = json.loads(self.told("tell", made).stdout)
        self.assertEqual((told["said"], told["files"]), ([{"a": "/file"}], {"file": 4}))
        self.assertGreater(told["peak_rss_bytes"], 1e5)

    def test_what_fails_leaves_nothing(self):
        made = self.folder / "made"
        done = self.told("make", made, "--", sys.executable, "-c", "import sys; sys.exit(3)")
        self.assertEqual((done.returncode, made.exists()), (3, False))


if __name__ == "__main__":
    unittest.main()
