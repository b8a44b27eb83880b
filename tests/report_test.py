#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The report: its pieces, and the quick one on simulated scenes with its checks (no clock is read).

CURLIDAR names the command; the measuring programs lie beside it.
"""
import csv
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import unittest
from html.parser import HTMLParser
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
REPORT = ROOT / "bench/report/report.py"
sys.path[:0] = [str(REPORT.parent), str(ROOT / "bench")]
from frame import interpreter  # noqa: E402

if os.environ.get("CI") != "true" and not interpreter.found():
    print("The report needs numpy and matplotlib: ./dev setup ci installs them", file=sys.stderr)
    sys.exit(77)
interpreter.ensure_matplotlib()
from frame import cells, check, html, markdown, run, scans, store  # noqa: E402
from frame.context import OUTPUT, Context  # noqa: E402
from frame.tables import Column, Figure, Table  # noqa: E402

COMMAND = os.environ.get("CURLIDAR")
COLUMNS = [Column("name", "codec"), Column("error", "error", "m"),
           Column("share", "F", check="share")]


def table(**cells_of_row):
    return Table("t", "A table", "every return.", COLUMNS,
                 [{"name": "a", "error": .01, "share": .5, **cells_of_row}], command="x")


class CellsTest(unittest.TestCase):
    def test_empty_cells_are_refused(self):
        for value in (None, "", " ", float("nan"), float("inf"), [1], cells.Missing(""),
                      cells.Published(None, "a book")):
            with self.subTest(value=value):
                with self.assertRaisesRegex(cells.BadCell, "row 1, column error"):
                    table(error=value)
        with self.assertRaises(cells.BadCell):
            Table("t", "A table", "every return.", COLUMNS, [{"name": "a", "error": 1}])
        with self.assertRaises(cells.BadCell):
            Table("t", "A table", "every return.", COLUMNS, [])

    def test_missing_says_why_and_published_is_marked(self):
        text = "\n".join(markdown.lines_of(table(error=cells.Missing("no PCL"),
                                                 share=cells.Published(.25, "a book"))))
        self.assertIn("| a | n/a (no PCL) | 0.25 † |", text)
        self.assertIn("- † published: a book", text)
        page = html.table_html(table(error=cells.Missing("no <PCL>"),
                                     share=cells.Published(.25, "a book")))
        self.assertIn("n/a (no &lt;PCL&gt;)", page)
        self.assertRegex(page, r"0\.25<sup title=\"published: a book\">†</sup>")

    def test_sources_are_told_apart(self):
        rows = [{"name": "a", "error": cells.Published(1, "one"),
                 "share": cells.Published(2, "two")}]
        text = "\n".join(markdown.lines_of(Table("t", "T", "all.", COLUMNS, rows)))
        self.assertIn("| 1 †1 | 2 †2 |", text)

    def test_numbers_keep_what_matters(self):
        self.assertEqual(cells.number(.000048, 3), "4.8e-05")
        self.assertEqual(cells.number(0., 3), "0.000")
        self.assertEqual(cells.number(123456, 3), "123,456")
        self.assertEqual(cells.number(.0123456, ".2g"), "0.012")
        self.assertEqual(cells.plain(cells.Published(4.8e-05, "x"), 3), "4.8e-05")


class CheckTest(unittest.TestCase):
    def test_signs_and_shares(self):
        self.assertEqual(list(check.cells_of(table())), [])
        self.assertEqual(len(list(check.cells_of(table(error=-.1)))), 1)
        self.assertEqual(len(list(check.cells_of(table(share=1.1)))), 1)
        self.assertEqual(list(check.cells_of(table(error=cells.Published(-1, "a book")))), [])

    def test_rates_fall_as_errors_grow(self):
        def complaints(*pairs):
            rows = [{"name": "a", "error": error, "share": share} for error, share in pairs]
            return list(check.falls(Table("t", "T", "all.", COLUMNS, rows), "error", "share",
                                    ["name"]))
        self.assertEqual(complaints((.1, .2), (.01, .5)), [])
        self.assertEqual(len(complaints((.1, .6), (.01, .5))), 1)

    def test_pages_that_load_something_are_told(self):
        good = '<a href="#x"><img src="data:image/png;base64,AA">'
        self.assertEqual(list(check.page_of(good)), [])
        for bad in ('<img src="a.png">', '<a href="https://a.b/">', "<script>", "<link rel=x>",
                    "url(https://a.b/c)", '@import "a"', '<img src="//a.b/c">'):
            self.assertEqual(len(list(check.page_of(bad))), 1, bad)


class MeasuringTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.out = Path(folder.name)
        self.count = self.out / "count"
        self.program = self.out / "program.py"
        self.program.write_text("import sys\nopen(sys.argv[1], 'a').write('x')\n"
                                "print('{\"value\":', sys.argv[2], '}')\n", encoding="utf-8")

    def context(self):
        found = Context(self.out, Path("none"), self.out, [], [], {})
        found.progress = lambda text: None
        return found

    def measure(self, value="1"):
        return self.context().measure("s", {"of": value},
                                      [sys.executable, self.program, str(self.count), value])

    def times(self):
        return len(self.count.read_text(encoding="utf-8"))

    def test_what_is_stored_is_not_measured_again(self):
        self.assertEqual([self.measure(), self.measure()], [[{"value": 1}]] * 2)
        self.assertEqual(self.times(), 1)
        self.measure("2")
        self.assertEqual(self.times(), 2)

    def test_other_programs_measure_again(self):
        self.measure()
        self.program.write_text(self.program.read_text(encoding="utf-8") + "#", encoding="utf-8")
        self.measure()
        self.assertEqual(self.times(), 2)

    def test_failures_are_told_and_tried_again(self):
        self.assertIn("no JSON", self.measure("nonsense")[0]["failure"])
        self.assertIn("no JSON", self.measure("nonsense")[0]["failure"])
        self.assertEqual(self.times(), 2)
        self.assertFalse((self.out / "measurements/s.jsonl").exists())

    def test_files_are_made_when_they_are_needed(self):
        context = self.context()
        made = context.made(".txt", [
            sys.executable, "-c", "import sys; open(sys.argv[1], 'w').write('7')", OUTPUT])
        self.assertFalse(made.path.exists())
        command = [sys.executable, "-c",
                   "import sys; print('{\"read\":', open(sys.argv[1]).read(), '}')", made]
        self.assertEqual(context.measure("s", {}, command), [{"read": 7}])
        self.assertTrue(made.path.exists())
        context.clean()
        self.assertEqual(self.context().measure("s", {}, command), [{"read": 7}])
        self.assertFalse(made.path.exists())

    def test_objects_on_one_line_or_many(self):
        self.assertEqual(run.objects_in('{"a": 1}\n{\n "b": 2\n}\n'), [{"a": 1}, {"b": 2}])
        for bad in ("no", '{"a": 1} no', "[1]"):
            with self.assertRaises(run.CommandFailed):
                run.objects_in(bad)

    def test_a_torn_store_is_measured_again(self):
        self.measure()
        path = self.out / "measurements/s.jsonl"
        path.write_text(path.read_text(encoding="utf-8")[:20], encoding="utf-8")
        self.assertEqual(store.Store(path.parent).section("s"), {})


class ScansTest(unittest.TestCase):
    def test_named_scans_and_folders(self):
        with tempfile.TemporaryDirectory() as name:
            data, other = Path(name) / "data", Path(name) / "other"
            (data / "kitti_raw").mkdir(parents=True)
            other.mkdir()
            (data / "MANIFEST.tsv").write_text(
                "path\tdataset\tsensor\tchannels\n"
                "kitti_raw/a.bin\tKITTI\tHDL-64E\t64\nkitti_raw/b.bin\tKITTI\tHDL-64E\t64\n",
                encoding="utf-8")
            for path in (data / "kitti_raw/a.bin", data / "kitti_raw/b.bin", other / "c.pcd"):
                path.touch()
            names = lambda *options: [scan.name for scan in scans.chosen(*options)]  # noqa: E731
            self.assertEqual(names([], data, False, False), ["kitti_raw/a.bin"])
            self.assertEqual(names([], data, True, False), ["kitti_raw/a.bin", "kitti_raw/b.bin"])
            self.assertEqual(names([other], data, False, False), ["c.pcd"])
            self.assertEqual(names([other, data], data, False, True), ["kitti_raw/a.bin"])
            named = scans.chosen([data / "kitti_raw/b.bin"], data, False, False)
            self.assertTrue(named[0].is_kitti)
            with self.assertRaises(scans.NoScans):
                scans.chosen([other / "none"], data, False, False)


class Page(HTMLParser):
    """Rows and cells of tables, and every attribute that loads something."""

    def __init__(self, text):
        super().__init__()
        self.loads, self.cells, self.inside = [], [], False
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        found = dict(attrs)
        self.loads += [value for key, value in found.items()
                       if key in ("src", "srcset", "data", "poster")]
        self.loads += [found["href"]] if tag in ("link", "image") and "href" in found else []
        if tag == "td":
            self.cells.append("")
            self.inside = True

    def handle_endtag(self, tag):
        self.inside = self.inside and tag != "td"

    def handle_data(self, data):
        if self.inside:
            self.cells[-1] += data


@unittest.skipUnless(COMMAND, "CURLIDAR names no command")
class QuickReportTest(unittest.TestCase):
    """One quick report; it is interrupted on the way, then completed, then made once more."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="curlidar-report-")
        cls.addClassCleanup(cls.folder.cleanup)
        cls.out = Path(cls.folder.name) / "report"
        cls.stopped = cls.interrupted()
        cls.stored = cls.lines_stored()
        cls.first = cls.make()
        cls.again = cls.make()

    @classmethod
    def command(cls):
        return [sys.executable, "-B", REPORT, "--quick", "--simulated", "--check", "-o", cls.out]

    @classmethod
    def make(cls):
        return subprocess.run(cls.command(), capture_output=True, text=True, check=False)

    @classmethod
    def interrupted(cls):
        """Stopped by a signal as soon as something is measured."""
        child = subprocess.Popen(cls.command(), stderr=subprocess.PIPE, text=True)
        with child:
            for line in child.stderr:
                if cls.lines_stored() and line:
                    child.send_signal(signal.SIGINT)
                    break
            child.stderr.read()
        return child.returncode

    @classmethod
    def lines_stored(cls):
        return sum(len(path.read_text(encoding="utf-8").splitlines())
                   for path in cls.out.glob("measurements/*.jsonl"))

    def counts(self, done):
        found = re.search(r"(\d+) measured, (\d+) stored already", done.stderr)
        self.assertIsNotNone(found, done.stderr)
        return int(found[1]), int(found[2])

    def test_is_complete_and_sane(self):
        self.assertEqual(self.first.returncode, 0, self.first.stderr)
        self.assertIn("check: nothing is wrong", self.first.stderr)

    def test_goes_on_where_it_was_stopped(self):
        self.assertNotEqual(self.stopped, 0)
        self.assertGreater(self.stored, 0)
        measured, stored = self.counts(self.first)
        self.assertEqual(stored, self.stored)
        self.assertGreater(measured, 0)

    def test_measures_nothing_twice(self):
        self.assertEqual(self.again.returncode, 0, self.again.stderr)
        self.assertEqual(self.counts(self.again), (0, sum(self.counts(self.first))))

    def test_nothing_is_left_over(self):
        self.assertFalse((self.out / "scratch").exists())
        self.assertEqual(list(self.out.rglob("*.part")), [])

    def test_page_is_one_file(self):
        text = (self.out / "index.html").read_text(encoding="utf-8")
        page = Page(text)
        self.assertTrue(page.loads)
        for target in page.loads:
            self.assertTrue(target.startswith("data:image/png;base64,"), target[:80])
        self.assertFalse("<script" in text)
        self.assertGreater(len(page.cells), 100)
        self.assertEqual([cell for cell in page.cells if not cell.strip()], [])
        self.assertLess(len(text), 15e6)
        for theme in ("prefers-color-scheme:dark", "currentColor"):
            self.assertTrue(theme in text, theme)
        ids = re.findall(r'\sid="([^"]*)"', text)
        self.assertEqual(len(ids), len(set(ids)))

    def test_tables_hold_figures_of_this_run(self):
        tables = {path.stem: list(csv.reader(path.read_text(encoding="utf-8").splitlines()))
                  for path in (self.out / "tables").glob("*.csv")}
        for name, rows in tables.items():
            self.assertEqual({len(row) for row in rows}, {len(rows[0])}, name)
        self.assertIn("SuperRso (network)", [row[0] for row in tables["upsampling"]])
        self.assertEqual(len(tables["metrics-distances"]), 1 + 3 * 2)
        markdown_text = (self.out / "report.md").read_text(encoding="utf-8")
        for link in re.findall(r"\]\(([^)]*)\)", markdown_text):
            self.assertTrue((self.out / link).is_file(), link)
        for path in self.out.glob("measurements/*.jsonl"):
            for line in path.read_text(encoding="utf-8").splitlines():
                self.assertNotIn(str(self.out), json.loads(line)["command"])


class WordsTest(unittest.TestCase):
    """What is said where nothing can be made."""

    def fails(self, *arguments, **environment):
        done = subprocess.run([sys.executable, "-B", REPORT, *arguments], capture_output=True,
                              text=True, check=False, env={**os.environ, **environment})
        self.assertNotEqual(done.returncode, 0)
        self.assertNotIn("Traceback", done.stderr)
        return done.stderr

    def test_no_command(self):
        self.assertIn("CURLIDAR", self.fails(CURLIDAR="/nowhere/curlidar"))

    @unittest.skipUnless(COMMAND, "CURLIDAR names no command")
    def test_no_such_scan_and_no_place_for_the_report(self):
        with tempfile.TemporaryDirectory() as name:
            said = self.fails("-o", f"{name}/r", f"{name}/none.pcd")
            self.assertIn("none.pcd: no such file", said)
            (Path(name) / "file").touch()
            self.assertIn(f"{name}/file", self.fails("-o", f"{name}/file/r", "--simulated"))

    @unittest.skipUnless(COMMAND, "CURLIDAR names no command")
    def test_real_scans_alone_must_be_there(self):
        with tempfile.TemporaryDirectory() as name:
            said = self.fails("-o", f"{name}/r", "--real", "--sections", "maps", CURLIDAR_DATA=name)
            self.assertIn(f"no MANIFEST.tsv in {name}", said)
            self.assertIn("not allowed with", self.fails("--real", "--simulated"))

    @unittest.skipUnless(COMMAND, "CURLIDAR names no command")
    def test_the_command_finds_and_starts_the_report(self):
        with tempfile.TemporaryDirectory() as name:
            done = subprocess.run(
                [COMMAND, "report", "--quick", "--simulated", "--sections", "maps", "--check", "-o",
                 f"{name}/r"], capture_output=True, text=True, check=False,
                env={**os.environ, "CURLIDAR_REPORT_DIR": str(REPORT.parent)})
            self.assertEqual(done.returncode, 0, done.stderr)
            text = (Path(name) / "r/report.md").read_text(encoding="utf-8")
            self.assertIn("`curlidar report --quick --simulated --sections maps`", text)

    def test_no_such_section(self):
        self.assertIn("'none'", self.fails("--sections", "none"))

    def test_missing_packages_are_named(self):
        code = ("import sys; sys.path.insert(0, sys.argv[1]); from frame import interpreter as i; "
                "i.NEEDED = ('no_such_module',); i.SYSTEM_PYTHON = '/nowhere'; "
                "i.ensure_matplotlib()")
        done = subprocess.run([sys.executable, "-c", code, REPORT.parent], capture_output=True,
                              text=True, check=False)
        self.assertEqual(done.returncode, 4)
        self.assertIn("apt-get install python3-no_such_module", done.stderr)


class FigureTest(unittest.TestCase):
    def test_plots_take_the_colours_of_the_page(self):
        from frame import plots
        with tempfile.TemporaryDirectory() as name:
            figure, axes = plots.panels(2)
            axes[0].plot([1, 2], [3, 4], label="curlidar")
            path = Path(name) / "figures" / "a-plot.svg"
            path.parent.mkdir()
            plots.save(figure, path)
            text = path.read_text(encoding="utf-8")
            self.assertTrue("currentColor" in text)
            self.assertFalse(plots.INK in text)
            drawn = Figure("a-plot", "A", "B", "svg", "x")
            self.assertEqual(list(check.figure_of(drawn, Path(name))), [])
            inline = plots.inline(text)
            self.assertFalse("<style>:root" in inline)
            self.assertTrue("max-width" in inline.partition(">")[0], inline[:300])
            self.assertTrue(all(found.startswith("a-plot-") for found in
                                re.findall(r'\sid="([^"]*)"', inline)))


if __name__ == "__main__":
    unittest.main(verbosity=2)
