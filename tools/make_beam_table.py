#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes a frozen beam table (docs/format/beams/*.txt): fitted to scans that are not motion
compensated, or, without scans, with the very numbers of a profile, where drivers use these.

    tools/make_beam_table.py --profile profiles/hdl64e-kitti.toml --number 1 --slots 4000 \\
        --unit-mm 2 --lateral-mm 26 --output docs/format/beams/hdl64e-kitti.txt SCAN ...

The profile gives the first guess of elevations, heights and lateral offsets, good to a fraction of
a millimetre in 10 m. Scans are KITTI's .bin or binary .pcd of four floats a point, ring by ring from
the top, each ring beginning at azimuth 0. Coordinates are rounded to a millimetre, so that one scan
determines a beam to some micrometres. Needs NumPy.

What is fitted of each ring: elevation, height, azimuth offset, range phase; and the lateral offset
unless --lateral-mm says that rings have this, turn about to the right and left.
"""
import argparse
import math
import re
from pathlib import Path

import numpy as np


def read_scan(path):
    data = Path(path).read_bytes()
    if path.endswith(".pcd"):
        begin = data.index(b"DATA binary\n") + 12
        count = int(re.search(rb"\nPOINTS (\d+)", data[:begin]).group(1))
        data = data[begin:begin + 16 * count]
    points = np.frombuffer(data, "<f4").reshape(-1, 4)[:, :3].astype(float)
    return points[np.linalg.norm(points, axis=1) > 0.3]


def rings_of(points):
    azimuth = np.arctan2(points[:, 1], points[:, 0]) % (2 * math.pi)
    ring = np.zeros(len(points), int)
    ring[1:] = np.cumsum(np.diff(azimuth) < -math.pi)
    return ring


def profile_list(text, key):
    found = re.search(rf"^{key} = \[(.*?)\]", text, re.S | re.M)
    if not found:
        return np.zeros(0)
    return np.array([float(x) for x in found.group(1).split(",") if x.strip()])


class Beams:
    """Columns of `values`: elevation, height, lateral, azimuth offset, range phase."""

    def __init__(self, text, pitch, unit):
        self.pitch, self.unit = pitch, unit
        elevation = np.radians(profile_list(text, "elevation_deg"))
        none = np.zeros(len(elevation))
        columns = [profile_list(text, key) for key in ("vertical_offset_m", "horizontal_offset_m")]
        columns += [np.radians(profile_list(text, "azimuth_offset_deg")), none]
        self.values = np.stack([elevation] + [c if len(c) else none for c in columns], 1)

    def along(self, points, ring):
        """Azimuth and range of the beam that saw each point."""
        elevation, height, lateral = self.values[ring, :3].T
        rho = np.hypot(points[:, 0], points[:, 1])
        azimuth = np.arctan2(points[:, 1], points[:, 0]) - np.arcsin(lateral / rho)
        level = np.sqrt(rho**2 - lateral**2)
        return azimuth, level * np.cos(elevation) + (points[:, 2] - height) * np.sin(elevation)

    def start(self, points, ring):
        """Azimuth offsets (modulo the pitch) and phases from the circular means of each ring."""
        azimuth, distance = self.along(points, ring)
        for k in range(len(self.values)):
            at = ring == k
            for column, values, step in ((3, azimuth, self.pitch), (4, distance, self.unit)):
                mean = np.exp(2j * math.pi * values[at] / step).sum()
                self.values[k, column] = np.angle(mean) / 2 / math.pi * step

    def numbers(self, points, ring):
        """Firing slot (modulo the shift of its ring) and range number of each point."""
        azimuth, distance = self.along(points, ring)
        return (np.round((azimuth - self.values[ring, 3]) / self.pitch),
                np.round((distance - self.values[ring, 4]) / self.unit))

    def points(self, ring, slot, number):
        elevation, height, lateral, offset, phase = self.values[ring].T
        azimuth = slot * self.pitch + offset
        distance = self.unit * number + phase
        level = distance * np.cos(elevation)
        c, s = np.cos(azimuth), np.sin(azimuth)
        return np.c_[level * c - lateral * s, level * s + lateral * c,
                     distance * np.sin(elevation) + height]

    def refine(self, scans, fixed_lateral, limit):
        """One step of least squares for every ring."""
        free = [0, 1, 3, 4] if fixed_lateral else [0, 1, 2, 3, 4]
        for k in range(len(self.values)):
            rows, wanted = [], []
            for points, ring in scans:
                at = ring == k
                ring_points, rings = points[at], ring[at]
                slot, number = self.numbers(ring_points, rings)
                start = self.points(rings, slot, number)
                good = np.linalg.norm(ring_points - start, axis=1) < limit
                columns = []
                for column in free:
                    before = self.values[k, column]
                    self.values[k, column] = before + 1e-6
                    columns.append((self.points(rings, slot, number) - start)[good].ravel() / 1e-6)
                    self.values[k, column] = before
                rows.append(np.stack(columns, 1))
                wanted.append((ring_points - start)[good].ravel())
            step = np.linalg.lstsq(np.concatenate(rows), np.concatenate(wanted), rcond=None)[0]
            self.values[k, free] += step
        self.values[:, 4] = (self.values[:, 4] + self.unit / 2) % self.unit - self.unit / 2


def shifts_of(beams, scans, slots):
    """How many slots after its own azimuth each ring fired, the same for all scans."""
    rings = len(beams.values)
    found = []
    for points, ring in scans:
        used = np.zeros((rings, slots))
        used[ring, beams.numbers(points, ring)[0].astype(int) % slots] = 1
        shift = np.zeros(rings, int)
        votes = used[rings // 2]
        for _ in range(3):
            spectrum = np.fft.fft(np.minimum(votes, 1))
            for k in range(rings):
                match = np.fft.ifft(np.fft.fft(used[k]).conj() * spectrum).real
                shift[k] = (match.argmax() + slots // 2) % slots - slots // 2
            votes = sum(np.roll(used[k], shift[k]) for k in range(rings)) // max(1, rings // 10)
        found.append(shift - shift[rings // 2])
    for shift in found:
        if (shift != found[0]).any():
            raise SystemExit("the scans disagree on which lasers fire together")
    return found[0] - (found[0].min() + found[0].max()) // 2


def report(beams, scans, names):
    for name, (points, ring) in zip(names, scans):
        model = beams.points(ring, *beams.numbers(points, ring))
        distance = np.linalg.norm(model - points, axis=1) * 1000
        exact = np.mean(np.abs(np.round(model, 3) - points) < 2e-4)
        print(f"{name}: mean {distance.mean():.3f} mm, 99 % {np.percentile(distance, 99):.2f}, "
              f"worst {distance.max():.2f}; {100 * exact:.2f} % of coordinates to the millimetre")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--profile", required=True)
    parser.add_argument("--number", type=int, required=True)
    parser.add_argument("--slots", type=int, required=True)
    parser.add_argument("--unit-mm", type=float, required=True)
    parser.add_argument("--lateral-mm", type=float)
    parser.add_argument("--output", required=True)
    parser.add_argument("scans", nargs="*")
    options = parser.parse_args()

    pitch, unit = 2 * math.pi / options.slots, options.unit_mm / 1000
    scans = [(points, rings_of(points)) for points in map(read_scan, options.scans)]
    beams = Beams(Path(options.profile).read_text(), pitch, unit)
    shift = np.zeros(len(beams.values), int)
    if scans:
        if options.lateral_mm:
            beams.values[:, 2] = np.copysign(options.lateral_mm / 1000, beams.values[:, 2])
        beams.start(*scans[0])
        for step in range(6):
            beams.refine(scans, options.lateral_mm is not None, .002 if step < 3 else .0012)
        report(beams, scans, options.scans)
        shift = shifts_of(beams, scans, options.slots)
    Path(options.output).write_text(table_text(options, beams, shift))


def table_text(options, beams, shift):
    """The file: angles in 2^-32 of a turn, lengths in 2^-16 m."""
    turn = 2**32
    name = Path(options.output).stem
    lines = [f"# Beams of {name}, by tools/make_beam_table.py. Part of the format: never changed.",
             "# Number of the table, encoder positions of a turn, range unit in 2^-48 m;",
             "# then for each ring, from the top: elevation and azimuth offset (2^-32 of a turn),",
             "# height, lateral offset and range phase (2^-16 m).",
             f"{options.number} {options.slots} {round(options.unit_mm * 2**48 / 1000)}"]
    for (elevation, height, lateral, offset, phase), m in zip(beams.values, shift):
        angles = [elevation, offset - m * beams.pitch]
        lines.append(" ".join([str(round(a / 2 / math.pi * turn)) for a in angles] +
                              [str(round(x * 65536)) for x in (height, lateral, phase)]))
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
