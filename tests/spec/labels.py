# SPDX-License-Identifier: BSD-3-Clause
"""Labels of a leaf with more than one layer: which layer each occupied cell is on."""


def decode_labels(field, block, layers):
    """cell -> layer."""
    labels = {}
    for cell in block.cells:
        labels[cell] = _Label(field, layers, labels, cell).decode() if len(layers) > 1 else 0
    return labels


class _Label:
    """One label to decode, with what it looks at."""

    def __init__(self, field, layers, labels, cell):
        self.field = field
        self.labels = labels
        self.row, self.column = cell
        self.count = len(layers)
        self.ranges = [field.window.range(layer, *cell) for layer in layers]

    def at(self, up, right):
        """The layer of a cell, None if unknown."""
        cell = (self.row - up, self.column + right)
        if cell in self.labels:
            return self.labels[cell]
        known = self.field.known.get(cell)
        if known is None:
            return None
        errors = [abs(known.range - r) for r in self.ranges]
        return errors.index(min(errors))

    def on(self, cell, layer):
        layer_there = self.at(*cell)
        return 2 if layer_there is None else 1 if layer_there == layer else 0

    def chain(self, first, cells):
        """How many of the cells are on `first` before one that is not."""
        on = [self.on(cell, first) == 1 for cell in cells]
        return (*on, False).index(False)

    def gap(self, first):
        others = [r for k, r in enumerate(self.ranges) if k != first]
        d = min(abs(r - self.ranges[first]) for r in others)
        bound = self.field.window.step // 8
        gap = 0
        while gap < 7 and d > bound:
            bound = 2 * bound + 1
            gap += 1
        return gap

    def nearer(self, first):
        nearer = [r < self.ranges[first] for k, r in enumerate(self.ranges) if k != first]
        return 2 if not any(nearer) else 0 if all(nearer) else 1

    def about(self, layer):
        return (self.row, self.column), self.ranges, layer

    def decode(self):
        W, N, NW, NE, WW, NN = (0, -1), (1, 0), (1, -1), (1, 1), (0, -2), (2, 0)
        first = next((a for a in map(lambda c: self.at(*c), (W, N, NW, NE)) if a is not None), 0)
        second = next((a for a in map(lambda c: self.at(*c), (N, NE, NW))
                       if a is not None and a != first), None)

        def pattern_of(layer, cells):
            a, b, c = (self.on(cell, layer) for cell in cells)
            return 9 * a + 3 * b + c
        pattern = pattern_of(first, (NW, NE, N))
        wide = pattern_of(first, (WW, NN, W))
        run = self.chain(first, ((0, -2), (0, -4), (0, -8)))
        rise = self.chain(first, ((1, 0), (3, 0), (7, 0)))
        gap, nearer = self.gap(first), self.nearer(first)
        x = self.count - 2
        known = 0 if self.at(*W) is None else 1
        decide = self.field.decide
        if decide("label_first", (3 * (2 * pattern + known) + x,
                                  27 * (3 * min(gap, 5) + nearer) + pattern, 27 * pattern + wide,
                                  3 * (4 * run + rise) + nearer), 3 * x + self.on(W, first),
                  self.about(first)):
            return first
        if self.count == 2:
            return 1 - first
        left = self.count - 1
        if second is not None:
            pattern2 = pattern_of(second, (NW, NE, N))
            if decide("label_second", (3 * pattern2 + x, 2 * pattern2 + x - 1,
                                       3 * pattern + nearer, 4 * (3 * gap + nearer) + run), x,
                      self.about(second)):
                return second
            left -= 1
        for k in range(self.count):
            if k in (first, second):
                continue
            if left == 1:
                return k
            a = 4 * (2 * x + left - 2) + k
            if decide("label_rest", (a, a, nearer, a), 0, self.about(k)):
                return k
            left -= 1
        raise AssertionError("no layer is left")
