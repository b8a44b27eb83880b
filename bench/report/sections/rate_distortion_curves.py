# SPDX-License-Identifier: BSD-3-Clause
"""Rate and distortion: which codecs are measured with which commands, and the curves that come of
it."""
import shutil
import sys
from pathlib import Path

from common import curves
from frame.cells import Missing

BENCH = Path(__file__).resolve().parents[2]
SECTION = "rate_distortion"
ERRORS_M = (.001, .005, .01, .02, .05)
QUICK_ERRORS_M = (.005, .02, .05)
QUICK_SETTINGS = 6  # of each peer
QUICK_CODECS = ("pcl-octree", "draco-kd-tree", "xyz-zstd19", "jpeg-xl-e9-1024", "jpeg-xl-e9-2048",
                "range-zstd19-2048", "range-zstd19-4096")
OURS = "curlidar"
TITLES = {
    OURS: "curlidar", f"{OURS}, effort 9": "curlidar, effort 9",
    "pcl-octree": "PCL octree", "draco-kd-tree": "Draco kd-tree",
    "xyz-zstd19": "x, y, z: deltas + zstd-19", "jpeg-xl-e9": "range image + JPEG XL e9",
    "range-zstd19": "range image, deltas + zstd-19", "png": "range image + PNG",
    "gpcc-octree": "G-PCC octree", "gpcc-predictive": "G-PCC predictive",
    "gpcc-angular": "G-PCC predictive, angular, lossy", "cloudini": "Cloudini zstd"}
IMAGES = ("jpeg-xl-e9", "range-zstd19", "png")
EXTERNAL = {"tmc3": ("gpcc-angular", "gpcc-predictive", "gpcc-octree"),
            "pcd_to_cloudini_converter": ("cloudini",)}
TOOLS = {"tmc3": "G-PCC", "pcd_to_cloudini_converter": "Cloudini"}
NOT_REACHED = Missing("not reached by its settings")


def length(metres):
    return f"{metres * 1e3:g} mm" if metres < .01 else f"{metres * 1e2:g} cm"


def key_of(metres):
    return f"at_{metres * 1e3:g}mm"


def errors_of(context):
    return QUICK_ERRORS_M if context.quick else ERRORS_M


def efforts_of(context):
    return ("default",) if context.quick else ("default", "9")


def name_of(line):
    """The codec of a line; ours is one for each effort."""
    codec = line["codec"]
    return f"{codec}, effort {line['effort']}" if line.get("effort") == "9" else codec


def title_of(codec):
    base, _, columns = codec.rpartition("-")
    if columns.isdigit() and base in IMAGES:
        return TITLES[base].replace("range image", f"range image rings x {columns}")
    return TITLES.get(codec, codec)


# What is measured -------------------------------------------------------------------------------

def script(*parts):
    return [sys.executable, "-B", BENCH.joinpath(*parts)]


def commands_of(context, item):
    """(part, key, command) of everything that is measured of a scan or scene."""
    cloud, program = context.cloud(item), context.bin / "rate_distortion"
    errors, efforts = errors_of(context), efforts_of(context)
    settings = QUICK_SETTINGS if context.quick else 0
    yield "grid", {"settings": settings}, [
        *script("rate_distortion", "lines.py"), program, context.curlidar, cloud,
        ",".join(f"{error:g}" for error in errors), ",".join(efforts), str(settings)]
    for effort in efforts:
        for error in errors:
            yield "raw", {"codec": OURS, "error_m": error, "effort": effort}, [
                *script("raw", "line.py"), context.curlidar, cloud, f"{error:g}", effort]
    few = ["--settings", str(settings), "--codecs", ",".join(QUICK_CODECS)] if context.quick else []
    yield "raw", {"codec": "peers", "settings": settings}, [program, "cloud", cloud, *few]
    for tool, codecs in EXTERNAL.items():
        path = shutil.which(tool)
        if path:
            for codec in codecs:
                yield "raw", {"codec": codec, "settings": settings}, [
                    *script("peers", "external.py"), codec, Path(path), context.curlidar, cloud,
                    str(settings)]


def lines_of(context, item, part):
    """All lines of a part, failures as lines of their codec."""
    lines = []
    for which, key, command in commands_of(context, item):
        if which != part:
            continue
        for line in context.measure(SECTION, {"input": item.id, "part": part, **key}, command):
            lines.append({"codec": key.get("codec", "grid"), "effort": key.get("effort", ""),
                          **line} if "failure" in line else line)
    return lines


def inputs_of(context, part):
    """Everything; in quick mode a scan and a scene, on the grid the first of them only."""
    if not context.quick:
        return context.inputs
    few = list(dict.fromkeys([*context.inputs[:1], *context.scenes[-1:]]))
    return few[:1] if part == "grid" else few


# What was measured ------------------------------------------------------------------------------

class Curves:
    """The curves of one input: points by codec, and why a codec has none."""

    def __init__(self, total):
        self.total, self.points, self.reasons = total, {}, {}

    def add(self, line):
        codec, reason = name_of(line), line.get("skipped") or line.get("failure")
        self.points.setdefault(codec, [])
        if reason:
            self.reasons[codec] = Missing(reason)
        else:
            self.points[codec].append(self.point(line))

    def point(self, line):
        both = [line["nearest_to_decoded"], line["nearest_to_raw"]]
        return {"bits": 8 * line["bytes"] / self.total, "error_m": max(s["mean"] for s in both),
                "back": line["points_back"], "encode_ms": line["encode_ms"],
                "decode_ms": line["decode_ms"],
                "p95_m": max(s["p95"] for s in both), "setting": line["setting"]}

    def bits_at(self, codec, error_m):
        points = self.points.get(codec, [])
        found = curves.rate_at(points, error_m, "bits", curves.SLACK)
        if found is not None:
            return found
        return NOT_REACHED if points else self.reasons.get(codec, Missing("not measured"))

    def near(self, codec, error_m, key):
        """A figure of the setting whose error is nearest to one."""
        point = curves.nearest(self.points[codec], error_m)
        if point is None:
            return self.reasons.get(codec, NOT_REACHED)
        return point[key] if point[key] is not None else Missing("its command does not decode")


class GridCurves(Curves):
    def point(self, line):
        return {"bits": line["bits_per_cell"], "error_m": line["error_m"], "back": line["points"],
                "encode_ms": line["encode_ms"], "decode_ms": line["decode_ms"],
                "p95_m": line["p95_m"], "setting": line["setting"],
                "error_kind": line["error_kind"]}


def raw_curves(context, item):
    lines = lines_of(context, item, "raw")
    total = next((line["returns"] for line in lines if "returns" in line), 0)
    found = Curves(total)
    for line in lines:
        if "codec" in line:
            found.add(line)
    return found


def grid_curves(context, item):
    """(heading of its grid, curves) for each grid of an input."""
    grids = []
    for line in lines_of(context, item, "grid"):
        if "cells" in line and "codec" not in line:
            grids.append((f"{line['rows']} x {line['cols']} cells, {line['min_range']} m .. "
                          f"{line['max_range']}", GridCurves(line["cells"])))
        elif not grids:
            grids.append(("no grid", GridCurves(0)))
            grids[-1][1].add(line)
        else:
            grids[-1][1].add(line)
    return grids
