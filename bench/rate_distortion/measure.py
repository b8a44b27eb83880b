# SPDX-License-Identifier: BSD-3-Clause
"""Runs the codecs on a grid: the peers through the rate_distortion program, ours through the
command. Every measured point of a curve is a dict with the keys of COLUMNS."""
import json
import re
import subprocess
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1]))
from common.timed import run  # noqa: E402

OURS = "curlidar"
TARGETS_M = (.05, .02, .01, .005, .002)
EFFORTS = ("9", "default")
BREAKDOWN = ("header", "mask", "partition", "modes", "coefficients", "labels", "residual")
COLUMNS = (
    "scan", "sensor", "min_range", "max_range", "rows", "cols", "cells", "codec", "setting",
    "bytes", "bits_per_cell", "points", "error_kind", "error_m", "rms_m", "p95_m", "max_m",
    "own_range_mean_m", "own_point_mean_m", "nearest_to_decoded_mean_m", "nearest_to_grid_mean_m",
    "target_m", "effort", *(f"{part}_bits" for part in BREAKDOWN))


def output_of(*command):
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    if run.returncode != 0:
        raise RuntimeError(run.stderr.strip().splitlines()[-1] if run.stderr.strip()
                           else f"{command[0]} ended with {run.returncode}")
    return run.stdout


def point(grid, size, codec, setting, measured):
    """One point. Its error is that of a cell's own return where order is kept (of the range for
    codecs of range images), otherwise the larger of the directed nearest-neighbour means."""
    nearest = max(measured["nearest_to_decoded"], measured["nearest_to_grid"],
                  key=lambda stats: stats["mean"])
    kind = next((kind for kind in ("own_range", "own_point") if kind in measured), "nearest")
    error = measured.get(kind, nearest)
    return {
        "scan": grid.scan.name, "sensor": grid.scan.sensor, "min_range": grid.min_range,
        "max_range": grid.max_range, "rows": size["rows"], "cols": size["cols"],
        "cells": size["cells"], "codec": codec, "setting": setting, "bytes": measured["bytes"],
        "bits_per_cell": measured["bytes"] * 8 / size["cells"], "points": measured["points"],
        "error_kind": kind, "error_m": error["mean"], "rms_m": error["rms"],
        "p95_m": error["p95"], "max_m": error["max"],
        "own_range_mean_m": measured.get("own_range", {}).get("mean"),
        "own_point_mean_m": measured.get("own_point", {}).get("mean"),
        "nearest_to_decoded_mean_m": measured["nearest_to_decoded"]["mean"],
        "nearest_to_grid_mean_m": measured["nearest_to_grid"]["mean"]}


def peers(grid, program):
    """(size of the grid, points, what was left out and why)."""
    size, *lines = map(json.loads, output_of(program, "peers", grid.path).splitlines())
    points = [point(grid, size, line["codec"], line["setting"], line)
              for line in lines if "bytes" in line]
    notes = [f"{line['codec']} {line.get('setting', '')}".strip() + f": {line['skipped']}"
             for line in lines if "skipped" in line]
    return size, points, notes


def has_error_target(curlidar):
    """Whether the command knows --error and --effort (its older ones have --error-stop only)."""
    usage = output_of(curlidar, "encode", "--help")
    return all(re.search(rf"^\s+{option}[ ,=]", usage, re.MULTILINE)
               for option in ("--error", "--effort"))


def ours_at(grid, size, program, curlidar, target_m, effort, folder):
    """One file of ours, decoded by the command and measured here, not by its encoder."""
    coded, decoded = folder / "ours.curl", folder / "ours.pcd"
    options = [] if effort == "default" else ["--effort", effort]
    told, encode_s = run(
        [curlidar, "encode", grid.path, "--profile", "compact", "--error", str(target_m), *options,
         "--attributes", "none", "--threads", "1", "--json", "-o", coded], folder)
    report = json.loads(told)
    _, decode_s = run([curlidar, "decode", coded, "--threads", "1", "--quiet", "-o", decoded],
                      folder)
    measured = json.loads(output_of(program, "errors", grid.path, decoded))
    measured["bytes"] = coded.stat().st_size
    result = point(grid, size, OURS, f"error {target_m} effort {effort}", measured)
    result.update(target_m=target_m, effort=effort, encode_ms=1e3 * encode_s,
                  decode_ms=1e3 * decode_s)
    result.update({f"{part}_bits": report.get("breakdown", {}).get(part) for part in BREAKDOWN})
    return result, disagreements(report, result)


def disagreements(report, result):
    """Where the encoder's own figures, or its promise on the error, do not hold."""
    wrong = []
    name = f"{OURS} {result['setting']}"
    for key, own in (("bytes", result["bytes"]), ("mean_error_m", result["own_point_mean_m"])):
        said = report.get(key)
        if said is not None and abs(said - own) > 1e-3 * own:
            wrong.append(f"{name}: encode says {key} {said:g}, measured {own:g}")
    target_m, error_m = result["target_m"], result["error_m"]
    if not .95 * target_m < error_m <= target_m:
        wrong.append(f"{name}: mean error {error_m:.5f} m is outside (0.95 E, E]")
    return wrong


def ours(grid, size, program, curlidar, folder):
    """(points, notes): every target at effort 9 and at the default effort."""
    points, notes = [], []
    for target_m in TARGETS_M:
        for effort in EFFORTS:
            try:
                result, wrong = ours_at(grid, size, program, curlidar, target_m, effort, folder)
            except RuntimeError as error:
                notes.append(f"{OURS} error {target_m} effort {effort}: {error}")
                continue
            points.append(result)
            notes += wrong
    return points, notes
