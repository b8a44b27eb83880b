# SPDX-License-Identifier: BSD-3-Clause
"""The chunk `corrections`."""
import math

from entropy import decide
from integers import clip
from points import Invalid, PointStream, STEPS, rounded
from signed_integers import IntegerDecoder, half_octave, wrap64


def size(n):
    return min(half_octave(abs(n)), 15)


def side(n):
    return 0 if n < 0 else 2 if n > 0 else 1


class CorrectionsDecoder:
    def __init__(self, payload):
        self.stream = PointStream(payload)
        self.numbers = self.stream.numbers
        self.coders = [IntegerDecoder(3) for _ in range(3)]
        self.flags = [[32768, 0] for _ in range(16)]
        self.history = 0
        self.last = [0] * 3
        self.recent, self.drift = [0.0] * 3, [0.0] * 3

    def apply(self, predicted):
        if len(predicted) != self.stream.count:
            raise Invalid("another number of points")
        points = []
        for p in predicted:
            point = self.stream.raw()
            if point is None:
                point = self._moved(p) if self.numbers.kind == STEPS else self._exact(p)
            self.stream.check()
            points.append(tuple(point))
        return points

    def _moved(self, p):
        moved = decide(self.stream.decoder, self.flags[self.history], 255)
        self.history = (2 * self.history + moved) % 16
        if not moved:
            return p
        others, steps = 0, []
        for a in range(3):
            last = size(self.last[a])
            n = self.coders[a].decode(self.stream.decoder, (16 * last + others, last, others),
                                      side(self.last[a]))
            others = min(others + size(n), 15)
            steps.append(n)
        self.last = steps
        if max(map(abs, steps)) > 1 << 46:
            raise Invalid("moved too far")
        return [rounded(x + n * self.numbers.step, self.numbers.type) if n else x
                for x, n in zip(p, steps)]

    def _exact(self, predicted):
        others, sides, steps, point = 0, 0, [], []
        for a, x in enumerate(predicted):
            p, number = self.numbers.position_of(x), self.numbers.number(x)
            s = self.numbers.spacing(p)
            fraction = clip((p - self.numbers.position(number)) / s, -0.5, 0.5)
            part = min(math.floor((fraction + 0.5) * 16), 15)
            recent = min(half_octave(math.floor(min(self.recent[a] / s * 16, 2.0 ** 60))), 31)
            drift = clip(math.floor(self.drift[a] / s * 8 + 0.5), -3, 3) + 3
            contexts = (16 * recent + part, 16 * (9 * drift + sides) + part, 16 * recent + others)
            n = self.coders[a].decode(self.stream.decoder, contexts,
                                      16 * (3 * drift + side(self.last[a])) + part)
            others = min(others + size(n), 15)
            sides = 3 * sides + side(n)
            e = (n - fraction) * s
            self.recent[a] += (abs(e) - self.recent[a]) * 0.125
            self.drift[a] += (e - self.drift[a]) * 0.125
            steps.append(n)
            point.append(self.numbers.value(wrap64(number + n)))
        self.last = steps
        return point


def apply_corrections(payload, predicted):
    return CorrectionsDecoder(payload).apply(predicted)
