# SPDX-License-Identifier: BSD-3-Clause
"""Integer arithmetic of the format: notation, square roots, sines and cosines.

Written from docs/format/curl-format-1.md alone, like every module of this folder.
"""
from functools import lru_cache
from math import isqrt  # floor(sqrt(x)), exactly

__all__ = ["clip", "divide", "isqrt", "mulshift", "sin_cos", "signed_angle"]

ONE_TURN = 1 << 32


def clip(value, low, high):
    return low if value < low else high if value > high else value


def divide(a, b):
    """a / b towards zero; Python's // is floor(a / b)."""
    return a // b if (a < 0) == (b < 0) else -(-a // b)


def mulshift(a, b, bits):
    return clip(a * b >> bits, -(1 << 62), 1 << 62)


def signed_angle(angle):
    """A binary angle as a number in [-2^31, 2^31)."""
    return (angle + (1 << 31)) % ONE_TURN - (1 << 31)


# round(2^33 (pi / 4)^k / k!)
_C = [8589934592, 6746518852, 2649351758, 693598668, 136187780, 21392326, 2800249, 314187, 30845,
      2692, 211, 15]


def _series(u, terms):
    h = 0
    for k in terms:
        h = _C[k] - (u * h >> 32)
    return h


@lru_cache(maxsize=None)
def sin_cos(angle):
    """(sine, cosine) of a binary angle in Q30."""
    quarter, r = divmod(angle % ONE_TURN, 1 << 30)
    a = r if r <= 1 << 29 else (1 << 30) - r
    u = a * a >> 26
    cosine = (_series(u, range(10, -1, -2)) + 4) >> 3
    sine = (a * _series(u, range(11, 0, -2)) + (1 << 31)) >> 32
    if r > 1 << 29:
        sine, cosine = cosine, sine
    for _ in range(quarter):
        sine, cosine = cosine, -sine
    return sine, cosine
