# SPDX-License-Identifier: BSD-3-Clause
"""The residual chunk of one segment: prediction of a cell's range, and learning from it."""
from entropy import RangeDecoder, prior_weights
from integers import clip, divide
from residual_symbol import SymbolDecoder

TOP = 1 << 30

# Neighbours W, N, NW, NE, WW, NN, WWW, NWW, NEE, NNW, NNE and their weights.
UP = (0, 1, 1, 1, 0, 2, 0, 1, 1, 2, 2)
RIGHT = (-1, 0, -1, 1, -2, 0, -3, -2, 2, -1, 1)
MEAN = (8, 8, 4, 4, 3, 3, 0, 0, 0, 0, 0)
ERROR = (4, 4, 2, 2, 2, 1, 1, 1, 1, 0, 0)
LEFT = (6, 0, 0, 0, 4, 0, 3, 0, 0, 0, 0)
ABOVE = (0, 6, 4, 4, 0, 2, 0, 2, 2, 1, 1)


class Levels:
    """The ranges that residuals can give."""

    def __init__(self, step, lattice):
        self.lattice = clip(lattice, 1 << 16, 1 << 40) if lattice else 0
        self.step = (self.lattice + 32768) >> 16 if lattice else clip(step, 1, 1 << 24)

    def range(self, blend, q):
        if not self.lattice:
            return clip(blend + q * self.step, 1, TOP)
        first = ((blend << 16) + self.lattice // 2) // self.lattice
        k = clip(first + q, 0, (1 << 46) // self.lattice + 1)
        return clip((k * self.lattice + 32768) >> 16, 1, TOP)


class Cell:
    """A decoded cell: surface, range, deviation from the field, errors of guesses and blend."""

    def __init__(self, surface, range_, field, error):
        self.surface = surface
        self.range = range_
        self.deviation = range_ - field
        self.error = error


class Prediction:
    """What is known of a cell before its residual."""

    def __init__(self, state, row, column, surface, field):
        self.field = clip(field, 1, TOP)
        self.near = [state.cells.get((row - up, column + right)) for up, right in zip(UP, RIGHT)]
        self.known = [i for i in range(11) if self.near[i]]
        self.same = [bool(cell) and cell.surface == surface for cell in self.near]
        self.grade = [0 if not self.near[i] else 2 if self.same[i] else 1 for i in range(4)]
        self.set = sum(1 << i for i in range(4) if self.grade[i] == 2)
        self._spreads(state)
        self._inputs(state)
        self._guesses()
        self._blend(state.levels.step)

    def error_of(self, i):
        return self.near[i].error[6] if self.near[i] else 0

    def _spreads(self, state):
        weight = 2 + sum(ERROR[i] for i in self.known)
        self.spread = []
        for k in range(7):
            top = 3 * state.usual[k] + state.levels.step
            total = sum(ERROR[i] * min(self.near[i].error[k], top) for i in self.known)
            self.spread.append((2 * state.usual[k] + total) // weight)

    def _inputs(self, state):
        d = [0] * 11
        for i in self.known:
            shift = (state.offset if UP[i] > 0 else 0) + (state.last_offset if UP[i] > 1 else 0)
            d[i] = clip(self.near[i].deviation + shift, -TOP, TOP)
        total, weights = 0, 24576
        for i in self.known:
            if MEAN[i]:
                trust = MEAN[i] * (6 if self.same[i] else 3)
                w = (trust << 10) * 42954916 // (42954916 + d[i] * d[i])
                total += w * d[i]
                weights += w
        self.centre = divide(total, weights)
        self.clip_at = 2 * self.spread[1] + state.levels.step
        self.x = [0] * 11
        for i in self.known:
            self.x[i] = clip(d[i] - self.centre, -self.clip_at, self.clip_at)
        self.left = self._weighted(LEFT)
        self.above = self._weighted(ABOVE)
        start = 11 * self.set
        total = sum(state.filter[start + i] * self.x[i] for i in range(11))
        self.filtered = self.centre + (total >> 16)

    def _weighted(self, weights):
        total = sum(weights[i] * self.x[i] for i in self.known)
        return self.centre + divide(total, 4 + sum(weights[i] for i in self.known))

    def _guesses(self):
        smooth = [clip(self.field + d, 1, TOP)
                  for d in (self.centre, self.filtered, self.left, self.above)]
        self.guess = [self.field, *smooth, self._texture()]

    def _texture(self):
        w, n, nw = self.near[:3]
        if not w and not n:
            return self.field
        if not w or not n:
            return (w or n).range
        if not nw:
            return (w.range + n.range) // 2
        return clip(w.range + n.range - nw.range, min(w.range, n.range), max(w.range, n.range))

    def _blend(self, step):
        s = [self.spread[k] + step // 4 + 1 for k in range(6)]
        least = min(s)
        total = weights = 0
        for k in (0, 2, 3, 4, 5):
            v = (least << 10) // s[k]
            v = v * v
            v = v * v >> 20
            v = v * v >> 20
            total += v * (self.guess[k] - self.guess[1])
            weights += v
        shift = divide(total, weights) if weights else 0
        self.blend = clip(self.guess[1] + shift, 1, TOP)


class ResidualDecoder:
    """Decodes on construction. `range`: cell -> range, of the cells in complete rows."""

    def __init__(self, data, rows, coded, step, lattice, cut=False):
        """`coded`: cell -> (surface number, field range), of the coded cells."""
        decoder = RangeDecoder(data)
        self.levels = Levels(step, lattice)
        self.symbols = SymbolDecoder(decoder)
        self.usual = [1024] * 7
        self.filter = prior_weights("residual_filter", 16 * 11, 0)
        self.offset = self.last_offset = self.count = 0
        self.cells = {}
        sure = 0
        for row in range(rows):
            self.last_offset, self.offset, self.count = self.offset, 0, 0
            for cell in sorted(cell for cell in coded if cell[0] == row):
                self._cell(cell, *coded[cell])
            if decoder.read < len(data):
                sure = row + 1
            if decoder.exhausted:
                break
        self.complete_rows = rows if not cut and not decoder.exhausted else sure
        self.range = {cell: known.range for cell, known in self.cells.items()
                      if cell[0] < self.complete_rows}

    def _cell(self, cell, surface, field):
        p = Prediction(self, *cell, surface, field)
        q = self.symbols.decode(p, self.levels)
        range_ = self.levels.range(p.blend, q)
        error = [min(abs(range_ - guess), 1 << 20) for guess in (*p.guess, p.blend)]
        self.cells[cell] = Cell(surface, range_, p.field, error)
        self._learn(p, self.cells[cell])

    def _learn(self, p, cell):
        for k in range(7):
            self.usual[k] += divide(cell.error[k] - self.usual[k], 64)
        e = clip(cell.deviation - p.filtered, -p.clip_at, p.clip_at)
        energy = 1 + p.clip_at * p.clip_at + sum(x * x for x in p.x)
        for i in range(11):
            w = self.filter[11 * p.set + i] + divide(e * p.x[i] * 4096, energy)
            self.filter[11 * p.set + i] = clip(w, -65536, 65536)
        if any(UP[i] > 0 for i in p.known):
            limit = 2 * p.spread[4] + self.levels.step
            o = clip(cell.deviation - p.above + self.offset, -limit, limit)
            self.count = min(self.count + 1, 64)
            self.offset += divide(o - self.offset, self.count + 4)
