# SPDX-License-Identifier: BSD-3-Clause
"""What the chunks `loose` and `corrections` share: numbers, their header, raw points."""
import math
import struct

from entropy import RangeDecoder, decide
from integers import clip
from signed_integers import wrap64

FLOAT32, FLOAT64 = 8, 9
STEPS, DECIMALS, RANKS32, RANKS64 = range(4)
_LARGEST = {FLOAT32: struct.unpack("<f", b"\xff\xff\x7f\x7f")[0],
            FLOAT64: struct.unpack("<d", b"\xff\xff\xff\xff\xff\xff\xef\x7f")[0]}
_LEAST = {FLOAT32: 2.0 ** -126, FLOAT64: 2.0 ** -1022}
_FORMS = {FLOAT32: ("<f", "<i", 31), FLOAT64: ("<d", "<q", 63)}


class Invalid(Exception):
    pass


def rounded(x, kind):
    """x in the precision of a type; Invalid if it is not finite there."""
    try:
        x = struct.unpack("<f", struct.pack("<f", x))[0] if kind == FLOAT32 else x
    except OverflowError:
        raise Invalid("too large for float32") from None
    if not math.isfinite(x):
        raise Invalid("not finite")
    return x


def rank(x, kind):
    real, integer, bits = _FORMS[kind]
    b = struct.unpack(integer, struct.pack(real, x))[0]
    return b if b >= 0 else b ^ ((1 << bits) - 1)


def of_rank(n, kind):
    real, integer, bits = _FORMS[kind]
    if not -1 << bits <= n < 1 << bits:
        raise Invalid("no rank")
    x = struct.unpack(real, struct.pack(integer, n if n >= 0 else n ^ ((1 << bits) - 1)))[0]
    if not math.isfinite(x):
        raise Invalid("not the rank of a finite value")
    return x


def _bounded(x):
    return 2.0 ** 58 if x > 2.0 ** 58 else x if x > -(2.0 ** 58) else -(2.0 ** 58)


def _nearest(x):
    return math.floor(_bounded(x) + 0.5)


class Numbers:
    def __init__(self, kind, coordinates, parameter):
        self.kind, self.type, self.parameter = kind, coordinates, parameter
        self.grid = kind in (STEPS, DECIMALS)
        self.ranks = FLOAT32 if kind == RANKS32 else FLOAT64
        if kind == STEPS:
            self.step = parameter
        else:
            self.step = float(10 ** parameter) if kind == DECIMALS else 2.0 ** parameter

    def value(self, n):
        if not self.grid:
            return rounded(of_rank(n, self.ranks), self.type)
        if abs(n) > 1 << 46:
            raise Invalid("no such number")
        return rounded(n * self.step if self.kind == STEPS else n / self.step, self.type)

    def _rank_of(self, x):
        most = _LARGEST[self.ranks]
        return rank(rounded(clip(x, -most, most), self.ranks), self.ranks)

    def number(self, x):
        return _nearest(self.position_of(x)) if self.grid else self._rank_of(x)

    def position_of(self, x):
        return _bounded(x * self.step if self.kind == DECIMALS else x / self.step)

    def position(self, n):
        return float(n) if self.grid else self.position_of(of_rank(n, self.ranks))

    def number_at(self, p):
        return _nearest(p) if self.grid else self._rank_of(p * self.step)

    def spacing(self, p):
        if self.grid:
            return 1.0
        v = clip(abs(p * self.step), _LEAST[self.ranks], _LARGEST[self.ranks])
        digits = 24 if self.ranks == FLOAT32 else 53
        return 2.0 ** clip(math.frexp(v)[1] - digits - self.parameter, -800, 60)


class PointStream:
    """The header, and the decoder of what follows it."""

    def __init__(self, payload):
        kind, coordinates, flag = payload[:3]
        if kind > RANKS64 or coordinates not in (FLOAT32, FLOAT64) or flag > 1:
            raise Invalid("unknown kind of coordinates")
        at, shift, self.count = 3, 0, 0
        while True:
            byte = payload[at]
            self.count |= (byte & 127) << shift
            at, shift = at + 1, shift + 7
            if byte < 128:
                break
        form = "<d" if kind == STEPS else "<h"
        parameter = struct.unpack_from(form, payload, at)[0]
        self.numbers = Numbers(kind, coordinates, parameter)
        self.decoder = RangeDecoder(payload[at + struct.calcsize(form):])
        self.some_raw = flag == 1
        self._models = [[32768, 0], [32768, 0]]
        self._raw = 0

    def raw(self):
        """The coordinates of the next point if it is raw, else None."""
        if not self.some_raw:
            return None
        self._raw = decide(self.decoder, self._models[self._raw], 255)
        if not self._raw:
            return None
        bits = 32 if self.numbers.type == FLOAT32 else 64
        point = []
        for _ in range(3):
            n = 0
            for _ in range(bits):
                n = 2 * n + self.decoder.plain()
            point.append(of_rank(n - (1 << bits) if n >> (bits - 1) else n, self.numbers.type))
        return point

    def check(self):
        if self.decoder.exhausted:
            raise Invalid("the stream ends early")


__all__ = ["FLOAT32", "FLOAT64", "Invalid", "Numbers", "PointStream", "STEPS", "rounded", "wrap64"]
