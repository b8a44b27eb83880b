# SPDX-License-Identifier: BSD-3-Clause
"""Residuals as decisions: shapes about guesses and adaptive tables, mixed."""
from entropy import learn, learn_weights, prior_models, prior_weights, squash, stretch, weighted
from integers import clip

NODES = 18
CONTEXTS = (24, 54, 64, 64, 196, 49)
ONE = 1 << 32


def _tails():
    tails, power = [], ONE
    for _ in range(386):
        tails.append((power << 31) // ((1 << 31) + power // 2))
        power = (power * 4162829762 + (1 << 31)) >> 32
    return tails


_TAIL = _tails()


def _f(x):
    """The share of the standard shape below x."""
    i, p = divmod(min(abs(x), 3072), 8)
    tail = (_TAIL[i] * (8 - p) + _TAIL[i + 1] * p) >> 3
    return tail if x < 0 else ONE - tail


def _share(ones, zeros):
    return ((ones + 256) << 16) // (ones + zeros + 512)


class _Shape:
    def __init__(self, level, guess, spread, step):
        self.centre = 2 * (guess - level)
        self.inverse = (1 << 33) // (spread * 45 // 64 + step // 8 + 1)

    def below(self, t):
        return _f(clip(t - self.centre, -(1 << 29), 1 << 29) * self.inverse >> 26)


class SymbolDecoder:
    """The models, and the decoding of one residual after the other."""

    def __init__(self, decoder):
        self.decoder = decoder
        self.starts = [NODES * sum(CONTEXTS[:t]) for t in range(6)]
        self.models = prior_models("residual", NODES * sum(CONTEXTS))
        self.weights = prior_weights("residual_mix", NODES * (6 + 9) * 11, 65536 * 5 // 44)

    def decode(self, prediction, levels):
        return _Symbol(self, prediction, levels).decode()


class _Symbol:
    def __init__(self, tables, prediction, levels):
        self.tables = tables
        self.p = p = prediction
        self.step = step = levels.step
        self.level = level = levels.range(p.blend, 0)
        self.unit = p.spread[6] + step // 4 + 1
        self.activity = self._size(p.spread[6])
        self.grades = 3 * p.grade[0] + p.grade[1]
        self.shapes = [_Shape(level, guess, spread, step) for guess, spread in (
            (p.blend, p.spread[6]), (p.guess[2], p.spread[2]), (p.guess[4], p.spread[4]),
            (p.guess[5], p.spread[5]), (p.blend, 3 * p.spread[6]))]
        self.contexts = self._contexts(1)

    def _size(self, v):
        y = 1 + 4 * v // self.step
        n = y.bit_length()
        return min(2 * (n - 1) + ((y >> (n - 2)) & 1 if n > 1 else 0), 23)

    def _coarse(self, v):
        return self._size(abs(v)) // 3

    def _side(self, k, sign):
        t = sign * (self.p.guess[k] - self.level)
        a, unit = abs(t), self.unit
        m = 0 if 4 * a < unit else 1 if a < unit else 2 if a < 3 * unit else 3
        return 3 - m if t < 0 else 3 + m

    def _contexts(self, sign):
        p, coarse = self.p, self._coarse
        return (self.activity,
                self.activity // 4 * 9 + self.grades,
                coarse(p.error_of(0)) * 8 + coarse(p.error_of(1)),
                coarse(p.guess[0] - self.level) * 8 + coarse(p.guess[5] - p.guess[1]),
                min(self.activity // 6, 3) * 49 + self._side(5, sign) * 7 + self._side(4, sign),
                self._side(0, sign) * 7 + self._side(2, sign))

    def _decide(self, node, shares):
        tables = self.tables
        models = [tables.models[start + node * count + context] for start, count, context in
                  zip(tables.starts, CONTEXTS, self.contexts)]
        inputs = [stretch(p) for p in shares] + [stretch(model[0]) for model in models]
        starts = ((6 * node + min(self.activity // 3, 5)) * 11,
                  (6 * NODES + 9 * node + self.grades) * 11)
        sums = [weighted(tables.weights, start, inputs) for start in starts]
        bit = tables.decoder.decode(squash(sum(sums) >> 1))
        for start, total in zip(starts, sums):
            error = (65536 if bit else 0) - squash(total)
            learn_weights(tables.weights, start, inputs, error, 2)
        for model in models:
            learn(model, bit, 255)
        return bit

    def decode(self):
        less = [shape.below(-self.step) for shape in self.shapes]
        more = [ONE - shape.below(self.step) for shape in self.shapes]
        if self._decide(0, [_share(ONE - min(ONE, a + b), a + b) for a, b in zip(less, more)]):
            return 0
        self.negative = self._decide(1, [_share(a, b) for a, b in zip(less, more)])
        self.contexts = self._contexts(-1 if self.negative else 1)
        self.low = [ONE - a for a in (less if self.negative else more)]
        self.high = [ONE] * 5
        size = self._magnitude() + 1
        return -size if self.negative else size

    def _magnitude(self):
        bits = 0
        while bits < 30 and self._split(1 << bits, 2 + min(bits, 9)):
            bits += 1
        value = 1 << (bits - 1) if bits > 0 else 0
        for place in range(bits - 2, -1, -1):
            node = 12 + min(bits - 2, 4) if place == bits - 2 else 17
            if self._split(value + (1 << place), node):
                value += 1 << place
        return value

    def _split(self, m, node):
        """Is |q| greater than m?"""
        bound = (2 * m + 1) * self.step
        middle = []
        for shape, low, high in zip(self.shapes, self.low, self.high):
            below = ONE - shape.below(-bound) if self.negative else shape.below(bound)
            middle.append(clip(below, low, high))
        bit = self._decide(node, [_share(high - mid, mid - low)
                                  for low, mid, high in zip(self.low, middle, self.high)])
        if bit:
            self.low = middle
        else:
            self.high = middle
        return bit
