# SPDX-License-Identifier: BSD-3-Clause
"""Levels of attributes: order and attributes, sections 4.3 and 4.4."""
from entropy import MOST, learn, squash, stretch
from integers import clip
from adaptive import model

CONTEXTS, INPUTS = 11, 16
FULL = 0xFFFFFFFF
TRUST = (0, 120, 205, 256)
START_WEIGHT, MOST_WEIGHT = 74898, 8388352
NEIGHBOURS = ((0, -1, 64), (0, -2, 38), (0, -3, 22), (0, -4, 16), (-1, 0, 51), (-1, -1, 32),
              (-1, 1, 32), (-1, -2, 19), (-1, 2, 19), (-2, 0, 26), (-2, -1, 16), (-2, 1, 16))


def half(x):
    n = (x + 1).bit_length() - 1
    return 2 * n + ((x + 1 >> n - 1) & 1 if n else 0)


def scatter(x):
    x = x * 0x9E3779B1 & FULL
    x ^= x >> 15
    x = x * 0x85EBCA6B & FULL
    return x ^ x >> 13


class Window:
    """What surrounds a record: as the table of section 4.3 has it."""

    def __init__(self, known, cell):
        self.near_left = self.near_above = 3
        self.row = self.range = self.shape = 0
        if cell is None:
            self._loose(known)
        else:
            self.known, self.cell, self.r = known, cell, known.range(*cell)
            self._cell(*cell)

    def _loose(self, known):
        last, before = known.loose
        self.left = 20 if last is None else last[0]
        self.above = self.above_left = self.left2 = self.left if before is None else before[0]
        self.mean16 = 8 * (self.left + self.above)
        self.spread = min(half(abs(self.left - self.above)) // 2, 7)
        self.misses = min(half(sum(level[1] for level in known.loose if level)), 7)

    def _cell(self, i, j):
        level = self.known.level
        left = next((k for k in (1, 2) if level(i, j - k) is not None), None)
        above = next((k for k in (1, 2) if level(i - k, j) is not None), None)
        self.left = level(i, j - left) if left else level(i - above, j) if above else 20
        self.above = level(i - above, j) if above else self.left
        if left:
            self.near_left = self._near(self.known.range(i, j - left))
        if above:
            self.near_above = self._near(self.known.range(i - above, j))
        corner, second = level(i - 1, j - 1), level(i, j - 2)
        self.above_left = self.above if corner is None else corner
        self.left2 = self.left if second is None else second
        self.row, self.range = i, half(self.r >> 14)
        self._mean(i, j)
        miss = self.known.miss
        s = (2 * miss(i, j - 1) + 2 * miss(i - 1, j) + miss(i - 1, j + 1)) // 2
        self.misses = min(5 * half(s) // 8, 7)
        self.shape = (4 * (36 * self._slope(i, j + 1) + 6 * self._slope(i, j - 1)
                           + self._slope(i + 1, j)) + self._near(self.known.range(i - 1, j)))

    def _near(self, x):
        d, u = abs(x - self.r), self.r // 50 + 3277
        return 0 if 10 * d < 3 * u else 1 if d < u else 2 if d < 4 * u else 3

    def _slope(self, k, column):
        x = self.known.range(k, column)
        if x == 0:
            return 0
        d, u = x - self.r, self.r // 256 + 656
        away = 0 if 2 * abs(d) < u else 1 if abs(d) < 2 * u else 2
        return 3 - away if d < 0 else 3 + away

    def _mean(self, i, j):
        total = weighted = squares = 0
        for rows, columns, weight in NEIGHBOURS:
            level = self.known.level(i + rows, j + columns)
            if level is None:
                continue
            apart = abs(self.known.range(i + rows, j + columns) - self.r)
            a = min(16 * apart // (self.r // 32 + 6554), 1023)
            w = 4096 * weight // (256 + a * a) + 1
            v = clip(16 * level + self.known.lift(i, i + rows), 0, 4080)
            total, weighted, squares = total + w, weighted + w * v, squares + w * v * v
        if total == 0:
            self.mean16, self.spread = 16 * self.left, 5
            return
        self.mean16 = weighted // total
        variance = max(squares // total - self.mean16 ** 2, 0)
        self.spread = min(half(variance >> 6) // 2, 7)


class Known:
    """Levels that have been decoded."""

    def __init__(self, grid):
        self.grid, self.levels, self.loose = grid, {}, [None, None]
        self.mean, self.count = [0] * grid.rows, [0] * grid.rows

    def level(self, i, j):
        return self.levels.get((i, j), (None, 0))[0]

    def miss(self, i, j):
        return self.levels.get((i, j), (None, 0))[1]

    def range(self, i, j):
        if (i, j) not in self.grid.record:
            return 0
        return 1 if self.grid.ranges is None else max(self.grid.ranges[i][j], 1)

    def lift(self, i, other):
        if i == other or min(self.count[i], self.count[other]) <= 50:
            return 0
        return self.mean[i] - self.mean[other] >> 4

    def add(self, cell, window, level):
        found = level, min(abs(level - window.mean16 // 16), 255)
        if cell is None:
            self.loose = [found, self.loose[0]]
            return
        self.levels[cell] = found
        i = cell[0]
        self.count[i] = min(self.count[i] + 1, 200)
        change = 256 * level - self.mean[i]
        self.mean[i] += abs(change) // self.count[i] * (1 if change >= 0 else -1)


class Shape:
    def __init__(self, guess, errors, number):
        self.guess, self.errors, self.number = guess, errors, number
        self.slope = 23265280 // (errors[number] + 1024)

    def below(self, v):
        return squash((16 * v - 8 - self.guess) * self.slope >> 8)

    def upper(self, low, middle, high):
        a, b, c = 0 if low == 0 else self.below(low), self.below(middle), self.below(high)
        return 2 * (((c - b + 4) << 15) // (c - a + 8))

    def learn(self, level):
        e = self.errors[self.number]
        self.errors[self.number] = e + (256 * abs(16 * level - self.guess) - e >> 6)


class Levels:
    """decode() gives the levels of a grid's records one after the other."""

    def __init__(self, decoder, bits, grid):
        self.decoder, self.bits = decoder, bits
        self.known = Known(grid)
        self.cells = iter([*grid.cells, *[None] * grid.loose])
        self.line_bits = clip(grid.records.bit_length() - 1, 4, 15)
        self.lines, self.weights = {}, {}
        self.errors = [[40960] * 64 for _ in range(4)]

    def decode(self):
        cell = next(self.cells)
        window = Window(self.known, cell)
        contexts, sets, shapes = self._contexts(window), self._sets(window), self._shapes(window)
        node = root = 1
        for q in reversed(range(self.bits)):
            if q in (self.bits - 1, 3):
                root = node
                lines = [self._line(k, x, root) for k, x in enumerate(contexts)]
            node = 2 * node + self._bit(lines, root, node, q, sets, shapes)
        level = node - (1 << self.bits)
        for shape in shapes:
            shape.learn(level)
        self.known.add(cell, window, level)
        return level

    @staticmethod
    def _contexts(w):
        mean = w.mean16 // 16
        gradient = clip(w.left + w.above - w.above_left, 0, 255)
        return (0, w.left + 256 * w.near_left, w.above + 256 * w.near_above,
                w.left + 256 * w.left2, gradient + 256 * w.spread, w.row << 10 | mean // 2,
                w.row << 10 | w.range | w.left // 8 << 6, w.row << 16 | w.range << 8 | w.left,
                w.row << 10 | w.shape, mean // 2 + (w.range << 7) + (w.spread << 13),
                w.shape + (mean // 4 << 10))

    @staticmethod
    def _sets(w):
        return w.spread, 16 * w.misses + 4 * w.near_left + w.near_above, w.range

    def _shapes(self, w):
        aims = ((w.mean16, 8 * w.spread + w.misses), (16 * w.left, 8 * w.near_left + w.misses),
                (16 * w.above, 8 * w.near_above + w.spread), (w.mean16, w.row % 64))
        return [Shape(guess, self.errors[k], number) for k, (guess, number) in enumerate(aims)]

    def _line(self, k, context, root):
        number = scatter(scatter(context + 1 & FULL) + 0x2545F491 * root & FULL)
        number >>= 32 - self.line_bits
        return self.lines.setdefault((k, number), [model() for _ in range(16)])

    def _bit(self, lines, root, node, q, sets, shapes):
        depth = node.bit_length() - root.bit_length()
        models = [line[(1 << depth) + node % (1 << depth)] for line in lines]
        x = [stretch(p) * TRUST[min(visits, 3)] >> 8 for p, visits in models]
        low = (node << q + 1) - (1 << self.bits)
        x += [stretch(shape.upper(low, low + (1 << q), low + (2 << q))) for shape in shapes]
        x.append(128)
        numbers = (0, 256 * sets[0] + node), (1, 8 * sets[1] + q), (2, 8 * sets[2] + q)
        rows = [self.weights.setdefault(n, [START_WEIGHT] * (INPUTS - 1) + [0]) for n in numbers]
        d = [clip((sum((w + 128 >> 8) * s for w, s in zip(row, x)) + 2048) >> 12, -MOST, MOST)
             for row in rows]
        bit = self.decoder.decode(squash((sum(d) * 21845 + 32768) >> 16))
        for row, total in zip(rows, d):
            e = (65536 if bit else 0) - squash(total)
            if abs(e) < 256:
                continue
            g = 12 * e >> 5
            row[:] = [clip(w + (g * s + 256 >> 9), -MOST_WEIGHT, MOST_WEIGHT)
                      for w, s in zip(row, x)]
        for pair in models:
            learn(pair, bit, 60)
        return bit
