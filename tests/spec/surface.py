# SPDX-License-Identifier: BSD-3-Clause
"""Surfaces of the field chunk: directions, patches and the functions of inverse range."""
from functools import lru_cache

from integers import clip, isqrt, mulshift, signed_angle, sin_cos

FUNCTIONS = (0, 1, 3, 6)


class Window:
    """What the field of a segment sees of the scan: where its cells look, and the step."""

    def __init__(self, elevations, turn, first, columns, step):
        self.elevations = [signed_angle(e) for e in elevations]
        self.turn = turn
        self.first = first
        self.rows, self.columns = len(elevations), columns
        self.step = step

    def azimuth(self, column):
        return ((1 << 31) + ((self.first + column << 32) // self.turn)) % (1 << 32)

    def azimuth_between(self, total):
        """Half-way between two columns of the segment, given by their sum."""
        return (1 << 31) + (2 * self.first + total << 31) // self.turn

    def cell_azimuth(self, row, column):
        return self.azimuth(column)

    @staticmethod
    def in_cell(surface, _row, _column):
        """What a surface is in a cell."""
        return surface

    def range(self, surface, row, column):
        """Of a surface in a cell."""
        return surface.range(self.direction(row, column))

    @lru_cache(maxsize=None)
    def direction(self, row, column):
        sin_a, cos_a = sin_cos(self.cell_azimuth(row, column))
        sin_e, cos_e = sin_cos(self.elevations[row])
        return ((cos_e * cos_a + (1 << 37)) >> 38, (cos_e * sin_a + (1 << 37)) >> 38,
                (sin_e + 128) >> 8)


class RayWindow(Window):
    """The same on the sensor's own rays: the segment begins at (row, column) of the image."""

    def __init__(self, rays, row, column, rows, columns, step):
        super().__init__(rays.elevation[row:row + rows], len(rays.firings), column, columns, step)
        self.rays = rays
        self.first_row = row

    def azimuth_between(self, total):
        total += 2 * self.first
        a, b = (self.rays.encoder_angle(k) for k in (total // 2, (total + 1) // 2))
        return a + (b - a) % (1 << 32) // 2

    def cell_azimuth(self, row, column):
        return self.rays.azimuth(self.first_row + row, self.first + column)

    def range(self, surface, row, column):
        o = self.rays.origin(self.first_row + row, self.first + column)
        beside = sum(n * x for n, x in zip(surface.plane, o)) >> 16
        return surface.range(self.direction(row, column), (1 << 30) - beside)


def _inverse_root(x, bits):
    return (1 << (30 + bits // 2)) // isqrt(x) if x > 0 else 0


def _scale(mean):
    if mean <= 0 or isqrt(mean) == 0:
        return 0
    return min((1 << 42) // isqrt(mean), 1 << 32)


class Shape:
    """Scales and norms of the blocks of one row, height and width."""

    def __init__(self, window, row, height, width):
        angles = window.elevations[row:row + height]
        n = height * width
        self.elevation = sum(angles) // height
        self.sin, self.cos = sin_cos(self.elevation)
        self.norm = _inverse_root(n << 20, 20)
        u = [self.cos * sin_cos((2 * j - (width - 1) << 31) // window.turn)[0] >> 32
             for j in range(width)]
        self.scale_u = _scale(sum(x * x for x in u) // width)
        v = [sin_cos(e - self.elevation)[0] >> 2 for e in angles]
        self.scale_v = _scale(sum(x * x // height for x in v))
        self.norm_uu = self.norm_vv = self.skew_v = 0
        if width > 2 and self.scale_u > 0:
            square = (n * 4 * (width * width - 4) << 20) // (5 * (width * width - 1))
            self.norm_uu = _inverse_root(square, 20)
        if height > 2 and self.scale_v > 0:
            self._vertical_square(angles, n)

    def _vertical_square(self, angles, n):
        most = 1 << 23
        g = [clip(sin_cos(e - self.elevation)[0] * self.scale_v >> 24, -most, most) for e in angles]
        q = [x * x >> 20 for x in g]
        height = len(angles)
        self.skew_v = sum(a * b >> 20 for a, b in zip(q, g)) // height
        variance = (sum(a * a >> 20 for a in q) // height - (1 << 20)
                    - (self.skew_v * self.skew_v >> 20))
        if variance > 1 << 14:
            self.norm_vv = _inverse_root(n * variance, 20)


class Patch:
    """A block with its shape and its frame."""

    def __init__(self, window, shape, column, width):
        self.shape = shape
        sin_a, cos_a = sin_cos(window.azimuth_between(2 * column + width - 1))
        self.C = (shape.cos * cos_a >> 30, shape.cos * sin_a >> 30, shape.sin)
        self.U = (-sin_a, cos_a, 0)
        self.V = (-shape.sin * cos_a >> 30, -shape.sin * sin_a >> 30, shape.cos)

    def squares(self, d):
        """B3, B4 and B5 in a direction, Q20."""
        shape, most = self.shape, 1 << 23
        x = clip(_dot(self.U, d) * shape.scale_u >> 24, -most, most)
        y = clip(_dot(self.V, d) * shape.scale_v >> 24, -most, most)

        def b(t, norm):
            return clip(mulshift(t, norm, 30), -most, most)
        return (b((x * x >> 20) - (1 << 20), shape.norm_uu), b(x * y >> 20, shape.norm),
                b((y * y >> 20) - (1 << 20) - (shape.skew_v * y >> 20), shape.norm_vv))


def _dot(a, b):
    return (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) >> 22


def range_of(inverse, share=1 << 30):
    quotient = (clip(share, 1 << 28, 1 << 32) << 16) // clip(inverse, 1 << 19, 1 << 34)
    return clip(quotient, 1 << 12, 1 << 27)


def add_axis(plane, k, axis):
    return tuple(clip(n + mulshift(k, x, 30), -(1 << 38), 1 << 38) for n, x in zip(plane, axis))


def facing(range_, patch):
    return add_axis((0, 0, 0), (1 << 46) // clip(range_, 1 << 12, 1 << 27), patch.C)


class Surface:
    """A plane and three curves in the frame of the patch it was coded in."""

    def __init__(self, plane, functions=0, patch=None, curves=(0, 0, 0)):
        self.plane = plane
        self.functions = functions  # the place of its F in FUNCTIONS
        self.patch = patch
        self.curves = curves

    def plane_range(self, d):
        return range_of(_dot(self.plane, d))

    def range(self, d, share=1 << 30):
        inverse = _dot(self.plane, d)
        if any(self.curves):
            inverse += sum(a * b for a, b in zip(self.curves, self.patch.squares(d))) >> 20
        return range_of(inverse, share)


def step_40(inverse, step):
    return max(mulshift(mulshift(inverse, inverse, 30), step, 6), 1)


def with_functions(plane, patch, functions, coefficients, t):
    """The surface of a plane and coefficients with the step t."""
    shape, most = patch.shape, 1 << 38
    q = list(coefficients) + [0] * (6 - len(coefficients))
    if q[0]:
        k = mulshift(mulshift(q[0], t, 0), shape.norm, 40)
        plane = add_axis(plane, clip(k, -most, most), patch.C)
    for value, scale, axis in ((q[1], shape.scale_u, patch.U), (q[2], shape.scale_v, patch.V)):
        if value:
            k = mulshift(mulshift(mulshift(value, t, 0), shape.norm, 30), scale, 24)
            plane = add_axis(plane, clip(k, -most, most), axis)
    curves = tuple(clip(mulshift(mulshift(value, t, 0), 1, 10), -(1 << 36), 1 << 36)
                   for value in q[3:])
    return Surface(plane, functions, patch, curves)
