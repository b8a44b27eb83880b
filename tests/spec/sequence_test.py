#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The golden sequence as the decoder of this folder reads it, whole and damaged."""
import json
import struct
import sys
import unittest
from pathlib import Path

from container import Corrupt, Unsupported, chunk_bytes
from indexed import chunk_at
from sequence import AS_BEFORE, Sequence, file_of_frame, read_group, seconds

GOLDEN = Path(__file__).resolve().parents[1] / "golden"
sys.path.append(str(GOLDEN))
from make_sequence import GROUP, GROUPS, RETURNS, make

DATA = (GOLDEN / "sequences" / "two-groups.curl").read_bytes()


def twin_of(name):
    return json.loads((GOLDEN / f"{name}.json").read_text("ascii"))


class SequenceTest(unittest.TestCase):
    def test_the_golden_file_is_that_of_its_maker(self):
        self.assertEqual(make(), DATA)

    def test_stamps_and_kinds_are_those_that_were_put_in(self):
        sequence = Sequence(DATA)
        self.assertEqual((sequence.group, sequence.still), (GROUP, False))
        for number, scans in enumerate(GROUPS):
            summary = sequence.entries[number][2]
            self.assertEqual(summary["returns"], sum(RETURNS[name] for _, name, _, _ in scans))
            self.assertEqual(summary["time"], scans[0][2])
            for frame, (kind, name, time, pose) in zip(sequence.frames(number), scans):
                self.assertEqual((frame.kind, frame.returns), (kind, RETURNS[name]))
                self.assertEqual(frame.time, None if time is None else seconds(time))
                self.check_pose(frame, pose)

    def check_pose(self, frame, pose):
        if pose is None:
            self.assertIsNone(frame.place)
            return
        place, (w, x, y, z) = pose
        self.assertEqual(frame.place, [value / 2 ** 20 for value in place])
        diagonal = [w * w + x * x - y * y - z * z, w * w - x * x + y * y - z * z]
        for k, value in enumerate(diagonal):
            self.assertAlmostEqual(frame.rotation[k][k], value / 2 ** 56, delta=1e-8)

    def test_files_come_back_byte_for_byte(self):
        for number, scans in enumerate(GROUPS):
            for data, (_, name, _, _) in zip(Sequence(DATA).files(number), scans):
                self.assertEqual(data, (GOLDEN / f"{name}.curl").read_bytes())

    def test_scans_decode_to_their_twins(self):
        for number, scans in enumerate(GROUPS):
            for scan, (_, name, _, _) in zip(Sequence(DATA).scans(number), scans):
                twin = twin_of(name)
                if "slots" in twin:
                    slots = [struct.pack(">3d", *slot).hex() for slot in scan.slots]
                    self.assertTrue(slots == twin["slots"], name)
                else:
                    self.assertTrue(sum(scan.range, []) == twin["range"], name)

    def test_every_changed_byte_is_found(self):
        for at in range(0, len(DATA), 11):
            damaged = bytearray(DATA)
            damaged[at] ^= 0x10
            with self.assertRaises((Corrupt, Unsupported), msg=f"byte {at}"):
                sequence = Sequence(bytes(damaged))
                for number in range(len(GROUPS)):
                    sequence.frames(number)

    def test_a_damaged_group_harms_no_other(self):
        damaged = bytearray(DATA)
        damaged[Sequence(DATA).entries[0][0] + 300] ^= 1
        sequence = Sequence(bytes(damaged))
        with self.assertRaises(Corrupt):
            sequence.frames(0)
        self.assertEqual(sequence.files(1), Sequence(DATA).files(1))

    def test_groups_that_break_a_rule(self):
        part = Sequence(DATA).part(1)
        first, frames = read_group(part)
        self.assertEqual((first, len(frames)), (4, 2))
        for changed in (b"\x04" + part[1:], part[:2] + b"\x00" + part[3:], part[:6],
                        part[:2] + b"\x7f" + part[3:], part.replace(frames[0].bytes, b"\x01")):
            with self.assertRaises(Corrupt):
                read_group(changed)

    def test_frames_that_break_a_rule(self):
        chunk = b"\x23\x02\x00"  # an order of one byte
        for frame in (b"\x00" + bytes([0x23 | AS_BEFORE]), b"\x00" + chunk + chunk,
                      b"\x00\x00\x00", b"\x00\x23\x09\x00"):
            with self.assertRaises(Corrupt):
                file_of_frame(frame, {})

    def test_other_kinds_are_refused(self):
        _, header, after = chunk_at(DATA, 8)
        for changed in (b"\x00" + header[1:], b"\x02\x02" + header[2:]):
            with self.assertRaises(Unsupported):
                Sequence(DATA[:8] + chunk_bytes(0x30, changed) + DATA[after:])


if __name__ == "__main__":
    unittest.main()
