#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The golden map of scans as the decoder of this folder reads it, whole and damaged."""
import math
import sys
import unittest
from pathlib import Path

from container import Corrupt, Unsupported
from scan import Scan
from scan_map import ScanMap, read_part

GOLDEN = Path(__file__).resolve().parents[1] / "golden"
sys.path.append(str(GOLDEN))
from make_scan_map import ORIGIN, SCANS, make

DATA = (GOLDEN / "scan_maps" / "two-scans.curl").read_bytes()


class ScanMapTest(unittest.TestCase):
    def test_the_golden_file_says_what_was_put_in(self):
        scan_map = ScanMap(DATA)
        self.assertEqual(scan_map.origin, list(ORIGIN))
        self.assertEqual((scan_map.min_range, scan_map.max_range), (2.5, 80))
        self.assertEqual((scan_map.scans, scan_map.way), (2, 9.5))
        self.assertEqual(scan_map.metadata, {"place": "Straße"})
        self.assertEqual(len(scan_map.entries), len(SCANS))
        for number, (name, place, quaternion, time) in enumerate(SCANS):
            found, rotation, when, file = scan_map.scan(number)
            self.assertEqual(found, list(place))
            self.assertEqual(when, None if math.isnan(time) else time)
            self.assertEqual(file, (GOLDEN / "compact" / f"{name}.curl").read_bytes())
            w, _, _, z = quaternion
            wanted = [[1 - 2 * z * z, -2 * w * z, 0], [2 * w * z, 1 - 2 * z * z, 0], [0, 0, 1]]
            for row, row_wanted in zip(rotation, wanted):
                for value, value_wanted in zip(row, row_wanted):
                    self.assertAlmostEqual(value, value_wanted, delta=4e-9)
            self.check_summary(scan_map.entries[number][2], place, file)

    def check_summary(self, summary, place, file):
        points = list(Scan(file).points())
        self.assertEqual(summary["points"], len(points))
        farthest = max(math.dist((0, 0, 0), point) for point in points)
        self.assertLessEqual(farthest, summary["radius"] * 0.1)
        self.assertLess(summary["radius"] * 0.1, farthest + 0.3)
        for found, value, origin in zip(summary["place"], place, ORIGIN):
            self.assertAlmostEqual(found, value - origin, 4)

    def test_the_golden_file_is_that_of_its_maker(self):
        self.assertEqual(make(), DATA)

    def test_every_changed_byte_is_found(self):
        for at in range(0, len(DATA), 7):
            damaged = bytearray(DATA)
            damaged[at] ^= 0x10
            with self.assertRaises((Corrupt, Unsupported), msg=f"byte {at}"):
                scan_map = ScanMap(bytes(damaged))
                for number in range(len(scan_map.entries)):
                    scan_map.scan(number)

    def test_parts_that_hold_no_pose(self):
        part = ScanMap(DATA).data[ScanMap(DATA).entries[0][0] + 3:][:60]
        read_part(part)
        for changed in (part[:47], part[:24] + bytes(4) + part[28:], b"\xff" * 8 + part[8:]):
            with self.assertRaises(Corrupt):
                read_part(changed)


if __name__ == "__main__":
    unittest.main()
