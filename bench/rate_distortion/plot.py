#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draws curves.csv as an SVG: one panel for each grid, mean error across, bits a cell upwards.

usage: plot.py CURVES.csv OUT.svg
"""
import csv
import math
import sys
from html import escape

from measure import OURS
from table import GOALS, is_reference

from common.curves import frontier

PANEL_W, PANEL_H, PER_ROW = 360, 250, 3
LEFT, RIGHT, TOP, BOTTOM = 40, 18, 34, 40  # of a panel, around its axes
HEAD = 56                                  # above the panels, for the legend
ERRORS_M = (.001, .002, .005, .01, .02, .05, .1)
BITS = (.25, .5, 1, 2, 4, 8, 16, 32)
COLOURS = {"jpeg-xl-e9": "#0072b2", "range-zstd19": "#56b4e9", "png": "#009e73",
           "draco-kd-tree": "#e69f00", "pcl-octree": "#cc79a7", "xyz-zstd19": "#999999"}
OUR_COLOURS = {"9": "#d00000", "default": "#ff8a80"}


def curves_of(points):
    """(label, colour, points) of every curve of a grid, ours last: it lies on top."""
    for codec, colour in COLOURS.items():
        yield codec, colour, [p for p in points if p["codec"] == codec]
    for effort, colour in OUR_COLOURS.items():
        yield (f"{OURS}, effort {effort}", colour,
               [p for p in points if p["codec"] == OURS and p["effort"] == effort])


class Panel:
    """The axes of one grid, at a place of the page."""

    def __init__(self, x, y):
        self.left, self.right = x + LEFT, x + PANEL_W - RIGHT
        self.top, self.bottom = y + TOP, y + PANEL_H - BOTTOM

    def x(self, error_m):
        t = math.log(error_m / ERRORS_M[0]) / math.log(ERRORS_M[-1] / ERRORS_M[0])
        return self.left + t * (self.right - self.left)

    def y(self, bits):
        t = math.log(bits / BITS[0]) / math.log(BITS[-1] / BITS[0])
        return self.bottom - t * (self.bottom - self.top)

    def axes(self, title):
        out = [text(self.left, self.top - 10, title, "start", "#222", 10)]
        for e in ERRORS_M:
            out.append(line(self.x(e), self.top, self.x(e), self.bottom))
            label = f"{e * 1e3:g} mm" if e < .01 else f"{e * 1e2:g} cm"
            out.append(text(self.x(e), self.bottom + 14, label, "middle"))
        for b in BITS:
            out.append(line(self.left, self.y(b), self.right, self.y(b)))
            out.append(text(self.left - 5, self.y(b) + 3, f"{b:g}", "end"))
        return out

    def curve(self, points, colour):
        kept = [p for p in frontier(points)
                if ERRORS_M[0] <= p["error_m"] <= ERRORS_M[-1]
                and BITS[0] <= p["bits_per_cell"] <= BITS[-1]]
        places = [f"{self.x(p['error_m']):.1f},{self.y(p['bits_per_cell']):.1f}" for p in kept]
        if not places:
            return []
        out = [f'<polyline points="{" ".join(places)}" fill="none" stroke="{colour}" '
               'stroke-width="1.6"/>']
        return out + [f'<circle cx="{x}" cy="{y}" r="2" fill="{colour}"/>'
                      for x, y in (place.split(",") for place in places)]

    def goals(self):
        return [f'<path d="M{self.x(e) - 4:.1f} {self.y(goal):.1f}h8m-4 -4v8" '
                f'stroke="{colour}" stroke-width="1.2"/>'
                for e, goals in GOALS.items() for goal, colour in zip(goals, OUR_COLOURS.values())]


def text(x, y, content, anchor, colour="#555", size=9):
    return (f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{colour}" '
            f'font-size="{size}">{escape(content)}</text>')


def line(x1, y1, x2, y2, colour="#ddd", width=.7):
    return (f'<path d="M{x1:.1f} {y1:.1f}L{x2:.1f} {y2:.1f}" stroke="{colour}" '
            f'stroke-width="{width}"/>')


def legend(points):
    out = [text(LEFT, 20, "Bits per occupied cell against mean error; crosses: the goals", "start",
                "#222", 13)]
    x = LEFT
    for label, colour, curve in curves_of(points):
        if not curve:
            continue
        out += [line(x, 38, x + 18, 38, colour, 2.5), text(x + 23, 42, label, "start", "#222", 11)]
        x += 36 + 6.4 * len(label)
    return out


def draw(points):
    """The whole picture as a string."""
    grids = {}
    for p in points:
        grids.setdefault((p["scan"], p["min_range"], p["max_range"]), []).append(p)
    width = PER_ROW * PANEL_W
    height = HEAD + -(-len(grids) // PER_ROW) * PANEL_H
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
           f'width="{width}" height="{height}" font-family="sans-serif">',
           f'<rect width="{width}" height="{height}" fill="white"/>', *legend(points)]
    for i, ((_, near, far), grid) in enumerate(grids.items()):
        panel = Panel(i % PER_ROW * PANEL_W, HEAD + i // PER_ROW * PANEL_H)
        first = grid[0]
        sensor, folder = first["sensor"].split(" (")[0], first["scan"].rpartition("/")[0]
        out += panel.axes(f"{sensor}, {folder} ({near} m .. {far})")
        for _, colour, curve in curves_of(grid):
            out += panel.curve(curve, colour)
        out += panel.goals() if is_reference(first) else []
    return "\n".join([*out, "</svg>", ""])


def read(path):
    """The points of a stored curve, with the numbers that a plot or a table needs."""
    with open(path, encoding="utf-8", newline="") as file:
        points = list(csv.DictReader(file))
    for p in points:
        p["error_m"], p["bits_per_cell"] = float(p["error_m"]), float(p["bits_per_cell"])
    return points


def main():
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        return 2
    with open(sys.argv[2], "w", encoding="utf-8") as file:
        file.write(draw(read(sys.argv[1])))
    return 0


if __name__ == "__main__":
    sys.exit(main())
