# SPDX-License-Identifier: BSD-3-Clause
"""What is measured: which scans, with which settings of the command."""
import sys
from dataclasses import dataclass, field
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1]))
from common.digest import digest  # noqa: E402

SCANS = (
    "kitti_raw/curl_example/0.pcd",
    "kitti_odometry_00/velodyne/000000.bin",
    "kitti_raw/sfnd/data_1/0000000000.pcd",
    "velodyne/ndt_omp_hdl32/251370668.pcd",
    "ouster_sdk/OS-0-128-U1_v2.3.0_1024x10_frame1491.pcd",
    "ouster_sdk/OS-1-32-G_v2.1.1_1024x10_frame638.pcd",
    "ouster_sdk/OS-2-32-U0_v2.0.0_1024x10_frame5424.pcd",
    "nebula/hesai/xt16/1732848128093928016.pcd",
    "tls_indoor/room_scan1.pcd",
    "kitti_object/000000.bin",
)
# Scans of one drive, by the one that is measured: what `calibrate` may learn its sensor from.
BATCHES = {SCANS[2]: tuple(f"kitti_raw/sfnd/data_1/{n:010}.pcd" for n in range(5))}

NEAREST_M = (.001, .005, .01, .02, .05)
BOUNDS_M = (.002, .01, .02, .05)
QUICK_NEAREST_M = (.01, .05)
QUICK_BOUNDS_M = (.02,)
ATTRIBUTES_BOUND_M = .02  # of the geometry that attributes are measured beside
EFFORTS = ("9", "default")
MODES = ("nearest", "bound", "lossless", "intensity", "attributes")
AUTO, BATCH = "auto", "batch"  # the sensor: found by the command, or calibrated from a batch


@dataclass(frozen=True)
class Scan:
    name: str  # relative to the data folder where it lies in there: never a folder of a machine
    path: Path
    batch: tuple = ()  # paths
    attributes: tuple = field(default=(), compare=False)


@dataclass(frozen=True)
class Setting:
    """One encoding. `mode`: nearest (mean nearest-neighbour distance), bound (every point) and
    lossless are geometry only; intensity, attributes (all of them) are lossless beside a bound."""
    mode: str
    target_m: float
    effort: str
    profile: str = AUTO

    def arguments(self, sensor=None):
        """Of `curlidar encode`, without the files."""
        target = {"nearest": ["--error-nn", f"{self.target_m:g}"], "lossless": ["--lossless"]}.get(
            self.mode, ["--max-error", f"{self.target_m:g}"])
        kept = {"intensity": "intensity", "attributes": "all"}.get(self.mode, "none")
        effort = [] if self.effort == "default" else ["--effort", self.effort]
        profile = [] if sensor is None else ["--sensor", str(sensor)]
        return [*target, "--attributes", kept, *effort, "--no-index", *profile]


def scans_of(paths, data):
    """The scans named, or all of SCANS that are there: (scans, names that are missing)."""
    found, missing = [], []
    for path in [Path(path) for path in paths] or [data / name for name in SCANS]:
        inside = data in path.resolve().parents
        name = path.resolve().relative_to(data).as_posix() if inside else path.name
        if not path.is_file():
            missing.append(name)
            continue
        batch = tuple(data / other for other in BATCHES.get(name, ()))
        found.append(Scan(name, path, batch if all(p.is_file() for p in batch) else ()))
    return found, missing


def settings_of(scan, efforts=EFFORTS, modes=MODES, quick=False):
    """The settings for a scan, the quickest to measure first; `quick` leaves most of them out."""
    points = [("lossless", 0.)]
    points += [("bound", e) for e in reversed(QUICK_BOUNDS_M if quick else BOUNDS_M)]
    points += [("nearest", e) for e in reversed(QUICK_NEAREST_M if quick else NEAREST_M)]
    if "intensity" in scan.attributes:
        points.append(("intensity", ATTRIBUTES_BOUND_M))
    if set(scan.attributes) - {"intensity"}:
        points.append(("attributes", ATTRIBUTES_BOUND_M))
    points = [point for point in points if point[0] in modes]
    batch = [(mode, e) for mode, e in points if mode in ("nearest", "lossless")]
    return [Setting(mode, e, effort, profile)
            for effort in reversed(efforts)
            for profile, chosen in ((AUTO, points), (BATCH, batch if scan.batch else []))
            for mode, e in chosen]


def key_of(build, scan, setting):
    """Rows with the same key are the same measurement."""
    batch = scan.batch if setting.profile == BATCH else ()
    return digest(build, scan.path, *batch, *setting.arguments(), setting.profile)
