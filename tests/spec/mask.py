# SPDX-License-Identifier: BSD-3-Clause
"""The mask chunk of one segment: which cells hold a return."""
from entropy import MOST, RangeDecoder, learn, prior_models, squash, stretch, weight_words
from integers import clip

RUN = (0, 1, 2, 3, 4, 4, 5, 5, 5, 6, 6, 6, 6, 6, 6, 6, 7)
REACH = (0, 1, 2, 3, 4, 4, 4, 5, 5, 5, 5, 6, 6, 6, 6, 6, 7)
MODELS, CONTEXTS, SETS = 8, 1024, 128
MOST_WEIGHT = 8388352
# start from priors, visits at most, rate
WAYS = ((True, 255, 5), (True, 255, 14), (True, 6, 10), (False, 0, 10))


def _equal(cells):
    """How many of the cells 1.. equal cell 0, up to the first that does not."""
    n = 0
    while n + 1 < len(cells) and cells[n + 1] == cells[0]:
        n += 1
    return n


def _changes(cells):
    return sum(a != b for a, b in zip(cells, cells[1:]))


def _fields(*fields):
    """A context from (value, bit) pairs."""
    return sum(value << bit for value, bit in fields)


class _Around:
    """The cells around (i, j). A, S and T are indexed with k + 15, L and U with k - 1."""

    def __init__(self, mask, i, j):
        def row(r, low, high):
            return [mask.cell(r, j + k) for k in range(low, high + 1)]
        self.turn = mask.turn
        self.A, self.S, self.T = row(i - 1, -15, 16), row(i - 2, -15, 16), row(i - 3, -15, 16)
        self.L = [mask.rows[i][j - k] if j >= k else mask.cell(i - 1, j - k) for k in range(1, 33)]
        self.U = [mask.cell(i - k, j) for k in range(1, 33)]
        self.left, self.here, self.second = self.L[0], self.A[15], self.S[15]
        self.next, self.before = self.A[16], self.A[14]
        self.left_run, self.up_run = _equal(self.L[:17]), _equal(self.U[:17])
        self.above_reach = _equal(self.A[15:])
        self.above_changes = _changes(self.A[15 - 6:15 + 7])
        self.left_changes = _changes(self.L[:9])

    def contexts(self):
        A, S, T, L, U = self.A, self.S, self.T, self.L, self.U
        left, here, second = self.left, self.here, self.second
        second_reach = _equal(S[15:])
        differing = sum(A[15 + k] != S[15 + k] for k in range(-4, 5))
        beside = L[0] + A[14] + A[15] + A[16]
        near = L[1] + L[2] + A[13] + A[17] + A[18] + S[14] + S[15] + S[16]
        far = sum(S[10:14]) + sum(S[17:21]) + sum(T[12:19])
        return (
            _fields((RUN[self.left_run], 0), (left, 3), (RUN[self.up_run], 4), (here, 7),
                    (self.next, 8), (second, 9)),
            _fields((RUN[self.above_reach], 0), (here, 3), (RUN[self.left_run], 4), (left, 7),
                    (second, 8), (S[16], 9)),
            _fields((min(self.above_changes, 7), 0), (min(self.left_changes, 3), 3),
                    (min(differing, 7), 5), (left, 8), (here, 9)),
            _fields((S[18], 0), (S[17], 1), (S[16], 2), (S[15], 3), (S[14], 4), (S[13], 5),
                    (A[16], 6), (A[15], 7), (L[0], 8), (L[1], 9)),
            _fields((REACH[self.above_reach], 0), (REACH[second_reach], 3), (here, 6),
                    (second, 7), (left, 8), (min(self.left_run, 1), 9)),
            _fields((7 * sum(L) // 32, 0), (7 * sum(A) // 32, 3), (3 * sum(S) // 32, 6), (left, 8),
                    (here, 9)),
            _fields(*((U[k], k) for k in range(7)), (left, 7), (self.next, 8), (self.before, 9)),
            _fields((beside, 0), (near, 3), (min(far // 4, 3), 7), (left, 9)))

    def cells(self):
        return [*self.L[:8], *self.A[9:22][::-1], *self.S[11:20][::-1], *self.T[12:19][::-1],
                self.U[3], self.U[4], 1]

    def sets(self):
        scale = sum(self.turn >= bound for bound in (700, 1400, 2800))
        up_class = self.up_run if self.up_run < 2 else 2 if self.up_run < 5 else 3
        return (_fields((self.left, 0), (self.A[16], 1), (self.A[15], 2), (self.A[14], 3),
                        (self.second, 4)),
                32 + _fields((min(self.above_changes, 3), 0), (min(self.left_changes, 3), 2),
                             (self.left, 4), (self.here, 5)),
                96 + _fields((scale, 0), (up_class, 2), (self.here ^ self.left, 4)))


class MaskDecoder:
    """Decodes on construction: `rows`, lists of 0 and 1; the complete ones first, then zeros."""

    models_of, more_cells, tables = MODELS, 0, ("mask", "mask_mix")

    def __init__(self, data, rows, columns, turn, cut=False):
        self.columns, self.turn = columns, turn
        self.rows = []
        self.complete_rows = rows
        if rows == 0 or columns == 0:
            return
        self.decoder = RangeDecoder(data)
        self._start(2 * self.decoder.plain() + self.decoder.plain())
        for i in range(rows):
            self.rows.append([0] * columns)
            for j in range(columns):
                around = _Around(self, i, j)
                self.rows[i][j] = self._cell(around, *self.hints(i, j, around))
            if self.decoder.exhausted or (cut and self.decoder.read >= len(data)):
                self.complete_rows = i
                break
        self.rows = [*self.rows[:self.complete_rows],
                     *([0] * columns for _ in range(rows - self.complete_rows))]

    def hints(self, _i, _j, _around):
        """Further contexts, cells, and sets."""
        return (), [], ()

    def cell(self, row, column):
        if row < 0:
            return 0
        if self.columns == self.turn:
            return self.rows[row][column % self.columns]
        return self.rows[row][clip(column, 0, self.columns - 1)]

    def _start(self, way):
        priors, visits, self.rate = WAYS[way]
        if priors:
            models, self.weights = self.known_before()
            self.models = [[p, min(v, visits)] for p, v in models]
        else:
            self.models = [[32768, 0] for _ in range(self.models_of * CONTEXTS)]
            usual, more = (5 << 20) // (4 * self.models_of), self.models_of - MODELS
            sets = SETS + (64 if more else 0)
            self.weights = ([usual] * 8 + [0] * (40 + self.more_cells) + [usual] * more) * sets

    def known_before(self):
        """Models and weights."""
        return (prior_models(self.tables[0], self.models_of * CONTEXTS),
                [clip(256 * w, -MOST_WEIGHT, MOST_WEIGHT) for w in weight_words(self.tables[1])])

    def _cell(self, around, contexts, cells, sets):
        models = [self.models[CONTEXTS * m + c]
                  for m, c in enumerate((*around.contexts(), *contexts))]
        x = [stretch(model[0]) for model in models[:MODELS]]
        x += [128 if cell else -128 for cell in [*around.cells(), *cells]]
        x += [stretch(model[0]) for model in models[MODELS:]]
        starts = [len(x) * s for s in (*around.sets(), *sets)]
        d = [clip((sum((w + 128 >> 8) * s for w, s in zip(self.weights[start:start + len(x)], x))
                   + 2048) >> 12, -MOST, MOST) for start in starts]
        bit = self.decoder.decode(squash((sum(d) * ((65536 + len(d) // 2) // len(d)) + 32768) >> 16))
        for start, total in zip(starts, d):
            e = (65536 if bit else 0) - squash(total)
            if abs(e) < 256:
                continue
            g = e * self.rate >> 5
            for i, s in enumerate(x, start):
                w = self.weights[i] + ((g * s + 256) >> 9)
                self.weights[i] = clip(w, -MOST_WEIGHT, MOST_WEIGHT)
        for model in models:
            learn(model, bit, 255)
        return bit
