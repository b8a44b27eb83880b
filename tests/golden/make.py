#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes the golden files anew: simulated scans, encoded by the command, and their JSON twins.

    tests/golden/make.py COMMAND GOLDEN_TOOL        (build/test/bin/curlidar and
                                                     build/test/tests/golden/golden_tool)

For changes of the format only: what is in tests/golden/compact is decoded by every later version.
"""
import hashlib
import json
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1] / "spec"))
from container import file_of, read_chunks, varint

COMPACT = Path(__file__).resolve().parent / "compact"
# name: scene, sensor, options of simulate, columns of the grid, options of encode
ENCODED = {
    "street-16": ("street", "vlp16", [], 96, ["--error", 0.05, "--no-index"]),
    "room-16-fast": ("room", "vlp16", [], 40, ["--error", 0.02, "--effort", 1, "--no-index"]),
    "forest-40-small": ("forest", "pandar40p", [], 32, ["--error", 0.05, "--effort", 9]),
    "corridor-32-fine": ("corridor", "os1-32", [], 24, ["--error", 0.002, "--no-index"]),
    "room-64-noisy": ("room", "pandar64", ["--noise", 0.1], 20, ["--error", 0.01, "--no-index"]),
    "forest-40-step": ("forest", "pandar40p", [], 60, ["--step", 0.03, "--no-index"]),
    "room-32-layers": ("room", "os0-32", ["--noise", 0, "--dropout", 0], 40,
                       ["--step", 0.004, "--effort", 9]),
    "street-128": ("street", "os0-128", [], 8, ["--error", 0.08, "--no-index"]),
    "college-32-step": ("newer-college", "hdl32e", [], 40, ["--step", 0.25]),
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
    "rays-named": ("street-16", {"rays": {
        "table": 3, "unit": 1125899906843, "firings": [20 * k + k * k % 7 for k in range(96)]}}),
    "rays-moved": ("room-64-noisy", {"bands": 2, "sectors": 2, "rays": {
        "table": 1, "firings": [190 * k + 37 for k in range(20)],
        "turn_shift": 4, "move_shift": 2,
        "motion": [[160000, -48000, 33554432], [92000, -1200, 400], *[[0, 0, 0]] * 4]}}),
    "rays-own": ("room-16-fast", {
        "range_offset": [(k * 5147) % 2048 - 1024 for k in range(16)], "offset_shift": 3,
        "elevation_shift": 6, "lattice": 17179869, "step": 6000, "rays": {
            "slots": 36000, "unit": 562949953421, "azimuth_shift": 7, "phase_shift": 1,
            "firings": [880 * k + (k * k * 31) % 41 + (300 if k > 30 else 0) for k in range(40)],
            "rays": [[(k % 4 - 1) * 67108864, 9000 * (k // 8) - 700 * k, 1704 * (k % 2 * 2 - 1),
                      (k * 26) % 131 // 2 * 2 - 64] for k in range(16)],
            "motion": [[9000000, -1234567, 250000000], [-70000, 1000, 13], [5, -600000, 70000],
                       [0, 6000, 0], [0, 0, -800000000], [65536000, -1, 0]]}}),
    "tiny-leaves": ("street-16", {"root_log2": 2, "smallest_leaf": 1, "columns": 40}),
    "large-roots": ("forest-40-small", {"root_log2": 5, "smallest_leaf": 64, "effort": 2}),
    "empty-rows": ("street-16", {"empty_rows": [0, 1, 6, 7, 8, 15], "columns": 48}),
    "one-row": ("street-16", {"rows": 1, "elevation": [0], "columns": 96}),
    "one-cell": ("street-16", {"only_cell": [9, 17], "columns": 32, "residual_step": 64}),
    "no-return": ("street-16", {"empty_rows": list(range(16)), "columns": 24}),
    "single": ("street-16", {"rows": 1, "columns": 1, "only_cell": [0, 0]}),
}
# name: the file that it is the beginning of, share of its bytes in 1/100
CUT = {"cut-in-mask": ("segments", 15), "cut-in-field": ("segments", 60),
       "cut-in-residual": ("corridor-32-fine", 70)}


# Streams of noise, which reach what no encoder would write. name: the file that gives the row
# table and rays, way of the mask (None: the mask of that file), parameters in the order of the file; flags:
# root_log2, 8 residuals, 32 a turn, 64 a lattice.
NOISE = {
    "noise-mask-1": ("street-16", 1, (0x2B, 16, 24, 9000, 4, 500, 900, 893)),
    "noise-mask-2": ("street-16", 2, (0x23, 16, 24, 20000, 1, 2000, 5)),
    "noise-mask-3": ("street-16", 3, (0x2D, 16, 24, 1 << 24, 64, 1, 3000, 0)),
    "noise-field": ("room-16-fast", None, (0x04, 16, 40, 5000, 8)),
    "noise-residual": ("heights-offsets", None, (0x2C, 16, 40, 5000, 8, 700, 1000, 980)),
    "noise-rays": ("rays-own", None, (0x0C, 16, 40, 5000, 8, 700)),
    "noise-lattice": ("heights-offsets", None, (0x6D, 16, 40, 5000, 8, 17179869, 1000, 980)),
}


def run(*arguments):
    return subprocess.run([str(a) for a in arguments], check=True, stdout=subprocess.PIPE).stdout


def noise_file(name, source, way, parameters):
    def noise(what, size):
        return hashlib.shake_256(f"{name} {what}".encode()).digest(size)
    chunks = {chunk.kind: chunk.payload
              for chunk in read_chunks((COMPACT / f"{source}.curl").read_bytes())}
    mask = chunks[0x13]
    if way is not None:
        # Two plain decisions, the high bit of `way` first; a one is the lower half of the values.
        mask = noise("mask", 700)
        mask = bytes([(3 - way) << 6 | mask[0] & 63]) + mask[1:]
    payload = bytes([parameters[0]]) + b"".join(varint(value) for value in parameters[1:])
    made = [(0x10, payload), (0x11, chunks[0x11])]
    made += [(0x16, chunks[0x16])] if 0x16 in chunks else []
    made += [(0x13, mask), (0x14, noise("field", 2500))]
    if parameters[0] & 8:
        made.append((0x15, varint(40) + noise("flags", 40) + noise("residual", 3500)))
    return file_of(made)


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
    for name, arguments in NOISE.items():
        (COMPACT / f"{name}.curl").write_bytes(noise_file(name, *arguments))
    for file in sorted(COMPACT.glob("*.curl")):
        file.with_suffix(".json").write_bytes(run(tool, "twin", file))
    files = [*COMPACT.iterdir()]
    print(f"{len(files)} files, {sum(file.stat().st_size for file in files)} bytes")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
