#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Peers that are programs of their own, on one raw scan: JSON lines as `rate_distortion cloud`
prints them. CPU times are of the whole program, which reads and writes files too.

usage: external.py CODEC PROGRAM CURLIDAR SCAN SETTINGS
  CODEC     gpcc-octree, gpcc-predictive, gpcc-angular (PROGRAM: tmc3 of MPEG's TMC13) or cloudini
            (PROGRAM: pcd_to_cloudini_converter)
  SETTINGS  at most so many of the codec's, 0: all
"""
import json
import math
import sys
import tempfile
import tomllib
from pathlib import Path

import numpy

sys.path.append(str(Path(__file__).resolve().parents[1]))
from common.timed import CommandFailed, run  # noqa: E402

STATISTICS = ("mean", "rms", "p95", "max")
STEPS_M = (.002, .004, .008, .016, .03, .06, .12, .2)
ANGULAR_STEP_M = .001
# Radii in steps of 2^first of the lattice, azimuths in 2^second of a turn: the six rates of MPEG's
# common test conditions for spinning sensors, finest first.
ANGULAR = ((1, 24), (2, 23), (4, 21), (5, 20), (7, 19), (8, 19))
RESOLUTIONS_M = (.002, .004, .008, .016, .03, .06, .12)
COMMON = ("--disableAttributeCoding=1", "--mergeDuplicatedPoints=1")
OCTREE = (*COMMON, "--geomTreeType=0", "--neighbourAvailBoundaryLog2=8",
          "--intra_pred_max_node_size_log2=6", "--inferredDirectCodingMode=1",
          "--maxNumQtBtBeforeOt=4", "--minQtbtSizeLog2=0", "--planarEnabled=1")
PREDICTIVE = (*COMMON, "--geomTreeType=1", "--predGeomSort=2")


def thinned(settings, count):
    """At most `count` settings, the ends and what lies evenly between; 0: all."""
    if count == 0 or len(settings) <= count:
        return settings
    if count == 1:
        return settings[len(settings) // 2:][:1]
    gaps = count - 1
    return tuple(settings[(i * (len(settings) - 1) + gaps // 2) // gaps] for i in range(count))


def write_ply(path, points):
    """Points as floats: exact for integers below 2^24."""
    header = ("ply\nformat binary_little_endian 1.0\n"
              f"element vertex {len(points)}\n"
              "property float x\nproperty float y\nproperty float z\nend_header\n")
    path.write_bytes(header.encode() + points.astype("<f4").tobytes())


class Scan:
    """The returns of a scan, and how a decoded cloud compares with them."""

    def __init__(self, curlidar, path, folder):
        self.curlidar, self.path, self.folder = curlidar, path, folder
        self.points = self.read(path)

    def read(self, path):
        out = self.folder / "points.npy"
        out.unlink(missing_ok=True)
        run([self.curlidar, "convert", path, out, "--attributes", "none", "--threads", "1",
             "--quiet"], self.folder)
        points = numpy.load(out).astype(float)[:, :3]
        if path != self.path:
            return points  # integers: 0, 0, 0 is a point
        return points[numpy.isfinite(points).all(axis=1) & points.any(axis=1)]

    def errors(self, decoded):
        path = self.folder / "decoded.npy"
        numpy.save(path, decoded.astype(numpy.float32))
        told, _ = run([self.curlidar, "compare", self.path, path, "--threads", "1", "--json"],
                      self.folder)
        report = json.loads(told)
        return {"returns": report["points_a"], "points_back": report["points_b"],
                "nearest_to_decoded": {key: report["a_to_b"][key] for key in STATISTICS},
                "nearest_to_raw": {key: report["b_to_a"][key] for key in STATISTICS}}


def gpcc(program, scan, step_m, flags_of):
    """One stream of tmc3. It codes integers: multiples of the step, the least of each axis at 0, so
    that what it calls an origin cannot matter. `flags_of`: flags by where the sensor lies then."""
    levels = numpy.rint(scan.points / step_m)
    origin = levels.min(axis=0)
    if (levels.max(axis=0) - origin).max() >= 2 ** 24:
        raise CommandFailed(f"steps of {step_m} m do not fit into 24 bits")
    source, coded, out = (scan.folder / name for name in ("in.ply", "coded.bin", "out.ply"))
    for path in (coded, out):
        path.unlink(missing_ok=True)
    write_ply(source, levels - origin)
    _, encode_s = run([program, "--mode=0", f"--uncompressedDataPath={source}",
                       f"--compressedStreamPath={coded}", *flags_of(-origin)], scan.folder)
    _, decode_s = run([program, "--mode=1", f"--compressedStreamPath={coded}",
                       f"--reconstructedDataPath={out}", "--outputBinaryPly=1"], scan.folder)
    if not coded.is_file() or not out.is_file():
        raise CommandFailed("tmc3 wrote no stream, or no decoded cloud")
    decoded = (scan.read(out) + origin) * step_m
    return {"bytes": coded.stat().st_size, **scan.errors(decoded), "encode_ms": 1e3 * encode_s,
            "decode_ms": 1e3 * decode_s}


def listed(values):
    return ",".join(f"{value:.8g}" for value in values)


def beams_of(scan):
    """(tangents of elevation, heights in metres, columns in a turn), the lowest beam first."""
    told, _ = run([scan.curlidar, "info", scan.path, "--json"], scan.folder)
    info = json.loads(told)
    elevations, heights = info["elevations_deg"], [0.] * len(info["elevations_deg"])
    if info["sensor"] != "auto":  # a built-in one: it knows where its beams start
        told, _ = run([scan.curlidar, "sensors", info["sensor"]], scan.folder)
        heights = tomllib.loads(told)["rings"].get("vertical_offset_m", heights)
    beams = sorted(zip((math.tan(math.radians(each)) for each in elevations), heights))
    return [beam[0] for beam in beams], [beam[1] for beam in beams], info["columns"]


def angular_flags(beams, radius_log2, azimuth_log2, head):
    """Flags of angular predictive coding in the spherical domain. What tmc3 calls angles of its
    lasers are tangents."""
    tangents, heights, columns = beams
    return (*PREDICTIVE, "--predGeomAzimuthSortPrecision=1024", "--planarEnabled=1",
            "--angularEnabled=1", f"--lidarHeadPosition={listed(head)}",
            f"--numLasers={len(tangents)}", f"--lasersTheta={listed(tangents)}",
            f"--lasersZ={listed(height / ANGULAR_STEP_M for height in heights)}",
            f"--lasersNumPhiPerTurn={listed([columns] * len(tangents))}",
            "--positionQuantisationEnabled=1", "--positionBaseQp=58",
            f"--positionRadiusInvScaleLog2={radius_log2}",
            f"--positionAzimuthScaleLog2={azimuth_log2}",
            f"--positionAzimuthSpeed={round(2 ** azimuth_log2 / columns)}")


def cloudini(program, scan, resolution_m):
    """Its converter has no way back, so that there is no time of decoding; what its format gives
    back are the coordinates rounded to the resolution."""
    source, coded = scan.folder / "in.pcd", scan.folder / "coded.cld_pcl"
    if not source.is_file():
        run([scan.curlidar, "convert", scan.path, source, "--attributes", "none", "--drop-invalid",
             "--threads", "1", "--quiet"], scan.folder)
    coded.unlink(missing_ok=True)
    _, encode_s = run([program, "-y", "-c", "zstd", "-r", f"{resolution_m:g}", "-f", source, "-o",
                       coded], scan.folder)
    if not coded.is_file():
        raise CommandFailed(f"{Path(program).name} wrote no {coded.name}")
    decoded = numpy.rint(scan.points / resolution_m) * resolution_m
    return {"bytes": coded.stat().st_size, **scan.errors(decoded), "encode_ms": 1e3 * encode_s,
            "decode_ms": None}


def settings_of(codec, program, scan):
    """(what the setting is called, what measures it) for every setting of a codec."""
    if codec == "cloudini":
        return [(f"resolution_m {r:g}", lambda r=r: cloudini(program, scan, r))
                for r in RESOLUTIONS_M]
    if codec == "gpcc-angular":
        beams = beams_of(scan)
        return [(f"radius {r} azimuth {a}", lambda r=r, a=a: gpcc(
            program, scan, ANGULAR_STEP_M, lambda head: angular_flags(beams, r, a, head)))
            for r, a in ANGULAR]
    flags = {"gpcc-octree": lambda _: OCTREE,
             "gpcc-predictive": lambda head: (*PREDICTIVE, "--predGeomAzimuthSortPrecision=8",
                                              f"--lidarHeadPosition={listed(head)}")}[codec]
    return [(f"step_m {s:g}", lambda s=s: gpcc(program, scan, s, flags)) for s in STEPS_M]


def main():
    codec, program, curlidar, path, count = sys.argv[1:]
    with tempfile.TemporaryDirectory() as name:
        scan = Scan(curlidar, Path(path), Path(name))
        for setting, measure in thinned(settings_of(codec, program, scan), int(count)):
            line = {"codec": codec, "setting": setting}
            try:
                line.update(measure())
            except CommandFailed as error:
                line["skipped"] = str(error).replace(name, "")
            print(json.dumps(line), flush=True)


if __name__ == "__main__":
    if len(sys.argv) != 6 or sys.argv[1] not in ("gpcc-octree", "gpcc-predictive", "gpcc-angular",
                                                 "cloudini"):
        sys.exit(__doc__)
    try:
        main()
    except CommandFailed as error:
        sys.exit(str(error))
