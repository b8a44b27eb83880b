# SPDX-License-Identifier: BSD-3-Clause
"""Maps of scans (docs/format/curl-map-file-1.md)."""
import math

from container import Reader
from indexed import FAR, MapFile, need, numbers


class ScanMap(MapFile):
    KIND = 1

    def summary(self, reader):
        place = numbers(reader, "3f")
        radius, points = reader.varint(), reader.varint()
        need(all(map(math.isfinite, place)) and radius <= 1 << 24 and points < 1 << 32, "a summary")
        return {"place": place, "radius": radius, "points": points}

    def scan(self, number):
        """Place, rotation by rows, time or None, and the scan's file."""
        return read_part(self.part(number))


def read_part(payload):
    reader = Reader(payload)
    place = numbers(reader, "3d")
    q = [number / 2 ** 30 for number in numbers(reader, "4i")]
    (time,) = numbers(reader, "d")
    need(all(abs(x) <= FAR for x in place), "a place")
    square = sum(number * number for number in q)
    need(abs(square - 1) <= 1e-6, "a quaternion")
    w, x, y, z = (number / math.sqrt(square) for number in q)
    rotation = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    return place, rotation, time if math.isfinite(time) else None, payload[reader.at:]
