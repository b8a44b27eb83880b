# SPDX-License-Identifier: BSD-3-Clause
"""The field chunk of one segment: partition, layers, coefficients."""
from entropy import decide_mixed, prior_models, prior_weights
from integers import clip, mulshift
from labels import decode_labels
from surface import FUNCTIONS, Patch, Shape, Surface, facing, range_of, step_40, with_functions

# kind: sizes of its four tables, sets of weights
KINDS = {
    "split": ((12, 192, 144, 240), 12),
    "split_kind": ((24, 216, 72, 2), 2),
    "layer_count": ((18, 288, 270, 54), 3),
    "new_surface": ((12, 240, 72, 192), 2),
    "parent": ((72, 144, 360, 24), 6),
    "function_count": ((72, 288, 288, 216), 6),
    "range_zero": ((12, 48, 4, 5), 1),
    "range_sign": ((2, 4, 2, 5), 1),
    "range_class": ((24, 96, 48, 24), 1),
    "range_bits": ((24, 48, 48, 24), 1),
    "coefficient_zero": ((48, 144, 288, 192), 12),
    "coefficient_sign": ((12, 36, 24, 12), 1),
    "coefficient_class": ((288, 432, 576, 24), 2),
    "coefficient_bits": ((24, 48, 144, 24), 1),
    "label_first": ((162, 486, 729, 48), 9),
    "label_second": ((81, 54, 81, 96), 3),
    "label_rest": ((24, 24, 3, 24), 1),
}


class FieldModels:
    """Models and weights of all kinds of decisions."""

    def __init__(self, decoder):
        self.decoder = decoder
        self.kinds = {}
        models = sets = 0
        for name, (sizes, weight_sets) in KINDS.items():
            starts = [models + sum(sizes[:t]) for t in range(4)]
            self.kinds[name] = (starts, sizes, sets, weight_sets)
            models += sum(sizes)
            sets += weight_sets
        self.models = prior_models("field", models)
        self.weights = prior_weights("field_mix", 4 * sets, 65536 * 5 // 16)

    def decide(self, name, contexts, weight_set, _label=None):
        starts, sizes, first_set, sets = self.kinds[name]
        assert all(0 <= c < size for c, size in zip(contexts, sizes)) and 0 <= weight_set < sets
        models = [self.models[start + c] for start, c in zip(starts, contexts)]
        return decide_mixed(self.decoder, models, self.weights, 4 * (first_set + weight_set),
                            10, 127)

    def magnitude(self, class_decision, top_decision):
        t = 0
        while t < 21 and class_decision(t):
            t += 1
        if t < 2:
            return t
        m = 1
        for i in range(t - 2, -1, -1):
            m = 2 * m + (top_decision(t) if i == t - 2 else self.decoder.plain())
        return m


class Known:
    """What is remembered of a decoded cell."""

    def __init__(self, surface, number, range_, layers, cells, leaf):
        self.surface = surface
        self.number = number
        self.range = range_
        self.depth = min(layers - 1, 2) + 1
        self.cells = cells
        self.leaf = leaf


class Block:
    """A block with what its decisions look at."""

    def __init__(self, field, row, column, h, w):
        self.row, self.column, self.h, self.w = row, column, h, w
        self.n = n = h * w
        self.cells = [(r, c) for r in range(row, row + h) for c in range(column, column + w)
                      if field.occupied[r][c]]
        self.returns = len(self.cells)
        if not self.cells:
            return
        self.size = sum(n > bound for bound in (4, 8, 16, 64, 256))
        side = min(h, w)
        self.shape = (3 * sum(side < bound for bound in (32, 16, 8))
                      + (1 if w > h else 2 if w < h else 0))
        self.filled = 2 if 4 * self.returns >= 3 * n else 1 if 4 * self.returns >= n else 0
        self.few = sum(self.returns > bound for bound in (2, 6, 16))
        self.middle = field.window.direction(row + h // 2, column + w // 2)
        self.left_size, self.left_depth = self._beside(field, row + h // 2, column - 1)
        self.above_size, self.above_depth = self._beside(field, row - 1, column + w // 2)
        self._parents(field)
        self.spread = self._spread(field.window.step)

    def _beside(self, field, row, column):
        cell = field.known.get((row, column))
        if cell is None:
            return 0, 0
        size = 1 if cell.cells < self.n else 2 if cell.cells == self.n else 3
        return size, cell.depth

    def _parents(self, field):
        row, column, h, w = self.row, self.column, self.h, self.w
        m, l = row + h // 2, column + w // 2

        def run(r, c, dr, dc, k):
            cells = (field.known.get((r + i * dr, c + i * dc)) for i in range(k))
            return next((cell for cell in cells if cell), None)
        left = (run(m, column - 1, 1, 0, h - h // 2) or run(m, column - 1, -1, 0, h // 2 + 1)
                or run(m, column - 2, 0, -1, 3))
        above = (run(row - 1, l, 0, 1, w - w // 2) or run(row - 1, l, 0, -1, w // 2 + 1)
                 or run(row - 2, l, -1, 0, 2))
        others = (run(row - 1, column + w - 1, 0, 1, 4), run(row, column - 1, -1, 0, 3),
                  run(row + h - 1, column - 1, -1, 0, 2))
        self.parents = []
        for cell in (left, above, *others):
            if cell and cell.surface not in self.parents:
                self.parents.append(cell.surface)
        ranges = [cell.range for cell in (left, above) if cell]
        self.expected = sum(ranges) // len(ranges) if ranges else 983040

    def _spread(self, step):
        if len(self.parents) < 2:
            return 0
        ranges = [parent.plane_range(self.middle) for parent in self.parents]
        t = 4 * (max(ranges) - min(ranges))
        return sum(t >= bound * step for bound in (1, 4, 16, 64))


class Field:
    """Decodes on construction. `known`: cell -> Known, for every occupied cell, or, if not
    `complete`, for those of the roots that no missing byte could change."""

    parent_stride = 6

    def __init__(self, decoder, window, occupied, root_log2, smallest_leaf, cut=False):
        self.models = FieldModels(decoder)
        self.window = window
        self.occupied = occupied
        self.smallest_leaf = smallest_leaf
        self.known = {}
        self.leaves = []
        self.surfaces = 0
        self.shapes = {}
        self.complete = True
        root = 1 << root_log2
        for row in range(0, window.rows, root):
            for column in range(0, window.columns, root):
                before = (dict(self.known), len(self.leaves), self.surfaces)
                self._block(row, column, min(root, window.rows - row),
                            min(root, window.columns - column))
                if decoder.exhausted or (cut and decoder.read > len(decoder.data)):
                    self.known, leaves, self.surfaces = before
                    del self.leaves[leaves:]
                    self.complete = False
                    return

    def decide(self, name, contexts, weight_set, label=None):
        return self.models.decide(name, contexts, weight_set, label)

    def _new_block(self, row, column, h, w):
        return Block(self, row, column, h, w)

    def _block(self, row, column, h, w):
        block = self._new_block(row, column, h, w)
        if not block.cells:
            return
        split = self._split(block)
        h1, w1 = (h + 1) // 2, (w + 1) // 2
        if split == "leaf":
            self._leaf(block)
            return
        heights = [(row, h1), (row + h1, h - h1)] if split != "columns" else [(row, h)]
        widths = [(column, w1), (column + w1, w - w1)] if split != "rows" else [(column, w)]
        for r, height in heights:
            for c, width in widths:
                self._block(r, c, height, width)

    def _split(self, b):
        least = self.smallest_leaf
        quad = b.h == b.w and b.n // 4 >= least
        rows = b.h >= b.w and 1 < b.h <= 16 and b.n // 2 >= least
        columns = b.w >= b.h and 1 < b.w <= 16 and b.n // 2 >= least
        if not (quad or rows or columns):
            return "leaf"
        s = b.shape
        if not self.decide("split", (s, 16 * s + 4 * b.left_size + b.above_size,
                                     12 * s + 4 * b.filled + b.few,
                                     20 * s + 4 * b.spread + b.few), s):
            return "leaf"

        def kind(k):
            g = 12 * k + s
            depths = 3 * min(b.left_depth, 2) + min(b.above_depth, 2)
            return self.decide("split_kind", (g, 9 * g + depths, 3 * g + b.filled, k), k)
        if quad and (not (rows or columns) or kind(0)):
            return "quad"
        if rows and columns:
            return "rows" if kind(1) else "columns"
        return "rows" if rows else "columns"

    def _leaf(self, b):
        key = (b.row, b.h, b.w)
        if key not in self.shapes:
            self.shapes[key] = Shape(self.window, *key)
        patch = Patch(self.window, self.shapes[key], b.column, b.w)
        count = self._layer_count(b)
        layers, used = [], []
        for i in range(count):
            layers.append(self._layer(b, patch, count, i, used))
        labels = decode_labels(self, b, layers)
        number = len(self.leaves)
        for cell in b.cells:
            layer = labels[cell]
            surface = layers[layer]
            range_ = self.window.range(surface, *cell)
            self.known[cell] = Known(surface, self.surfaces + layer, range_, count, b.n, number)
        self.surfaces += count
        self.leaves.append(b)

    def _layer_count(self, b):
        most = min(4, max(b.returns // 2, 1))
        layers = 1
        while layers < most:
            a = 6 * (layers - 1) + b.size
            contexts = (a, 16 * a + 4 * b.left_depth + b.above_depth,
                        15 * a + 5 * b.filled + b.spread, 3 * a + b.filled)
            if not self.decide("layer_count", contexts, layers - 1):
                break
            layers += 1
        return layers

    def _layer(self, b, patch, layers, i, used):
        late = min(i, 1)
        parent = self._parent(b, layers, late, used)
        fresh = 1 if parent is None else 0
        f = self._function_count(b, layers, late, parent, fresh)
        step = self.window.step
        if fresh:
            steps = self._range_steps(b, late)
            r = b.expected + steps * max(mulshift(step, patch.shape.norm, 30), 1)
            r = clip(r, 1 << 12, 1 << 27)
            plane = facing(r, patch)
        else:
            r = parent.plane_range(b.middle)
            plane = parent.plane
        q = self._coefficients(b, f, fresh, late)
        return self._surface(plane, patch, f, q, step_40((1 << 46) // r, step))

    def _parent(self, b, layers, late, used):
        """The parent's surface, None for a new one."""
        count = len(b.parents)
        if count == 0:
            return None
        s = 2 * b.size + late
        contexts = (s, 20 * s + 5 * (min(count, 4) - 1) + b.spread,
                    6 * s + 2 * min(layers - 1, 2) + (1 if used else 0),
                    16 * s + 4 * b.left_depth + b.above_depth)
        if self.decide("new_surface", contexts, late):
            return None
        k = 0
        while k < count - 1:
            a = 2 * (self.parent_stride * k + count - 1) + late
            y = 1 if k in used else 0
            contexts = (a, 2 * a + y, 5 * a + b.spread,
                        2 * (3 * b.parents[k].functions + min(k, 2)) + y)
            if self.decide("parent", contexts, 2 * min(k, 2) + late):
                break
            k += 1
        used.append(k)
        return b.parents[k]

    def _surface(self, plane, patch, f, q, step):
        return with_functions(plane, patch, f, q, step)

    def _function_count(self, b, layers, late, parent, fresh):
        f0 = 0 if fresh else parent.functions
        f = fresh
        while f < 3:
            a = 2 * (6 * (2 * f + fresh) + b.size) + late
            contexts = (a, 4 * a + f0, 4 * a + b.few, 3 * a + min(layers - 1, 2))
            if not self.decide("function_count", contexts, 2 * f + fresh):
                break
            f += 1
        return f

    def _range_steps(self, b, late):
        s = 2 * b.size + late
        known = min(len(b.parents), 3)
        if not self.decide("range_zero", (s, 4 * s + known, known, b.spread), 0):
            return 0
        negative = self.decide("range_sign", (late, known, late, b.spread), 0)
        m = self.models.magnitude(
            lambda t: self.decide("range_class", (t, 4 * t + known, 2 * t + late, t), 0),
            lambda t: self.decide("range_bits", (t, 2 * t + negative, 2 * t + late, t), 0))
        size = min(m + 1, 1 << 24)
        return -size if negative else size

    def _coefficients(self, b, f, fresh, late):
        q = [0] * fresh
        energy = 0
        big = 1 if b.size > 2 else 0
        g = f - 1
        for k in range(fresh, FUNCTIONS[f]):
            base = k + 6 * fresh
            kind = 4 * base + 2 * big + late
            e = min(energy, 3)
            contexts = (kind, 3 * kind + g, 6 * kind + b.size, 4 * kind + e)
            if not self.decide("coefficient_zero", contexts, base):
                q.append(0)
                continue
            negative = self.decide("coefficient_sign", (base, 3 * base + g, 2 * base + big, base), 0)
            m = self.models.magnitude(
                lambda t: self.decide("coefficient_class",
                                      (24 * base + t, 24 * (6 * g + b.size) + t,
                                       24 * (4 * k + e) + t, t), fresh),
                lambda t: self.decide("coefficient_bits", (t, 2 * t + fresh, 6 * t + k, t), 0))
            size = min(m + 1, 1 << 20)
            q.append(-size if negative else size)
            energy += min(size, 8)
        return q
