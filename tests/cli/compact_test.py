# SPDX-License-Identifier: BSD-3-Clause
"""The compact profile: targets, every return, decoding in part, cut files, pictures."""

import json
import random
import unittest

from support import INPUT, OK, USAGE, CommandTest, png_size, write_kitti


class CompactTest(CommandTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.simulate("scan.pcd")
        assert cls.execute("project", "scan.pcd", "--rows", "rings", "--cols", 512, "--min-range",
                           1, "--max-range", 60, "-o", "grid.pcd").returncode == OK

    def encode(self, *arguments, name="x.curl"):
        report = self.run_json("encode", "grid.pcd", "-o", name, "--attributes", "none",
                               "--effort", 2, *arguments)
        self.assertEqual(report["bytes"], self.path(name).stat().st_size)
        return report

    def test_a_grid_keeps_its_cells_and_the_error_is_what_was_asked_for(self):
        report = self.encode("--error", 0.03)
        self.assertEqual(report["profile"], "compact")
        self.assertTrue(report["cell_centres"])
        self.assertEqual(report["points_coded"], self.run_json("info", "grid.pcd")["returns"])
        self.assertLessEqual(report["mean_error_m"], 0.03)
        self.assertGreater(report["mean_error_m"], 0.95 * 0.03)
        self.assertLessEqual(report["mean_error_m"], report["rms_error_m"])
        self.assertLessEqual(report["rms_error_m"], report["max_error_m"])
        self.assertEqual(sum(report["dropped"].values()), 0)
        bits = sum(report["breakdown"].values())
        self.assertAlmostEqual(bits, 8 * report["bytes"], 2)
        self.assertEqual(set(report["breakdown"]), {"header", "mask", "partition", "modes",
                                                    "coefficients", "labels", "residual",
                                                    "records"})

    def test_other_targets(self):
        near = self.encode("--error-nn", 0.03)
        self.run_ok("decode", "x.curl", "-o", "near.pcd")
        distances = self.run_json("compare", "near.pcd", "grid.pcd")
        worse = max(distances["a_to_b"]["mean"], distances["b_to_a"]["mean"])
        self.assertLessEqual(worse, 0.03 + 1e-6)  # the file of points holds floats
        self.assertAlmostEqual(worse, near["error_nn_m"], 5)
        bits = self.encode("--bits", 3)
        self.assertLessEqual(bits["bits_per_point_coded"], 3)
        self.assertGreaterEqual(bits["bits_per_point_coded"], 0.97 * 3)
        self.assertEqual(self.encode("--step", 0.25)["step_m"], 0.25)

    def test_depth_images_are_asked_for(self):
        image = self.run_json("encode", "scan.pcd", "--cols", 512, "-o", "image.curl",
                              "--attributes", "none", "--effort", 1)
        self.assertNotIn("records", image)
        self.assertEqual(image["points_coded"] + image["dropped"]["collided"], image["points_in"])
        self.assertGreater(image["dropped"]["collided"], 0)
        info = self.run_json("info", "image.curl")
        self.assertFalse(info["every_return"])
        self.assertNotIn("records", info)
        near = self.run_json("encode", "scan.pcd", "--max-range", 20, "-o", "near.curl",
                             "--effort", 1)
        self.assertGreater(near["dropped"]["out_of_range"], 0)
        self.assertEqual(near["points_coded"],
                         near["points_in"] - sum(near["dropped"].values()))
        text = self.run_ok("encode", "scan.pcd", "--cols", 512, "-o", "image.curl").decode()
        self.assertIn("not coded one for one", text)

    def test_every_return_and_what_was_found(self):
        self.simulate("rays.pcd", "--range-unit", 0.002)
        report = self.run_json("encode", "rays.pcd", "--max-error", 0.02, "-o", "all.curl")
        self.assertEqual(report["points_coded"], report["points_in"])
        self.assertEqual(sum(report["dropped"].values()), 0)
        self.assertLessEqual(report["max_error_m"], 0.02)
        records = report["records"]
        self.assertEqual((records["bound_m"], records["bit_exact"]), (0.02, False))
        self.assertEqual(records["lattice"], "rays")
        self.assertEqual(records["slots"], 1808)
        self.assertEqual(records["share_on_lattice"], 1)
        self.assertLess(records["residual_mm"]["across"], 0.1)
        info = self.run_json("info", "all.curl")
        self.assertTrue(info["every_return"])
        for key in ["lattice", "table", "firings", "slots", "loose", "bound_m", "bit_exact",
                    "any_order"]:
            self.assertEqual(info["records"][key], records[key], key)
        scan = self.run_json("info", "rays.pcd")
        self.assertEqual(info["records"]["cloud_slots"], scan["slots"])
        self.assertEqual(info["records"]["coordinates"], "float32")
        self.assertIsNone(info["records"]["motion"])
        chunks = {c["name"]: c["bytes"] for c in info["chunks"]}
        for name in ["compact_rays", "order", "records", "promise"]:
            self.assertIn(name, chunks)
        parts = records["bytes"]
        self.assertLessEqual(chunks["order"], parts["order"])  # which counts its frame, too
        self.assertLessEqual(chunks["records"], parts["attributes"])
        text = self.run_ok("encode", "rays.pcd", "--max-error", 0.02, "-o", "all.curl").decode()
        for word in ["every point within 20.0 mm", "100.00 %", "1,808 positions", "calibrat",
                     "order", "attributes", "corrected"]:
            self.assertIn(word, text)
        self.assertNotIn("not coded one for one", text)
        text = self.run_ok("info", "all.curl").decode()
        for word in ["every one of the scan", "every point within 20.0 mm", "1,808 positions"]:
            self.assertIn(word, text)

    def test_points_without_rings(self):
        uniform = random.Random(5)
        write_kitti(self.path("noise.bin"),
                    [[uniform.uniform(-20, 20) for _ in range(3)] + [0] for _ in range(500)])
        report = self.run_json("encode", "noise.bin", "--max-error", 0.01)
        self.assertEqual(report["records"]["lattice"], "none")
        self.assertIn("No rings", report["records"]["notes"][0])
        info = self.run_json("info", "noise.curl")
        self.assertEqual((info["rings"], info["rows"], info["columns"]), (0, 0, 0))
        self.assertEqual(info["records"]["loose"], 500)
        self.assertEqual(self.run_json("decode", "noise.curl", "-o", "back.bin")["points"], 500)
        for text in [self.run_ok("encode", "noise.bin", "--max-error", 0.01),
                     self.run_ok("info", "noise.curl")]:
            self.assertIn(b"points one after the other", text)
        # There is no field to be seen from elsewhere, nor rings to choose.
        for arguments in [["--rows", 2], ["--cols", 0.5], ["--organised"], ["--no-masks"]]:
            self.run_fail(INPUT, "decode", "noise.curl", *arguments, "-o", "no.pcd",
                          says=["noise.curl", "without a field"])
        self.run_fail(INPUT, "decode", "noise.curl", "--rings", "0:4", "-o", "no.pcd", says="rings")
        data = self.path("noise.curl").read_bytes()
        self.path("cut.curl").write_bytes(data[:len(data) // 2])
        self.run_fail(INPUT, "decode", "cut.curl", "--allow-truncated", "-o", "no.pcd",
                      says="cut off")
        self.assertFalse(self.path("no.pcd").exists())

    def test_effort_and_index(self):
        fast = self.run_json("encode", "grid.pcd", "-o", "fast.curl", "--attributes", "none",
                             "--effort", 1)
        best = self.run_json("encode", "grid.pcd", "-o", "best.curl", "--attributes", "none",
                             "--effort", 6)
        self.assertLess(best["bytes"], fast["bytes"])
        whole = self.encode("--step", 0.05, "--no-index")
        self.assertEqual(whole["segments"], 1)
        self.assertLessEqual(whole["bytes"], self.encode("--step", 0.05)["bytes"])

    def test_segments_as_asked(self):
        parts = self.encode("--step", 0.2, "--segments", "2x3")
        self.assertEqual(parts["segments"], 6)
        whole = self.run_json("decode", "x.curl", "-o", "whole.pcd")
        part = self.run_json("decode", "x.curl", "-o", "part.pcd", "--azimuth", "0:60")
        self.assertLess(0, part["points"])
        self.assertLess(part["points"], whole["points"])

    def test_contradictions_are_refused(self):
        for arguments, says in [(["--error", 0.1, "--bits", 1], ["--error", "--bits"]),
                                (["--step", 0.1, "--error-nn", 1], ["--step", "--error-nn"]),
                                (["--patch", 4], ["--patch", "--profile paper"]),
                                (["--preset", "indoor"], ["--preset", "--profile paper"]),
                                (["--rows", "uniform"], ["--profile paper"]),
                                (["--profile", "paper", "--error", 0.1], ["--error", "compact"]),
                                (["--error", 0], ["--error"]), (["--effort", 10], ["--effort"]),
                                (["--error", "small"], ["--error"]),
                                (["--segments", "2x0"], ["--segments"]),
                                (["--segments", "1x4", "--no-index"], ["--segments"])]:
            with self.subTest(arguments=arguments):
                self.run_fail(USAGE, "encode", "grid.pcd", "-o", "no.curl", *arguments, says=says)
        self.assertFalse(self.path("no.curl").exists())

    def test_out_of_reach_says_what_helps(self):
        self.run_fail(INPUT, "encode", "scan.pcd", "--cols", 300, "--error", 0.005, "-o", "no.curl",
                      says=["out of reach", "--cols"])

    def test_geometry_only_files_hold_nothing_else(self):
        self.encode("--step", 0.3)
        names = {chunk["name"] for chunk in self.run_json("info", "x.curl")["chunks"]}
        self.assertFalse(names & {"attributes", "metadata"})
        self.encode("--step", 0.3, "--meta", "note=kept")
        self.assertEqual(self.run_json("info", "x.curl")["metadata"], {"note": "kept"})

    def test_info_tells_where_bytes_go_and_what_the_partition_is(self):
        report = self.encode("--error", 0.01)
        info = self.run_json("info", "x.curl")
        self.assertEqual(info["profile"], "compact")
        self.assertEqual(sum(part["bytes"] for part in info["parts"]), info["bytes"])
        statistics = info["statistics"]
        self.assertEqual(statistics, report["statistics"])
        self.assertEqual(sum(statistics["leaves_by_layers"]), statistics["leaves"])
        self.assertEqual(info["parameters"]["step_m"], report["step_m"])
        text = self.run_ok("info", "x.curl").decode()
        for word in ["partition", "leaves", "layers", "compact_mask", "bits a return"]:
            self.assertIn(word, text)

    def test_parts_of_a_scan(self):
        self.encode("--error", 0.01)
        whole = self.run_json("decode", "x.curl", "-o", "whole.pcd")
        upper = self.run_json("decode", "x.curl", "--rings", "0:8", "-o", "upper.pcd")
        lower = self.run_json("decode", "x.curl", "--rings", "8:16", "-o", "lower.pcd")
        self.assertEqual(upper["points"] + lower["points"], whole["points"])
        quarters = [self.run_json("decode", "x.curl", "--azimuth", f"{a}:{a + 90}", "-o",
                                  "quarter.pcd")["points"] for a in [45, 135, 225, 315]]
        self.assertEqual(sum(quarters), whole["points"])
        coarse = self.run_json("decode", "x.curl", "--field-only", "-o", "coarse.pcd")
        self.assertEqual(coarse["points"], whole["points"])
        error = self.run_json("compare", "coarse.pcd", "grid.pcd")["a_to_b"]["mean"]
        self.assertGreater(error, self.run_json("compare", "whole.pcd", "grid.pcd")["a_to_b"]["mean"])
        both = self.run_json("decode", "x.curl", "--region", "0:8,-45:45", "-o", "both.pcd")
        same = self.run_json("decode", "x.curl", "--rings", "0:8", "--azimuth", "-45:45", "-o",
                             "same.pcd")
        self.assertEqual(both["points"], same["points"])
        self.assertLess(both["points"], upper["points"])
        for arguments in [["--region", "0:8"], ["--region", "0:8,"], ["--rings", "8"], ["--rings", "9:3"], ["--azimuth", "a:b"],
                          ["--azimuth", "9:9"]]:
            self.run_fail(USAGE, "decode", "x.curl", *arguments, "-o", "no.pcd", says=arguments[0])
        self.run_fail(INPUT, "decode", "x.curl", "--rings", "90:99", "-o", "no.pcd", says="region")
        self.run_ok("encode", "scan.pcd", "--profile", "paper", "-o", "paper.curl")
        self.run_fail(INPUT, "decode", "paper.curl", "--rings", "0:4", "-o", "no.pcd",
                      says="compact")

    def test_parts_of_every_return(self):
        self.run_ok("encode", "scan.pcd", "--max-error", 0.01, "--effort", 1, "-o", "all.curl")
        points = {}
        for name, arguments in [("whole", []), ("coarse", ["--field-only"]),
                                ("upper", ["--rings", "0:8"]), ("lower", ["--rings", "8:16"]),
                                ("dense", ["--rows", 4])]:
            report = self.run_json("decode", "all.curl", *arguments, "-o", f"{name}.pcd")
            points[name] = report["points"]
        loose = self.run_json("info", "all.curl")["records"]["loose"]
        self.assertEqual(points["upper"] + points["lower"], points["whole"] - loose)
        self.assertEqual(points["coarse"], points["whole"])
        self.assertGreater(points["dense"], 2 * points["whole"])
        # The field alone is coarser, but each of its points has its own attributes.
        distances = [self.run_json("compare", f"{name}.pcd", "scan.pcd")["a_to_b"]["mean"]
                     for name in ["whole", "coarse"]]
        self.assertLess(distances[0], 0.01)
        self.assertGreater(distances[1], 2 * distances[0])
        for name in ["scan", "coarse"]:
            self.run_ok("convert", f"{name}.pcd", f"{name}.npy")
            self.run_ok("convert", f"{name}.pcd", f"{name}.csv")
        values = [[line.split(",")[3:] for line in self.path(f"{name}.csv").read_text().split()]
                  for name in ["scan", "coarse"]]
        self.assertEqual(*values)

    def test_cut_files_with_every_return(self):
        self.run_ok("encode", "scan.pcd", "--max-error", 0.01, "--effort", 1, "-o", "all.curl")
        data = self.path("all.curl").read_bytes()
        offsets = {c["name"]: c["offset"] for c in self.run_json("info", "all.curl")["chunks"]}
        for chunk, share in [("compact_residual", 0.1), ("order", 0.9), ("records", 1)]:
            with self.subTest(chunk=chunk):
                self.path("cut.curl").write_bytes(data[:offsets[chunk] + 5])
                self.run_fail(INPUT, "decode", "cut.curl", "-o", "no.pcd", says="--allow-truncated")
                result = self.execute("decode", "cut.curl", "--allow-truncated", "-o", "cut.pcd",
                                      "--json")
                self.assertEqual(result.returncode, OK, result.stderr)
                self.assertEqual(result.stderr.count(b"\n"), 1)
                report = json.loads(result.stdout)
                self.assertGreater(len(report["missing"]), 0)
                whole = self.run_json("info", "scan.pcd")["returns"]
                self.assertGreaterEqual(report["points"], share * whole)
        self.assertFalse(self.path("no.pcd").exists())

    def test_cut_files(self):
        self.encode("--error", 0.01)
        data = self.path("x.curl").read_bytes()
        self.path("cut.curl").write_bytes(data[:len(data) * 6 // 10])
        self.run_fail(INPUT, "decode", "cut.curl", "-o", "no.pcd", says="--allow-truncated")
        self.assertFalse(self.path("no.pcd").exists())
        result = self.execute("decode", "cut.curl", "--allow-truncated", "-o", "cut.pcd", "--json")
        self.assertEqual(result.returncode, OK)
        self.assertTrue(result.stderr.startswith(b"curlidar: warning: cut.curl"), result.stderr)
        self.assertEqual(result.stderr.count(b"\n"), 1)
        report = json.loads(result.stdout)
        self.assertGreater(len(report["missing"]), 0)
        self.assertGreater(report["points"], 0)
        self.path("damaged.curl").write_bytes(data[:50] + bytes([data[50] ^ 1]) + data[51:])
        self.run_fail(INPUT, "decode", "damaged.curl", "--allow-truncated", "-o", "no.pcd")

    def test_pictures_of_the_partition(self):
        self.encode("--error", 0.05)
        for view in ["partition", "layers"]:
            self.run_ok("render", "x.curl", "--view", view, "--size", "640x0", "-o", f"{view}.png")
            width, height = png_size(self.path(f"{view}.png"))
            self.assertEqual(width, 640)
            self.assertGreater(height, 16 * 4 * 3)
        self.run_fail(INPUT, "render", "grid.pcd", "--view", "layers", "-o", "no.png")
        self.run_ok("encode", "scan.pcd", "--profile", "paper", "-o", "paper.curl")
        self.run_fail(INPUT, "render", "paper.curl", "--view", "layers", "-o", "no.png",
                      says="compact")


if __name__ == "__main__":
    unittest.main()
