#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes scan_maps/two-scans.curl anew from golden scans, written down from docs/format alone.

The library writes the same bytes from the same scans and poses (tests/unit/mapfile), and the second
decoder reads them (tests/spec/scan_map_test.py). For changes of the format only.
"""
import math
import struct
import sys
from pathlib import Path

GOLDEN = Path(__file__).resolve().parent
sys.path.append(str(GOLDEN.parent / "spec"))
from container import END, MAGIC, VERSION, chunk_bytes, varint
from scan import Scan

ORIGIN = (1000.0, -2000.0, 3.0)
# golden scan, place, quaternion w x y z, time
SCANS = [
    ("street-16", (1000.5, -2000.25, 3.125), (math.sqrt(0.5), 0, 0, math.sqrt(0.5)), 1.5),
    ("room-16-fast", (1010.0, -2001.0, 3.0), (math.sqrt(0.8), 0, 0, 0.8 / (2 * math.sqrt(0.8))),
     math.nan),
]


def text(string):
    return varint(len(string.encode())) + string.encode()


def make():
    header = bytes([1]) + struct.pack("<5d", *ORIGIN, 2.5, 80) + varint(2)
    header += struct.pack("<d", 9.5) + varint(1) + text("place") + text("Straße")
    data = MAGIC + bytes([VERSION]) + chunk_bytes(0x30, header)
    index = varint(len(SCANS))
    for name, place, quaternion, time in SCANS:
        scan = (GOLDEN / "compact" / f"{name}.curl").read_bytes()
        part = struct.pack("<3d4id", *place, *(round(q * 2 ** 30) for q in quaternion), time) + scan
        data += chunk_bytes(0x31, part)
        points = Scan(scan).points()
        radius = max(math.sqrt(x * x + y * y + z * z) for x, y, z in points)
        summary = struct.pack("<3f", *(a - b for a, b in zip(place, ORIGIN)))
        summary += varint(math.ceil(radius / 0.1) + 1) + varint(len(points))
        index += varint(len(part)) + varint(len(summary)) + summary
    begin, chunk = len(data), chunk_bytes(0x32, index)
    footer = chunk_bytes(0x33, struct.pack("<QQ", begin, len(chunk)))
    return data + chunk + footer + chunk_bytes(END, b"")


if __name__ == "__main__":
    (GOLDEN / "scan_maps").mkdir(exist_ok=True)
    (GOLDEN / "scan_maps" / "two-scans.curl").write_bytes(make())
