# SPDX-License-Identifier: BSD-3-Clause
"""Surface maps (docs/format/curl-map-file-1.md); their tiles are in tile.py."""
from container import Reader
from indexed import MapFile, need, numbers
from tile import Tile

SETTINGS = ("step", "metres_per_bit", "root", "smallest_leaf", "footprint", "drop",
            "bare_samples", "full_weight", "intensity_step")
MOST_TILES = 1 << 20
MOST_HEIGHT = 1e6
BOX_STEP = 0.25
BESIDE = 0.05


def signed(reader):
    value = reader.varint()
    return -(value + 1) // 2 if value & 1 else value // 2


def key_of(reader):
    key = signed(reader), signed(reader)
    need(all(-MOST_TILES <= k < MOST_TILES for k in key), "a tile beyond the largest map")
    return key


class SurfaceMap(MapFile):
    KIND = 0

    def __init__(self, data):
        super().__init__(data)
        keys = [summary["key"] for _, _, summary in self.entries]
        need(len(set(keys)) == len(keys), "a tile twice")

    def header_of_kind(self, reader):
        self.side, self.thinning = numbers(reader, "2d")
        self.settings = dict(zip(SETTINGS, numbers(reader, "9d")))
        flags = reader.u8()
        need(0.5 <= self.side <= 1024 and 0.001 <= self.thinning <= 10, "sizes")
        roots = self.side / self.settings["root"]
        need(roots == round(roots) and 1 <= roots <= 64, "a tile is no whole number of roots")
        need(flags <= 3, "unknown flags")
        self.curves, self.intensity = bool(flags & 1), bool(flags & 2)

    def summary(self, reader):
        key = key_of(reader)
        leaves = reader.varint()
        summary = {"key": key, "leaves": leaves, "box": None}
        if leaves == 0:
            return summary
        columns = [(reader.u8(), reader.u8()) for _ in range(2)]
        heights = signed(reader), signed(reader)
        need(all(first <= last for first, last in (*columns, heights)), "an empty box")
        need(all(abs(h * BOX_STEP) <= MOST_HEIGHT for h in heights), "a box too high")
        box = [(self.origin[k] + self.side * (key[k] + first / 256) - BESIDE,
                self.origin[k] + self.side * (key[k] + (last + 1) / 256) + BESIDE)
               for k, (first, last) in enumerate(columns)]
        box.append(tuple(self.origin[2] + h * BOX_STEP for h in heights))
        summary["box"] = box
        return summary

    def tile(self, number):
        """The decoded tile, and the place of its corner in the map's frame."""
        reader = Reader(self.part(number))
        key = key_of(reader)
        need(key == self.entries[number][2]["key"], "another tile than the index says")
        tile = Tile(reader.data[reader.at:])
        need(tile.side * tile.edge(0) / 4096 == self.side, "a tile of another side")
        x, y, z = self.origin
        return tile, (x + key[0] * self.side, y + key[1] * self.side, z)
