# SPDX-License-Identifier: BSD-3-Clause
"""The order chunk: what the slots of a cloud hold and which records they are."""
import struct

from container import Corrupt, Reader, Unsupported
from entropy import RangeDecoder, decide
from adaptive import LIMIT, SignedNumbers, Sizes, model, plain_number

POINT, NAN, ZERO, ODD = range(4)
HIT, LOOSE, INSERTED, JUMP = range(4)


def block(reader):
    """A block that is not compressed: the standard library has no zstd."""
    size, compressed = divmod(reader.varint(), 2)
    if compressed:
        raise Unsupported("zstd")
    return reader.bytes(size)


def join_planes(planes, size):
    count = len(planes) // size
    return b"".join(planes[i::count] for i in range(count)) if count else b""


class Grid:
    """`occupied`: rows of flags; records are numbered on construction."""

    def __init__(self, occupied, columns, loose=0, ranges=None, shift=None):
        self.rows, self.columns, self.loose = len(occupied), columns, loose
        self.occupied, self.ranges = occupied, ranges
        self.shift = shift or [0] * self.rows
        self.cells = [(i, j) for i in range(self.rows) for j in range(columns) if occupied[i][j]]
        self.record = {cell: number for number, cell in enumerate(self.cells)}
        self.records = len(self.cells) + loose


class Walk:
    def __init__(self, decoder, grid):
        rows, columns = grid.rows, grid.columns
        self.by_column, self.backward = decoder.plain(), decoder.plain()
        self.rows, self.first = [], {}
        repeated, turns = [model(), model()], SignedNumbers()
        last, before, row, first = 1, 1, rows - 1, 0
        for _ in range(rows):
            if decide(decoder, repeated[0], 30):
                step = last
            elif decide(decoder, repeated[1], 30):
                step = before
            else:
                step = plain_number(decoder, (rows - 1).bit_length())
            last, before = step, last
            if step >= rows:
                raise Corrupt("a step of a walk")
            row = (row + step) % rows
            turn = turns.decode(decoder)
            if row in self.first or abs(turn) > columns:
                raise Corrupt("a row of a walk")
            first = (first + turn) % columns
            self.rows.append(row)
            self.first[row] = first
        self.columns = columns

    def cells(self):
        sign = -1 if self.backward else 1

        def cell(row, t):
            return row, (self.first[row] + sign * t) % self.columns
        if self.by_column:
            return [cell(row, t) for t in range(self.columns) for row in self.rows]
        return [cell(row, t) for row in self.rows for t in range(self.columns)]


class Order:
    """Decodes on construction: width, height, type, kinds, record (of each point), odd."""

    def __init__(self, payload, grid):
        reader = Reader(payload)
        slots, self.width, self.height = (reader.varint() for _ in range(3))
        self.type = reader.u8()
        if self.type > 9 or slots < grid.records:
            raise Corrupt("shape of a cloud")
        if max(self.width, self.height) >> 32 or (
                self.height > 1 and self.width * self.height != slots):
            raise Corrupt("shape of a cloud")
        self.decoder = RangeDecoder(reader.bytes(reader.varint()))
        self.grid = grid
        walk = Walk(self.decoder, grid).cells() if grid.rows * grid.columns else []
        self.rows_of_places = [cell[0] for cell in walk]
        loose = range(len(grid.cells), grid.records)
        self.places = [grid.record.get(cell) for cell in walk] + list(loose)
        self._decode(slots)
        if self.decoder.exhausted:
            raise Corrupt("the order ends early")
        self.odd = self._odd(reader)
        reader.end()

    def _decode(self, slots):
        self.open = [True] * len(self.places)
        self.left = self.grid.records
        self.at, self.history, self.last_kind = 0, (0, 0, 0), 0
        self.emitted = (0, 0)
        self.row_emitted = [(0, 0)] * self.grid.rows
        self.flags, self.last_row = [(0, 0)] * self.grid.rows, None
        self.hit = {}
        self.inserted = [[model() for _ in range(3)] for _ in range(64)]
        self.loose = [model() for _ in range(64)]
        self.emits, self.kind = {}, [[model(), model()] for _ in range(4)]
        self.moves, self.behind, self.jump = model(), [model(), model()], [Sizes(), Sizes()]
        self.kinds, self.record = [], []
        for slot in range(slots):
            if self.decoder.exhausted:
                raise Corrupt("the order ends early")
            self.above = 0
            if self.height > 1 and 0 < self.width <= slot:
                self.above = 1 if self.kinds[slot - self.width] == POINT else 2
            place = self._slot()
            if place is None:
                self.kinds.append(self._kind())
            else:
                self.kinds.append(POINT)
                self.open[place] = False
                self.left -= 1
                self.record.append(self.places[place])
        if self.left:
            raise Corrupt("records without a slot")

    def _open_from(self, place):
        count = len(self.places)
        return next(p % count for p in range(place, place + count + 1) if self.open[p % count])

    def _slot(self):
        """The place of a point; none for another slot."""
        if self._empty_cells() or not self.left:
            return None
        here = self._open_from(self.at)
        h = 16 * self.history[0] + 4 * self.history[1] + self.history[2]
        flags = (0, 0) if self.last_row is None else self.flags[self.last_row]
        hit = self.hit.setdefault((h, self.above, flags), model())
        if decide(self.decoder, hit, LIMIT):
            self.at = here + 1
            return self._event(HIT, here)
        if decide(self.decoder, self.inserted[h][self.above], LIMIT):
            return self._event(INSERTED, None)
        loose = [p for p in range(len(self.rows_of_places), len(self.places)) if self.open[p]]
        if loose and decide(self.decoder, self.loose[h], LIMIT):
            return self._event(LOOSE, loose[0])
        moves = decide(self.decoder, self.moves, LIMIT)
        behind = decide(self.decoder, self.behind[moves], LIMIT)
        distance = self.jump[moves].decode(self.decoder) + 1
        if distance >= self.left:
            raise Corrupt("a jump too far")
        left = [p for p, number in enumerate(self.places) if number is not None and self.open[p]]
        place = left[(left.index(here) + (-distance if behind else distance)) % len(left)]
        if moves:
            self.at = place + 1
        return self._event(JUMP, place)

    def _empty_cells(self):
        """Whether an empty cell is the slot."""
        while self.left:
            place = self._open_from(self.at)
            if self.places[place] is not None:
                return False
            self.open[place] = False
            self.at = place + 1
            row = self.rows_of_places[place]
            context = self.row_emitted[row], self.emitted, self.above
            emitted = decide(self.decoder, self.emits.setdefault(context, model()), LIMIT)
            self.row_emitted[row] = self.row_emitted[row][1], emitted
            self.emitted = self.emitted[1], emitted
            if emitted:
                return True
        return False

    def _event(self, event, place):
        self.history = *self.history[1:], event
        if self.last_row is not None:
            self.flags[self.last_row] = self.flags[self.last_row][1], int(event != HIT)
        in_cell = place is not None and place < len(self.rows_of_places)
        self.last_row = self.rows_of_places[place] if in_cell else None
        return place

    def _kind(self):
        models = self.kind[self.last_kind]
        if decide(self.decoder, models[0], LIMIT):
            self.last_kind = NAN
        else:
            self.last_kind = ZERO if decide(self.decoder, models[1], LIMIT) else ODD
        return self.last_kind

    def _odd(self, reader):
        count = self.kinds.count(ODD)
        if not count:
            return []
        planes = block(reader)
        if len(planes) != 24 * count:
            raise Corrupt("number of odd slots")
        return [list(bits) for bits in struct.iter_unpack("<3Q", join_planes(planes, 24))]
