#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Raw scans with every return: bits at given errors, bounds and bit for bit, each file verified
(./dev raw).

Prints a table for each scan and stores the measurements in raw.csv beside this file. A run that was
stopped goes on where it was: what the same build has measured of the same scan is not measured
again. Exits with 1 if a file is not as promised or a goal is missed.
"""
import argparse
import csv
import dataclasses
import os
import sys
import tempfile
import threading
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

import measure
import plan
import table

HERE = Path(__file__).resolve().parent
DATA = Path(os.environ.get("CURLIDAR_DATA", HERE.parents[1] / "../shared/data")).resolve()


def arguments():
    def listed(known):
        def parse(text):
            if unknown := set(text.split(",")) - set(known):
                raise argparse.ArgumentTypeError(f"{unknown.pop()!r} is not of {', '.join(known)}")
            return tuple(name for name in known if name in text.split(","))
        return parse

    parser = argparse.ArgumentParser(prog="./dev raw", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scans", nargs="*", metavar="SCANS",
                        help="only these; default: one of every sensor in CURLIDAR_DATA")
    parser.add_argument("--quick", action="store_true",
                        help="default effort and two errors only")
    parser.add_argument("--effort", type=listed(plan.EFFORTS), metavar="LIST",
                        help="9, default or both (9,default); default: both, with --quick default")
    parser.add_argument("--modes", type=listed(plan.MODES), default=plan.MODES, metavar="LIST",
                        help=f"of {','.join(plan.MODES)}; default: all")
    parser.add_argument("--fresh", action="store_true", help="measure again what is stored")
    parser.add_argument("--jobs", type=int, default=1, metavar="N",
                        help="scans encoded at once, one thread each; CPU times hold only for 1")
    parser.add_argument("--csv", type=Path, default=HERE / "raw.csv",
                        help="where the measurements go")
    parser.add_argument("--curlidar", type=Path, required=True, help=argparse.SUPPRESS)
    options = parser.parse_args()
    options.effort = options.effort or (("default",) if options.quick else plan.EFFORTS)
    return options


def identity(row):
    return tuple(row[key] for key in measure.IDENTITY)


class Store:
    """The file of measurements. One row for each thing measured, the newest; always whole."""

    def __init__(self, path):
        self.path, self.rows, self.lock = path, {}, threading.Lock()
        if path.is_file():
            with open(path, encoding="utf-8", newline="") as file:
                for row in csv.DictReader(file):
                    known = {key: row.get(key) or "" for key in measure.COLUMNS}
                    self.rows[identity(known)] = known

    def has(self, key):
        return any(row["key"] == key and not row["failure"] for row in self.rows.values())

    def add(self, row):
        """Numbers with the digits that matter, so that files compare."""
        row = {key: f"{value:.6g}" if isinstance(value, float) else str(value)
               for key, value in row.items()}
        with self.lock:
            self.rows[identity(row)] = row
            self.write()

    def write(self):
        scans = {name: i for i, name in enumerate(plan.SCANS)}
        ordered = sorted(self.rows.values(), key=lambda row: (
            scans.get(row["scan"], len(scans)), row["scan"], row["profile"], row["effort"],
            plan.MODES.index(row["mode"]), float(row["target_m"])))
        part = self.path.with_suffix(".part")
        with open(part, "w", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, measure.COLUMNS, lineterminator="\n")
            writer.writeheader()
            writer.writerows(ordered)
        part.replace(self.path)


def say(done, count, row):
    bits = table.number(table.bits_of(row, row["mode"]))
    seconds = f"{float(row['cpu_s']):.1f} s" if row["cpu_s"] != "" else "-"
    print(f"[{done}/{count}] {row['scan']} {table.label(*table.target_of(row))}, effort "
          f"{row['effort']}, {row['profile']}: {bits} b, {seconds} {row['failure']}".rstrip(),
          file=sys.stderr, flush=True)


def measure_all(measurer, scans, options, store):
    """Measures what is not stored. Returns the rows of each scan."""
    wanted = [(scan, setting) for scan in scans
              for setting in plan.settings_of(scan, options.effort, options.modes, options.quick)]
    keys = {scan.name: set() for scan in scans}
    missing = []
    for scan, setting in wanted:
        key = plan.key_of(measurer.build, scan, setting)
        keys[scan.name].add(key)
        if options.fresh or not store.has(key):
            missing.append((scan, setting))
    if len(missing) < len(wanted):
        print(f"{len(wanted) - len(missing)} of {len(wanted)} are measured already.",
              file=sys.stderr)
    with ThreadPoolExecutor(max(options.jobs, 1)) as pool:
        tasks = [pool.submit(measurer.measure, *each) for each in missing]
        try:
            for done, task in enumerate(as_completed(tasks), 1):
                row = task.result()
                store.add(row)
                say(done, len(tasks), row)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return {name: [row for row in store.rows.values() if row["key"] in wanted_keys]
            for name, wanted_keys in keys.items()}


def main():
    options = arguments()
    scans, absent = plan.scans_of(options.scans, DATA)
    for name in absent:
        print(f"{name}: not there, left out (CURLIDAR_DATA names the folder of the scans)",
              file=sys.stderr)
    if not scans:
        sys.exit("No scan to measure.")
    store, missed, wrong = Store(options.csv), 0, 0
    with tempfile.TemporaryDirectory() as folder:
        measurer = measure.Measurer(options.curlidar.resolve(), folder)
        scans = [dataclasses.replace(scan, attributes=measurer.attributes(scan)) for scan in scans]
        measured = measure_all(measurer, scans, options, store)
    for rows in measured.values():
        if rows:
            lines, misses, complaints = table.lines_of(rows)
            missed, wrong = missed + misses, wrong + complaints
            print("\n".join(lines), end="\n\n")
    print(f"{missed} goals missed, {wrong} measurements not as they should be.")
    if older := sum(row["build"] != measurer.build for row in store.rows.values()):
        print(f"{older} rows of {options.csv.name} are of other builds.", file=sys.stderr)
    return 1 if missed or wrong or absent and options.scans else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit("Stopped; the same command goes on from here.")
