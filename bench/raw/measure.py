# SPDX-License-Identifier: BSD-3-Clause
"""Encodes a scan, has the file verified, and measures what decodes from it. Every measurement is a
dict with the keys of COLUMNS."""
import json
import sys
import tempfile
import threading
from pathlib import Path

import plan

sys.path.append(str(Path(__file__).resolve().parents[1]))
from common.timed import CommandFailed, run  # noqa: E402

IDENTITY = ("scan", "profile", "mode", "target_m", "effort")
PARTS = ("header", "mask", "partition", "modes", "coefficients", "labels", "residual")
RECORD_PARTS = ("rays", "directions", "loose", "corrections", "order", "attributes")
COLUMNS = (
    *IDENTITY, "points", "bytes", "bits_per_point", "geometry_bits", "attributes_bits",
    "nearest_m", "nearest_to_decoded_m", "nearest_to_raw_m", "own_mean_m", "max_m", "bound_m",
    "verify_ok", "bit_exact", "order", "lattice", "table", "share_on_lattice", "motion",
    "loose_points", "corrected_points", *(f"{part}_bits" for part in PARTS),
    *(f"{part}_bits" for part in RECORD_PARTS if part != "attributes"), "encodings", "cpu_s",
    "verify_cpu_s", "build", "key", "failure")


class Measurer:
    """Measures with one build of the command; its scratch files lie in `folder`."""

    def __init__(self, curlidar, folder):
        self.curlidar, self.folder = curlidar, Path(folder)
        self.build = plan.digest(Path(curlidar))
        self.calibrating = threading.Lock()

    def attributes(self, scan):
        told, _ = run([self.curlidar, "info", scan.path, "--json"], self.folder)
        return tuple(a["name"] for a in json.loads(told).get("attributes", ()))

    def sensor(self, scan, setting):
        """The profile file of a batch, calibrated when first asked for; None for AUTO."""
        if setting.profile != plan.BATCH:
            return None
        path = self.folder / f"{plan.digest(scan.name)}.toml"
        with self.calibrating:
            if not path.is_file():
                run([self.curlidar, "calibrate", *scan.batch, "--name", "batch", "--threads", "1",
                     "--quiet", "-o", path], self.folder)
        return path

    def measure(self, scan, setting):
        row = {key: "" for key in COLUMNS}
        row.update(scan=scan.name, profile=setting.profile, mode=setting.mode,
                   target_m=f"{setting.target_m:g}", effort=setting.effort, build=self.build,
                   key=plan.key_of(self.build, scan, setting))
        with tempfile.TemporaryDirectory(dir=self.folder) as name:
            try:
                row.update(self.figures(scan, setting, Path(name)))
            except CommandFailed as error:
                row["failure"] = str(error).replace(str(scan.path), scan.name).replace(name, "")
        return row

    def figures(self, scan, setting, folder):
        coded, decoded = folder / "scan.curl", folder / "scan.pcd"
        told, cpu_s = run([self.curlidar, "encode", scan.path,
                           *setting.arguments(self.sensor(scan, setting)), "--threads", "1",
                           "--json", "-o", coded], folder)
        result = figures_of_encode(json.loads(told), coded.stat().st_size)
        result["cpu_s"] = cpu_s
        # 3: not as promised, which the report explains.
        told, result["verify_cpu_s"] = run(
            [self.curlidar, "verify", coded, scan.path, "--threads", "1", "--json"], folder, (0, 3))
        if not told:
            raise CommandFailed("verify ended with 3 and without a report")
        result.update(figures_of_verify(json.loads(told)))
        run([self.curlidar, "decode", coded, "--attributes", "none", "--threads", "1", "--quiet",
             "-o", decoded], folder)
        told, _ = run([self.curlidar, "compare", scan.path, decoded, "--threads", "1", "--json"],
                      folder)
        result.update(figures_of_compare(json.loads(told)))
        return result


def figures_of_encode(report, size):
    """Bits are of each return of the input, and of the whole file as it lies on disk."""
    points = report["points_in"]
    records, parts = report.get("records", {}), report.get("breakdown", {})
    bits = {name: 8 * count / points for name, count in records.get("bytes", {}).items()}
    result = {
        "points": points, "bytes": size, "bits_per_point": 8 * size / points,
        "geometry_bits": report["bits_per_point_coded"] * report["points_coded"] / points,
        "lattice": records.get("lattice", ""), "table": records.get("table") or "",
        "share_on_lattice": records.get("share_on_lattice", ""),
        "motion": records.get("motion", ""), "loose_points": records.get("loose", ""),
        "corrected_points": records.get("corrected", ""), "encodings": report.get("encodings", "")}
    result.update({f"{part}_bits": parts[part] / points for part in PARTS if part in parts})
    result.update({f"{part}_bits": bits[part] for part in RECORD_PARTS if part in bits})
    if report["bytes"] != size:
        result["failure"] = f"encode says {report['bytes']} bytes, the file has {size}"
    return result


def figures_of_verify(report):
    result = {"own_mean_m": report["mean_error_m"], "max_m": report["max_error_m"],
              "bound_m": "" if report["bound_m"] is None else report["bound_m"],
              "verify_ok": report["ok"], "bit_exact": report["bit_exact"],
              "order": report["order"]}
    if not report["ok"]:
        result["failure"] = "verify: " + ("; ".join(report["failures"]) or "not ok")
    return result


def figures_of_compare(report):
    to_decoded, to_raw = report["a_to_b"]["mean"], report["b_to_a"]["mean"]
    return {"nearest_to_decoded_m": to_decoded, "nearest_to_raw_m": to_raw,
            "nearest_m": max(to_decoded, to_raw)}
