# SPDX-License-Identifier: BSD-3-Clause
"""One tile of a surface map, from docs/format/curl-surface-tile-1.md."""
import struct

from entropy import RangeDecoder, decide_mixed

UNKNOWN, EMPTY = -1, -2
KINDS = {  # sizes of the five tables, mixes
    "occupied": ((1152, 1536, 162, 576, 384), 6), "split": ((54, 162, 384, 96, 72), 6),
    "new": ((24, 162, 72, 64, 18), 3), "candidate": ((18, 54, 54, 24, 2), 2),
    "axis": ((2, 12, 128, 2, 2), 2), "terms": ((24, 72, 96, 12, 72), 4),
    "curved": ((6, 12, 6, 18, 6), 1), "zero": ((48, 144, 8, 192, 8), 8),
    "sign": ((8, 48, 24, 8, 8), 1), "class": ((192, 1152, 192, 768, 24), 2),
    "bits": ((192, 192, 24, 24, 192), 1), "full": ((18, 96, 162, 30, 36), 6),
    "cell": ((768, 1536, 512, 384, 1088), 27)}


def limit(value, most):
    return max(-most, min(most, value))


class Plane:
    def __init__(self, axis, pu, pv, height, slopes):
        self.axis, self.pu, self.pv, self.height, self.slopes = axis, pu, pv, height, slopes

    def at(self, x, y):
        rise = self.slopes[0] * (x - self.pu) + self.slopes[1] * (y - self.pv)
        return limit(self.height + ((rise + 32768) >> 16), 1 << 30)


class Leaf:
    def __init__(self, level, at, centre):
        self.level, self.at, self.centre = level, at, centre
        self.plane, self.curve, self.intensity, self.cells = None, [0, 0, 0], 0, []


class Tile:
    def __init__(self, data):
        self._header(data)
        self.decoder = RangeDecoder(data[self.position:])
        self.models, self.weights = {}, {}
        for kind in KINDS:
            self._forget(kind)
        self.planes, self.leaves, self.fine, self.before, self.later = [], [], {}, {}, 0
        self._pass()
        while self.decoder.plain():
            self.later += 1
            if self.later == 16:
                raise ValueError("too many passes")
            self.before.update({place: leaf for place, leaf in self.fine.items() if leaf >= 0})
            self.fine = {}
            for kind in ("occupied", "split"):
                self._forget(kind)
            self._pass()
        if self.decoder.exhausted or self.decoder.read < len(data) - self.position:
            raise ValueError("the bits do not end where the surface does")

    def _forget(self, kind):
        sizes, mixes = KINDS[kind]
        self.models[kind] = [[[32768, 0] for _ in range(size)] for size in sizes]
        self.weights[kind] = [16384] * (5 * mixes)

    def _pass(self):
        for x in range(self.side):
            for y in range(self.side):
                for z in range(self.rows):
                    context = Context(self, 0, (x, y, z))
                    if self._occupied(context, 0):
                        self._cube(context)
                    else:
                        self._fill(context, EMPTY)

    def found(self, place):
        """What a finest cube holds."""
        now = self.fine.get(place, UNKNOWN)
        return now if now >= 0 else self.before.get(place, now)

    def _header(self, data):
        def varint():
            value = shift = 0
            while True:
                byte = data[self.position]
                self.position += 1
                value |= (byte & 127) << shift
                shift += 7
                if byte < 128:
                    return value
        self.root = 11 + (data[0] & 7)
        self.levels = data[0] >> 3 & 7
        self.curves, self.lit = data[0] >> 6 & 1, data[0] >> 7
        self.cells_log2, self.fall = data[1] & 7, (data[1] >> 3) + 1
        self.position = 2
        self.side, self.step = varint(), varint()
        row = varint()
        self.base = -(row + 1) // 2 if row & 1 else row // 2
        self.rows = varint()
        self.intensity_step = 0
        if self.lit:
            self.intensity_step = struct.unpack_from("<f", data, self.position)[0]
            self.position += 4

    def edge(self, level):
        return 1 << (self.root - level)

    def cells(self, level):
        return 1 << max(self.cells_log2 - level, 0)

    def height_step(self, level):
        step = self.step
        for _ in range(self.root - level - 11):
            step = step * self.fall >> 4
        return max(step, 1)

    def _bit(self, kind, at, mix):
        models = [table[i] for table, i in zip(self.models[kind], at)]
        return decide_mixed(self.decoder, models, self.weights[kind], 5 * mix, 10, 127)

    def _fill(self, c, value):
        f = c.fine
        for x in range(c.at[0] * f, c.at[0] * f + f):
            for y in range(c.at[1] * f, c.at[1] * f + f):
                for z in range(c.at[2] * f, c.at[2] * f + f):
                    self.fine[x, y, z] = value

    def _occupied(self, c, siblings):
        l, o = c.level, c.around
        return self._bit("occupied", ((64 * l + o) * 3 + c.crossing[0], (64 * l + o) * 4 + c.contact,
                                      27 * l + c.all, (8 * l + siblings) * 12 + 4 * c.crossing[0] + c.contact,
                                      64 * l + o), l)

    def _cube(self, c):
        l = c.level
        if l < self.levels and self._bit(
                "split", ((3 * l + c.finer) * 3 + c.crossing[0], 27 * l + c.all, 64 * l + c.around,
                          16 * l + 4 * c.contact + len(c.candidates), (3 * l + c.finer) * 4 + c.contact), l):
            siblings = 0
            for k in range(8):
                child = Context(self, l + 1, tuple(2 * p + (k >> d & 1) for d, p in enumerate(c.at)))
                if (k == 7 and not siblings) or self._occupied(child, siblings):
                    siblings += 1
                    self._cube(child)
                else:
                    self._fill(child, EMPTY)
            return
        self._leaf(c)

    def _number(self, w, c, q, energy):
        big = 6 * w + c.level
        if not self._bit("zero", (big, 3 * big + q, w, 4 * big + energy, w), w):
            return 0
        negative = self._bit("sign", (w, big, 3 * w + q, w, w), 0)
        z = 0
        while z < 16 and self._bit("class", (24 * w + z, 24 * big + z, 24 * w + z,
                                             24 * (4 * w + energy) + z, z), min(z, 1)):
            z += 1
        value = 1 if z else 0
        for k in range(1, z):
            value = 2 * value + (self._bit("bits", (24 * w + z, 24 * w + z, z, z, 24 * w + z), 0)
                                 if k == 1 else self.decoder.plain())
        value = min(value + 1, 32768)
        return -value if negative else value

    def _numbers(self, kinds, c, q):
        energy, values = 0, []
        for w in kinds:
            values.append(self._number(w, c, q, energy))
            energy = min(3, energy + min(abs(values[-1]), 3))
        return values

    def _candidate(self, c):
        l, n = c.level, len(c.candidates)
        if n == 0 or self._bit("new", (4 * l + c.crossing[0] + (c.crossing[0] > 0 and c.contact == 3),
                                       27 * l + c.all, 12 * l + 3 * c.contact + c.finer, c.around,
                                       3 * l + n - 1), c.crossing[0]):
            if not self._bit("axis", (0, l, c.around, 0, 0), 0):
                return None, 2
            return None, self._bit("axis", (1, 6 + l, 64 + c.around, 1, 1), 1)
        for k in range(1, n):
            x, y = c.crossing[k - 1], c.crossing[k]
            if self._bit("candidate", (3 * l + x, 9 * l + 3 * x + y, 27 * (k - 1) + c.all,
                                       4 * l + c.contact, k - 1), k - 1):
                return k - 1, None
        return n - 1, None

    def _leaf(self, c):
        l, leaf = c.level, Leaf(c.level, c.at, c.centre)
        chosen, axis = self._candidate(c)
        new = chosen is None
        q = 0 if new else c.crossing[chosen]
        i = 1 if new else 0
        while i < 2:
            k = i + (2 if new else 0)
            lk = 4 * l + k
            if not self._bit("terms", (lk, 3 * lk + q, 4 * lk + c.contact, 3 * k + c.finer,
                                       3 * lk + c.finer), k):
                break
            i += 1
        first = 1 if new else 6 if i == 2 else 0
        slope = 3 if new else 2
        values = self._numbers([[], [first], [first, slope, slope]][i], c, q)
        if self.curves and self._bit("curved", (l, 2 * l + new, l, 3 * l + q, l), 0):
            step = max(1, (self.height_step(l) << 30) // self.edge(l) ** 2)
            leaf.curve = [limit(v * step, 1 << 20) for v in self._numbers([4, 4, 4], c, q)]
        if self.lit:
            leaf.intensity = limit(c.intensity + self._number(5, c, q, 0), 32768)
        if new or i:
            base = None if new else self.planes[c.candidates[chosen]]
            axis = axis if new else base.axis
            u, v = c.centre[(axis + 1) % 3], c.centre[(axis + 2) % 3]
            values += [0] * (3 - len(values))
            height = (c.centre[axis] if new else base.at(u, v)) + values[0] * self.height_step(l)
            step = max(1, (self.height_step(l) << 17) // self.edge(l))
            slopes = [limit((0 if new else base.slopes[k]) + values[k + 1] * step, 131072)
                      for k in range(2)]
            leaf.plane = len(self.planes)
            plane = Plane(axis, u, v, limit(height, 1 << 30), slopes)
        else:
            leaf.plane = c.candidates[chosen]
            plane = self.planes[leaf.plane]
        leaf.cells = self._footprint(c, plane, 0 if new else 1 if i else 2)
        if leaf.plane == len(self.planes):
            self.planes.append(plane)
        self._fill(c, len(self.leaves))
        self.leaves.append(leaf)

    def _state(self, axis, point):
        e = self.root - self.levels
        base = self.base << self.root
        found = self.found((point[0] >> e, point[1] >> e, (point[2] - base) >> e))
        if found < 0:
            return 2 if found == UNKNOWN else 0
        leaf = self.leaves[found]
        if self.planes[leaf.plane].axis != axis:
            return 3
        m, edge = self.cells(leaf.level), self.edge(leaf.level)
        place = []
        for k in ((axis + 1) % 3, (axis + 2) % 3):
            place.append((point[k] - (leaf.centre[k] - edge // 2)) // (edge // m))
        return leaf.cells[place[0] * m + place[1]]

    def _footprint(self, c, plane, r):
        l, m, h, a = c.level, self.cells(c.level), c.half, plane.axis
        if m == 1:
            return [1]
        u, v, d = (a + 1) % 3, (a + 2) % 3, 2 * h // m

        def middle(i, j):
            return c.centre[u] - h + i * d + d // 2, c.centre[v] - h + j * d + d // 2

        taken = set()

        def opened(i, j):
            return off[i, j] <= reach and (i, j) not in taken

        reach = h + ((abs(plane.slopes[0]) + abs(plane.slopes[1])) * d >> 17) + 256
        off = {(i, j): abs(plane.at(*middle(i, j)) - c.centre[a]) for i in range(m) for j in range(m)}
        state, known, seen = {place: 0 for place in off}, 0, 0
        for i in range(-1, m + 1):
            for j in range(-1, m + 1):
                if (i, j) in off and not self.later:
                    continue
                point = [0, 0, 0]
                point[u], point[v] = middle(i, j)
                point[a] = max(c.centre[a] - h, min(c.centre[a] + h - 1, plane.at(point[u], point[v])))
                found = self._state(a, point)
                if (i, j) in off:
                    if found == 1:
                        state[i, j] = 1
                        taken.add((i, j))
                    continue
                state[i, j] = found
                known += state[i, j] != 2
                seen += state[i, j] == 1
        b = min(4, 5 * seen // known) if known else 5
        lower = min(b, 4)
        if self._bit("full", (3 * l + r, 16 * l + 3 * lower + r, 27 * l + c.all, 5 * l + lower,
                              6 * l + b), l):
            return [1 if opened(i, j) else 0 for i in range(m) for j in range(m)]
        decoded = on = 0
        for i in range(m):
            for j in range(m):
                if not opened(i, j):
                    continue
                w, n = state[i, j - 1], state[i - 1, j]
                east = state[i, j + 1] if j == m - 1 else 2
                south = state[i + 1, j] if i == m - 1 else 2
                far = (state[i, j - 2] if j else 2) + (state[i - 2, j] if i else 2)
                wn = w + 4 * n
                near = wn + 16 * state[i - 1, j - 1] + 64 * state[i - 1, j + 1]
                p = min(7, 6 * off[i, j] // h)
                y = min(15, 16 * on // decoded) if decoded else 16
                state[i, j] = self._bit(
                    "cell", (3 * near + min(l, 2), 6 * near + min(m.bit_length(), 5),
                             2 * (wn + 16 * east + 64 * south) + (a == 2), 3 * (8 * wn + p) + r,
                             17 * (wn + 16 * min(far, 3)) + y), (3 * min(w, 2) + min(n, 2)) * 3 + r)
                decoded += 1
                on += state[i, j]
        return [state[i, j] if opened(i, j) else 0 for i in range(m) for j in range(m)]


class Context:
    """What tells about a cube before it is decoded."""

    def __init__(self, tile, level, at):
        self.level, self.at = level, at
        edge = tile.edge(level)
        self.half = edge // 2
        self.centre = [p * edge + edge // 2 for p in at]
        self.centre[2] += tile.base << tile.root
        self.fine = f = 1 << (tile.levels - level)
        low = [p * f for p in at]
        votes, touching, smaller = {}, 0, 0
        for x in range(-1, f + 1):
            for y in range(-1, f + 1):
                side = x in (-1, f) or y in (-1, f) or tile.later
                for z in range(-1, f + 1) if side else (-1, f):
                    found = tile.found((low[0] + x, low[1] + y, low[2] + z))
                    if found < 0:
                        continue
                    leaf = tile.leaves[found]
                    touching += 1
                    smaller += leaf.level > level
                    votes[leaf.plane] = votes.get(leaf.plane, 0) + 1
        crossing = {}
        if votes:
            crossing = {plane: self._crossing(tile.planes[plane]) for plane in votes}
        else:
            for plane in range(max(0, len(tile.planes) - 24), len(tile.planes)):
                if kind := self._crossing(tile.planes[plane]):
                    votes[plane], crossing[plane] = 0, kind
        order = sorted(votes, key=lambda plane: (-crossing[plane], -votes[plane], -plane))
        self.candidates = order[:3]
        self.crossing = [crossing[plane] for plane in self.candidates]
        self.crossing += [0] * (3 - len(self.crossing))
        self.all = 9 * self.crossing[0] + 3 * self.crossing[1] + self.crossing[2]
        most = votes[order[0]] if order else 0
        self.contact = 0 if most == 0 else 1 if most < f else 2 if most < 2 * f + 2 else 3
        self.finer = 0 if smaller == 0 else 1 if 2 * smaller < touching else 2
        self.around = 0
        for k, way in enumerate(((-1, 0, 0), (0, -1, 0), (0, 0, -1), (-1, 0, 1), (0, -1, 1), (-1, -1, 0))):
            spans = [range(f >> 1 if d < 0 else 0, (f + 1) >> 1 if d > 0 else f) for d in way]
            corner = [p + d * f for p, d in zip(low, way)]
            if any(tile.found((corner[0] + x, corner[1] + y, corner[2] + z)) >= 0
                   for x in spans[0] for y in spans[1] for z in spans[2]):
                self.around |= 1 << k
        self.intensity = tile.leaves[-1].intensity if tile.leaves else 0

    def _crossing(self, plane):
        a, q = plane.axis, self.half // 2
        u, v = self.centre[(a + 1) % 3], self.centre[(a + 2) % 3]
        inside = sum(abs(plane.at(u + du, v + dv) - self.centre[a]) <= self.half
                     for du, dv in ((0, 0), (-q, -q), (-q, q), (q, -q), (q, q)))
        return 0 if inside == 0 else 1 if inside < 4 else 2


def twin(tile):
    """A line for each leaf, as tests/golden/surface_twin.hpp writes them."""
    lines = []
    for leaf in tile.leaves:
        plane = tile.planes[leaf.plane]
        a = plane.axis
        height = plane.at(leaf.centre[(a + 1) % 3], leaf.centre[(a + 2) % 3])
        lit = round(leaf.intensity * tile.intensity_step * 65536)
        numbers = [leaf.level, *leaf.centre, a, height, *plane.slopes, *leaf.curve, lit]
        lines.append(" ".join(map(str, numbers)) + " " + "".join(map(str, leaf.cells)) + "\n")
    return "".join(lines)
