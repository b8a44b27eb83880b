#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""spec_test.py FOLDER: the decoder of this folder, written from docs/format alone, gives what the
JSON twins of a folder of golden files say."""
import json
import sys
import unittest
from pathlib import Path

from container import read_chunks
from header import read_index
from scan import INDEX, LAYERS, Scan

FOLDER = Path(__file__).resolve().parents[1] / "golden" / "compact"
HEADER = ("rows", "columns", "turn_columns", "first_column", "step", "residual_step", "lattice",
          "root_log2", "smallest_leaf", "bands", "sectors")


class SpecTest(unittest.TestCase):
    def check(self, name):
        data = (FOLDER / f"{name}.curl").read_bytes()
        twin = json.loads((FOLDER / f"{name}.json").read_text("ascii"))
        scan = Scan(data, cut=not twin["complete"])
        for field in HEADER:
            self.assertEqual(getattr(scan.parameters, field), twin[field], field)
        for field in ("elevation", "height", "range_offset"):
            self.assertEqual(getattr(scan.table, field), twin[field], field)
        self.check_rays(scan.rays, twin.get("rays"))
        for field in ("field", "surface", "range"):
            wanted = twin[field] if twin[field] is not None else twin["range"]
            self.assertTrue(getattr(scan, field) == wanted, f"{field} differs")
        points = [list(point) for point in scan.points()]
        self.assertEqual(len(points), twin["returns"])
        self.assertTrue(points[::twin["points_every"]] == twin["points"])
        self.check_index(read_chunks(data, cut=True))

    def check_rays(self, rays, twin):
        self.assertEqual(rays is None, twin is None)
        for field, wanted in (twin or {}).items():
            self.assertEqual(getattr(rays, field), wanted, field)

    def check_index(self, chunks):
        sizes = [len(chunk.payload) for kind in LAYERS for chunk in chunks
                 if chunk.kind == kind and chunk.whole]
        for chunk in chunks:
            if chunk.kind == INDEX and all(other.whole for other in chunks):
                self.assertEqual(read_index(chunk.payload, len(sizes)), sizes)


def add_tests():
    for file in sorted(FOLDER.glob("*.curl")):
        def test(self, name=file.stem):
            self.check(name)
        setattr(SpecTest, "test_" + file.stem.replace("-", "_"), test)


if __name__ == "__main__":
    if len(sys.argv) > 1 and Path(sys.argv[1]).is_dir():
        FOLDER = Path(sys.argv.pop(1))
    add_tests()
    unittest.main()
