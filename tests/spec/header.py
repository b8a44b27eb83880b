# SPDX-License-Identifier: BSD-3-Clause
"""Parameters, row table and index of a compact scan."""
from container import Corrupt, Reader, Unsupported
from entropy import RangeDecoder, decide

MAX_CELLS = 1 << 26


def _need(condition, what):
    if not condition:
        raise Corrupt(what)


class Parameters:
    """The compact_parameters chunk."""

    def __init__(self, payload):
        reader = Reader(payload)
        flags = reader.u8()
        if flags & 128:
            raise Unsupported("compact_parameters: flags of a later version")
        self.root_log2 = flags & 7
        has_residual, has_segments, has_turn, has_lattice = (bool(flags >> b & 1) for b in range(3, 7))
        _need(1 <= self.root_log2 <= 5, "root_log2")
        _need(has_residual or not has_lattice, "a lattice without residuals")
        self.rows = reader.varint()
        self.columns = reader.varint()
        self.step = reader.varint()
        self.smallest_leaf = reader.varint()
        self.lattice = reader.varint() if has_lattice else 0
        self.residual_step = self.lattice >> 16
        if has_residual and not has_lattice:
            self.residual_step = reader.varint()
            _need(1 <= self.residual_step <= 1 << 24, "residual_step")
        self.bands, self.sectors = (reader.varint(), reader.varint()) if has_segments else (1, 1)
        self.turn_columns, self.first_column = (
            (reader.varint(), reader.varint()) if has_turn else (self.columns, 0))
        reader.end()
        self._check()

    def _check(self):
        _need(1 <= self.rows <= 1 << 16, "rows")
        _need(1 <= self.turn_columns <= 1 << 22, "turn_columns")
        _need(0 <= self.first_column < self.turn_columns, "first_column")
        _need(1 <= self.columns <= self.turn_columns, "columns")
        _need(1 <= self.step <= 1 << 24, "step")
        _need(1 <= self.smallest_leaf <= 1024, "smallest_leaf")
        _need(not self.lattice or 1 << 16 <= self.lattice <= 1 << 40, "lattice")
        _need(1 <= self.bands <= self.rows and 1 <= self.sectors <= self.columns
              and self.bands * self.sectors <= 4096, "segments")
        _need(self.rows * self.columns <= MAX_CELLS, "more cells than this decoder takes")

    def segments(self):
        """(row, column, rows, columns) of each."""
        def parts(total, count):
            edges = [i * total // count for i in range(count + 1)]
            return [(begin, end - begin) for begin, end in zip(edges, edges[1:])]
        return [(row, column, rows, columns) for row, rows in parts(self.rows, self.bands)
                for column, columns in parts(self.columns, self.sectors)]


class Numbers:
    """Numbers of one kind and the models that code them."""

    def __init__(self, decoder):
        self.decoder = decoder
        self.zero = [[32768, 0], [32768, 0]]
        self.sign = [32768, 0]
        self.size = [[32768, 0] for _ in range(32)]
        self.top = [[32768, 0] for _ in range(33)]
        self.last_zero = 0

    def _bit(self, model):
        return decide(self.decoder, model, 30)

    def next(self):
        zero = self._bit(self.zero[self.last_zero])
        self.last_zero = zero
        if zero:
            return 0
        negative = self._bit(self.sign)
        n = 0
        while n < 32 and self._bit(self.size[n]):
            n += 1
        t = 1 if n else 0
        for i in range(n - 1):
            t = 2 * t + (self._bit(self.top[n]) if i == 0 else self.decoder.plain())
        return -(t + 1) if negative else t + 1


def sequence(decoder, rows, differences, most):
    """One number for each row."""
    shift = sum(decoder.plain() << b for b in range(4, -1, -1))
    k = sum(decoder.plain() << b for b in range(1, -1, -1))
    _need(shift <= 24, "shift of a sequence")
    first, later = Numbers(decoder), Numbers(decoder)
    values, u, m, fresh = [], 0, 0, True
    for row in range(rows):
        if differences and row == 0:
            u = first.next()
        else:
            d = (m + 128 >> 8) + later.next()
            m = 256 * d if fresh else m + (256 * d - m >> k)
            fresh = False
            u = u + d if differences else d
        _need(abs(u << shift) <= most, "a row's number")
        values.append(u << shift)
    return values


class RowTable:
    """The compact_sensor chunk. `height` and `range_offset` are empty where there are none;
    elevations are in the chunk of the rays, if the scan `has_rays`."""

    def __init__(self, payload, rows):
        reader = Reader(payload)
        flags = reader.u8()
        if flags & ~7:
            raise Unsupported("compact_sensor: flags of a later version")
        self.has_rays = bool(flags & 4)
        _need(not self.has_rays or not flags & 1, "heights beside rays")
        decoder = RangeDecoder(payload[1:])
        self.elevation = [] if self.has_rays else sequence(decoder, rows, True, 1 << 30)
        self.height = sequence(decoder, rows, False, 1 << 22) if flags & 1 else []
        self.range_offset = sequence(decoder, rows, False, 1 << 22) if flags & 2 else []
        _need(not decoder.exhausted and decoder.read >= len(payload) - 1, "compact_sensor")


def read_index(payload, chunks):
    """Sizes of the payloads of all masks, fields, residuals."""
    reader = Reader(payload)
    sizes = [reader.varint() for _ in range(chunks)]
    reader.end()
    _need(all(size < 1 << 48 for size in sizes), "compact_index")
    return sizes
