# SPDX-License-Identifier: BSD-3-Clause
"""Commands on clouds: convert, info, compare, project, simulate, render, sensors."""

import json
import math
import unittest

from support import INPUT, USAGE, CommandTest, ply_header, png_size, read_kitti, write_kitti


class ConvertTest(CommandTest):
    POINTS = [(1.5, -2.25, 0.125, 0.5), (0, 0, 0, 0), (float("nan"), 1, 2, 3), (4, 5, 6, 1)]

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        write_kitti(cls.folder / "scan.bin", cls.POINTS)

    def test_every_format_there_and_back_is_exact(self):
        original = self.path("scan.bin").read_bytes()
        for extension in ["pcd", "ply", "npy", "csv"]:
            with self.subTest(extension=extension):
                self.run_ok("convert", "scan.bin", f"copy.{extension}")
                self.run_ok("convert", f"copy.{extension}", "back.bin")
                back = self.path("back.bin").read_bytes()
                if extension == "csv":  # the sign and payload of NaN are not kept as text
                    self.assertTrue(math.isnan(read_kitti(self.path("back.bin"))[2][0]))
                    self.assertEqual(back[:32] + back[48:], original[:32] + original[48:])
                else:
                    self.assertEqual(back, original)

    def test_encodings(self):
        for encoding in ["ascii", "binary", "binary_compressed"]:
            self.run_ok("convert", "scan.bin", "e.pcd", "--encoding", encoding)
            self.assertIn(f"DATA {encoding}\n".encode(), self.path("e.pcd").read_bytes())
        self.run_ok("convert", "scan.bin", "e.ply", "--encoding", "binary_big_endian")
        self.assertIn(b"binary_big_endian", self.path("e.ply").read_bytes())

    def test_drop_invalid_and_attributes(self):
        report = self.run_json("convert", "scan.bin", "clean.pcd", "--drop-invalid",
                               "--attributes", "none")
        self.assertEqual((report["points_in"], report["points"]), (4, 2))
        self.run_fail(INPUT, "convert", "clean.pcd", "more.ply", "--attributes", "intensity",
                      says="intensity")

    def test_pipes(self):
        data = self.run_ok("convert", "-", "-", "--format", "kitti", "--to-format", "csv", "-q",
                           stdin=self.path("scan.bin").read_bytes())
        lines = data.decode().splitlines()
        self.assertTrue(any(line.replace(" ", ",").startswith("1.5,-2.25,0.125,0.5")
                            for line in lines), lines)

    def test_many_into_a_folder(self):
        write_kitti(self.path("two.bin"), self.POINTS)
        reports = self.run_json("convert", "scan.bin", "two.bin", "plys/", "--to-format", "ply")
        self.assertEqual(len(reports), 2)
        self.assertEqual(self.files("plys"), ["scan.ply", "two.ply"])

    def test_the_input_is_never_replaced(self):
        before = self.path("scan.bin").read_bytes()
        self.run_fail(USAGE, "convert", "scan.bin", "./scan.bin", says="replace")
        self.assertEqual(self.path("scan.bin").read_bytes(), before)


class InfoTest(CommandTest):
    def test_a_simulated_scan_is_recognised(self):
        self.simulate("scan.pcd")
        info = self.run_json("info", "scan.pcd")
        self.assertEqual(info["kind"], "scan")
        self.assertEqual(info["rings"], 16)
        self.assertEqual(info["ring_source"], "ring_attribute"
                         if "_" in info["ring_source"] else info["ring_source"])
        self.assertEqual(len(info["elevations_deg"]), 16)
        self.assertAlmostEqual(info["elevations_deg"][0], 15, 1)
        self.assertAlmostEqual(info["elevations_deg"][-1], -15, 1)
        self.assertLessEqual(info["range_m"]["p50"], info["range_m"]["p90"])
        self.assertEqual({a["name"] for a in info["attributes"]}, {"intensity", "ring", "time"})

    def test_nan_and_zero_slots_are_counted(self):
        nan = float("nan")
        points = [(10 * math.cos(i / 50), 10 * math.sin(i / 50), 0, 1) for i in range(314)]
        write_kitti(self.path("holes.bin"), points + [(0, 0, 0, 0)] * 3 + [(nan, 1, 1, 1)] * 2)
        info = self.run_json("info", "holes.bin", "--sensor", "vlp16")
        self.assertEqual((info["slots"], info["returns"]), (319, 314))
        self.assertEqual((info["zero"], info["not_finite"]), (3, 2))

    def test_a_given_sensor_is_used(self):
        self.simulate("scan.pcd")
        self.assertEqual(self.run_json("info", "scan.pcd", "--sensor", "hdl32e")["rings"], 32)

    def test_a_curl_file(self):
        self.simulate("scan.pcd")
        encoded = self.run_json("encode", "scan.pcd", "--profile", "paper")
        info = self.run_json("info", "scan.curl")
        self.assertEqual(info["kind"], "curl")
        for key in ["points_coded", "coefficients", "patches", "bytes", "sensor", "profile"]:
            self.assertEqual(info[key], encoded[key], key)
        names = [chunk["name"] for chunk in info["chunks"]]
        self.assertIn("sensor", names)
        self.assertIn("patches", names)
        self.assertLess(sum(chunk["bytes"] for chunk in info["chunks"]), info["bytes"])
        text = self.run_ok("info", "scan.curl").decode()
        self.assertIn("parts:", text)

    def test_several_inputs_give_one_array(self):
        self.simulate("scan.pcd")
        self.assertEqual(len(self.run_json("info", "scan.pcd", "scan.pcd")), 2)


class CompareTest(CommandTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.a = [(float(i), 1.0, 0.0, 0) for i in range(10)]
        write_kitti(cls.folder / "a.bin", cls.a)
        # Every point moved up by 0.5, one extra point 3 away from its nearest.
        write_kitti(cls.folder / "b.bin",
                    [(x, y, z + 0.5, i) for x, y, z, i in cls.a] + [(9.0, 4.0, 0.0, 0)])

    def test_distances_by_hand(self):
        report = self.run_json("compare", "a.bin", "b.bin")
        self.assertEqual((report["points_a"], report["points_b"]), (10, 11))
        for key, value in [("mean", 0.5), ("rms", 0.5), ("std", 0), ("p50", 0.5), ("p95", 0.5),
                           ("max", 0.5)]:
            self.assertAlmostEqual(report["a_to_b"][key], value, 12, key)
        self.assertAlmostEqual(report["b_to_a"]["max"], 3, 12)
        self.assertAlmostEqual(report["b_to_a"]["mean"], (10 * 0.5 + 3) / 11, 12)

    def test_metrics_by_hand(self):
        report = self.run_json("compare", "--thresholds", "0.1,0.5", "a.bin", "b.bin", "--peak", 2)
        mean = (10 * 0.5 + 3) / 11
        square = (10 * 0.25 + 9) / 11
        self.assertAlmostEqual(report["symmetric"]["mean"], mean, 12)
        self.assertAlmostEqual(report["symmetric"]["rms"], math.sqrt(square), 12)
        self.assertAlmostEqual(report["chamfer_m"], (0.5 + mean) / 2, 12)
        self.assertAlmostEqual(report["chamfer_m2"], 0.25 + square, 12)
        far, near = report["matches"]
        self.assertEqual((far["precision"], far["recall"], far["f_score"]), (0, 0, 0))
        self.assertAlmostEqual(near["precision"], 10 / 11, 12)
        self.assertEqual((near["threshold"], near["recall"]), (0.5, 1))
        self.assertAlmostEqual(near["f_score"], 20 / 21, 12)
        errors = report["point_to_point"]
        self.assertEqual(report["peak"], 2)
        self.assertAlmostEqual(errors["a_to_b_mse"], 0.25, 12)
        self.assertAlmostEqual(errors["mse"], square, 12)
        self.assertAlmostEqual(errors["rms"], math.sqrt(square), 12)
        self.assertAlmostEqual(errors["psnr_db"], 10 * math.log10(3 * 4 / square), 9)
        self.assertEqual(report["voxels"]["voxel"], 0.1)
        self.assertEqual([report["voxels"][key] for key in
                          ("occupied_a", "occupied_b", "occupied_both", "iou")], [10, 11, 0, 0])
        for key in ("point_to_plane", "images", "quantiles"):
            self.assertIsNone(report[key], key)
        self.assertEqual(report["notes"], [])

    def test_planes_and_quantiles(self):
        # A floor of 20 x 20 points, and the same slid along itself by 1 cm and lifted by 2 mm.
        floor = [(5 + 0.1 * (i % 20), 0.1 * (i // 20), -1.0, 0) for i in range(400)]
        write_kitti(self.path("floor.bin"), floor)
        write_kitti(self.path("moved.bin"), [(x + 0.01, y, z + 0.002, 0) for x, y, z, _ in floor])
        report = self.run_json("compare", "floor.bin", "moved.bin", "--planes", "--quantiles", 3)
        self.assertAlmostEqual(report["point_to_plane"]["rms"], 0.002, 6)
        self.assertEqual(report["point_to_plane"]["normals"], "estimated")
        self.assertAlmostEqual(report["point_to_point"]["rms"], math.hypot(0.01, 0.002), 6)
        self.assertEqual(report["quantiles"]["fractions"], [0, 0.5, 1])
        for side in ("a_to_b", "b_to_a"):
            for value in report["quantiles"][side]:
                self.assertAlmostEqual(value, math.hypot(0.01, 0.002), 6)

    def test_images(self):
        for name, xs in [("a", [1, 0, 4, 5, 90, 0]), ("b", [2, 3, 4, 0, 90, 0])]:
            rows = "".join(f"{x} 0 0\n" for x in xs)
            self.path(f"{name}.pcd").write_text(
                "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 3\n"
                f"HEIGHT 2\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 6\nDATA ascii\n{rows}")
        images = self.run_json("compare", "a.pcd", "b.pcd", "--images")["images"]
        self.assertEqual([images[key] for key in ("pixels", "valid_a", "valid_b", "valid_both",
                                                  "missed", "invented")], [6, 4, 4, 3, 1, 1])
        self.assertAlmostEqual(images["mask_iou"], 0.6, 12)
        self.assertAlmostEqual(images["mae_all"], (1 + 3 + 5) / 6, 12)
        self.assertAlmostEqual(images["mae_both"], 1 / 3, 12)
        self.assertAlmostEqual(images["rmse_both"], math.sqrt(1 / 3), 12)
        # a: 1, 5 are 1 from a point of b; b: 2, 3 are 1 from one of a. The origin has its own.
        self.assertAlmostEqual(images["chamfer_m2_all"], 2 / 6 + 2 / 6, 12)
        images = self.run_json("compare", "a.pcd", "b.pcd", "--images", "--min-range", 1.5,
                               "--max-range", 80)["images"]
        self.assertEqual((images["valid_a"], images["valid_b"]), (2, 3))
        self.assertAlmostEqual(images["mae_all"], (2 + 3 + 5) / 6, 12)
        self.assertIn("mask IoU", self.run_ok("compare", "a.pcd", "b.pcd", "--images").decode())
        self.run_fail(INPUT, "compare", "a.bin", "b.bin", "--images", says="not organised")
        self.run_fail(USAGE, "compare", "a.pcd", "b.pcd", "--images", "--min-range", 5,
                      "--max-range", 4)

    def test_itself(self):
        report = self.run_json("compare", "a.bin", "a.bin")
        self.assertEqual(report["a_to_b"]["max"], 0)
        self.assertEqual(report["b_to_a"]["max"], 0)
        self.assertIsNone(report["point_to_point"]["psnr_db"])
        self.assertEqual(len(report["notes"]), 1)
        self.assertIn("infinite", report["notes"][0])
        self.assertEqual(report["matches"][0]["f_score"], 1)
        self.assertEqual([match["threshold"] for match in report["matches"]], [.02, .05, .1, .2])
        self.assertIn("no error", self.run_ok("compare", "a.bin", "a.bin").decode())

    def test_standard_input_and_the_table(self):
        text = self.run_ok("compare", "-", "b.bin", "--format", "kitti",
                           stdin=self.path("a.bin").read_bytes()).decode()
        self.assertIn("50.0 cm", text)
        self.assertIn("p95", text)

    def test_the_error_cloud(self):
        self.run_ok("compare", "b.bin", "a.bin", "--error-cloud", "error.ply")
        self.assertEqual(ply_header(self.path("error.ply")), {"vertex": 11})
        self.run_ok("convert", "error.ply", "error.csv", "--attributes", "error")
        last = self.path("error.csv").read_text().split()[-1].split(",")
        self.assertAlmostEqual(float(last[-1]), 3, 6)

    def test_a_cloud_without_returns_is_refused(self):
        write_kitti(self.path("none.bin"), [(0, 0, 0, 0)])
        self.run_fail(INPUT, "compare", "a.bin", "none.bin")


class ProjectTest(CommandTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.simulate("scan.pcd")

    def test_the_grid_and_its_counts(self):
        report = self.run_json("project", "scan.pcd")
        self.assertEqual(report["output"], "scan.projected.pcd")
        self.assertEqual(report["points_in"],
                         report["points"] + sum(report["dropped"].values()))
        info = self.run_json("info", "scan.projected.pcd")
        self.assertTrue(info["organised"])
        self.assertEqual((info["height"], info["width"]), (16, 1024))
        self.assertEqual(info["returns"], report["points"])
        self.assertGreaterEqual(info["range_m"]["min"], 5 - 1e-3)

    def test_rows_columns_and_ranges(self):
        report = self.run_json("project", "scan.pcd", "-o", "grid.pcd", "--rows", 40, "--cols",
                               360, "--min-range", 1, "--max-range", 20)
        info = self.run_json("info", "grid.pcd")
        self.assertEqual((info["height"], info["width"]), (40, 360))
        self.assertLessEqual(info["range_m"]["max"], 20 + 1e-3)
        self.assertGreater(report["dropped"]["out_of_range"], 0)
        self.run_ok("project", "scan.pcd", "-o", "rings.pcd", "--rows", "rings")


class SimulateTest(CommandTest):
    def test_the_same_seed_gives_the_same_bytes(self):
        a = self.simulate("a.pcd", "--threads", "1").read_bytes()
        b = self.simulate("b.pcd", "--threads", "3").read_bytes()
        c = self.simulate("c.pcd", "--seed", "2").read_bytes()
        self.assertEqual(a, b)
        self.assertNotEqual(a, c)

    def test_every_scene(self):
        for scene in ["street", "room", "forest", "corridor"]:
            report = self.run_json("simulate", "--scene", scene, "--sensor", "vlp16", "-o",
                                   f"{scene}.pcd")
            self.assertGreater(report["points"], 1000, scene)

    def test_truth_is_organised_and_exact(self):
        report = self.run_json("simulate", "--sensor", "vlp16", "--noise", 0, "--dropout", 0, "-o",
                               "scan.pcd", "--truth-output", "truth.pcd", "--truth-rows", 2,
                               "--truth-cols", 0.5)
        info = self.run_json("info", "truth.pcd")
        self.assertEqual((info["height"], info["width"]), (32, 512))
        self.assertEqual(info["returns"], report["truth_points"])

    def test_standard_output(self):
        data = self.run_ok("simulate", "--sensor", "vlp16", "-q", "-o", "-", "--to-format", "csv")
        self.assertGreater(data.count(b"\n"), 1000)
        self.run_fail(USAGE, "simulate", "-o", "-", "--json", says="standard output")


class RenderTest(CommandTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.simulate("scan.pcd")

    def test_every_view_and_colour(self):
        for view in ["range-image", "birds-eye", "perspective"]:
            for colour in ["range", "height", "intensity"]:
                with self.subTest(view=view, colour=colour):
                    report = self.run_json("render", "scan.pcd", "-o", "p.png", "--view", view,
                                           "--colour", colour)
                    self.assertEqual(png_size(self.path("p.png")),
                                     (report["width"], report["height"]))

    def test_size_error_colours_and_curl_files(self):
        self.run_ok("encode", "scan.pcd")
        report = self.run_json("render", "scan.curl", "-o", "e.png", "--size", "320x200",
                               "--colour", "error", "--reference", "scan.pcd", "--rows", 4)
        self.assertEqual(png_size(self.path("e.png")), (320, 200))
        plain = self.run_json("render", "scan.curl", "-o", "e.png")
        self.assertGreater(report["points"], plain["points"])

    def test_default_name_and_standard_output(self):
        self.run_ok("render", "scan.pcd")
        png_size(self.path("scan.png"))
        data = self.run_ok("render", "scan.pcd", "-o", "-", "-q")
        self.assertEqual(data, self.path("scan.png").read_bytes())


class SensorsTest(CommandTest):
    def test_the_list_and_a_profile_to_edit(self):
        sensors = {s["name"]: s for s in self.run_json("sensors")}
        for name, rings in [("hdl64e-kitti", 64), ("vlp16", 16), ("os1-64", 64), ("xt32", 32),
                            ("superrso16", 16), ("hdl32e", 32)]:
            found = [s for s in sensors if s.endswith(name)]
            self.assertTrue(found, name)
            self.assertEqual(sensors[found[0]]["rings"], rings)
        toml = self.run_ok("sensors", "vlp16")
        self.path("mine.toml").write_bytes(toml)
        self.assertEqual(self.run_ok("sensors", "mine.toml"), toml)
        a = json.loads(self.run_ok("sensors", "vlp16", "--json"))
        b = json.loads(self.run_ok("sensors", "mine.toml", "--json"))
        self.assertEqual(a, b)


if __name__ == "__main__":
    unittest.main()
