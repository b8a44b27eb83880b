# SPDX-License-Identifier: BSD-3-Clause
"""The command line itself: help, versions, usage errors, exit codes."""

import os
import re
import subprocess
import unittest

from support import CURLIDAR, FILE, INPUT, USAGE, CommandTest

COMMANDS = ["encode", "decode", "mesh", "upsample", "convert", "info", "project", "compare",
            "verify", "simulate", "render", "sensors", "calibrate", "demo", "register"]
MAP_COMMANDS = ["build", "append", "info", "extract", "sample", "compare", "render"]


class UsageTest(CommandTest):
    def setUp(self):
        for file in self.folder.iterdir():
            file.unlink()

    def test_help_lists_every_command_and_the_exit_codes(self):
        text = self.run_ok("--help").decode()
        for command in [*COMMANDS, "map", "report"]:
            self.assertIn(f"\n  {command} ", text)
        self.assertIn("Exit codes:", text)
        text = self.run_ok("map", "--help").decode()
        for command in MAP_COMMANDS:
            self.assertIn(f"\n  {command} ", text)
        self.assertIn("Examples:", text)

    def test_every_command_explains_itself(self):
        for words in [*([command] for command in COMMANDS),
                      *(["map", command] for command in MAP_COMMANDS)]:
            with self.subTest(command=words):
                text = self.run_ok(*words, "--help").decode()
                self.assertIn("--json", text)
                self.assertIn("--threads", text)
                self.assertIn("--quiet", text)
                if words != ["demo"]:
                    self.assertIn("Examples:", text)

    def test_report_says_where_its_programs_should_be(self):
        self.assertIn("Examples:", self.run_ok("report", "--help").decode())
        missing = {**os.environ, "CURLIDAR_REPORT_DIR": str(self.folder / "nothing")}
        result = subprocess.run([CURLIDAR, "report"], env=missing, capture_output=True, check=False)
        self.assertEqual(result.returncode, FILE)
        self.assertIn(b"CURLIDAR_REPORT_DIR", result.stderr)
        self.assertEqual(self.execute("report", "--no-such").returncode, USAGE)

    def test_encode_help_shows_the_parameter_table_with_defaults(self):
        text = self.run_ok("encode", "--help").decode()
        for option, default in [("--upsample RxC", "2x2"), ("--patch", "4"), ("--overlap", "2"),
                                ("--cliff-row", "2"), ("--cliff-col", "0.2"),
                                ("--cliff-diag", "2.01"), ("--accept", "0.5"),
                                ("--max-degree", "100"), ("--k", "9"), ("--outlier-radius", "1"),
                                ("--outlier-min", "7"), ("--min-range", "5"),
                                ("--max-range", "p90"), ("--cols", "1024")]:
            line = next(line for line in text.splitlines() if line.strip().startswith(option))
            # "--patch UINT=4" or, in later CLI11, "--patch UINT [4]".
            self.assertRegex(line, rf"[=\[]{re.escape(default)}\]?\s", option)

    def test_version(self):
        self.assertRegex(self.run_ok("--version").decode(), r"^curlidar \d+\.\d+\.\d+\n$")

    def test_without_arguments_the_help_is_shown(self):
        result = self.execute()
        self.assertEqual(result.returncode, USAGE)
        self.assertEqual(result.stdout, b"")
        self.assertIn(b"encode", result.stderr)

    def test_an_unknown_command_is_named(self):
        self.assertIn(b"'enkode' is no command", self.execute("enkode").stderr)

    def test_wrong_usage(self):
        for arguments in [["enkode"], ["encode"], ["encode", "a.pcd", "--no-such-option"],
                          ["encode", "a.pcd", "--upsample", "2y2"],
                          ["encode", "a.pcd", "--upsample", "0x1"],
                          ["encode", "a.pcd", "--upsample", "1.5x1"],
                          ["encode", "a.pcd", "--max-range", "p101"],
                          ["encode", "a.pcd", "--max-range", "-3"],
                          ["encode", "a.pcd", "--min-range", "nan"],
                          ["encode", "a.pcd", "--rows", "many"],
                          ["encode", "a.pcd", "--profile", "best"],
                          ["encode", "a.pcd", "--preset", "underwater"],
                          ["encode", "a.pcd", "--sensor", "hdl65"],
                          ["encode", "a.pcd", "--attributes", "a,,b"],
                          ["encode", "a.pcd", "--meta", "no-equals"],
                          ["encode", "a.pcd", "--threads", "-1"],
                          ["encode", "a.pcd", "--patch", "0"],
                          ["encode", "a.pcd", "-o", "a.pcd"],
                          ["encode", "-", "--json"],
                          ["encode", "a.curl"],
                          ["decode", "a.curl", "--rows", "0"],
                          ["decode", "a.curl", "--rows", "inf"],
                          ["decode", "a.curl", "--format", "docx"],
                          ["decode", "a.curl", "--encoding", "morse"],
                          ["convert", "a.pcd"],
                          ["convert", "a.pcd", "a.curl"],
                          ["convert", "a.pcd", "a.pcd"],
                          ["encode", "a.pcd", "--max-error", "0"],
                          ["encode", "a.pcd", "--max-error", "nan"],
                          ["encode", "a.pcd", "--max-error", "0.1", "--error", "0.1"],
                          ["encode", "a.pcd", "--max-error", "0.1", "--lossless"],
                          ["encode", "a.pcd", "--lossless", "--cols", "512"],
                          ["encode", "a.pcd", "--max-error", "0.1", "--min-range", "1"],
                          ["encode", "a.pcd", "--any-order", "--cols", "512"],
                          ["encode", "a.pcd", "--lossless", "--profile", "paper"],
                          ["encode", "a.pcd", "--any-order", "--profile", "paper"],
                          ["verify", "a.curl"],
                          ["verify", "-", "-"],
                          ["compare", "a.pcd"],
                          ["compare", "-", "-"],
                          ["compare", "a.pcd", "a.pcd", "--thresholds", "0.1,-1"],
                          ["compare", "a.pcd", "a.pcd", "--peak", "0"],
                          ["compare", "a.pcd", "a.pcd", "--voxel", "0"],
                          ["compare", "a.pcd", "a.pcd", "--quantiles", "1"],
                          ["compare", "a.pcd", "a.pcd", "--max-range", "80"],
                          ["simulate", "--scene", "moon"],
                          ["simulate", "--dropout", "2"],
                          ["render", "a.pcd", "--view", "inside-out"],
                          ["render", "a.pcd", "--colour", "error"],
                          ["render", "a.pcd", "--size", "0x0"],
                          ["sensors", "auto"],
                          ["info", "a.pcd", "--sensor", "hdl65"]]:
            with self.subTest(arguments=arguments):
                result = self.run_fail(USAGE, *arguments)
                self.assertEqual(result.stdout, b"")
        self.assertEqual(self.files(), [])

    def test_a_missing_file_is_named(self):
        for arguments in [["encode", "nowhere.pcd"], ["decode", "nowhere.pcd"],
                          ["info", "nowhere.pcd"], ["render", "nowhere.pcd"],
                          ["compare", "nowhere.pcd", "nowhere.pcd"],
                          ["verify", "nowhere.pcd", "nowhere.pcd"],
                          ["project", "nowhere.pcd"], ["mesh", "nowhere.pcd"],
                          ["upsample", "nowhere.pcd"], ["convert", "nowhere.pcd", "b.ply"]]:
            with self.subTest(arguments=arguments):
                self.run_fail(FILE, *arguments, says="nowhere.pcd")
        self.assertEqual(self.files(), [])

    def test_an_input_that_is_no_cloud_is_refused(self):
        self.path("text.pcd").write_text("This is a letter, not a point cloud.\n")
        self.path("empty.pcd").write_bytes(b"")
        for name in ["text.pcd", "empty.pcd"]:
            for command in ["encode", "info", "render", "project", "mesh", "upsample", "decode"]:
                with self.subTest(name=name, command=command):
                    self.run_fail(INPUT, command, name, says=name)
        self.assertEqual(self.files(), ["empty.pcd", "text.pcd"])

    def test_an_output_that_cannot_be_written(self):
        self.simulate("scan.pcd")
        for arguments in [["encode", "scan.pcd", "-o", "no/such/folder/scan.curl"],
                          ["convert", "scan.pcd", "no/such/folder/scan.ply"],
                          ["render", "scan.pcd", "-o", "no/such/folder/scan.png"],
                          ["mesh", "scan.pcd", "-o", "no/such/folder/scan.ply"]]:
            with self.subTest(arguments=arguments):
                self.run_fail(FILE, *arguments, says="no/such/folder")
        self.assertEqual(self.files(), ["scan.pcd"])


if __name__ == "__main__":
    unittest.main()
