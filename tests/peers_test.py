#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The peer codecs on a small simulated scan: `rate_distortion cloud`, and the driver of programs
that are codecs (bench/peers/external.py) with stand-ins for them."""
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CURLIDAR, PROGRAM = os.environ["CURLIDAR"], os.environ["RATE_DISTORTION"]
PYTHONS = [python for python in (sys.executable, "/usr/bin/python3") if subprocess.run(
    [python, "-c", "import numpy, tomllib"], check=False, capture_output=True).returncode == 0]

# Its stream is the cloud, zipped. tmc3 has --NAME=VALUE options.
TMC3 = """#!{python}
import sys, zlib
options = dict(each.lstrip("-").split("=", 1) for each in sys.argv[1:])
def read(name): return open(options[name], "rb").read()
if options["mode"] == "0":
    assert options["disableAttributeCoding"] == "1", options
    if options.get("angularEnabled"):
        assert len(options["lasersTheta"].split(",")) == int(options["numLasers"]) == 16, options
    open(options["compressedStreamPath"], "wb").write(zlib.compress(read("uncompressedDataPath")))
else:
    decoded = zlib.decompress(read("compressedStreamPath"))
    open(options["reconstructedDataPath"], "wb").write(decoded)
"""
CLOUDINI = """#!{python}
import sys, zlib
options = dict(zip(sys.argv[2::2], sys.argv[3::2]))
assert sys.argv[1] == "-y" and options["-c"] == "zstd" and float(options["-r"]) > 0, options
open(options["-o"], "wb").write(zlib.compress(open(options["-f"], "rb").read()))
"""


def output_of(*command):
    return subprocess.run([str(part) for part in command], check=True, capture_output=True,
                          text=True).stdout


class PeersTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.scratch.name)
        cls.scan = cls.folder / "scan.pcd"
        output_of(CURLIDAR, "simulate", "--scene", "room", "--sensor", "vlp16", "--quiet",
                  "--threads", "1", "-o", cls.scan)

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def cloud(self, *options):
        head, *lines = map(json.loads, output_of(
            PROGRAM, "cloud", self.scan, *options).splitlines())
        return head["returns"], lines

    def test_every_codec_is_measured_or_says_why_not(self):
        returns, lines = self.cloud("--settings", "2")
        codecs = {line["codec"] for line in lines}
        self.assertLessEqual({"pcl-octree", "draco-kd-tree", "xyz-zstd19", "jpeg-xl-e9-2048",
                              "png-4096", "range-zstd19-2048"}, codecs)
        for line in lines:
            if "skipped" in line:
                self.assertIn("not found when this was built", line["skipped"])
                continue
            self.assertLess(0, line["points_back"])
            self.assertLessEqual(line["points_back"], returns)
            self.assertLess(line["bytes"], 12 * returns)
            for way in ("nearest_to_decoded", "nearest_to_raw"):
                self.assertLessEqual(line[way]["mean"], line[way]["rms"])
                self.assertLessEqual(line[way]["p95"], line[way]["max"])

    def test_finer_settings_cost_more_and_err_less(self):
        returns, lines = self.cloud("--codecs", "xyz-zstd19", "--settings", "3")
        sizes = [line["bytes"] for line in lines]
        errors = [line["nearest_to_decoded"]["mean"] for line in lines]
        self.assertEqual(len(lines), 3)
        self.assertEqual(sizes, sorted(sizes, reverse=True))
        self.assertEqual(errors, sorted(errors))
        self.assertLess(errors[0], .002)  # of steps of 2 mm
        self.assertEqual({line["points_back"] for line in lines}, {returns})

    def test_a_fine_range_image_errs_by_its_columns_only(self):
        returns, (line,) = self.cloud("--codecs", "range-zstd19-4096", "--settings", "1")
        self.assertLess(line["nearest_to_raw"]["mean"], .03)
        self.assertGreater(line["points_back"], .9 * returns)

    def test_unknown_codecs_and_options_are_refused(self):
        for options in (("--codecs", "zip"), ("--settings", "two"), ("--speed", "9"),
                        ("--codecs",)):
            run = subprocess.run([PROGRAM, "cloud", self.scan, *options], check=False,
                                 capture_output=True, text=True)
            self.assertEqual(run.returncode, 1, options)
            self.assertRegex(run.stderr, "usage|no codec is called zip")

    def external(self, codec, stand_in):
        if not PYTHONS:
            self.skipTest("no Python with numpy")
        program = self.folder / "program"
        program.write_text(stand_in.format(python=PYTHONS[0]), encoding="utf-8")
        program.chmod(0o755)
        return [json.loads(line) for line in output_of(
            PYTHONS[0], "-B", ROOT / "bench/peers/external.py", codec, program, CURLIDAR,
            self.scan, "2").splitlines()]

    def test_gpcc_is_driven_on_a_lattice_of_its_step(self):
        returns, _ = self.cloud("--codecs", "xyz-zstd19", "--settings", "1")
        for codec, coarsest in (("gpcc-octree", .2), ("gpcc-predictive", .2),
                                ("gpcc-angular", .001)):
            fine, coarse = self.external(codec, TMC3)
            self.assertEqual({fine["points_back"], coarse["points_back"]}, {returns}, codec)
            self.assertGreater(fine["bytes"], 0)
            self.assertLessEqual(fine["nearest_to_raw"]["max"], .002)
            self.assertLessEqual(coarse["nearest_to_decoded"]["max"], coarsest)

    def test_cloudini_is_driven_and_has_no_time_of_decoding(self):
        fine, coarse = self.external("cloudini", CLOUDINI)
        self.assertLess(fine["nearest_to_raw"]["mean"], .002)
        self.assertGreater(coarse["nearest_to_raw"]["mean"], fine["nearest_to_raw"]["mean"])
        self.assertIsNone(fine["decode_ms"])

    def test_a_program_that_fails_is_told_for_each_setting(self):
        lines = self.external("gpcc-octree", "#!{python}\nimport sys\nsys.exit('no such option')\n")
        self.assertEqual(["no such option" in line["skipped"] for line in lines], [True, True])


if __name__ == "__main__":
    unittest.main(verbosity=2)
