# SPDX-License-Identifier: BSD-3-Clause
"""Adaptive codes of whole numbers: order and attributes, section 2."""
from entropy import decide

LIMIT = 60


def model():
    return [32768, 0]


def wrapped(value):
    """Modulo 2^64, signed."""
    value &= (1 << 64) - 1
    return value - (1 << 64) if value >> 63 else value


def plain_number(decoder, bits):
    value = 0
    for _ in range(bits):
        value = 2 * value + decoder.plain()
    return value


def unzigzag(value):
    return -(value + 1) // 2 if value & 1 else value // 2


class Sizes:
    def __init__(self):
        self.longer = [model() for _ in range(64)]
        self.second = [model() for _ in range(65)]
        self.third = [[model(), model()] for _ in range(65)]

    def decode(self, decoder):
        n = 0
        while n < 64 and decide(decoder, self.longer[n], LIMIT):
            n += 1
        if n < 2:
            return n
        t = 1
        for known in range(1, n):
            if known == 1:
                bit = decide(decoder, self.second[n], LIMIT)
            elif known == 2:
                bit = decide(decoder, self.third[n][t % 2], LIMIT)
            else:
                bit = decoder.plain()
            t = 2 * t + bit
        return t


class SignedNumbers:
    def __init__(self):
        self.sizes = Sizes()
        self.sign = model()

    def decode(self, decoder):
        size = self.sizes.decode(decoder)
        if size and decide(decoder, self.sign, LIMIT):
            size = -size
        return wrapped(size)
