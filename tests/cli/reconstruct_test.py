# SPDX-License-Identifier: BSD-3-Clause
"""decode at other densities, in given directions, as another sensor, as a mesh."""

import json
import math
import struct
import unittest

from support import FILE, INPUT, OK, USAGE, CommandTest, ply_header, read_kitti


def write_npy(path, rows, kind="<f4"):
    """An N x k array of numbers."""
    width = len(rows[0]) if rows else 3
    head = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': ({len(rows)}, {width}), }}"
    head = head.ljust(117) + "\n"
    code = {"<f4": "f", "<f8": "d"}[kind]
    path.write_bytes(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head.encode() +
                     b"".join(struct.pack(f"<{width}{code}", *row) for row in rows))


def read_csv(path):
    """Rows of numbers below the header, by its names."""
    lines = path.read_text().splitlines()
    names = lines[0].replace("#", "").replace(",", " ").split()
    return [dict(zip(names, map(float, line.replace(",", " ").split()))) for line in lines[1:]]


class ReconstructCommandTest(CommandTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.simulate("scan.pcd")
        cls.report = json.loads(cls.execute("encode", "scan.pcd", "--effort", 1,
                                            "--json").stdout)

    def decode(self, *arguments):
        return self.run_json("decode", "scan.curl", *arguments)


class DirectionsTest(ReconstructCommandTest):
    def test_one_point_for_each_in_order_with_nan(self):
        up = (0.0, 0.0, 1.0)
        rays = [(math.cos(0.1 * i), math.sin(0.1 * i), -0.15) for i in range(60)] + [up]
        for kind in ["<f4", "<f8"]:
            write_npy(self.path("rays.npy"), rays, kind)
            report = self.decode("--directions", "rays.npy", "--confidence", "-o", "hits.csv")
            hits = read_csv(self.path("hits.csv"))
            self.assertEqual(len(hits), 61)
            self.assertEqual(report["points"], sum(not math.isnan(h["x"]) for h in hits))
            self.assertGreater(report["points"], 30)
            self.assertTrue(math.isnan(hits[60]["x"]))
            for ray, hit in zip(rays, hits):
                if math.isnan(hit["x"]):
                    continue
                far = math.dist((0, 0, 0), (hit["x"], hit["y"], hit["z"]))
                for axis, name in enumerate("xyz"):
                    self.assertAlmostEqual(hit[name], far * ray[axis] / math.hypot(*ray), 3)
                self.assertTrue(0 < hit["confidence"] <= 1)

    def test_wrong_ones_are_named(self):
        write_npy(self.path("two.npy"), [(1.0, 2.0)])
        self.run_fail(INPUT, "decode", "scan.curl", "--directions", "two.npy", "-o", "no.npy",
                      says=["two.npy", "(1, 2)"])
        for bad in [(0.0, 0.0, 0.0), (math.nan, 1.0, 0.0)]:
            write_npy(self.path("bad.npy"), [(1.0, 0.0, 0.0), bad])
            self.run_fail(INPUT, "decode", "scan.curl", "--directions", "bad.npy", "-o", "no.npy",
                          says=["bad.npy", "direction 1"])
        self.run_fail(FILE, "decode", "scan.curl", "--directions", "none.npy", "-o", "no.npy",
                      says="none.npy")
        self.assertFalse(self.path("no.npy").exists())

    def test_kitti_files_have_no_word_for_nothing(self):
        write_npy(self.path("rays.npy"), [(1.0, 0.0, -0.1), (0.0, 0.0, 1.0)])
        done = self.execute("decode", "scan.curl", "--directions", "rays.npy", "-o", "hits.bin",
                            "--attributes", "intensity")
        self.assertEqual(done.returncode, OK, done.stderr)
        self.assertIn(b"1 records are NaN", done.stderr)
        self.assertEqual(len(read_kitti(self.path("hits.bin"))), 2)


class SensorTest(ReconstructCommandTest):
    def test_as_another_sensor(self):
        report = self.decode("--sensor", "hdl32e", "-o", "other.pcd")
        self.assertGreater(report["points"], 5000)
        info = self.run_json("info", "other.pcd", "--sensor", "hdl32e")
        self.assertEqual(info["returns"], report["points"])
        self.decode("--sensor", "hdl32e", "--organised", "-o", "grid.pcd")
        info = self.run_json("info", "grid.pcd")
        self.assertEqual((info["height"], info["returns"]), (32, report["points"]))
        self.assertIn("ring", [a["name"] for a in info["attributes"]])

    def test_unknown_ones_are_wrong_usage(self):
        self.run_fail(USAGE, "decode", "scan.curl", "--sensor", "hdl99", says="hdl99")


class DensityTest(ReconstructCommandTest):
    def test_more_and_less(self):
        points = [self.decode("--density", d, "-o", "even.pcd")["points"] for d in (0.1, 1, 10)]
        self.assertAlmostEqual(points[1] / points[0], 10, delta=2)
        self.assertAlmostEqual(points[2] / points[1], 10, delta=1)

    def test_limits(self):
        self.run_fail(INPUT, "decode", "scan.curl", "--density", 1000, "--max-points", 1000, "-o",
                      "no.pcd", says=["1000", "part of the scan"])
        self.run_fail(USAGE, "decode", "scan.curl", "--density", 0, says="--density")
        self.assertFalse(self.path("no.pcd").exists())

    def test_originals_are_kept(self):
        report = self.decode("--rows", 2, "--keep-originals", "--original", "--confidence",
                             "--attributes", "ring", "-o", "both.csv")
        self.run_ok("decode", "scan.curl", "-o", "plain.csv", "--attributes", "none")
        both, plain = read_csv(self.path("both.csv")), read_csv(self.path("plain.csv"))
        coded = self.report["points_coded"]
        self.assertEqual([[p[k] for k in "xyz"] for p in both[:coded]],
                         [[p[k] for k in "xyz"] for p in plain])
        self.assertTrue(all(p["original"] == (i < coded) for i, p in enumerate(both)))
        self.assertTrue(all(p["confidence"] == 1 for p in both[:coded]))
        self.assertGreater(report["points"], 1.5 * coded)
        self.assertEqual(set(both[0]), {"x", "y", "z", "ring", "confidence", "original"})


class GridTest(ReconstructCommandTest):
    def test_factors_beyond_the_limits_are_wrong_usage(self):
        for option in ("--rows", "--cols"):
            for factor in (4097, 0.0009):
                self.run_fail(USAGE, "decode", "scan.curl", option, factor, "-o", "no.pcd",
                              says=[option, "4096"])
        self.assertEqual(self.decode("--rows", 0.001, "--cols", 0.001, "-o", "p.pcd")["rows"], 0.001)

    def test_nothing_is_invented_at_1_x_1(self):
        self.run_ok("decode", "scan.curl", "-o", "plain.pcd")
        plain = self.path("plain.pcd").read_bytes()
        for options in (["--keep-originals"], ["--min-confidence", 0.9], ["--rows", 1],
                        ["--keep-originals", "--strategy", "masks"]):
            self.run_ok("decode", "scan.curl", *options, "-o", "same.pcd")
            self.assertEqual(self.path("same.pcd").read_bytes(), plain, options)


class MeshTest(ReconstructCommandTest):
    def test_ply_and_obj(self):
        report = self.decode("--mesh", "--normals", "-o", "surface.ply")
        self.assertEqual(ply_header(self.path("surface.ply")),
                         {"vertex": report["points"], "face": report["triangles"]})
        self.assertIn(b"property float nx", self.path("surface.ply").read_bytes()[:400])
        self.decode("--mesh", "--normals", "-o", "surface.obj")
        lines = self.path("surface.obj").read_text().splitlines()
        for start, count in [("v ", "points"), ("vn ", "points"), ("f ", "triangles")]:
            self.assertEqual(sum(line.startswith(start) for line in lines), report[count])
        self.assertGreater(report["triangles"], report["points"])
        denser = self.decode("--mesh", "--rows", 2.5, "--azimuth", "-45:45", "-o", "part.ply")
        self.assertGreater(denser["triangles"], report["triangles"] / 4)
        self.run_ok("decode", "scan.curl", "--mesh")
        self.assertTrue(self.path("scan.decoded.ply").exists())

    def test_obj_by_format_and_in_capitals(self):
        self.decode("--mesh", "-o", "surface.obj")
        wanted = self.path("surface.obj").read_bytes()
        self.decode("--mesh", "-o", "LOUD.OBJ")
        self.assertEqual(self.path("LOUD.OBJ").read_bytes(), wanted)
        done = self.execute("decode", "scan.curl", "--mesh", "--format", "obj", "-o", "-")
        self.assertEqual((done.returncode, done.stdout), (OK, wanted))
        self.path("twin.curl").write_bytes(self.path("scan.curl").read_bytes())
        self.run_ok("decode", "scan.curl", "twin.curl", "--mesh", "--format", "obj", "-o", "many/")
        self.assertEqual(self.files("many"), ["scan.decoded.obj", "twin.decoded.obj"])
        self.assertEqual(self.path("many/twin.decoded.obj").read_bytes(), wanted)

    def test_what_it_is_not_for(self):
        self.run_fail(USAGE, "decode", "scan.curl", "--mesh", "-o", "mesh.pcd", says=".obj")
        self.run_fail(USAGE, "decode", "scan.curl", "--mesh", "--format", "pcd", says=".obj")
        self.run_fail(USAGE, "decode", "scan.curl", "--mesh", "--attributes", "ring",
                      says="--attributes")
        self.run_fail(USAGE, "decode", "scan.curl", "--mesh", "--density", 10, says="--density")
        self.run_fail(USAGE, "decode", "scan.curl", "--mesh", "--organised", says="--organised")


class BeliefTest(ReconstructCommandTest):
    def test_less_confidence_gives_more_points(self):
        points = [self.decode("--rows", 4, "--min-confidence", p, "-o", "c.pcd")["points"]
                  for p in (0, 0.2, 0.5)]
        self.assertGreater(points[0], points[1])
        self.assertGreater(points[1], points[2])
        self.run_fail(USAGE, "decode", "scan.curl", "--min-confidence", 1.5, says="1.5")

    def test_best_finds_more_of_the_truth_than_masks_and_invents_no_more(self):
        self.simulate("street.pcd", "--truth-output", "truth.pcd", "--truth-rows", 4,
                      "--grid-rows", "rings")
        self.run_ok("encode", "street.pcd", "--effort", 1)
        found = {}
        for strategy in ("best", "masks"):
            self.run_ok("decode", "street.curl", "--rows", 4, "--strategy", strategy, "-o",
                        f"{strategy}.pcd")
            compared = self.run_json("compare", "truth.pcd", f"{strategy}.pcd", "--thresholds", 0.2)
            found[strategy] = compared["matches"][0]
        self.assertGreater(found["best"]["recall"], found["masks"]["recall"] + 0.02)
        self.assertGreater(found["best"]["precision"], found["masks"]["precision"] - 0.01)
        self.run_ok("decode", "street.curl", "--rows", 4, "-o", "default.pcd")
        self.assertEqual(self.path("default.pcd").read_bytes(), self.path("best.pcd").read_bytes())
        self.run_fail(USAGE, "decode", "scan.curl", "--strategy", "hope", says="hope")

    def test_masks_tell_no_confidence(self):
        self.run_ok("encode", "scan.pcd", "--profile", "paper", "-o", "paper.curl")
        wanted = [["--min-confidence", 0.5], ["--confidence"], ["--density-profile", "generic"]]
        for options in wanted:
            for way in (["--rows", 2], ["--density", 5], ["--mesh"], ["--sensor", "vlp16"]):
                if "--mesh" in way and "--confidence" in options:
                    continue
                self.run_fail(USAGE, "decode", "paper.curl", *way, *options, "-o", "no.ply",
                              says=["paper.curl", "--strategy best"])
                self.run_fail(USAGE, "decode", "scan.curl", "--strategy", "masks", *way, *options,
                              "-o", "no.ply", says=["scan.curl", "--strategy best"])
        self.assertFalse(self.path("no.ply").exists())
        best = self.run_json("decode", "paper.curl", "--rows", 2, "--strategy", "best",
                             "--min-confidence", 0.2, "-o", "best.pcd")
        self.assertGreater(best["points"], 1000)

    def test_returns_of_paper_files_are_sure_originals(self):
        self.run_ok("encode", "scan.pcd", "--profile", "paper", "-o", "paper.curl")
        report = self.run_json("decode", "paper.curl", "-o", "plain.csv", "--attributes", "none")
        self.run_ok("decode", "paper.curl", "--min-confidence", 0.6, "--confidence", "--original",
                    "-o", "sure.csv", "--attributes", "none")
        plain, sure = read_csv(self.path("plain.csv")), read_csv(self.path("sure.csv"))
        self.assertEqual([[p[k] for k in "xyz"] for p in sure],
                         [[p[k] for k in "xyz"] for p in plain])
        self.assertGreater(len(sure), 0.9 * report["points_coded"])
        self.assertTrue(all(p["confidence"] == p["original"] == 1 for p in sure))

    def test_the_sparse_preset(self):
        report = self.decode("--preset", "sparse", "-o", "dense.pcd")
        self.assertEqual(report["rows"], 4)  # 16 rings
        self.assertEqual(report["min_confidence"], 0.2)
        self.assertGreater(report["points"], 1.5 * self.report["points_coded"])
        self.run_ok("decode", "scan.curl", "-o", "plain.csv", "--attributes", "none")
        self.run_ok("decode", "scan.curl", "--preset", "sparse", "-o", "dense.csv", "--attributes",
                    "none")
        plain, dense = [self.path(name).read_text().splitlines()
                        for name in ("plain.csv", "dense.csv")]
        self.assertEqual(dense[:len(plain)], plain)  # the returns come first
        self.decode("--preset", "sparse", "--organised", "-o", "grid.pcd")
        own = self.decode("--preset", "sparse", "--rows", 2, "--min-confidence", 0, "-o", "d.pcd")
        self.assertEqual((own["rows"], own["min_confidence"]), (2, 0))
        self.run_fail(USAGE, "decode", "scan.curl", "--preset", "dense", says="dense")

    def test_the_sparse_preset_gives_the_returns_of_64_rings(self):
        self.run_ok("simulate", "--sensor", "hdl64e-kitti", "-o", "many.pcd")
        self.run_ok("encode", "many.pcd", "--effort", 1)
        self.run_ok("decode", "many.curl", "-o", "plain.pcd")
        self.run_ok("decode", "many.curl", "--preset", "sparse", "-o", "preset.pcd")
        self.assertEqual(self.path("preset.pcd").read_bytes(), self.path("plain.pcd").read_bytes())

    def test_the_sparse_preset_of_paper_files(self):
        self.run_ok("encode", "scan.pcd", "--profile", "paper", "-o", "paper.curl")
        sparse = ["decode", "paper.curl", "--preset", "sparse", "-o", "dense.pcd"]
        report = self.run_json(*sparse)
        self.assertEqual((report["rows"], report["min_confidence"]), (4, 0.2))
        self.assertGreater(report["points"], 1.5 * report["points_coded"])
        self.assertEqual(self.run_json(*sparse, "--strategy", "masks")["min_confidence"], 0)

    def test_normals(self):
        self.decode("--rows", 2, "--normals", "-o", "n.csv")
        known = 0
        for p in read_csv(self.path("n.csv")):
            normal = [p["normal_x"], p["normal_y"], p["normal_z"]]
            if math.isnan(normal[0]):
                continue
            known += 1
            self.assertAlmostEqual(math.hypot(*normal), 1, 4)
            self.assertLess(sum(n * p[k] for n, k in zip(normal, "xyz")), 0)
        self.assertGreater(known, self.report["points_coded"])


class PartsTest(ReconstructCommandTest):
    WAYS = [["--rows", 2.5], ["--cols", 0.3], ["--density", 5], ["--sensor", "vlp16"], ["--mesh"],
            ["--rows", 2, "--keep-originals"]]

    def test_a_part_of_the_scan_in_every_way(self):
        for way in self.WAYS:
            with self.subTest(way=way):
                output = "part.ply" if way == ["--mesh"] else "part.csv"
                report = self.decode(*way, "--azimuth", "20:50", "-o", output)
                self.assertGreater(report["points"], 10)
                if output == "part.ply":
                    continue
                for p in read_csv(self.path(output)):
                    azimuth = math.degrees(math.atan2(p["y"], p["x"]))
                    self.assertTrue(19.999 <= azimuth <= 50.001, azimuth)

    def test_an_empty_part_gives_an_empty_cloud_and_says_so(self):
        # The ring that looks up steepest, where the street has no houses.
        def coded(azimuth):
            return self.execute("decode", "scan.curl", "--rings", "0:1", "--azimuth", azimuth,
                                "-o", "none.pcd", "--json")
        part = next(f"{a}:{a + 1}" for a in range(-180, 180)
                    if json.loads(coded(f"{a}:{a + 1}").stdout)["points_coded"] == 0)
        for way in [[], *self.WAYS]:
            with self.subTest(way=way):
                output = "none.ply" if way == ["--mesh"] else "none.csv"
                done = self.execute("decode", "scan.curl", *way, "--rings", "0:1", "--azimuth",
                                    part, "-o", output, "--json")
                self.assertEqual(done.returncode, OK, done.stderr)
                self.assertEqual(json.loads(done.stdout)["points"], 0)
                self.assertIn(b"warning: scan.curl holds no return in this region", done.stderr)
                self.assertTrue(self.path(output).exists())
        self.run_fail(INPUT, "decode", "scan.curl", "--rings", "16:20", "-o", "x.pcd", says="16")

    def test_ways_exclude_each_other(self):
        for options in [["--density", 1, "--rows", 2], ["--sensor", "vlp16", "--cols", 2],
                        ["--density", 1, "--organised"],
                        ["--sensor", "vlp16", "--keep-originals"],
                        ["--rows", 2, "--organised", "--keep-originals"]]:
            self.run_fail(USAGE, "decode", "scan.curl", *options, "-o", "x.pcd", says=options[-1]
                          if isinstance(options[-1], str) and options[-1].startswith("--")
                          else "give one of them")

    def test_same_bytes_for_any_number_of_threads(self):
        for way in self.WAYS:
            output = "ply" if way == ["--mesh"] else "pcd"
            extra = [] if way == ["--mesh"] else ["--normals", "--confidence"]
            for threads in (1, 3):
                self.decode(*way, *extra, "--threads", threads, "-o", f"t{threads}.{output}")
            self.assertEqual(self.path(f"t1.{output}").read_bytes(),
                             self.path(f"t3.{output}").read_bytes(), way)


if __name__ == "__main__":
    unittest.main(verbosity=2)
