# SPDX-License-Identifier: BSD-3-Clause
"""The sensor's own rays: beam tables, the compact_rays chunk, points, what the field sees."""
from functools import lru_cache
from pathlib import Path

from container import Corrupt, Reader, Unsupported
from entropy import RangeDecoder, decide_mixed
from header import Numbers, sequence
from integers import ONE_TURN, clip, divide, mulshift, signed_angle, sin_cos

BEAMS = Path(__file__).resolve().parents[2] / "docs" / "format" / "beams"
FARTHEST = 1 << 52


def _need(condition, what):
    if not condition:
        raise Corrupt(f"compact_rays: {what}")


def _rounded(a, bits):
    return (a + (1 << bits - 1)) >> bits


@lru_cache(maxsize=None)
def beam_tables():
    """number -> (slots, range unit, rows of elevation, azimuth offset, height, lateral, phase)."""
    tables = {}
    for path in BEAMS.glob("*.txt"):
        lines = [line for line in path.read_text("ascii").splitlines() if not line.startswith("#")]
        number, slots, unit, *rest = [int(word) for line in lines for word in line.split()]
        tables[number] = slots, unit, [rest[i:i + 5] for i in range(0, len(rest), 5)]
    return tables


class _Steps:
    """Steps from firing to firing."""

    def __init__(self, decoder, slots, count):
        self.decoder = decoder
        self.usual, self.pace = slots // count, (slots << 8) // count
        self.late = self.run = 0
        self.last = [0, 0]
        self.tables = [{}, {}, {}]
        self.weights = [65536 * 5 // 12] * (3 * 26)
        self.rest = Numbers(decoder)

    def _flag(self, which):
        near = [clip(step - self.usual, -4, 4) + 4 for step in self.last]
        lag = clip(self.late + 32 >> 6, -32, 32) + 32
        contexts = (near[0], near[1]), (near[0], min(self.run, 15)), lag
        models = [table.setdefault((c, which), [32768, 0])
                  for table, c in zip(self.tables, contexts)]
        return decide_mixed(self.decoder, models, self.weights, 3 * which, 20, 255)

    def _deviation(self):
        if self._flag(0):
            return 0
        negative = self._flag(1)
        size = 1
        while size <= 12 and self._flag((14 if negative else 2) + size - 1):
            size += 1
        if size > 12:
            size += abs(self.rest.next())
        return -size if negative else size

    def next(self):
        step = self.usual + self._deviation()
        self.run = self.run + 1 if step == self.last[0] else 0
        self.last = [step, self.last[0]]
        late = self.late - divide(self.late, 8) + self.pace - 256 * step
        self.late = clip(late, -(1 << 20), 1 << 20)
        return step


class Rays:
    """The compact_rays chunk of an image of rows x columns."""

    def __init__(self, payload, rows, columns):
        reader = Reader(payload)
        flags = reader.u8()
        if flags & ~15:
            raise Unsupported("compact_rays: flags of a later version")
        frozen, moved, full, has_unit = (bool(flags >> b & 1) for b in range(4))
        _need(moved or not full, "flags")
        self.table = reader.varint() if frozen else 0
        self.unit = 0
        if frozen:
            if self.table not in beam_tables():
                raise Unsupported("compact_rays: an unknown beam table")
            self.slots, unit, beams = beam_tables()[self.table]
            _need(len(beams) == rows, "rows of the beam table")
            if has_unit:
                self.unit = unit
        else:
            self.slots = reader.varint()
            _need(1 <= self.slots <= 1 << 22, "slots")
            if has_unit:
                self.unit = reader.varint()
        _need(not has_unit or 1 << 32 <= self.unit <= 1 << 56, "range unit")
        coded = payload[reader.at:]
        decoder = RangeDecoder(coded)
        if not frozen:
            beams = self._beams(decoder, rows)
        self.elevation = [beam[0] for beam in beams]
        self.rays = [list(beam[1:]) for beam in beams]
        self._firings(decoder, columns)
        self._motion(decoder, 6 if full else 2 if moved else 0)
        _need(not decoder.exhausted and decoder.read >= len(coded), "size")
        heights = [ray[1] for ray in self.rays]
        self.centre = sum(heights) // rows

    @classmethod
    def times(cls, payload, before, columns):
        """The rays of a scan that has its own firings and motion only."""
        rays = cls.__new__(cls)
        for name in ("table", "unit", "slots", "elevation", "rays", "centre"):
            setattr(rays, name, getattr(before, name))
        flags = payload[0]
        if flags & ~6:
            raise Unsupported("compact_rays: flags of a later version")
        _need(flags != 4, "flags")
        decoder = RangeDecoder(payload[1:])
        rays._firings(decoder, columns)
        rays._motion(decoder, 6 if flags & 4 else 2 if flags & 2 else 0)
        _need(not decoder.exhausted and decoder.read >= len(payload) - 1, "size")
        return rays

    @staticmethod
    def _beams(decoder, rows):
        columns = [sequence(decoder, rows, True, 1 << 30)]
        for most in ((1 << 31) - 1, 1 << 22, 1 << 22, 1 << 22):
            period = 1 + sum(decoder.plain() << b for b in (2, 1, 0))
            values = sequence(decoder, rows, False, most)
            order = [row for first in range(period) for row in range(first, rows, period)]
            columns.append([value for _, value in sorted(zip(order, values))])
        return list(zip(*columns))

    def _firings(self, decoder, columns):
        _need(columns <= self.slots, "more firings than slots")
        steps = _Steps(decoder, self.slots, columns)
        self.firings, last = [], -1
        for _ in range(columns):
            step = steps.next()
            _need(not decoder.exhausted and 1 <= step < self.slots - last, "firings")
            last += step
            self.firings.append(last)

    def _motion(self, decoder, parts):
        """turn, move, turn2, move2, rigid_turn, rigid_move."""
        self.motion = [[0, 0, 0] for _ in range(6)]
        if not parts:
            return
        shifts = [sum(decoder.plain() << b for b in range(4, -1, -1)) for _ in range(2)]
        _need(max(shifts) <= 24, "shift of the motion")
        numbers = Numbers(decoder)
        for part in range(parts):
            self.motion[part] = [numbers.next() << shifts[part % 2] for _ in range(3)]
            _need(max(map(abs, self.motion[part])) <= 1 << 30, "motion")
        _need(self.moves, "no motion")

    @property
    def moves(self):
        return any(map(any, self.motion))

    def encoder_angle(self, firing):
        return ((1 << 31) + (self.firings[firing] << 32) // self.slots) % ONE_TURN

    def shift(self, row):
        """Columns that the firings of a row are moved by."""
        return _rounded(self.rays[row][0] * len(self.firings), 32)

    def azimuth(self, row, column):
        firing = (column - self.shift(row)) % len(self.firings)
        return (self.encoder_angle(firing) + self.rays[row][0]) % ONE_TURN

    def origin(self, row, column):
        """Of a cell, beside the field's centre, Q16."""
        _, height, lateral, _ = self.rays[row]
        sine, cosine = sin_cos(self.azimuth(row, column))
        return (-_rounded(lateral * sine, 30), _rounded(lateral * cosine, 30), height - self.centre)

    def point(self, row, column, range_):
        """x, y, z in units of 2^-36 m."""
        _, height, lateral, phase = self.rays[row]
        azimuth = self.azimuth(row, column)
        sin_e, cos_e = sin_cos(self.elevation[row])
        sin_a, cos_a = sin_cos(azimuth)
        t = range_ << 16
        if self.unit:
            t = _rounded(_nearest(range_ << 32, self.unit) * self.unit, 16)
        t += phase << 16
        x = _rounded(mulshift(t, _rounded(cos_e * cos_a, 30), 16) - lateral * sin_a, 10)
        y = _rounded(mulshift(t, _rounded(cos_e * sin_a, 30), 16) + lateral * cos_a, 10)
        z = _rounded(mulshift(t, sin_e, 16), 10) + (height << 20)
        p = _limited((x, y, z))
        if not self.moves:
            return p
        u = mulshift(t, cos_e, 46)
        return self._moved(p, signed_angle(azimuth + _arc(lateral, u)))

    def _moved(self, p, z):
        turn, move, turn2, move2, rigid_turn, rigid_move = self.motion
        z2 = z * z >> 32

        def at(once, twice, bits):
            return [_rounded(a * z + b * z2, bits) for a, b in zip(once, twice)]
        p = _limited(_sum(_turned(at(turn, turn2, 32), p), at(move, move2, 12)))
        if any(rigid_turn):
            p = _turned(rigid_turn, p)
        return _limited(_sum(p, [value << 20 for value in rigid_move]))


def _nearest(a, b):
    """a / b, rounded to the nearest integer, halves up."""
    return (2 * a + b) // (2 * b)


def _sum(a, b):
    return tuple(x + y for x, y in zip(a, b))


def _limited(p):
    return tuple(clip(value, -FARTHEST, FARTHEST) for value in p)


def _arc(lateral, u):
    """The arc tangent of lateral / u as a binary angle."""
    half = 1 << 29
    if u > 0:
        x = clip((lateral << 30) // u, -half, half)
    else:
        x = half if lateral > 0 else -half if lateral < 0 else 0
    square = x * x >> 30
    s = 0
    for k in (7, 5, 3):
        s = square * ((1 << 30) // k - s) >> 30
    return _rounded((x - (x * s >> 30)) * 683565276, 30)


def _turned(w, p):
    q = p
    for k in range(10, 0, -1):
        inverse = (1 << 30) // k
        a, b, c = (_rounded(value * inverse, 30) for value in w)
        x, y, z = q
        cross = (mulshift(b, z, 30) - mulshift(c, y, 30), mulshift(c, x, 30) - mulshift(a, z, 30),
                 mulshift(a, y, 30) - mulshift(b, x, 30))
        q = _sum(p, cross)
    return q
