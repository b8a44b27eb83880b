#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""One scan on its grid, by all codecs, as JSON lines: the size of each grid, then a point a line
with the keys of measure.COLUMNS and CPU milliseconds (encode_ms, decode_ms). Those of the peers are
of the calls of their libraries; ours are of the whole command, which reads and writes files too.

usage: lines.py PROGRAM CURLIDAR SCAN TARGETS_M EFFORTS SETTINGS
  TARGETS_M, EFFORTS  of our codec, with commas: .05,.01 9,default
  SETTINGS            at most so many of each peer, 0: all
"""
import json
import sys
import tempfile
from pathlib import Path

import measure
import scans


def peers(grid, program, settings):
    """(size, lines)."""
    size, *lines = map(json.loads, measure.output_of(
        program, "peers", grid.path, "--settings", settings).splitlines())
    found = []
    for line in lines:
        if "bytes" in line:
            point = measure.point(grid, size, line["codec"], line["setting"], line)
            found.append({**point, "encode_ms": line["encode_ms"], "decode_ms": line["decode_ms"]})
        else:
            found.append(line)
    return size, found


def ours(grid, size, program, curlidar, targets_m, efforts, folder):
    for effort in efforts:
        for target_m in targets_m:
            try:
                point, wrong = measure.ours_at(grid, size, program, curlidar, target_m, effort,
                                               folder)
                yield {**point, "notes": wrong}
            except RuntimeError as error:
                yield {"codec": measure.OURS, "effort": effort, "target_m": target_m,
                       "skipped": str(error)}


def main(program, curlidar, scan, targets_m, efforts, settings):
    targets_m, efforts = [float(target) for target in targets_m.split(",")], efforts.split(",")
    scan = scans.Scan(Path(scan).name, Path(scan), "not stated")
    with tempfile.TemporaryDirectory() as name:
        grids = scans.grids_of(scan, curlidar, Path(name))
        if not grids:
            raise RuntimeError("no cell holds a return")
        for grid in grids:
            size, lines = peers(grid, program, settings)
            print(json.dumps({**size, "min_range": grid.min_range, "max_range": grid.max_range}))
            lines += ours(grid, size, program, curlidar, targets_m, efforts, Path(name))
            for line in lines:
                print(json.dumps(line), flush=True)


if __name__ == "__main__":
    if len(sys.argv) != 7:
        sys.exit(__doc__)
    try:
        main(*sys.argv[1:])
    except RuntimeError as error:
        sys.exit(str(error))
