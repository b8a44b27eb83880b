# SPDX-License-Identifier: BSD-3-Clause
"""The chunk `directions`."""
from entropy import RangeDecoder
from integers import clip
from points import Invalid
from signed_integers import IntegerDecoder, half_octave


def div(a, b):
    return (2 * a + b) // (2 * b)


class OffsetDecoder:
    def __init__(self, decoder, columns):
        self.decoder = decoder
        self.cell = (1 << 32) // max(columns, 1)
        self.coders = [IntegerDecoder(3) for _ in range(2)]
        self.misses = [[0] * 4 for _ in range(2)]
        self.best = [0, 0]
        self.last = [0, 0]

    def _wrap(self, axis, x):
        return x - self.cell * div(x, self.cell) if axis == 0 else x

    def offset(self, axis, left, second, above, above_left, s):
        guesses = (left, self._wrap(axis, 2 * left - second),
                   self._wrap(axis, left + above - above_left), above)
        misses = self.misses[axis]
        best = guesses[misses.index(min(misses))]
        base = div(best, s)
        part = 8 * clip(best - base * s + s // 2, 0, s - 1) // s
        error = min(half_octave(self.best[axis] // s >> 4), 39)

        def beside(x):
            return clip(div(x, s) - base, -2, 2) + 2

        p, q = beside(guesses[2]), beside(guesses[0])
        contexts = (8 * error + part, 40 * (25 * p + 5 * q + beside(guesses[3])) + error,
                    12 * (12 * error + self.last[axis]) + self.last[1 - axis])
        n = self.coders[axis].decode(self.decoder, contexts, 5 * (5 * part + p) + q)
        turn = 1 << 32
        offset = clip(clip(base + clip(n, -turn, turn), -turn, turn) * s, -1 << 31, (1 << 31) - 1)
        self.best[axis] += (256 * abs(best - offset) - self.best[axis] + 4) >> 3
        for j, g in enumerate(guesses):
            misses[j] += (256 * abs(g - offset) - misses[j] + 4) >> 3
        self.last[axis] = min(half_octave(abs(n)), 11)
        return offset


def decode_directions(payload, rows, columns, occupied, ranges):
    """[(across, up)] of the occupied cells; `occupied` row by row, `ranges` of those cells."""
    at, shift, step = 0, 0, 0
    while True:
        step |= (payload[at] & 127) << shift
        at, shift = at + 1, shift + 7
        if payload[at - 1] < 128:
            break
    if not 0 < step <= 1 << 30:
        raise Invalid("step")
    decoder = RangeDecoder(payload[at:])
    state, above = OffsetDecoder(decoder, columns), [(0, 0)] * columns
    offsets, ranges = [], iter(ranges)
    for row in range(rows):
        left = second = above_left = (0, 0)
        for column in range(columns):
            if not occupied[row * columns + column]:
                continue
            s = max(1, 683565276 * step // next(ranges))
            offset = tuple(state.offset(a, left[a], second[a], above[column][a], above_left[a], s)
                           for a in range(2))
            if decoder.exhausted:
                raise Invalid("the stream ends early")
            left, second, above_left = offset, left, above[column]
            above[column] = offset
            offsets.append(offset)
    return offsets
