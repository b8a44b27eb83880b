# SPDX-License-Identifier: BSD-3-Clause
"""The chunk `loose`."""
import math

from integers import clip
from points import PointStream
from signed_integers import IntegerDecoder, half_octave, wrap64

FEATURES = 11


class LeastSquares:
    def __init__(self, keep):
        self.keep = keep
        self.moments = [[0.0] * (j + 1) for j in range(FEATURES)]
        self.targets = [0.0] * FEATURES
        self.coefficients = [0.0] * FEATURES
        self.lessons = 0

    def predict(self, features):
        total = 0.0
        for c, f in zip(self.coefficients, features):
            total += c * f
        return total

    def learn(self, features, value, weight):
        for j in range(FEATURES):
            u = weight * features[j]
            row = self.moments[j]
            for k in range(j + 1):
                row[k] = row[k] * self.keep + u * features[k]
            self.targets[j] = self.targets[j] * self.keep + u * value
        self.lessons += 1
        if self.lessons % 4 == 0:
            self._solve()

    def _solve(self):
        lower = [[0.0] * FEATURES for _ in range(FEATURES)]
        for j in range(FEATURES):
            for k in range(j + 1):
                x = self.moments[j][k]
                if j == k:
                    x += 0.001
                for n in range(k):
                    x -= lower[j][n] * lower[k][n]
                if k < j:
                    lower[j][k] = x / lower[k][k]
                elif x > 1e-9:
                    lower[j][j] = math.sqrt(x)
                else:
                    return
        c = [0.0] * FEATURES
        for j in range(FEATURES):
            x = self.targets[j]
            for n in range(j):
                x -= lower[j][n] * c[n]
            c[j] = x / lower[j][j]
        for j in reversed(range(FEATURES)):
            x = c[j]
            for n in range(j + 1, FEATURES):
                x -= lower[n][j] * c[n]
            c[j] = x / lower[j][j]
        self.coefficients = c


def length(p):
    return math.sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2])


def turn(f, t, o):
    a, b, r = length(f), length(t), length(o)
    if not (a > 0 and b > 0 and r > 0):
        return o
    return [r * (o[i] / r + t[i] / b - f[i] / a) for i in range(3)]


def bounded(x, y):
    return x if abs(x) < 2.0 ** 60 else y


def on_ray(q, axis, known):
    if axis == 0:
        return q[0]
    by = 1 if axis == 2 and abs(q[1]) > abs(q[0]) else 0
    if q[by] == 0 or abs(q[by]) * 4 < abs(q[axis]):
        return q[axis]
    return bounded(q[axis] * (known[by] / q[by]), q[axis])


def error_class(x):
    h = half_octave(math.floor(min(x * 8, 2.0 ** 60)))
    return h if h <= 32 else min(32 + (h - 32) // 2, 63)


def side(x, y):
    return 0 if x < -y else 2 if x > y else 1


class Axis:
    def __init__(self):
        self.slow, self.fast = LeastSquares(0.99), LeastSquares(0.95)
        self.misses = [16.0] * 3
        self.recent = 16.0
        self.run = 0
        self.coder = IntegerDecoder(5)


class LooseDecoder:
    def __init__(self, payload):
        self.stream = PointStream(payload)
        self.numbers = self.stream.numbers
        self.axes = [Axis() for _ in range(3)]
        self.positions, self.errors, self.beyond = [], [], []
        self.match = None

    def decode(self):
        points = []
        for _ in range(self.stream.count):
            self._begin(len(points))
            point = self.stream.raw()
            if point is not None:
                self._push([self.numbers.position_of(x) for x in point], [0.0] * 3)
            else:
                point = self._point()
            self.stream.check()
            points.append(tuple(point))
        return points

    def _push(self, position, errors):
        self.positions.append(position)
        self.errors.append(errors)
        self.beyond.append(None if self.match is None else self.match + 1)

    def _distance(self, j):
        p, last = self.positions[j], self.positions[-1]
        dx, dy, dz = p[0] - last[0], p[1] - last[1], p[2] - last[2]
        return dx * dx + dy * dy + dz * dz

    def _find_match(self, i):
        if i < 10:
            return
        high, low = i - 9, max(1, i - 4097)
        expected = high if self.match is None else clip(self.match + 1, low, high)
        if self.match is None or i % 16 == 0:
            candidates = range(high, low - 1, -1)
        else:
            candidates = range(min(high, expected + 4), max(low, expected - 4) - 1, -1)
        self.match, least = expected, self._distance(expected) / 2
        for j in candidates:
            if self._distance(j) < least:
                least, self.match = self._distance(j), j

    def _begin(self, i):
        zero = [0.0] * 3
        self.last = self.second = self.third = zero
        if i > 0:
            self._find_match(i)
            p = self.positions
            self.last = p[i - 1]
            self.second = p[i - 2] if i > 1 else self.last
            self.third = p[i - 3] if i > 2 else self.second
        self.matched = self.next = self.before = self.after = self.far = self.turned = self.last
        if self.match is not None:
            m, p = self.match, self.positions
            self.matched, self.next, self.before, self.after = p[m], p[m + 1], p[m - 1], p[m + 2]
            beyond = self.beyond[m + 1]
            self.far = self.matched if beyond is None else p[beyond]
            self.turned = turn(self.matched, self.next, self.last)
        self.spun = turn(self.far, self.next, self.next)

    def _features(self, a, known, parallel, turned):
        last, matched, after = self.last, self.matched, self.next
        eighth = (turned - parallel if a == 0 else after[0] - matched[0] if a == 1
                  else known[1] - last[1])
        return [last[a] - self.second[a], self.second[a] - self.third[a], after[a] - matched[a],
                self.before[a] - matched[a], matched[a] - last[a], self.after[a] - after[a],
                turned - last[a], known[0] - last[0] if a > 0 else 0.0, eighth,
                after[a] - self.far[a], on_ray(self.spun, a, known) - last[a]]

    def _matched_error(self, a):
        if self.match is None:
            return self.axes[a].recent
        m, e = self.match, self.errors
        return (e[m + 1][a] * 2 + e[m][a] + e[m - 1][a]) / 4

    def _point(self):
        known, errors, numbers, before = [], [], [], 0
        for a in range(3):
            n, before, error = self._coordinate(a, known, before)
            numbers.append(n)
            errors.append(error)
        self._push(known, errors)
        return [self.numbers.value(n) for n in numbers]

    def _coordinate(self, a, known, before):
        axis, last = self.axes[a], self.last[a]
        parallel = last + self.next[a] - self.matched[a]
        turned = on_ray(self.turned, a, known)
        features = self._features(a, known, parallel, turned)
        slow = bounded(last + axis.slow.predict(features), last)
        fast = bounded(last + axis.fast.predict(features), last)
        guesses = (turned, slow, fast)
        total = weights = 0.0
        for g, h in zip(guesses, axis.misses):
            w = 1 / (h + 0.02)
            w = w * w
            w = w * w
            w = w * w
            weights += w
            total += w * g
        guess = total / weights

        base = self.numbers.number_at(guess)
        b = self.numbers.position(base)
        s = self.numbers.spacing(b)

        def offset(x):
            return clip(math.floor((x - b) / s + 0.5), -3, 3)

        fraction = clip((guess - b) / s, -0.5, 0.5)
        recent = error_class(axis.recent / s)
        matched = error_class(self._matched_error(a) / s)
        error_before = error_class((self.errors[-1][a] if self.errors else 0.0) / s)
        spread = error_class((abs(slow - turned) + abs(fast - slow)) / s)
        straight = offset(parallel)
        contexts = (4 * recent + min(math.floor(abs(fraction) * 8), 3),
                    12 * matched + min(before, 11), 16 * spread + min(recent // 2, 15),
                    16 * error_before + min(matched // 2, 15),
                    4 * (49 * (offset(turned) + 3) + 7 * (offset(last) + 3) + straight + 3)
                    + axis.run)
        sign = (9 * min(math.floor((fraction + 0.5) * 9), 8) + 3 * side(slow - guess, 0.1 * s)
                + side(straight, 0))
        n = axis.coder.decode(self.stream.decoder, contexts, sign)
        number = wrap64(base + n)
        v = self.numbers.position(number)
        known.append(v)
        axis.run = min(axis.run + 1, 3) if clip(n, -3, 3) == straight else 0
        self._learn(axis, features, guesses, guess, v - last, v)
        return number, half_octave(abs(n)), abs(v - guess)

    @staticmethod
    def _learn(axis, features, guesses, guess, moved, v):
        for j, g in enumerate(guesses):
            axis.misses[j] += (abs(g - v) - axis.misses[j]) * 0.125
        axis.recent += (abs(guess - v) - axis.recent) * 0.125
        q = v - guesses[1]
        weight = 1 / (axis.recent * axis.recent + q * q + 0.1)
        axis.slow.learn(features, moved, weight)
        axis.fast.learn(features, moved, weight)


def decode_loose(payload):
    return LooseDecoder(payload).decode()
