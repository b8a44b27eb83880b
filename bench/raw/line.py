#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""One raw scan with every return, encoded by us at one error, decoded and measured: a JSON line as
`rate_distortion cloud` prints them. CPU times are of the whole command, which reads and writes
files too.

usage: line.py CURLIDAR SCAN ERROR_M EFFORT
"""
import json
import sys
import tempfile
from pathlib import Path

import measure
import plan

CODEC = "curlidar"
STATISTICS = ("mean", "rms", "p95", "max")


def line_of(report, size, compared, effort, encode_s, decode_s):
    """`report` of encode, `compared` of compare (raw scan, decoded scan)."""
    figures = measure.figures_of_encode(report, size)
    if "failure" in figures:
        raise measure.CommandFailed(figures["failure"])
    return {"codec": CODEC, "effort": effort, "returns": figures["points"], "bytes": size,
            "points_back": compared["points_b"],
            "nearest_to_decoded": {key: compared["a_to_b"][key] for key in STATISTICS},
            "nearest_to_raw": {key: compared["b_to_a"][key] for key in STATISTICS},
            "encode_ms": 1e3 * encode_s, "decode_ms": 1e3 * decode_s}


def main():
    curlidar, scan, error_m, effort = sys.argv[1:]
    setting = plan.Setting("nearest", float(error_m), effort)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        coded, decoded = folder / "scan.curl", folder / "scan.pcd"
        told, encode_s = measure.run([curlidar, "encode", scan, *setting.arguments(), "--threads",
                                      "1", "--json", "-o", coded], folder)
        _, decode_s = measure.run([curlidar, "decode", coded, "--attributes", "none", "--threads",
                                   "1", "--quiet", "-o", decoded], folder)
        compared, _ = measure.run([curlidar, "compare", scan, decoded, "--threads", "1", "--json"],
                                  folder)
        line = line_of(json.loads(told), coded.stat().st_size, json.loads(compared), effort,
                       encode_s, decode_s)
    print(json.dumps({**line, "setting": f"error_nn {float(error_m):g}"}))


if __name__ == "__main__":
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    try:
        main()
    except measure.CommandFailed as error:
        sys.exit(str(error))
