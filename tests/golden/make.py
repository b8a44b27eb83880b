#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes the golden files anew: simulated scans, encoded by the command, and their JSON twins.

    tests/golden/make.py COMMAND GOLDEN_TOOL        (build/test/bin/curlidar and
                                                     build/test/tests/golden/golden_tool)

For changes of the format only: what is in tests/golden/compact is decoded by every later version.
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

COMPACT = Path(__file__).resolve().parent / "compact"
# name: scene, sensor, options of simulate, columns of the grid, options of encode
ENCODED = {
    "street-16": ("street", "vlp16", [], 64, ["--error", 0.05, "--no-index"]),
    "room-16-fast": ("room", "vlp16", [], 40, ["--error", 0.02, "--effort", 1, "--no-index"]),
    "forest-40-small": ("forest", "pandar40p", [], 32, ["--error", 0.05, "--effort", 9]),
    "corridor-32-fine": ("corridor", "os1-32", [], 24, ["--error", 0.002, "--no-index"]),
    "street-128": ("street", "os0-128", [], 12, ["--error", 0.08, "--no-index"]),
    "college-32-step": ("newer-college", "hdl32e", [], 24, ["--step", 0.25]),
}
# name: the file above it is made from, changes
RECODED = {
    "segments": ("street-16", {"bands": 2, "sectors": 3, "index": True}),
    "segments-residual": ("corridor-32-fine", {"bands": 3, "sectors": 2, "index": False}),
    "part-of-a-turn": ("street-16", {"columns": 40, "turn_columns": 2048, "first_column": 2037}),
    "heights-offsets": ("room-16-fast", {
        "height": [1000 * k - 7000 for k in range(16)], "height_shift": 5,
        "range_offset": [(k * 7919) % 4096 - 2048 for k in range(16)], "offset_shift": 3}),
    "lattice": ("room-16-fast", {"lattice": 17179869, "step": 6000}),
    "tiny-leaves": ("street-16", {"root_log2": 2, "smallest_leaf": 1, "columns": 40}),
    "large-roots": ("forest-40-small", {"root_log2": 5, "smallest_leaf": 64, "effort": 2}),
    "empty-rows": ("street-16", {"empty_rows": [0, 1, 6, 7, 8, 15], "columns": 48}),
    "one-row": ("street-16", {"rows": 1, "elevation": [0], "columns": 64}),
    "one-cell": ("street-16", {"only_cell": [9, 17], "columns": 32, "residual_step": 64}),
    "no-return": ("street-16", {"empty_rows": list(range(16)), "columns": 24}),
    "single": ("street-16", {"rows": 1, "columns": 1, "only_cell": [0, 0]}),
}
# name: the file that it is the beginning of, share of its bytes in 1/100
CUT = {"cut-in-mask": ("segments", 15), "cut-in-field": ("segments", 60),
       "cut-in-residual": ("corridor-32-fine", 70)}


def run(*arguments):
    return subprocess.run([str(a) for a in arguments], check=True, stdout=subprocess.PIPE).stdout


def main(command, tool):
    for old in [*COMPACT.glob("*.curl"), *COMPACT.glob("*.json")]:
        old.unlink()
    COMPACT.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        for name, (scene, sensor, simulated, columns, options) in ENCODED.items():
            scan, grid = Path(folder) / f"{name}.pcd", Path(folder) / f"{name}.grid.pcd"
            run(command, "simulate", "--scene", scene, "--sensor", sensor, *simulated, "-q",
                "-o", scan)
            run(command, "project", scan, "--rows", "rings", "--cols", columns, "--min-range", 1,
                "--max-range", "max", "-q", "-o", grid)
            run(command, "encode", grid, "--cols", columns, "--attributes", "none", *options,
                "-q", "-o", COMPACT / f"{name}.curl")
    for name, (source, changes) in RECODED.items():
        run(tool, "recode", COMPACT / f"{source}.curl", COMPACT / f"{name}.curl",
            json.dumps(changes))
    for name, (source, share) in CUT.items():
        whole = (COMPACT / f"{source}.curl").read_bytes()
        (COMPACT / f"{name}.curl").write_bytes(whole[:len(whole) * share // 100])
    for file in sorted(COMPACT.glob("*.curl")):
        file.with_suffix(".json").write_bytes(run(tool, "twin", file))
    files = [*COMPACT.iterdir()]
    print(f"{len(files)} files, {sum(file.stat().st_size for file in files)} bytes")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
