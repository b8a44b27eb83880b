#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Rate against distortion on real scans, ours and the peers side by side (./dev rate-distortion).

Prints a table for each scan. Without SCANS it measures one scan of every sensor in the data folder
and stores the curves: curves.csv and curves.svg beside this file.
"""
import argparse
import csv
import os
import sys
import tempfile
from pathlib import Path

import measure
import plot
import scans
import table

HERE = Path(__file__).resolve().parent
DATA = Path(os.environ.get("CURLIDAR_DATA", HERE.parents[1] / "../shared/data"))


def arguments():
    parser = argparse.ArgumentParser(prog="./dev rate-distortion", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scans", nargs="*", metavar="SCANS", help="only these; prints their tables")
    parser.add_argument("--all", action="store_true", help="every scan of the data folder; prints the tables")
    parser.add_argument("--csv", type=Path, help="where the curves go; the plot lies beside it")
    parser.add_argument("--bin", type=Path, required=True, help=argparse.SUPPRESS)
    return parser.parse_args()


def measure_grid(grid, options, folder):
    """All points of one grid, and prints its table. Returns (points, goals missed)."""
    program, curlidar = options.bin / "rate_distortion", options.bin / "curlidar"
    size, points, notes = measure.peers(grid, program)
    if options.ours:
        own, own_notes = measure.ours(grid, size, program, curlidar, folder)
        points += own
        notes += own_notes
    lines, missed = table.lines_of(points, options.ours)
    print("\n".join(lines))
    for note in notes:
        print(f"- {note}")
    print(flush=True)
    return points, missed if table.is_reference(points[0]) else 0


def measure_scan(scan, options):
    points, missed = [], 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        grids = scans.grids_of(scan, options.bin / "curlidar", folder)
        if not grids:
            raise RuntimeError("no cell holds a return")
        for grid in grids:
            more, misses = measure_grid(grid, options, folder)
            points += more
            missed += misses
    return points, missed


def store(points, path):
    """One line for each point: numbers with the digits that matter, so that files compare."""
    with open(path, "w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, measure.COLUMNS, lineterminator="\n", restval="",
                                extrasaction="ignore")
        writer.writeheader()
        for p in points:
            writer.writerow({key: f"{value:.6g}" if isinstance(value, float) else value
                             for key, value in p.items()})
    picture = path.with_suffix(".svg")
    picture.write_text(plot.draw(plot.read(path)), encoding="utf-8")
    print(f"Curves: {path.name} and {picture.name} in {path.parent}", file=sys.stderr)


def main():
    options = arguments()
    options.ours = measure.has_error_target(options.bin / "curlidar")
    if not options.ours:
        print("This command has no encode --error yet: peers only.\n")
    if options.scans:
        chosen = scans.from_paths(options.scans, DATA)
    elif (DATA / "MANIFEST.tsv").is_file():
        chosen = scans.from_manifest(DATA, options.all)
    else:
        sys.exit(f"No MANIFEST.tsv in {DATA}: set CURLIDAR_DATA, or name scans.")
    points, missed, failed = [], 0, 0
    for scan in chosen:
        try:
            more, misses = measure_scan(scan, options)
            points += more
            missed += misses
        except RuntimeError as error:
            print(f"**{scan.name}**, {scan.sensor}: {error}\n")
            failed += 1
    path = options.csv or (None if options.scans or options.all else HERE / "curves.csv")
    if path and points:
        store(points, path)
    if missed:
        print(f"{missed} of the goals on {scans.REFERENCE} are missed.")
    return 1 if missed or failed == len(chosen) else 0


if __name__ == "__main__":
    sys.exit(main())
