# SPDX-License-Identifier: BSD-3-Clause
"""A file with every return: from its bytes to the slots of a cloud."""
import struct

from attributes import Attributes
from container import Corrupt, Unsupported, read_chunks
from corrections import apply_corrections
from directions import decode_directions
from loose import decode_loose
from order import NAN, POINT, ZERO, Grid, Order
from points import FLOAT32, rounded
from scan import PARAMETERS, Scan

DIRECTIONS, LOOSE, CORRECTIONS, ORDER, RECORDS, PROMISE = 0x20, 0x21, 0x22, 0x23, 0x24, 0x81
QUIET_NAN = struct.unpack("<d", struct.pack("<Q", 0x7FF8 << 48))[0]


class CloudFile:
    """Decodes on construction. slots: x, y, z of each; order: width, height, type, kinds;
    attributes: as in the module of that name; bound: metres, 0 for bit for bit, None for nothing
    promised of points; any_order: whether the order was given up."""

    def __init__(self, data):
        self.chunks = {chunk.kind: chunk.payload for chunk in read_chunks(data)}
        if ORDER not in self.chunks:
            raise Corrupt("no order")
        self.scan = Scan(data) if PARAMETERS in self.chunks else None
        self.any_order = False
        self.bound = self._promise()
        cells = self._cell_points()
        loose = decode_loose(self.chunks[LOOSE]) if LOOSE in self.chunks else []
        self.order = Order(self.chunks[ORDER], self._grid(len(loose)))
        self.records = cells + loose
        if self.order.type == FLOAT32:
            self.records = [tuple(rounded(x, FLOAT32) for x in p) for p in self.records]
        if CORRECTIONS in self.chunks:
            self.records = apply_corrections(self.chunks[CORRECTIONS], self.records)
        self.slots = self._slots()
        self.attributes = []
        if RECORDS in self.chunks:
            grid = self._grid(len(loose))
            self.attributes = Attributes(self.chunks[RECORDS], self.order, grid).attributes

    def _promise(self):
        if PROMISE not in self.chunks:
            return None
        payload = self.chunks[PROMISE]
        flags = payload[0] if payload else 0
        if flags > 7:
            raise Unsupported("a promise of a later version")
        if flags == 0 or flags & 3 == 3 or len(payload) != (9 if flags & 1 else 1):
            raise Corrupt("a promise of an unknown kind")
        self.any_order = bool(flags & 4)
        if not flags & 1:
            return 0 if flags & 2 else None
        (bound,) = struct.unpack("<d", payload[1:])
        if not 0 < bound < float("inf"):
            raise Corrupt("a bound that is no length")
        return bound

    def _cell_points(self):
        """x, y, z in metres of the cells that have a range, row by row."""
        if DIRECTIONS not in self.chunks:
            return self.scan.points() if self.scan else []
        if not self.scan or self.scan.rays:
            raise Corrupt("offsets of directions without even columns")
        rows, columns = self.scan.parameters.rows, self.scan.parameters.columns
        flat = [r for row in self.scan.range for r in row]
        offsets = decode_directions(self.chunks[DIRECTIONS], rows, columns, [r > 0 for r in flat],
                                    [r for r in flat if r])
        cells = [divmod(cell, columns) for cell, r in enumerate(flat) if r]
        return [tuple(value / (1 << 36) for value in self.scan.point(*cell, *offset))
                for cell, offset in zip(cells, offsets)]

    def _grid(self, loose):
        if not self.scan:
            return Grid([], 0, loose)
        ranges, rays = self.scan.range, self.scan.rays
        shift = [rays.shift(row) for row in range(len(ranges))] if rays else None
        occupied = [[r > 0 for r in row] for row in ranges]
        return Grid(occupied, self.scan.parameters.columns, loose, ranges, shift)

    def _slots(self):
        record, odd = iter(self.order.record), iter(self.order.odd)
        slots = []
        for kind in self.order.kinds:
            if kind == POINT:
                slots.append(self.records[next(record)])
            elif kind == NAN:
                slots.append((QUIET_NAN,) * 3)
            elif kind == ZERO:
                slots.append((0.0, 0.0, 0.0))
            else:
                slots.append(struct.unpack("<3d", struct.pack("<3Q", *next(odd))))
        return slots
