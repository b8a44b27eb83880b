#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Files with every return decode, by docs/format alone, to the slots, attributes and promise that
their twins in tests/golden/clouds tell, bit for bit."""
import json
import struct
import unittest
from pathlib import Path

from cloud_file import CORRECTIONS, DIRECTIONS, LOOSE, ORDER, CloudFile
from container import Corrupt, file_of, read_chunks

FOLDER = Path(__file__).resolve().parents[1] / "golden" / "clouds"


class CloudFileTest(unittest.TestCase):
    def check(self, name):
        cloud = CloudFile((FOLDER / f"{name}.curl").read_bytes())
        twin = json.loads((FOLDER / f"{name}.json").read_text("ascii"))
        for field in ("width", "height", "type"):
            self.assertEqual(getattr(cloud.order, field), twin[field], field)
        self.assertEqual(cloud.bound, twin["bound"])
        found = [struct.pack(">3d", *slot).hex() for slot in cloud.slots]
        self.assertEqual(len(found), len(twin["slots"]))
        for slot, (a, b) in enumerate(zip(found, twin["slots"])):
            self.assertEqual(a, b, f"slot {slot}")
        self.assertEqual(len(cloud.attributes), len(twin["attributes"]))
        for decoded, wanted in zip(cloud.attributes, twin["attributes"]):
            self.assertEqual(decoded[:3], (wanted["name"], wanted["type"], wanted["components"]))
            self.assertTrue(decoded[3] == wanted["bits"], f"{wanted['name']} differs")

    def test_the_files_hold_every_chunk(self):
        kinds = set()
        for file in FOLDER.glob("*.curl"):
            kinds |= {chunk.kind for chunk in read_chunks(file.read_bytes())}
        self.assertLessEqual({0x10, 0x16, 0x20, 0x21, 0x22, 0x23, 0x24, 0x81}, kinds)

    def test_chunks_that_belong_to_others_are_needed(self):
        def without(name, kind, more=()):
            chunks = read_chunks((FOLDER / f"{name}.curl").read_bytes())
            return file_of([(c.kind, c.payload) for c in chunks if c.kind != kind] + list(more))
        with self.assertRaises(Corrupt):
            CloudFile(without("rays-bound", ORDER))
        with self.assertRaises(Corrupt):
            CloudFile(without("rays-bound", DIRECTIONS, [(DIRECTIONS, b"\x64")]))


def add_tests():
    for file in sorted(FOLDER.glob("*.curl")):
        def test(self, name=file.stem):
            self.check(name)
        setattr(CloudFileTest, "test_" + file.stem.replace("-", "_"), test)


if __name__ == "__main__":
    add_tests()
    unittest.main()
