#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The golden surface map as the decoder of this folder reads it, whole and damaged."""
import unittest
from pathlib import Path

from container import Corrupt, Unsupported
from surface_map import SurfaceMap
from tile import twin

GOLDEN = Path(__file__).resolve().parents[1] / "golden"
DATA = (GOLDEN / "surface_maps" / "four-tiles.curl").read_bytes()
TILES = [("box-deep", (-1, 2)), ("plane", (0, 0)), ("nothing", (0, 1)),
         ("sphere-curves", (70000, -3))]


class SurfaceMapTest(unittest.TestCase):
    def test_the_header_says_what_was_put_in(self):
        surface_map = SurfaceMap(DATA)
        self.assertEqual(surface_map.origin, [458000, 5432100, 112])
        self.assertEqual((surface_map.min_range, surface_map.max_range), (2.5, 80))
        self.assertEqual((surface_map.scans, surface_map.way), (300, 1234.5))
        self.assertEqual((surface_map.side, surface_map.thinning), (16, 0.05))
        self.assertEqual(surface_map.settings["intensity_step"], 0.25)
        self.assertTrue(surface_map.curves and surface_map.intensity)
        self.assertEqual(surface_map.metadata, {"place": "Straße", "sensor": ""})

    def test_every_tile_is_its_twin_in_its_place_and_box(self):
        surface_map = SurfaceMap(DATA)
        self.assertEqual([summary["key"] for _, _, summary in surface_map.entries],
                         [key for _, key in TILES])
        for number, (name, key) in enumerate(TILES):
            with self.subTest(name):
                tile, corner = surface_map.tile(number)
                self.assertTrue(twin(tile) == (GOLDEN / "surface" / f"{name}.txt").read_text())
                self.assertEqual(corner, (458000 + 16 * key[0], 5432100 + 16 * key[1], 112))
                summary = surface_map.entries[number][2]
                self.assertEqual(summary["leaves"], len(tile.leaves))
                self.assertEqual(summary["box"] is None, name == "nothing")
                for leaf in tile.leaves:
                    self.assert_inside(tile, leaf, corner, summary["box"])

    def assert_inside(self, tile, leaf, corner, box):
        """The middles of the footprint's cells on the surface, as far as it stays in the cube."""
        plane, half = tile.planes[leaf.plane], tile.edge(leaf.level) // 2
        cells, a = tile.cells(leaf.level), plane.axis
        u, v, d = (a + 1) % 3, (a + 2) % 3, 2 * half // cells
        for place, seen in enumerate(leaf.cells):
            point = list(leaf.centre)
            point[u] += place // cells * d + d // 2 - half
            point[v] += place % cells * d + d // 2 - half
            point[a] = plane.at(point[u], point[v])
            if not seen or abs(point[a] - leaf.centre[a]) > half or any(leaf.curve):
                continue
            for k in range(3):
                self.assertLessEqual(box[k][0], corner[k] + point[k] / 4096)
                self.assertLessEqual(corner[k] + point[k] / 4096, box[k][1])

    def test_damage_is_of_one_tile_or_of_all(self):
        whole = SurfaceMap(DATA)
        at, size, _ = whole.entries[0]
        damaged = bytearray(DATA)
        damaged[at + size // 2] ^= 1
        others = SurfaceMap(bytes(damaged))
        with self.assertRaises(Corrupt):
            others.tile(0)
        others.tile(1)
        for where in (10, len(DATA) - 30, len(DATA) - 10):
            damaged = bytearray(DATA)
            damaged[where] ^= 1
            with self.assertRaises(Corrupt):
                SurfaceMap(bytes(damaged))
        with self.assertRaises(Corrupt):
            SurfaceMap(DATA[:-1])
        with self.assertRaises(Unsupported):
            SurfaceMap((GOLDEN / "scan_maps" / "two-scans.curl").read_bytes())


if __name__ == "__main__":
    unittest.main()
