#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""damage_test.py FOLDER: what the format says to refuse and to tolerate, on files made from golden
ones. The decoder of this folder and, if CURLIDAR names it, the built command do so alike."""
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from container import Corrupt, Unsupported, chunk_bytes, crc32c, file_of, read_chunks
from scan import FIELD, INDEX, MASK, PARAMETERS, RAYS, RESIDUAL, SENSOR, Scan

FOLDER = Path(__file__).resolve().parents[1] / "golden" / "compact"
COMMAND = os.environ.get("CURLIDAR")


def load(name):
    return [(chunk.kind, chunk.payload)
            for chunk in read_chunks((FOLDER / f"{name}.curl").read_bytes())]


class DamageTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.segments = load("segments")        # with an index, maybe a residual layer
        cls.fine = load("corridor-32-fine")    # one segment, residuals
        cls.empty = load("no-return")

    def refused(self, data, cut=False):
        with self.assertRaises((Corrupt, Unsupported)):
            Scan(data, cut)
        if COMMAND:
            self.assertEqual(self.run_command(data, cut), 3)

    def accepted(self, data, cut=False):
        """The number of returns, on which both decoders agree."""
        returns = len(Scan(data, cut).points())
        if COMMAND:
            self.assertEqual(self.run_command(data, cut), 0)
        return returns

    def same(self, data, chunks):
        self.assertEqual(self.accepted(data), len(Scan(file_of(chunks)).points()))

    @staticmethod
    def run_command(data, cut):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "scan.curl"
            file.write_bytes(data)
            options = ["--allow-truncated"] if cut else []
            return subprocess.run([COMMAND, "decode", file, "-q", *options, "-o",
                                   Path(folder) / "cloud.npy"], capture_output=True).returncode

    @staticmethod
    def changed(chunks, kind, change):
        """The file with another payload of the first chunk of a type."""
        place = [other for other, _ in chunks].index(kind)
        payload = change(chunks[place][1])
        return file_of([*chunks[:place], (kind, payload), *chunks[place + 1:]])

    def test_ends(self):
        data = file_of(self.segments)
        self.refused(data[:-6])
        self.refused(data + b"x")
        self.refused(data[:300])
        self.refused(data[:7] + b"\x02" + data[8:])
        self.refused(data[:7] + b"\x00" + data[8:])
        self.assertGreater(self.accepted(data[:-6], cut=True), 0)

    def test_checksums(self):
        data = file_of(self.fine)
        for place in (12, 40, len(data) - 20):
            self.refused(data[:place] + bytes([data[place] ^ 1]) + data[place + 1:])
        unknown = bytearray(chunk_bytes(0x91, b"abc"))
        unknown[3] ^= 1
        self.refused(data[:-6] + bytes(unknown) + data[-6:])

    def test_unknown_chunks(self):
        for kind in (0x18, 0x3f, 0x71):
            self.refused(file_of([*self.fine, (kind, b"abc")]))
        for kind in (0x91, 0xf1):
            self.same(file_of([*self.fine, (kind, b"abc")]), self.fine)

    def test_order_and_number_of_chunks(self):
        chunks = self.segments
        self.same(file_of(chunks[1:] + chunks[:1]), chunks)
        self.same(file_of(sorted(chunks, key=lambda chunk: -chunk[0])), chunks)
        self.refused(file_of(chunks[1:]))
        self.refused(file_of(chunks[:1] + chunks))
        self.refused(file_of(chunks[:-1]))
        self.refused(file_of(chunks + chunks[-1:]))
        without_residuals = load("room-32-layers")
        self.refused(file_of([*without_residuals, (RESIDUAL, b"\0")]))

    def test_long_varints_are_tolerated(self):
        kind, payload = self.fine[0]
        body = bytes([kind, len(payload) | 128, 0]) + payload
        whole = file_of(self.fine)
        short = chunk_bytes(kind, payload)
        long = body + crc32c(body).to_bytes(4, "little")
        self.assertTrue(whole[8:].startswith(short))
        self.same(whole[:8] + long + whole[8 + len(short):], self.fine)

    def test_parameters(self):
        def flags(change):
            return self.changed(self.fine, PARAMETERS,
                                lambda p: bytes([change(p[0])]) + p[1:])
        self.refused(flags(lambda f: f | 128))
        self.refused(flags(lambda f: f & ~7))
        self.refused(flags(lambda f: f | 7))
        self.refused(self.changed(self.fine, PARAMETERS, lambda p: p + b"\0"))
        self.refused(self.changed(self.fine, PARAMETERS, lambda p: p[:-1]))
        self.refused(self.changed(self.fine, PARAMETERS, lambda p: p[:1] + b"\0" + p[2:]))

    def test_table_and_index(self):
        self.refused(self.changed(self.fine, SENSOR, lambda p: bytes([p[0] | 4]) + p[1:]))
        self.refused(self.changed(self.fine, SENSOR, lambda p: p + b"abcde"))
        self.same(self.changed(self.segments, INDEX, lambda p: b"\1" + p[1:]), self.segments)

    def test_rays(self):
        named, own = load("rays-named"), load("rays-own")
        rays = dict(named)[RAYS]
        for chunks in (named, own):
            self.refused(file_of([chunk for chunk in chunks if chunk[0] != RAYS]))
            self.refused(self.changed(chunks, SENSOR, lambda p: bytes([p[0] & ~4]) + p[1:]))
            self.refused(self.changed(chunks, SENSOR, lambda p: bytes([p[0] | 1]) + p[1:]))
            self.refused(self.changed(chunks, RAYS, lambda p: bytes([p[0] | 16]) + p[1:]))
            self.refused(self.changed(chunks, RAYS, lambda p: p[:len(p) // 2]))
            self.refused(self.changed(chunks, RAYS, lambda p: p + bytes(9)))
            self.refused(self.changed(chunks, RAYS, lambda p: b""))
        self.refused(file_of([*self.fine, (RAYS, rays)]))
        for number in (0, 1, 99):  # no such tables, and one of other rows
            self.refused(self.changed(named, RAYS, lambda p: bytes([p[0], number]) + p[2:]))
        self.refused(self.changed(named, RAYS, lambda p: bytes([p[0] | 4]) + p[1:]))
        self.refused(self.changed(named, PARAMETERS, lambda p: p[:2] + bytes([p[2] - 1]) + p[3:]))
        # A file cut behind its rays has a table and no returns.
        data = file_of(named)
        behind = data.index(rays) + len(rays) + 4
        self.assertEqual(self.accepted(data[:behind], cut=True), 0)
        self.refused(data[:behind - 5], cut=True)

    def test_streams(self):
        for kind in (MASK, FIELD, RESIDUAL):
            self.refused(self.changed(self.fine, kind, lambda p: b""))
            self.same(self.changed(self.fine, kind, lambda p: p + b"abc"), self.fine)
        for kind in (FIELD, RESIDUAL):
            self.refused(self.changed(self.fine, kind, lambda p: p[:len(p) // 2]))
        for flags in (b"", b"\5"):
            self.refused(self.changed(self.empty, RESIDUAL, lambda p: flags))
        self.same(self.changed(self.empty, RESIDUAL, lambda p: b"\0abc"), self.empty)


if __name__ == "__main__":
    if len(sys.argv) > 1 and Path(sys.argv[1]).is_dir():
        FOLDER = Path(sys.argv.pop(1))
    unittest.main()
