# SPDX-License-Identifier: BSD-3-Clause
"""Poses of scans, one 3 x 4 matrix a line (T_map_sensor).

  poses.py slice POSES FIRST LAST OUT                      lines [FIRST, LAST)
  poses.py length POSES                                    {"scans", "length_m"}
  poses.py union OUT.npy MIN_M MAX_M STEP FIRST POSES SCANS...
      the returns of raw scans within limits of range, in the frame of the map; of every STEP-th scan
      from FIRST on (STEP 0: all; negative: all but those)
"""
import json
import sys
from pathlib import Path

import numpy


def lines_of(path):
    lines = Path(path).read_text(encoding="utf-8").splitlines()
    return [line for line in lines if line.strip() and not line.lstrip().startswith("#")]


def matrices(path):
    return [numpy.array(line.replace(",", " ").split()[:12], dtype=float).reshape(3, 4)
            for line in lines_of(path)]


def returns_of(path):
    """N x 3, metres."""
    if Path(path).suffix == ".npy":
        points = numpy.load(path).astype(float)[:, :3]
    else:
        points = numpy.fromfile(path, dtype="<f4").reshape(-1, 4)[:, :3].astype(float)
    return points[numpy.isfinite(points).all(1) & (points != 0).any(1)]


def is_chosen(i, step, first):
    if step == 0:
        return True
    chosen = i >= first and (i - first) % abs(step) == 0
    return chosen if step > 0 else not chosen


def union(out, nearest_m, farthest_m, step, first, poses, *scans):
    parts = []
    for i, (scan, pose) in enumerate(zip(scans, matrices(poses), strict=True)):
        if is_chosen(i, int(step), int(first)):
            points = returns_of(scan)
            ranges = numpy.linalg.norm(points, axis=1)
            points = points[(ranges >= float(nearest_m)) & (ranges <= float(farthest_m))]
            parts.append(points @ pose[:, :3].T + pose[:, 3])
    numpy.save(out, numpy.concatenate(parts).astype(numpy.float32))


def length(poses):
    places = numpy.array([pose[:, 3] for pose in matrices(poses)])
    steps = numpy.linalg.norm(numpy.diff(places, axis=0), axis=1)
    print(json.dumps({"scans": len(places), "length_m": float(steps.sum())}))


def cut(poses, first, last, out):
    lines = lines_of(poses)[int(first):int(last)]
    Path(out).write_text("".join(line + "\n" for line in lines), encoding="utf-8")


if __name__ == "__main__":
    {"slice": cut, "length": length, "union": union}[sys.argv[1]](*sys.argv[2:])
