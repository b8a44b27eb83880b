# SPDX-License-Identifier: BSD-3-Clause
"""encode and decode: reports, factors, attributes, pipes, many inputs."""

import json
import os
import unittest

from support import FILE, INPUT, USAGE, CommandTest, read_kitti, write_kitti


class EveryProfile:
    """What holds whatever the field is made of; `profile` are the options that choose it."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.simulate("scan.pcd")
        cls.execute("convert", "scan.pcd", "scan.bin", "--attributes", "intensity")
        cls.report = json.loads(cls.execute("encode", "scan.pcd", *cls.profile, "--json").stdout)

    def test_report_has_the_keys_of_scripts(self):
        report = self.report
        for key in ["points_in", "points_coded", "bytes", "bits_per_point", "stages_ms"]:
            self.assertIn(key, report)
        size = self.path("scan.curl").stat().st_size
        self.assertEqual(report["bytes"], size)
        self.assertEqual(report["input"], "scan.pcd")
        self.assertEqual(report["output"], "scan.curl")
        self.assertAlmostEqual(report["bits_per_point"], 8 * size / report["points_in"], 6)
        self.assertGreater(len(report["stages_ms"]), 2)

    def test_every_return_is_accounted_for(self):
        dropped = sum(self.report["dropped"].values())
        self.assertLessEqual(self.report["points_coded"], self.report["points_in"] - dropped)
        self.assertGreater(self.report["points_coded"], 0.5 * (self.report["points_in"] - dropped))

    def test_plain_decode_gives_the_coded_returns(self):
        report = self.run_json("decode", "scan.curl", "-o", "plain.bin", "--attributes",
                               "intensity")
        self.assertEqual(report["points"], self.report["points_coded"])
        self.assertEqual(len(read_kitti(self.path("plain.bin"))), report["points"])
        distances = self.run_json("compare", "plain.bin", "scan.pcd")
        self.assertLess(distances["a_to_b"]["mean"], 0.2)

    def test_denser_and_fractional_grids(self):
        points = {}
        for rows, columns in [(1, 1), (4, 1), (1.5, 1), (1, 0.5)]:
            report = self.run_json("decode", "scan.curl", "--rows", rows, "--cols", columns, "-o",
                                   "grid.pcd")
            points[rows, columns] = report["points"]
        self.assertGreater(points[4, 1], 2 * points[1, 1])
        self.assertGreater(points[1.5, 1], points[1, 1])
        self.assertLess(points[1, 0.5], 0.7 * points[1, 1])

    def test_organised_and_without_masks(self):
        self.run_ok("decode", "scan.curl", "--organised", "-o", "grid.pcd")
        info, coded = self.run_json("info", "grid.pcd"), self.run_json("info", "scan.curl")
        self.assertTrue(info["organised"])
        self.assertEqual((info["height"], info["width"]), (coded["rows"], coded["columns"]))
        self.assertEqual(info["height"], 16)
        if self.columns is not None:
            self.assertEqual(info["width"], self.columns)
        masked = self.run_json("decode", "scan.curl", "-o", "masked.pcd")["points"]
        full = self.run_json("decode", "scan.curl", "--no-masks", "-o", "full.pcd")["points"]
        self.assertGreater(full, masked)

    def test_default_output_does_not_replace_the_scan(self):
        before = self.path("scan.pcd").read_bytes()
        self.run_ok("decode", "scan.curl")
        self.assertEqual(self.path("scan.pcd").read_bytes(), before)
        self.assertTrue(self.path("scan.decoded.pcd").exists())

    def test_every_output_format(self):
        for extension in ["pcd", "ply", "npy", "csv"]:
            with self.subTest(extension=extension):
                self.run_ok("decode", "scan.curl", "-o", f"all.{extension}")
                info = self.run_json("info", f"all.{extension}")
                self.assertEqual(info["returns"], self.report["points_coded"])

    def test_attributes_that_do_not_fit_are_not_dropped_silently(self):
        self.run_fail(INPUT, "decode", "scan.curl", "-o", "all.bin", says="--attributes")
        self.assertFalse(self.path("all.bin").exists())
        self.run_fail(INPUT, "decode", "scan.curl", "-o", "no.pcd", "--attributes", "colour",
                      says=["colour", "intensity"])

    def test_attribute_choice_at_encoding(self):
        self.run_ok("encode", "scan.pcd", *self.profile, "-o", "bare.curl", "--attributes", "none")
        self.run_ok("encode", "scan.pcd", *self.profile, "-o", "one.curl", "--attributes",
                    "intensity")
        self.assertLess(self.path("bare.curl").stat().st_size,
                        self.path("one.curl").stat().st_size)
        self.assertEqual(self.run_json("info", "bare.curl")["attributes"], [])
        names = [a["name"] for a in self.run_json("info", "one.curl")["attributes"]]
        self.assertEqual(names, ["intensity"])
        self.run_fail(INPUT, "encode", "scan.pcd", *self.profile, "-o", "bad.curl", "--attributes",
                      "colour", says="colour")

    def test_metadata_is_kept(self):
        self.run_ok("encode", "scan.pcd", *self.profile, "-o", "meta.curl", "--meta",
                    "frame_id=velodyne", "--meta", "note=a=b")
        metadata = self.run_json("info", "meta.curl")["metadata"]
        self.assertEqual(metadata["frame_id"], "velodyne")
        self.assertEqual(metadata["note"], "a=b")
        self.assertEqual(metadata["source"], "scan.pcd")

    def test_pipes(self):
        data = self.run_ok("encode", "-", *self.profile, "-q", "--sensor", "vlp16",
                           stdin=self.path("scan.pcd").read_bytes())
        result = self.execute("decode", "-", "--format", "kitti", "--attributes", "none",
                              stdin=data)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(len(result.stdout) % 16, 0)
        self.assertEqual(len(result.stdout) // 16, self.report["points_coded"])
        self.assertIn(b"points", result.stderr)  # the report makes way for the data

    def test_same_bytes_for_any_number_of_threads(self):
        for threads in [1, 3]:
            self.run_ok("encode", "scan.pcd", *self.profile, "-o", f"t{threads}.curl", "--threads",
                        threads)
            self.run_ok("decode", f"t{threads}.curl", "--rows", 3, "-o", f"t{threads}.pcd",
                        "--threads", threads)
        for kind in ["curl", "pcd"]:
            self.assertEqual(self.path(f"t1.{kind}").read_bytes(),
                             self.path(f"t3.{kind}").read_bytes())

    def test_the_text_report(self):
        text = self.run_ok("encode", "scan.pcd", *self.profile, "-o", "text.curl").decode()
        for word in ["points in", "points coded", "bits per point", "total", *self.words]:
            self.assertIn(word, text)
        quiet = self.run_ok("encode", "scan.pcd", *self.profile, "-o", "text.curl", "--quiet")
        self.assertEqual(quiet, b"")


class PaperProfileTest(EveryProfile, CommandTest):
    profile = ["--profile", "paper"]
    columns = 1024
    words = ["patches", "not coded one for one", "out of range"]

    def test_report_of_the_fit(self):
        self.assertGreater(self.report["cp_paper_percent"], 0)
        self.assertGreater(self.report["coefficients"], self.report["patches"])
        self.assertEqual(sum(self.report["degrees"].values()), self.report["patches"])

    def test_profiles_and_options(self):
        tuned = self.run_json("encode", "scan.pcd", "--profile", "paper-1to1", "-o", "tuned.curl")
        whole = self.run_json("encode", "scan.pcd", "--profile", "paper-global",
                              "--global-degree", 10, "-o", "global.curl")
        self.assertEqual(whole["coefficients"], 121)
        self.assertGreater(tuned["coefficients"], self.report["coefficients"])
        info = self.run_json("info", "tuned.curl")
        self.assertEqual(info["profile"], "paper-1to1")
        self.assertEqual(info["parameters"]["upsample_rows"], 1)
        self.run_ok("encode", "scan.pcd", "--profile", "paper-1to1", "--upsample", "1x3",
                    "--patch", 8, "--error-stop", "true", "-o", "mixed.curl")
        parameters = self.run_json("info", "mixed.curl")["parameters"]
        self.assertEqual(parameters["upsample_columns"], 3)
        self.assertEqual(parameters["patch"], 8)
        self.assertEqual(parameters["accept_m"], 0.01)  # the profile's, not the default

    def test_ranges_and_rows(self):
        near = self.run_json("encode", "scan.pcd", *self.profile, "--min-range", 0, "--max-range",
                             10, "--rows", "rings", "--cols", 512, "-o", "near.curl")
        self.assertGreater(near["dropped"]["out_of_range"], 0)
        info = self.run_json("info", "near.curl")
        self.assertEqual((info["rows"], info["columns"]), (16, 512))


class CompactProfileTest(EveryProfile, CommandTest):
    profile = ["--effort", 1]
    columns = None  # as many as the scan has firings
    words = ["Every return:", "Parts of the file:", "order", "attributes"]

    def test_nothing_is_dropped(self):
        self.assertEqual(self.report["points_coded"], self.report["points_in"])
        self.assertEqual(sum(self.report["dropped"].values()), 0)


class DepthImageTest(EveryProfile, CommandTest):
    profile = ["--effort", 1, "--cols", 1024]
    columns = 1024
    words = ["residual", "not coded one for one", "share a cell"]


class ManyInputsTest(CommandTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        for i in range(3):
            cls.simulate(f"{i}.pcd", "--seed", i)

    def test_a_folder_is_made_and_one_array_reported(self):
        reports = self.run_json("encode", "0.pcd", "1.pcd", "2.pcd", "-o", "out", "--effort", 1)
        self.assertEqual([r["input"] for r in reports], ["0.pcd", "1.pcd", "2.pcd"])
        self.assertEqual(self.files("out"), ["0.curl", "1.curl", "2.curl"])
        reports = self.run_json("decode", "out/0.curl", "out/1.curl", "-o", "back/", "--format",
                                "ply")
        self.assertEqual(len(reports), 2)
        self.assertEqual(self.files("back"), ["0.decoded.ply", "1.decoded.ply"])

    def test_a_bad_input_does_not_stop_the_others(self):
        self.path("bad.pcd").write_text("nothing")
        result = self.run_fail(INPUT, "encode", "0.pcd", "bad.pcd", "2.pcd", "-o", "some/",
                               "--effort", 1, "--json", says="bad.pcd")
        reports = json.loads(result.stdout)
        self.assertEqual(["error" in r for r in reports], [False, True, False])
        self.assertIn("bad.pcd", reports[1]["error"])
        self.assertEqual(self.files("some"), ["0.curl", "2.curl"])
        self.path("bad.pcd").unlink()

    def test_several_inputs_need_a_folder(self):
        self.path("file.curl").write_text("mine")
        self.run_fail(USAGE, "encode", "0.pcd", "1.pcd", "-o", "file.curl", says="directory")
        self.run_fail(USAGE, "encode", "0.pcd", "1.pcd", "-o", "-", says="directory")
        self.assertEqual(self.path("file.curl").read_text(), "mine")

    def test_two_inputs_of_one_name_are_refused(self):
        os.makedirs(self.path("a"), exist_ok=True)
        self.path("a/0.pcd").write_bytes(self.path("0.pcd").read_bytes())
        self.run_fail(USAGE, "encode", "0.pcd", "a/0.pcd", "-o", "twice/", says="both become")
        self.assertFalse(self.path("twice").exists())


class DamagedFileTest(CommandTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.simulate("scan.pcd")
        assert cls.execute("encode", "scan.pcd").returncode == 0
        cls.good = cls.folder.joinpath("scan.curl").read_bytes()

    def test_cut_and_damaged_files_make_no_output(self):
        before = self.files()
        size = len(self.good)
        for cut in [0, 1, 7, 8, 20, size // 2, size - 1]:
            self.check_refused(self.good[:cut])
        for place in [0, 5, 9, size // 3, size // 2, size - 2]:
            damaged = bytearray(self.good)
            damaged[place] ^= 0x10
            self.check_refused(bytes(damaged))
        self.assertEqual(self.files(), before)

    def check_refused(self, data):
        self.run_fail(INPUT, "decode", "-", "-o", "out.pcd", stdin=data)
        self.assertFalse(self.path("out.pcd").exists())

    def test_a_failed_write_leaves_the_old_file(self):
        self.path("kept.pcd").write_text("old")
        self.path("cut.curl").write_bytes(self.good[:100])
        self.run_fail(INPUT, "decode", "cut.curl", "-o", "kept.pcd", says="cut.curl")
        self.assertEqual(self.path("kept.pcd").read_text(), "old")
        self.path("kept.pcd").unlink()
        self.path("cut.curl").unlink()

    def test_a_full_disk_is_noticed(self):
        if not os.path.exists("/dev/full"):
            self.skipTest("no /dev/full here")
        import subprocess
        from support import CURLIDAR
        with open("/dev/full", "wb") as full:
            result = subprocess.run([CURLIDAR, "info", "scan.curl"], cwd=self.folder, stdout=full,
                                    stderr=subprocess.PIPE, timeout=60)
        self.assertEqual(result.returncode, FILE)
        self.assertIn(b"standard output", result.stderr)


class DegenerateScanTest(CommandTest):
    def encode(self, points, *arguments):
        write_kitti(self.path("few.bin"), points)
        return self.execute("encode", "few.bin", "--sensor", "vlp16", "--min-range", "0",
                            "--max-range", "max", *arguments)

    def test_few_points_are_coded_or_refused_with_a_reason(self):
        one_ring = [(10 * (i % 7 + 1), i - 50.0, 0.0, 0.5) for i in range(100)]
        for points in [[], [(0, 0, 0, 0)], [(float("nan"),) * 4], [(5, 0, 0, 1)],
                       [(5, 0, 0, 1)] * 50, [(5, 0, 0, 1), (0, 5, 0, 1), (-5, 0, 0.5, 1)],
                       one_ring]:
            for profile in ["compact", "paper", "paper-1to1", "paper-global"]:
                with self.subTest(points=len(points), profile=profile):
                    options = ["--outlier-radius", "0", "--global-degree", "8"]
                    result = self.encode(points, "--profile", profile,
                                         *(options if profile != "compact" else []))
                    if result.returncode != 0:
                        self.assertEqual(result.returncode, INPUT, result.stderr)
                        self.assertIn(b"few.bin", result.stderr)
                    elif profile == "compact":
                        self.run_ok("verify", "few.curl", "few.bin")
                        self.run_ok("decode", "few.curl")
                    else:
                        self.assertGreater(len(points), 0)
                        self.run_ok("decode", "few.curl")

    def test_a_scan_without_returns_keeps_its_slots(self):
        for points in [[], [(0, 0, 0, 0)], [(0, 0, 0, 0.5), (float("nan"),) * 4]]:
            with self.subTest(points=points):
                self.assertEqual(self.encode(points).returncode, 0)
                self.assertTrue(self.run_json("verify", "few.curl", "few.bin")["ok"])
                self.run_ok("decode", "few.curl", "-o", "back.bin")
                self.assertEqual(len(read_kitti(self.path("back.bin"))), len(points))

    def test_a_depth_image_without_returns_is_refused(self):
        for points in [[], [(0, 0, 0, 0)]]:
            self.assertEqual(self.encode(points, "--cols", 512).returncode, INPUT)


if __name__ == "__main__":
    unittest.main()
