#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What ./dev raw plans to measure, how it reads the command's reports, and what it has stored."""
import csv
import sys
import tempfile
import unittest
from pathlib import Path

ROOM = Path(__file__).resolve().parents[1] / "bench/raw"
sys.path.insert(0, str(ROOM))
import measure  # noqa: E402
import plan  # noqa: E402
import raw  # noqa: E402
import table  # noqa: E402

KITTI, XT16 = plan.SCANS[2], plan.SCANS[7]


def row(mode="nearest", target_m=.05, effort="9", bits=.5, profile=plan.AUTO, scan=KITTI, **more):
    """As it comes from the file: all texts."""
    found = {key: "" for key in measure.COLUMNS}
    found.update(scan=scan, mode=mode, target_m=target_m, effort=effort, profile=profile,
                 points=1000, bits_per_point=bits, nearest_m=.0495, own_mean_m=.07, max_m=.5, lattice="rays",
                 table="hdl64e-kitti", share_on_lattice=1, motion=True, corrections_bits=.1,
                 attributes_bits=3.8, cpu_s=2, verify_ok=True)
    found.update(more)
    return {key: str(value) for key, value in found.items()}


def encode_report(**more):
    return {"points_in": 1000, "points_coded": 1000, "bytes": 2000, "bits_per_point_coded": 12.,
            "encodings": 3, "breakdown": {"mask": 500., "records": 80.},
            "records": {"lattice": "rays", "table": None, "loose": 2, "corrected": 1,
                        "bytes": {"order": 10, "attributes": 475}}, **more}


class PlanTest(unittest.TestCase):
    def test_arguments_name_target_effort_and_attributes(self):
        self.assertEqual(plan.Setting("nearest", .001, "9").arguments(),
                         ["--error-nn", "0.001", "--attributes", "none", "--effort", "9",
                          "--no-index"])
        self.assertEqual(plan.Setting("lossless", 0., "default").arguments(Path("s.toml")),
                         ["--lossless", "--attributes", "none", "--no-index", "--sensor", "s.toml"])
        self.assertIn("intensity", plan.Setting("intensity", .02, "9").arguments())

    def test_attributes_are_measured_where_there_are_some(self):
        modes = lambda *names: {s.mode for s in plan.settings_of(  # noqa: E731
            plan.Scan("a", Path("a"), attributes=names))}
        geometry = {"nearest", "bound", "lossless"}
        self.assertEqual(modes(), geometry)
        self.assertEqual(modes("intensity"), geometry | {"intensity"})
        self.assertEqual(modes("intensity", "ring"), geometry | {"intensity", "attributes"})

    def test_every_goal_is_planned(self):
        for name, goals in table.GOALS.items():
            scan = plan.Scan(name, Path(name), attributes=("intensity",))
            planned = {(s.mode, s.target_m) for s in plan.settings_of(scan)}
            self.assertLessEqual(set(goals) - {("on unit", 0.)}, planned)

    def test_batches_are_measured_only_with_their_scans(self):
        alone, batch = (plan.settings_of(plan.Scan("a", Path("a"), paths))
                        for paths in ((), (Path("b"),)))
        self.assertNotIn(plan.BATCH, {s.profile for s in alone})
        self.assertIn(plan.BATCH, {s.profile for s in batch})

    def test_keys_tell_builds_scans_and_settings_apart(self):
        with tempfile.TemporaryDirectory() as folder:
            paths = [Path(folder, name) for name in "ab"]
            for path in paths:
                path.write_text(path.name, encoding="utf-8")
            a, b = (plan.Scan("same", path, (paths[1],)) for path in paths)
            settings = plan.settings_of(a)
            keys = [plan.key_of(build, scan, setting) for build in ("x", "y") for scan in (a, b)
                    for setting in settings]
            self.assertEqual(len(set(keys)), 4 * len(settings))
            self.assertEqual(plan.key_of("x", a, settings[0]), keys[0])

    def test_scans_are_named_without_the_folders_of_a_machine(self):
        with tempfile.TemporaryDirectory() as folder:
            data = Path(folder).resolve() / "data"
            inside, outside = data / KITTI, Path(folder) / "mine.pcd"
            for path in (inside, outside):
                path.parent.mkdir(parents=True, exist_ok=True)
                path.touch()
            found, missing = plan.scans_of([inside, outside, data / "no.pcd"], data)
            self.assertEqual([scan.name for scan in found], [KITTI, "mine.pcd"])
            self.assertEqual(missing, ["no.pcd"])
            self.assertEqual(found[0].batch, ())  # the others of the batch are not there
            found, missing = plan.scans_of([], data)
            self.assertEqual([scan.name for scan in found], [KITTI])
            self.assertEqual(len(missing), len(plan.SCANS) - 1)


class ReportsTest(unittest.TestCase):
    def test_bits_are_of_the_whole_file_for_each_return_of_the_input(self):
        figures = measure.figures_of_encode(encode_report(), 2000)
        self.assertAlmostEqual(figures["bits_per_point"], 16)
        self.assertAlmostEqual(figures["geometry_bits"], 12)
        self.assertAlmostEqual(figures["attributes_bits"], 3.8)
        self.assertAlmostEqual(figures["order_bits"], .08)
        self.assertAlmostEqual(figures["mask_bits"], .5)
        self.assertNotIn("failure", figures)

    def test_size_said_and_size_of_the_file_must_agree(self):
        self.assertIn("2001", measure.figures_of_encode(encode_report(), 2001)["failure"])

    def test_broken_promise_is_a_failure(self):
        report = {"mean_error_m": .01, "max_error_m": .03, "bound_m": .02, "ok": False,
                  "bit_exact": False, "order": True, "failures": ["one point is off"]}
        self.assertEqual(measure.figures_of_verify(report)["failure"], "verify: one point is off")
        report.update(ok=True, bound_m=None)
        figures = measure.figures_of_verify(report)
        self.assertNotIn("failure", figures)
        self.assertEqual(figures["bound_m"], "")

    def test_nearest_is_the_larger_direction(self):
        report = {"a_to_b": {"mean": .01}, "b_to_a": {"mean": .02}}
        self.assertEqual(measure.figures_of_compare(report)["nearest_m"], .02)

    def test_columns_hold_all_figures(self):
        figures = {**measure.figures_of_encode(encode_report(), 2000),
                   **measure.figures_of_compare({"a_to_b": {"mean": 1}, "b_to_a": {"mean": 1}})}
        self.assertLessEqual(set(figures), set(measure.COLUMNS))

    def test_command_that_fails_is_told_in_its_words(self):
        with tempfile.TemporaryDirectory() as folder:
            said, _ = measure.run([sys.executable, "-c", "print(1)"], folder)
            self.assertEqual(said.strip(), "1")
            program = [sys.executable, "-c", "import sys; sys.exit('no such thing')"]
            with self.assertRaisesRegex(measure.CommandFailed, "ended with 1: no such thing"):
                measure.run(program, folder)


class TableTest(unittest.TestCase):
    def test_goals_missed_are_counted(self):
        rows = [row(bits=.57), row(effort="default", bits=.62)]
        self.assertEqual(table.lines_of(rows)[1], 0)
        rows[0]["bits_per_point"] = ".571"
        lines, missed, wrong = table.lines_of(rows)
        self.assertEqual((missed, wrong), (1, 0))
        self.assertIn("| 0.571 (**+0.001**) | 0.57 | 0.62 |", lines[-1])
        rows[1]["bits_per_point"] = ".63"
        self.assertEqual(table.lines_of(rows)[1], 2)

    def test_goal_without_figures_is_missed(self):
        rows = [row(bits="", nearest_m="", cpu_s="", failure="encode ended with 3: no")]
        lines, missed, wrong = table.lines_of(rows)
        self.assertEqual((missed, wrong), (1, 1))
        self.assertIn("encode ended with 3", lines[-1])

    def test_scans_without_goals_miss_none(self):
        lines, missed, _ = table.lines_of([row(scan=XT16, bits=99)])
        self.assertEqual(missed, 0)
        self.assertTrue(lines[-1].endswith(f"| 2.75{table.OTHER_SCAN_MARK} |"), lines[-1])

    def test_attributes_are_their_own_bits_and_corrections_can_be_left_out(self):
        self.assertEqual(table.bits_of(row("intensity", bits=9), "intensity"), 3.8)
        rows = [row("lossless", 0., bits=6.65, nearest_m=0, own_mean_m=0, max_m=0, bit_exact=True)]
        lines, missed, wrong = table.lines_of(rows)
        self.assertEqual((missed, wrong), (0, 0))
        self.assertIn("| lossless | 6.65 | 7.20 |", lines[-2])
        self.assertIn("| lossless, corrections left out | 6.55 | 6.60 |", lines[-1])

    def test_batches_stand_beside(self):
        lines, _, _ = table.lines_of([row(), row(bits=.59, profile=plan.BATCH)])
        self.assertIn("| 0.50 | 0.57 | - | 0.63 | 0.59 | - | 4.95 cm |", lines[-1])
        self.assertEqual(lines[-1].count("|"), table.HEAD.count("|"))

    def test_errors_beyond_what_was_asked_are_told(self):
        self.assertEqual(table.complaints(row()), [])
        self.assertEqual(len(table.complaints(row(nearest_m=.0501))), 1)
        self.assertEqual(len(table.complaints(row(own_mean_m=.08))), 1)
        self.assertEqual(table.complaints(row("bound", .02, max_m=.02)), [])
        self.assertEqual(len(table.complaints(row("bound", .02, max_m=.0201))), 1)
        self.assertEqual(table.complaints(row("lossless", 0., bit_exact=True)), [])
        self.assertEqual(len(table.complaints(row("lossless", 0., bit_exact=False))), 1)


class StoreTest(unittest.TestCase):
    def test_newest_row_stays_and_failures_are_measured_again(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "raw.csv"
            store = raw.Store(path)
            store.add(row(key="old"))
            store.add(row(key="new", failure="no"))
            store.add(row(key="other", effort="default"))
            again = raw.Store(path)
            self.assertEqual(again.rows, store.rows)
            self.assertEqual([again.has(key) for key in ("old", "new", "other")],
                             [False, False, True])

    def test_stored_rows_have_the_columns_and_name_no_folder_of_a_machine(self):
        if not (ROOM / "raw.csv").is_file():
            self.skipTest("nothing is stored yet")
        with open(ROOM / "raw.csv", encoding="utf-8", newline="") as file:
            reader = csv.DictReader(file)
            self.assertEqual(tuple(reader.fieldnames), measure.COLUMNS)
            scans = {found["scan"] for found in reader}
        self.assertLessEqual(scans, set(plan.SCANS))


if __name__ == "__main__":
    unittest.main(verbosity=2)
