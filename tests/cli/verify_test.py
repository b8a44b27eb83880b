# SPDX-License-Identifier: BSD-3-Clause
"""verify: what a file promises, kept and broken."""

import json
import pathlib
import struct
import sys
import unittest

from support import FILE, INPUT, OK, USAGE, CommandTest, read_kitti, write_kitti

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "spec"))
from container import chunk_bytes  # noqa: E402

PROMISE = 0x81
BOUND, BITS, ANY_ORDER = 1, 2, 4  # flags of its first byte


class VerifyTest(CommandTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.simulate("scan.pcd", "--range-unit", 0.002)
        cls.encode("bound.curl", "--max-error", 0.01)
        cls.encode("bits.curl", "--lossless")

    @classmethod
    def encode(cls, name, *arguments, scan="scan.pcd"):
        result = cls.execute("encode", scan, "-o", name, "--effort", 1, "-q", *arguments)
        assert result.returncode == OK, result.stderr.decode()

    def verify(self, file, scan="scan.pcd"):
        report = self.run_json("verify", file, scan)
        self.assertTrue(report["ok"])
        self.assertEqual(report["failures"], [])
        return report

    def broken(self, file, scan="scan.pcd"):
        """The report of a file that does not keep its promise."""
        result = self.execute("verify", file, scan, "--json")
        self.assertEqual(result.returncode, INPUT, result.stderr)
        report = json.loads(result.stdout)
        self.assertFalse(report["ok"])
        self.assertGreater(len(report["failures"]), 0)
        return report

    def promise(self, file):
        """Payload of the chunk, read from the file's own list of chunks."""
        info = self.run_json("info", file)
        chunk, = [c for c in info["chunks"] if c["name"] == "promise"]
        return self.path(file).read_bytes()[chunk["offset"]:chunk["offset"] + chunk["bytes"]]

    def with_promise(self, file, payload, name):
        """The file with another promise, its checksum right."""
        old = chunk_bytes(PROMISE, self.promise(file))
        data = self.path(file).read_bytes()
        self.assertEqual(data.count(old), 1)
        self.path(name).write_bytes(data.replace(old, chunk_bytes(PROMISE, payload)))

    def test_a_bound_is_kept(self):
        report = self.verify("bound.curl")
        self.assertEqual(report["bound_m"], 0.01)
        self.assertLessEqual(report["max_error_m"], 0.01)
        self.assertGreater(report["max_error_m"], report["mean_error_m"])
        self.assertGreater(report["mean_error_m"], 0)
        self.assertEqual(report["points"], self.run_json("info", "scan.pcd")["returns"])
        for key in ["order", "order_promised", "shape", "attributes"]:
            self.assertTrue(report[key], key)
        self.assertEqual(report["attributes_left_out"], [])
        self.assertFalse(report["bit_exact_promised"])
        text = self.run_ok("verify", "bound.curl", "scan.pcd").decode()
        for word in ["within 10.0 mm", "attributes kept", "\nok\n"]:
            self.assertIn(word, text)

    def test_bit_for_bit(self):
        report = self.verify("bits.curl")
        self.assertTrue(report["bit_exact"])
        self.assertTrue(report["bit_exact_promised"])
        self.assertEqual(report["max_error_m"], 0)
        self.assertIsNone(report["bound_m"])

    def test_a_mean_error_promises_no_single_point(self):
        self.encode("mean.curl", "--error", 0.03)
        report = self.verify("mean.curl")
        self.assertIsNone(report["bound_m"])
        self.assertFalse(report["bit_exact_promised"])
        self.assertLessEqual(report["mean_error_m"], 0.03)
        self.assertIn("none for single points",
                      self.run_ok("verify", "mean.curl", "scan.pcd").decode())

    def test_empty_slots_and_shape(self):
        self.run_ok("project", "scan.pcd", "--cols", 512, "--rows", "rings", "-o", "grid.pcd")
        for target in [["--max-error", 0.005], ["--lossless"]]:
            self.encode("grid.curl", *target, scan="grid.pcd")
            report = self.verify("grid.curl", "grid.pcd")
            self.assertTrue(report["shape"])
            self.run_ok("decode", "grid.curl", "-o", "back.pcd")
            back, grid = (self.run_json("info", name) for name in ["back.pcd", "grid.pcd"])
            self.assertGreater(grid["not_finite"], 0)
            for key in ["width", "height", "returns", "not_finite", "zero", "organised"]:
                self.assertEqual(back[key], grid[key], key)

    def test_zeros_duplicates_and_any_points(self):
        nan = float("nan")
        write_kitti(self.path("odd.bin"),
                    [(1, 2, 3, .5), (0, 0, 0, 0), (1, 2, 3, .5), (nan, 1, 2, 3), (4e5, 5e6, 1, 1),
                     (4e5, 5e6, 2, 7), (-1, 0, 0, -0.0)])
        for target in [["--max-error", 0.01], ["--lossless"]]:
            self.encode("odd.curl", *target, scan="odd.bin")
            self.assertEqual(self.verify("odd.curl", "odd.bin")["points"], 5)
        self.run_ok("decode", "odd.curl", "-o", "back.bin")
        back, odd = read_kitti(self.path("back.bin")), read_kitti(self.path("odd.bin"))
        self.assertEqual(back[:3] + back[4:], odd[:3] + odd[4:])

    def test_an_order_that_was_given_up_is_not_claimed(self):
        write_kitti(self.path("empty.bin"), [(0, 0, 0, 0), (3, 4, 5, 1), (1, 2, 3, 4)])
        for scan, targets in [("scan.pcd", [["--max-error", 0.01], ["--lossless"], ["--step", 0.2]]),
                              ("empty.bin", [["--lossless"]])]:
            for target in targets:
                with self.subTest(scan=scan, target=target):
                    self.encode("set.curl", "--any-order", *target, scan=scan)
                    report = self.verify("set.curl", scan)
                    self.assertFalse(report["order"])
                    self.assertFalse(report["order_promised"])
                    self.assertTrue(report["attributes"])
                    self.assertEqual(report["bit_exact"], target == ["--lossless"])
                    self.assertIn("given up when encoding",
                                  self.run_ok("verify", "set.curl", scan).decode())

    def test_sets_that_differ(self):
        points = [(3 + i % 7, i * 0.5, 1.0, i) for i in range(200)]
        write_kitti(self.path("a.bin"), points)
        self.encode("a.curl", "--any-order", "--max-error", 0.01, scan="a.bin")
        write_kitti(self.path("mixed.bin"), points[::-1])
        self.verify("a.curl", "mixed.bin")
        for change, broken_key in [(points[1:], None), (points[:-1] + points[:1], None),
                                   (points[:-1] + [(3, 50, 1.0, 199)], None),
                                   (points[:-1] + [points[-1][:3] + (7,)], "attributes")]:
            write_kitti(self.path("other.bin"), change)
            report = self.broken("a.curl", "other.bin")
            if broken_key:
                self.assertFalse(report[broken_key])
        # The promise of bits is one of sets, too.
        self.encode("b.curl", "--any-order", "--lossless", scan="a.bin")
        write_kitti(self.path("moved.bin"), [(points[0][0] + 1e-6,) + points[0][1:]] + points[1:])
        self.assertFalse(self.broken("b.curl", "moved.bin")["bit_exact"])

    def test_a_bound_that_is_broken(self):
        kind, bound = struct.unpack("<Bd", self.promise("bound.curl"))
        self.assertEqual((kind, bound), (BOUND, 0.01))
        largest = self.verify("bound.curl")["max_error_m"]
        self.with_promise("bound.curl", struct.pack("<Bd", BOUND, largest), "just.curl")
        self.verify("just.curl")
        self.with_promise("bound.curl", struct.pack("<Bd", BOUND, largest * 0.999), "less.curl")
        report = self.broken("less.curl")
        self.assertEqual(report["max_error_m"], largest)
        self.assertIn("bound", report["failures"][0])
        self.assertIn(b"FAILED: ", self.execute("verify", "less.curl", "scan.pcd").stdout)
        # Nothing but the promise was wrong: the file decodes as before.
        for name in ["bound", "less"]:
            self.run_ok("decode", f"{name}.curl", "-o", f"{name}.pcd")
        self.assertEqual(self.path("bound.pcd").read_bytes(), self.path("less.pcd").read_bytes())

    def test_bits_that_are_broken(self):
        self.with_promise("bound.curl", bytes([BITS]), "liar.curl")
        report = self.broken("liar.curl")
        self.assertTrue(report["bit_exact_promised"])
        self.assertFalse(report["bit_exact"])

    def test_promises_that_make_no_sense_are_refused(self):
        for payload in [b"", bytes([0]), bytes([BOUND]), bytes([BITS, 0]), bytes([BOUND | BITS]),
                        bytes([8]), struct.pack("<Bd", BOUND | BITS, 0.1),
                        struct.pack("<Bd", BOUND, 0), struct.pack("<Bd", BOUND, -1),
                        struct.pack("<Bd", BOUND, float("nan")),
                        struct.pack("<Bd", BOUND, float("inf"))]:
            with self.subTest(payload=payload):
                self.with_promise("bound.curl", payload, "odd.curl")
                self.run_fail(INPUT, "verify", "odd.curl", "scan.pcd", says="odd.curl")

    def test_another_scan(self):
        self.simulate("other.pcd", "--seed", 2)
        report = self.broken("bound.curl", "other.pcd")
        self.assertFalse(report["order"])
        self.run_ok("convert", "scan.pcd", "scan.csv")
        lines = self.path("scan.csv").read_text().splitlines()
        lines[1], lines[500] = lines[500], lines[1]
        self.path("swapped.csv").write_text("\n".join(lines) + "\n")
        report = self.broken("bound.curl", "swapped.csv")
        self.assertGreater(report["max_error_m"], 0.01)

    def test_another_shape(self):
        write_kitti(self.path("row.bin"), [(i + 1, 1, 1, 0) for i in range(12)])
        self.run_ok("convert", "row.bin", "row.pcd")
        self.encode("row.curl", "--lossless", scan="row.pcd")
        text = self.path("row.pcd").read_bytes()
        self.path("block.pcd").write_bytes(
            text.replace(b"WIDTH 12\nHEIGHT 1\n", b"WIDTH 4\nHEIGHT 3\n"))
        self.assertNotEqual(self.path("block.pcd").read_bytes(), text)
        report = self.broken("row.curl", "block.pcd")
        self.assertTrue(report["order"])
        self.assertFalse(report["shape"])

    def test_attributes(self):
        self.encode("one.curl", "--attributes", "intensity", "--max-error", 0.05)
        report = self.verify("one.curl")
        self.assertEqual(set(report["attributes_left_out"]), {"ring", "time"})
        self.run_ok("convert", "scan.pcd", "less.pcd", "--attributes", "ring,time")
        report = self.broken("bound.curl", "less.pcd")
        self.assertFalse(report["attributes"])
        self.assertTrue(report["order"])
        self.assertIn("intensity", report["failures"][0])
        points = [(1 + i, 2, 3, 0.5) for i in range(100)]
        write_kitti(self.path("a.bin"), points)
        self.encode("a.curl", "--lossless", scan="a.bin")
        write_kitti(self.path("b.bin"), points[:-1] + [points[-1][:3] + (0.25,)])
        self.assertFalse(self.broken("a.curl", "b.bin")["attributes"])

    def test_files_without_every_return(self):
        self.encode("image.curl", "--cols", 512)
        self.encode_paper()
        for name in ["image.curl", "paper.curl"]:
            self.run_fail(INPUT, "verify", name, "scan.pcd", says=[name, "every return", "--cols"])

    def encode_paper(self):
        result = self.execute("encode", "scan.pcd", "--profile", "paper", "-o", "paper.curl", "-q")
        self.assertEqual(result.returncode, OK)

    def test_wrong_usage_and_bad_files(self):
        self.run_fail(USAGE, "verify", "bound.curl", says="SCAN")
        self.run_fail(USAGE, "verify", "-", "-", says="-")
        self.run_fail(FILE, "verify", "nowhere.curl", "scan.pcd", says="nowhere.curl")
        self.run_fail(FILE, "verify", "bound.curl", "nowhere.pcd", says="nowhere.pcd")
        self.run_fail(INPUT, "verify", "scan.pcd", "scan.pcd", says="scan.pcd")
        data = self.path("bound.curl").read_bytes()
        self.path("cut.curl").write_bytes(data[:len(data) // 2])
        self.run_fail(INPUT, "verify", "cut.curl", "scan.pcd", says="cut.curl")
        self.assertTrue(json.loads(self.run_ok("verify", "-", "scan.pcd", "--json",
                                               stdin=data))["ok"])


if __name__ == "__main__":
    unittest.main()
