# SPDX-License-Identifier: BSD-3-Clause
"""Entropy coding: the range decoder, adaptive models, mixing, tables of priors."""
from pathlib import Path

from integers import clip

PRIORS = Path(__file__).resolve().parents[2] / "docs" / "format" / "priors"

_KNOT = [32768, 40793, 47911, 53581, 57724, 60565, 62428, 63615, 64357, 64816, 65097, 65269, 65374,
         65438, 65476, 65500, 65514, 65523, 65528, 65531, 65533, 65534, 65535, 65535, 65536]
MOST = 3071  # of the logistic domain, on either side


def _squash(x):
    k, f = divmod(abs(x), 128)
    s = _KNOT[k] + (((_KNOT[k + 1] - _KNOT[k]) * f + 64) >> 7)
    return clip(s if x >= 0 else 65536 - s, 32, 65504)


_SQUASH = [_squash(x) for x in range(-MOST, MOST + 1)]
_STRETCH = []
for _i in range(4096):
    _x = _STRETCH[-1] if _STRETCH else -MOST  # squash does not fall
    while _x < MOST and _SQUASH[_x + MOST] < 16 * _i + 8:
        _x += 1
    _STRETCH.append(_x)


def squash(x):
    return _SQUASH[clip(x, -MOST, MOST) + MOST]


def stretch(p):
    return _STRETCH[p >> 4]


class RangeDecoder:
    """Decisions from the bytes of a stream; zeros after its end."""

    def __init__(self, data):
        self.data = data
        self.read = 0
        self.range = 0xFFFFFFFF
        self.value = 0
        for _ in range(4):
            self.value = self.value << 8 | self._next()

    def _next(self):
        self.read += 1
        return self.data[self.read - 1] if self.read <= len(self.data) else 0

    def decode(self, p):
        bound = (self.range >> 16) * p
        if self.value < bound:
            self.range, bit = bound, 1
        else:
            self.value -= bound
            self.range, bit = self.range - bound, 0
        while self.range < 1 << 24:
            self.range = self.range << 8
            self.value = self.value << 8 | self._next()
        return bit

    def plain(self):
        return self.decode(32768)

    @property
    def exhausted(self):
        return self.read > len(self.data) + 4


def words(name):
    """The words of a table of priors, unsigned; none if the format has no such table."""
    path = PRIORS / f"{name}.txt"
    lines = path.read_text("ascii").splitlines()
    digits = "".join("".join(line.split()) for line in lines if not line.startswith("#"))
    return [int(digits[i:i + 4], 16) for i in range(0, len(digits), 4)]


def _signed(value, bits):
    return value - (1 << bits) if value >> (bits - 1) else value


def prior_models(name, count):
    """[probability, visits] of `count` models."""
    states = [[squash(24 * _signed(word >> 8, 8)), word & 255] for word in words(name)]
    return (states + [[32768, 0] for _ in range(count - len(states))])[:count]


def weight_words(name):
    return [_signed(word, 16) for word in words(name)]


def prior_weights(name, count, usual):
    """`count` weights; `usual` is that of a weight which has no prior."""
    weights = [16 * word for word in weight_words(name)]
    return (weights + [usual] * (count - len(weights)))[:count]


def learn(model, bit, limit):
    probability, visits = model
    target = 65535 if bit else 0
    rate = (131072 + visits + 1) // (2 * visits + 3)
    model[0] = probability + (((target - probability) * rate + 32768) >> 16)
    if visits < limit:
        model[1] = visits + 1


def decide(decoder, model, limit):
    """A decision with one model."""
    bit = decoder.decode(clip(model[0], 32, 65504))
    learn(model, bit, limit)
    return bit


def weighted(weights, start, inputs):
    """The weighted sum of inputs of the logistic domain."""
    total = sum(weights[start + i] * s for i, s in enumerate(inputs))
    return clip((total + 32768) >> 16, -MOST, MOST)


def learn_weights(weights, start, inputs, error, rate):
    for i, s in enumerate(inputs):
        w = weights[start + i] + ((error * s * rate + 131072) >> 18)
        weights[start + i] = clip(w, -(1 << 20), 1 << 20)


def decide_mixed(decoder, models, weights, start, rate, limit):
    """A mixed decision of `models` with the weights from `start` on."""
    inputs = [stretch(model[0]) for model in models]
    p = squash(weighted(weights, start, inputs))
    bit = decoder.decode(p)
    learn_weights(weights, start, inputs, (65536 if bit else 0) - p, rate)
    for model in models:
        learn(model, bit, limit)
    return bit
