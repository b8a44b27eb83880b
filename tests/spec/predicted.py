# SPDX-License-Identifier: BSD-3-Clause
"""Predicted scans: what the scan before makes expect, and a field and a mask that are told by it."""
from container import Corrupt, Reader, Unsupported, crc32c
from entropy import RangeDecoder, decide_mixed, prior_models, prior_weights
from field import KINDS, Block, Field
from integers import ONE_TURN, clip, divide, isqrt, mulshift, sin_cos
from mask import MaskDecoder
from rays import Rays, _turned
from scan import PARAMETERS, RAYS, SENSOR, Parameters, Scan
from surface import RayWindow, Surface, Window, range_of, with_functions

PREDICTION = 0x17
LEVELS = 8
MOST_PLACE, MOST_PLANE = 1 << 28, 1 << 38


def _unfold(x):
    return -(x >> 1) - 1 if x & 1 else x >> 1


class Header:
    """The compact_prediction chunk."""

    def __init__(self, payload):
        reader = Reader(payload)
        flags = reader.u8()
        if flags & ~7:
            raise Unsupported("compact_prediction: flags of a later version")
        moved, self.same_rows, self.same_firings = (bool(flags >> b & 1) for b in range(3))
        self.reference = reader.u8() | reader.u8() << 8
        self.turn = [_unfold(reader.varint()) for _ in range(3)] if moved else [0] * 3
        self.move = [_unfold(reader.varint()) for _ in range(3)] if moved else [0] * 3
        reader.end()
        if (self.same_firings and not self.same_rows or max(map(abs, self.turn)) > 1 << 21
                or max(map(abs, self.move)) > 1 << 22):
            raise Corrupt("compact_prediction")


def fingerprint(scan):
    data = b"".join(r.to_bytes(4, "little") for row in scan.range for r in row)
    return crc32c(data) & 0xFFFF


class Sights:
    """Where the cells of a scan look: section 2."""

    def __init__(self, scan):
        p = scan.parameters
        self.scan = scan
        if scan.rays:
            self.window = RayWindow(scan.rays, 0, 0, p.rows, p.columns, p.step)
        else:
            self.window = Window(scan.table.elevation, p.turn_columns, p.first_column, p.columns,
                                 p.step)
        self.direction = self.window.direction

    def origin(self, row, column):
        if self.scan.rays:
            return self.scan.rays.origin(row, column)
        return 0, 0, self.scan.heights[row]


def plane_range(plane, sights, row, column):
    d, o = sights.direction(row, column), sights.origin(row, column)
    share = (1 << 30) - (sum(n * x for n, x in zip(plane, o)) >> 16)
    return range_of(sum(n * x for n, x in zip(plane, d)) >> 22, share)


def _facing(q):
    length = clip(isqrt(sum(x * x for x in q)), 4096, 1 << 27)
    return tuple(((1 << 46) // length * divide(x << 14, length)) >> 14 for x in q)


def _arc(t):
    x = (t - (1 << 29) << 30) // ((1 << 30) + t // 2)
    square, s = x * x >> 30, 0
    for k in (13, 11, 9, 7, 5, 3):
        s = square * ((1 << 30) // k - s) >> 30
    return 316933406 + ((x - (x * s >> 30)) * 683565276 >> 30)


def azimuth_of(x, y):
    a, b = abs(x), abs(y)
    if not a and not b:
        return 0
    c = _arc((b << 30) // a) if b <= a else (1 << 30) - _arc((a << 30) // b)
    if x < 0:
        c = (1 << 31) - c
    return (-c if y < 0 else c) % ONE_TURN


class Finder:
    """Which cell sees a place: section 3."""

    def __init__(self, scan):
        self.scan, p = scan, scan.parameters
        rows = []
        for k in range(p.rows):
            sine, cosine = sin_cos(scan.table.elevation[k])
            steep = 1 << 30
            slope = clip(divide(sine << 16, cosine), -steep, steep) if cosine > 0 else (
                steep if sine > 0 else -steep)
            height = (scan.rays.rays[k][1] - scan.rays.centre if scan.rays else scan.heights[k])
            rows.append((slope, height, k))
        self.rows = sorted(rows, key=lambda row: -row[0])
        self.positions = []
        if scan.rays:
            self.positions = [(position << 32) // scan.rays.slots for position in scan.rays.firings]

    def column(self, row, angle):
        p = self.scan.parameters
        f = (angle - (1 << 31)) % ONE_TURN
        if not self.positions:
            column = ((f * p.turn_columns + (1 << 31) >> 32) - p.first_column) % p.turn_columns
            return column if column < p.columns else None
        n = len(self.positions)
        after = next((i for i, b in enumerate(self.positions) if b >= f), 0)
        last = (after - 1) % n
        before = (f - self.positions[last]) % ONE_TURN
        behind = (self.positions[after] - f) % ONE_TURN
        if min(before, behind) > ONE_TURN // n:
            return None
        return ((after if behind < before else last) + self.scan.rays.shift(row)) % n

    def cell(self, q):
        level = isqrt(q[0] * q[0] + q[1] * q[1])
        if level < 4096:
            return None

        def height(i):
            return (level * self.rows[i][0] >> 16) + self.rows[i][1]
        low, high = 0, len(self.rows) - 1
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if height(middle) >= q[2] else (low, middle)
        near = [abs(height(i) - q[2]) for i in (low, high)]
        row = self.rows[high if near[1] < near[0] else low][2]
        gap = level // 32 if low == high else abs(height(low) - height(high))
        if 2 * min(near) > gap:
            return None
        angle = azimuth_of(q[0], q[1])
        if self.scan.rays:
            offset, _, lateral, _ = self.scan.rays.rays[row]
            angle -= offset + lateral * 683565276 // level
        column = self.column(row, angle % ONE_TURN)
        return None if column is None else (row, column)


class Prediction:
    """Section 4: source (a plane), expected range, level and was_there of the cells."""

    def __init__(self, header, reference, scan):
        p = scan.parameters
        self.rows, self.columns = p.rows, p.columns
        self.closed = p.columns == p.turn_columns
        self.sights = Sights(scan)
        one, w = 1 << 30, [x << 10 for x in header.turn]
        unit = [_turned(w, tuple(one if i == k else 0 for i in range(3))) for k in range(3)]
        self.matrix = [[unit[k][i] for k in range(3)] for i in range(3)]
        self.move = [x << 5 for x in header.move]
        self.source, self.range, self.level = {}, {}, {}
        self._splat(reference, Finder(scan))
        self._extend()
        self.there = {}
        if (reference.parameters.rows == p.rows
                and (reference.rays is None) == (scan.rays is None)):
            self._was_there(reference, scan)

    def _turned(self, p):
        return [sum(mulshift(m, x, 30) for m, x in zip(row, p)) for row in self.matrix]

    def _splat(self, reference, finder):
        sights, nearest = Sights(reference), {}
        for i, row in enumerate(reference.range):
            for j, r in enumerate(row):
                if not r:
                    continue
                r = clip(r - reference.offsets[i], 1 << 12, 1 << 27)
                o, d = sights.origin(i, j), sights.direction(i, j)
                p = [a + (r * b >> 22) for a, b in zip(o, d)]
                q = tuple(clip(a + b, -MOST_PLACE, MOST_PLACE)
                          for a, b in zip(self._turned(p), self.move))
                to = finder.cell(q)
                if to is None:
                    continue
                distance = isqrt(sum(x * x for x in q))
                if to not in nearest or distance < nearest[to][0]:
                    nearest[to] = distance, q, reference.planes[i, j]
        for cell in sorted(nearest):
            distance, q, before = nearest[cell]
            plane = self._plane(before, q)
            expected = plane_range(plane, self.sights, *cell)
            if 4 * expected < 3 * distance or 3 * expected > 4 * distance:
                plane = _facing(q)
                expected = plane_range(plane, self.sights, *cell)
            self.source[cell], self.range[cell], self.level[cell] = plane, expected, 0

    def _plane(self, before, q):
        n = self._turned(before)
        s = sum(mulshift(a, b, 16) for a, b in zip(n, q))
        if not 1 << 28 <= s <= 1 << 32:
            return _facing(q)
        share = (1 << 60) // s
        return tuple(clip(mulshift(x, share, 30), -MOST_PLANE, MOST_PLANE) for x in n)

    def _extend(self):
        edge = sorted(self.source)
        for level in range(1, LEVELS):
            taken = {}
            for cell in edge:
                i, j = cell
                for to in ((i, j - 1), (i, j + 1), (i - 1, j), (i + 1, j)):
                    if self.closed:
                        to = to[0], to[1] % self.columns
                    if (not 0 <= to[0] < self.rows or not 0 <= to[1] < self.columns
                            or to in self.source):
                        continue
                    if to not in taken or self.range[taken[to]] < self.range[cell]:
                        taken[to] = cell
            for to, cell in taken.items():
                self.source[to], self.level[to] = self.source[cell], level
                self.range[to] = plane_range(self.source[to], self.sights, *to)
            edge = sorted(taken)

    def _was_there(self, reference, scan):
        finder, p = Finder(reference), scan.parameters
        for i in range(self.rows):
            for j in range(self.columns):
                if scan.rays:
                    firing = (j - scan.rays.shift(i)) % len(scan.rays.firings)
                    angle = scan.rays.encoder_angle(firing)
                else:
                    angle = ((1 << 31) + ((p.first_column + j << 32) // p.turn_columns)) % ONE_TURN
                column = finder.column(i, angle)
                if column is not None and reference.range[i][column]:
                    self.there[i, j] = 1


class Guide:
    """What a segment sees of a prediction."""

    def __init__(self, prediction, row, column, before=None):
        """before: mask and field of the reference, if both scans are one segment."""
        self.p, self.row, self.column = prediction, row, column
        self.mask, self.field = before or (None, None)

    def _at(self, table, i, j, none):
        return table.get((self.row + i, self.column + j), none)

    def source(self, i, j):
        return self._at(self.p.source, i, j, None)

    def range(self, i, j):
        return self._at(self.p.range, i, j, 0)

    def level(self, i, j):
        return self._at(self.p.level, i, j, LEVELS)

    def there(self, i, j):
        return self._at(self.p.there, i, j, 0)


class Warped(Surface):
    """A layer on the warped field; `plane` is with the guiding cell's source."""
    added = (0, 0, 0)

    def over(self, plane):
        total = tuple(clip(a + b, -MOST_PLANE, MOST_PLANE) for a, b in zip(plane, self.added))
        return Surface(total, self.functions, self.patch, self.curves)


# kind: sizes of the fifth and sixth tables
MORE = {"split": (372, 180), "split_kind": (744, 120), "layer_count": (558, 90),
        "new_surface": (372, 240), "parent": (2604, 640), "function_count": (1440, 372),
        "range_zero": (60, 62), "range_sign": (10, 2), "range_class": (120, 144),
        "range_bits": (120, 24), "coefficient_zero": (960, 1488), "coefficient_sign": (48, 60),
        "coefficient_class": (1152, 720), "coefficient_bits": (96, 120), "label_first": (810, 90),
        "label_second": (405, 40), "label_rest": (120, 5)}
SIZES = {name: (*((84, 168, 420, 24) if name == "parent" else sizes), *MORE[name])
         for name, (sizes, _) in KINDS.items()}


class GuidedModels:
    def __init__(self, before=None):
        self.starts = {name: [0] * 6 for name in KINDS}
        models = sets = 0
        for table in (4, 0, 1, 2, 3, 5):
            for name, sizes in SIZES.items():
                self.starts[name][table] = models
                models += sizes[table]
        self.sets = {}
        for name, (_, count) in KINDS.items():
            self.sets[name] = sets
            sets += count
        if before:
            self.models = [list(model) for model in before.models]
            self.weights = list(before.weights)
            return
        self.models = prior_models("predicted_field", models)
        self.weights = prior_weights("predicted_field_mix", 6 * sets, 65536 * 5 // 24)


class GuidedField(Field):
    def __init__(self, decoder, window, occupied, root_log2, smallest_leaf, cut, guide):
        self.guide = guide
        self.guided = GuidedModels(getattr(guide.field, "guided", None))
        self.decoder = decoder
        super().__init__(decoder, window, occupied, root_log2, smallest_leaf, cut)

    def _new_block(self, row, column, h, w):
        block = Block(self, row, column, h, w)
        self.block, self.kind, self.used = block, 0, []
        if block.cells:
            self._guide(block)
        return block

    def _class(self, x):
        return sum(4 * x >= bound * self.window.step for bound in (1, 4, 16, 64))

    def _guide(self, b):
        guide, misses = self.guide, []
        for part in (1, 3):
            for cell in ((b.row + part * b.h // 4, b.column - 1),
                         (b.row - 1, b.column + part * b.w // 4)):
                known = self.known.get(cell)
                if known and guide.source(*cell):
                    misses.append(abs(known.range - guide.range(*cell)))
        b.trust = 1 + min(self._class(sum(misses) // len(misses)), 3) if misses else 0
        b.warp, b.guiding = 0, None
        middle = b.row + b.h // 2, b.column + b.w // 2
        cells = [cell for cell in b.cells if guide.source(*cell)]
        guiding = middle if guide.source(*middle) else cells[0] if cells else None
        if guiding is None:
            return
        plane = guide.source(*guiding)
        off = [abs(self.window.range(Surface(plane), *cell) - guide.range(*cell)) for cell in cells]
        flat = min(self._class(sum(off) // len(off)), 2) if off else 2
        sure = 1 if 4 * sum(guide.level(*cell) < 2 for cell in cells) >= 3 * b.returns else 0
        b.warp = 1 + 5 * (3 * sure + flat) + b.trust
        b.guiding = plane
        b.parents[:0] = [Warped(plane), Surface(plane)]

    def _more(self, name, c, weight_set, label):
        """The fifth and sixth contexts."""
        b = self.block
        w, t, from_ = b.warp, b.trust, self.kind
        a = c[0]
        if name == "split":
            return 31 * a + w, 3 * (5 * a + t) + b.filled
        if name in ("split_kind", "layer_count"):
            return 31 * a + w, 5 * a + t
        used = sum(1 << k for k in set(self.used))
        if name == "new_surface":
            return 31 * a + w, 4 * (5 * a + t) + used % 4
        if name == "parent":
            k = (a // 2 - len(b.parents) + 1) // 7
            return 31 * a + w, 2 * (16 * (5 * min(k, 3) + t) + used % 16) + a % 2
        if name == "function_count":
            return 5 * (4 * a + from_) + t, 31 * (4 * (weight_set // 2) + from_) + w
        if name == "range_zero":
            return 5 * a + t, 31 * (a % 2) + w
        if name == "range_sign":
            return 5 * a + t, a
        if name == "range_class":
            return 5 * a + t, 6 * a + b.size
        if name == "range_bits":
            return 5 * a + t, a
        if name == "coefficient_zero":
            return 5 * (4 * a + from_) + t, 31 * (4 * weight_set + from_) + w
        if name == "coefficient_sign":
            return 4 * a + from_, 5 * a + t
        if name == "coefficient_class":
            return 4 * a + from_, 5 * (24 * b.size + c[3]) + t
        if name == "coefficient_bits":
            return 4 * a + from_, 5 * a + t
        guess = self._guess(*label)
        if name == "label_first":
            return 5 * a + guess, 5 * (c[1] // 27) + guess
        if name == "label_second":
            return 5 * a + guess, 5 * (c[3] // 12) + guess
        return 5 * a + guess, guess

    def _guess(self, cell, ranges, layer):
        if not self.guide.source(*cell):
            return 0
        off = [abs(r - self.guide.range(*cell)) for r in ranges]
        nearest = off.index(min(off))
        others = min((x for k, x in enumerate(off) if k != nearest), default=1 << 40)
        return (1 if nearest == layer else 3) + (1 if 4 * off[nearest] <= others else 0)

    def decide(self, name, contexts, weight_set, label=None):
        contexts = (*contexts, *self._more(name, contexts, weight_set, label))
        assert all(0 <= c < size for c, size in zip(contexts, SIZES[name])), (name, contexts)
        g = self.guided
        models = [g.models[start + c] for start, c in zip(g.starts[name], contexts)]
        return decide_mixed(self.decoder, models, g.weights, 6 * (g.sets[name] + weight_set), 10,
                            127)

    parent_stride = 7

    def _parent(self, b, layers, late, used):
        self.used = used
        parent = super()._parent(b, layers, late, used)
        self.kind = 0 if parent is None else 1
        if parent is not None and b.guiding is not None and used[-1] < 2:
            self.kind = 2 + used[-1]
        return parent

    def _surface(self, plane, patch, f, q, step):
        if self.kind != 2:
            return super()._surface(plane, patch, f, q, step)
        own = with_functions((0, 0, 0), patch, f, q, step)
        warped = Warped(plane, f, patch, own.curves)
        warped.added = own.plane
        warped.plane = warped.over(plane).plane
        return warped


def _guided(window, guide):
    """A window that knows the planes of warped layers."""
    plain = window.range

    def in_cell(surface, row, column):
        if isinstance(surface, Warped) and guide.source(row, column):
            return surface.over(guide.source(row, column))
        return surface
    window.in_cell = in_cell
    window.range = lambda surface, row, column: plain(in_cell(surface, row, column), row, column)
    return window


class GuidedMask(MaskDecoder):
    models_of, more_cells, tables = 13, 24, ("predicted_mask", "predicted_mask_mix")

    def __init__(self, data, rows, columns, turn, cut, guide):
        self.guide, self.height = guide, rows
        super().__init__(data, rows, columns, turn, cut)

    def known_before(self):
        models, weights = super().known_before()
        before = self.guide.mask
        if isinstance(before, GuidedMask):
            return before.models, list(before.weights)
        return [*before.models, *models[len(before.models):]] if before else models, weights

    def _hint(self, what, i, j):
        if not 0 <= i < self.height:
            return 0
        j = j % self.columns if self.columns == self.turn else clip(j, 0, self.columns - 1)
        if what == "near":
            return 1 if self.guide.level(i, j) < 2 else 0
        return self.guide.there(i, j)

    def hints(self, i, j, around):
        """Further contexts, cells, and the set."""
        def bits(what, row, reach):
            value = 0
            for k in range(-reach, reach + 1):
                value = 2 * value + self._hint(what, i + row, j + k)
            return value
        n, na, nb = bits("near", 0, 3), bits("near", -1, 1), bits("near", 1, 1)
        t, ta, tb = bits("there", 0, 3), bits("there", -1, 1), bits("there", 1, 1)
        level = self.guide.level(i, j)
        far = level if level < 2 else 2 if level < 4 else 3
        left, here, after = around.left, around.here, around.next
        left3 = around.L[0] | around.L[1] << 1 | around.L[2] << 2
        above3 = around.A[14] << 2 | around.A[15] << 1 | around.A[16]

        def ones(x):
            return bin(x).count("1")
        wrong_t = ones(left3 ^ t >> 4) + ones(above3 ^ ta)
        wrong_n = ones(left3 ^ n >> 4) + ones(above3 ^ na)
        contexts = (
            (n >> 2 & 7) | na << 3 | nb << 6 | left << 9,
            (t >> 1 & 31) | (ta >> 1 & 1) << 5 | (tb >> 1 & 1) << 6 | left << 7 | here << 8
            | (n >> 3 & 1) << 9,
            far | (t >> 3 & 1) << 2 | min(wrong_t, 3) << 3 | min(wrong_n, 3) << 5 | left << 7
            | here << 8 | after << 9,
            (t >> 2 & 7) | far << 3 | (left ^ t >> 4 & 1) << 5 | (here ^ ta >> 1 & 1) << 6
            | left << 7 | here << 8 | (after ^ ta & 1) << 9,
            min(ones(n) + ones(na) + ones(nb), 15)
            | min((ones(t) + ones(ta) + ones(tb)) // 2, 7) << 4 | left << 7 | here << 8
            | (t >> 3 & 1) << 9)
        packed = n | t << 7 | na << 14 | nb << 17 | ta << 20 | (tb >> 1 & 1) << 23
        chosen = far | (t >> 3 & 1) << 2 | left << 3 | here << 4 | (n >> 2 & 1) << 5
        return contexts, [packed >> k & 1 for k in range(24)], (128 + chosen,)


class PredictedScan(Scan):
    """Decodes on construction, from the decoded scan before."""

    def __init__(self, data, reference, **options):
        self.reference = reference
        super().__init__(data, **options)

    def _header(self, chunks):
        found = {chunk.kind: chunk.payload for chunk in chunks if chunk.whole}
        self.prediction_header = head = Header(found[PREDICTION])
        before = self.reference
        if head.reference != fingerprint(before):
            raise Corrupt("another reference")
        if not head.same_rows:
            super()._header(chunks)
        else:
            self._take_rows(found, head, before)
        self.prediction = Prediction(head, before, self)

    def _take_rows(self, found, head, before):
        self.parameters = p = Parameters(found[PARAMETERS])
        if SENSOR in found or p.rows != before.parameters.rows:
            raise Corrupt("rows")
        self.table, self.heights, self.offsets = before.table, before.heights, before.offsets
        self.rays = before.rays
        if head.same_firings:
            if RAYS in found or p.columns != before.parameters.columns:
                raise Corrupt("firings")
        elif before.rays:
            self.rays = Rays.times(found[RAYS], before.rays, p.columns)

    def _guide(self, place):
        before = self.reference
        whole = self._count() == before._count() == 1
        return Guide(self.prediction, place[0], place[1],
                     (before.last_mask, before.last_field) if whole else None)

    def _mask(self, chunk, place):
        return GuidedMask(chunk.payload, place[2], place[3], self.parameters.turn_columns,
                          not chunk.whole, self._guide(place))

    def _field(self, chunk, window, mask, place):
        p, guide = self.parameters, self._guide(place)
        return GuidedField(RangeDecoder(chunk.payload), _guided(window, guide), mask.rows,
                           p.root_log2, p.smallest_leaf, not chunk.whole, guide)
