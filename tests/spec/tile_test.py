#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The second decoder reads the golden tiles of surface maps to the same leaves."""
import unittest
from pathlib import Path

from tile import Tile, twin

GOLDEN = Path(__file__).resolve().parents[1] / "golden" / "surface"


class TileTest(unittest.TestCase):
    def test_tiles_decode_to_their_twins(self):
        tiles = sorted(GOLDEN.glob("*.tile"))
        self.assertGreaterEqual(len(tiles), 5)
        for path in tiles:
            with self.subTest(path.name):
                self.assertTrue(twin(Tile(path.read_bytes())) == path.with_suffix(".txt").read_text())


if __name__ == "__main__":
    unittest.main()
