#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes sequences/two-groups.curl anew from golden scans, written down from docs/format alone.

The library reads the same scans from it and writes the same bytes (sequences_test.cpp), and the second
decoder reads it (tests/spec/sequence_test.py). For changes of the format only.
"""
import struct
import sys
from pathlib import Path

GOLDEN = Path(__file__).resolve().parent
sys.path.append(str(GOLDEN.parent / "spec"))
from container import END, MAGIC, ONCE, VERSION, chunk_bytes, read_chunks, varint

GROUP = 4
FIRST, ALONE, PREDICTED = range(3)
AS_BEFORE = 0x40
# Times in nanoseconds, places in 2^-20 m, quaternions in 2^-28: of the first group's scans only. The
# third turn is told by the quaternion nearer to the one before, of which w is below zero.
POSES = [((-3 << 20, 5, 1 << 40), (1 << 28, 0, 0, 0)),
         ((-2 << 20, 6, 1 << 40), (0, 0, 0, 1 << 28)),
         ((-1 << 20, -9, (1 << 40) + 3), (-161061274, 0, 0, 214748365)),
         ((17, 0, -(1 << 41)), (-161061274, 214748365, 0, 0))]
# kind, golden scan, time, pose
GROUPS = [[(FIRST, "predicted/street-0", 1600000000125000000, POSES[0]),
           (PREDICTED, "predicted/street-1", 1600000000250000000, POSES[1]),
           (PREDICTED, "predicted/street-2", 1600000000359375000, POSES[2]),
           (ALONE, "predicted/street-0", -5, POSES[3])],
          [(FIRST, "clouds/rings-directions", None, None),
           (ALONE, "clouds/organised", None, None)]]
RETURNS = {"predicted/street-0": 720, "predicted/street-1": 720, "predicted/street-2": 720,
           "clouds/rings-directions": 303, "clouds/organised": 378}


def zigzag(value):
    return varint(2 * value if value >= 0 else -2 * value - 1)


class Course:
    """Numbers, each told by what the two before foretell."""

    def __init__(self):
        self.told = []

    def __call__(self, value):
        before = self.told
        expected = 0 if not before else before[0] if len(before) == 1 else 2 * before[-1] - before[-2]
        self.told.append(value)
        return zigzag(((value - expected) + (1 << 63)) % (1 << 64) - (1 << 63))


def frame(kind, name, memory):
    if kind == FIRST:
        memory.clear()
    data = bytes([kind])
    chunks = read_chunks((GOLDEN / f"{name}.curl").read_bytes())
    for chunk in chunks:
        if chunk.kind in ONCE and memory.get(chunk.kind) == chunk.payload:
            data += bytes([chunk.kind | AS_BEFORE])
            continue
        size = 0 if chunk is chunks[-1] else len(chunk.payload) + 1
        data += bytes([chunk.kind]) + varint(size) + chunk.payload
        if chunk.kind in ONCE:
            memory[chunk.kind] = chunk.payload
    return data


def group(first, scans):
    memory = {}
    frames = [frame(kind, name, memory) for kind, name, _, _ in scans]
    stamped = scans[0][2] is not None
    data = bytes([3 if stamped else 0]) + varint(first) + varint(len(scans))
    before = 0
    for _, name, _, _ in scans:
        data += zigzag(RETURNS[name] - before)
        before = RETURNS[name]
    data += b"".join(varint(len(f)) for f in frames[:-1])
    if stamped:
        times, courses = Course(), [Course() for _ in range(7)]
        data += b"".join(times(time) for _, _, time, _ in scans)
        for _, _, _, (place, turn) in scans:
            data += b"".join(course(value) for course, value in zip(courses, place + turn))
    return data + b"".join(frames)


def summary(scans):
    data = varint(len(scans)) + varint(sum(RETURNS[name] for _, name, _, _ in scans))
    return data if scans[0][2] is None else data + zigzag(scans[0][2])


def make():
    data = MAGIC + bytes([VERSION]) + chunk_bytes(0x30, bytes([2, 0]) + varint(GROUP))
    index, first = varint(len(GROUPS)), 0
    for scans in GROUPS:
        part, about = group(first, scans), summary(scans)
        data += chunk_bytes(0x31, part)
        index += varint(len(part)) + varint(len(about)) + about
        first += len(scans)
    begin, chunk = len(data), chunk_bytes(0x32, index)
    footer = chunk_bytes(0x33, struct.pack("<QQ", begin, len(chunk)))
    return data + chunk + footer + chunk_bytes(END, b"")


if __name__ == "__main__":
    (GOLDEN / "sequences").mkdir(exist_ok=True)
    (GOLDEN / "sequences" / "two-groups.curl").write_bytes(make())
