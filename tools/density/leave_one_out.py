#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What a density profile is worth on drives that did not teach it.

For every group of LIST (lines of GROUP PATH) a profile is fitted to the other groups' scans and the
group's own scans are upsampled by TULIP's protocol with it. Prints the mean of every group and the
mean of these.
"""
import argparse
import collections
import json
import statistics
import subprocess
import tempfile
from pathlib import Path

FIGURES = ("mae_m", "both_valid_mae_m", "chamfer_m2", "iou", "f1", "mask_iou", "p50", "p95")


def read_list(path):
    groups = collections.defaultdict(list)
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.strip():
            group, scan = line.split(maxsplit=1)
            groups[group].append(scan)
    return groups


def measure(program, scan, profile):
    """{method: figures} of one scan."""
    output = subprocess.run([program, "upsampling", scan, "--profile", profile], check=True,
                            stdout=subprocess.PIPE, text=True).stdout
    lines = [json.loads(line) for line in output.splitlines()]
    return {line["method"]: line for line in lines if "method" in line}


def mean(rows):
    """Means of the figures of rows {method: figures}."""
    return {method: {figure: statistics.fmean(row[method][figure] for row in rows)
                     for figure in FIGURES} for method in rows[0]}


def show(name, methods):
    for method, figures in methods.items():
        numbers = " ".join(f"{figure} {value:.3f}" for figure, value in figures.items())
        print(f"{name:10} {method:24} {numbers}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("list", type=Path)
    parser.add_argument("--programs", type=Path, default=Path("build/ci/bin"),
                        help="folder of density and report_measure")
    parser.add_argument("--test", type=Path, help="scans to judge by, if not those of the list")
    parser.add_argument("--test-every", type=int, default=1)
    parser.add_argument("--fit", default="", help="further options of density, in one word")
    given = parser.parse_args()
    groups = read_list(given.test or given.list)
    results = []
    with tempfile.TemporaryDirectory() as folder:
        for group, scans in groups.items():
            profile = str(Path(folder) / f"{group}.toml")
            subprocess.run([given.programs / "density", "image", given.list, profile, "--without",
                            group, *given.fit.split()], check=True, stdout=subprocess.DEVNULL)
            rows = [measure(given.programs / "report_measure", scan, profile)
                    for scan in scans[::given.test_every]]
            results.append(mean(rows))
            show(group, results[-1])
    show("mean", mean(results))


if __name__ == "__main__":
    main()
