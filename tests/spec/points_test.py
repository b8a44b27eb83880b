#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The chunks of points decode, by docs/format/curl-format-1-points.md alone, to what
tests/golden/points says, bit for bit."""
import json
import struct
import unittest
from pathlib import Path

from corrections import apply_corrections
from directions import decode_directions
from loose import decode_loose
from points import Invalid

FOLDER = Path(__file__).resolve().parents[1] / "golden" / "points"


def points_of(texts):
    """Nine words of 16 digits are three points."""
    values = [struct.unpack(">d", bytes.fromhex(text))[0] for text in texts]
    return [tuple(values[i:i + 3]) for i in range(0, len(values), 3)]


def bits(points):
    return [struct.pack(">3d", *point).hex() for point in points]


class PointsTest(unittest.TestCase):
    def check(self, vector):
        payload = bytes.fromhex(vector["payload"])
        if vector["chunk"] == "directions":
            occupied = [digit == "1" for digit in vector["occupied"]]
            found = decode_directions(payload, vector["rows"], vector["columns"], occupied,
                                      vector["ranges"])
            self.assertEqual([list(offset) for offset in found], vector["offsets"])
            return
        wanted = points_of(vector["points"])
        if vector["chunk"] == "loose":
            found = decode_loose(payload)
        else:
            found = apply_corrections(payload, points_of(vector["predicted"]))
        self.assertEqual(bits(found), bits(wanted))

    def test_a_stream_that_ends_early_is_invalid(self):
        vector = json.loads((FOLDER / "loose-walk.json").read_text("ascii"))
        with self.assertRaises(Invalid):
            decode_loose(bytes.fromhex(vector["payload"])[:-20])


def add_tests():
    for file in sorted(FOLDER.glob("*.json")):
        def test(self, vector=json.loads(file.read_text("ascii"))):
            self.check(vector)
        setattr(PointsTest, "test_" + file.stem.replace("-", "_"), test)


if __name__ == "__main__":
    add_tests()
    unittest.main()
