# SPDX-License-Identifier: BSD-3-Clause
"""What is measured: real scans and simulated scenes."""
import sys
from dataclasses import dataclass
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[2]))
from common.manifest import MANIFEST, Scan, from_manifest, from_paths  # noqa: E402

CLOUDS = (".pcd", ".ply", ".bin", ".npy", ".csv")


@dataclass(frozen=True)
class Scene:
    """A simulated scan. `preset`: of the paper's parameters (curlidar encode --preset)."""
    name: str
    sensor: str
    preset: str
    seed: int = 1

    @property
    def id(self):
        return f"{self.name}-{self.sensor}"


SCENES = (Scene("street", "hdl64e-kitti", "outdoor"),
          Scene("newer-college", "os1-64-gen1", "newer-college"),
          Scene("room", "os1-64-gen1", "indoor"),
          Scene("forest", "hdl64e-kitti", "outdoor"),
          Scene("corridor", "os1-64-gen1", "indoor"))
QUICK_SCENES = SCENES[:3]


class NoScans(Exception):
    """What was named is not there, or holds no scan."""


def in_folder(folder, data, every):
    if (folder / MANIFEST).is_file():
        return from_manifest(folder, every)
    found = sorted(path for path in folder.rglob("*") if path.suffix in CLOUDS)
    if not found:
        raise NoScans(f"{folder}: no MANIFEST.tsv and no file that ends in {', '.join(CLOUDS)}")
    return from_paths(found, data)


def named(paths, data, every):
    """The scans that a person named: files, or folders of them."""
    scans = []
    for path in map(Path, paths):
        if path.is_dir():
            scans += in_folder(path, data, every)
        elif path.is_file():
            scans += from_paths([path], data)
        else:
            raise NoScans(f"{path}: no such file or folder")
    return list(dict.fromkeys(scans))


def chosen(paths, data, every, quick):
    """Named scans, or one of every dataset and sensor of the data folder (`every`: all of them);
    without a data folder none. `quick`: at most one, a KITTI scan if there is one."""
    if paths:
        scans = named(paths, data, every)
    else:
        scans = from_manifest(data, every) if (data / MANIFEST).is_file() else []
    if quick and scans:
        return [next((scan for scan in scans if scan.is_kitti), scans[0])]
    return [scan for scan in scans if scan.path.is_file()]


def every_scan_beside(scan):
    """All scans of the data folder that a scan lies in; itself if it lies in none."""
    path = scan.path.as_posix()
    root = Path(path.removesuffix(scan.name)) if path.endswith("/" + scan.name) else None
    if root is None or not (root / MANIFEST).is_file():
        return [scan]
    return [each for each in from_manifest(root, every=True) if each.path.is_file()]


__all__ = ["NoScans", "QUICK_SCENES", "SCENES", "Scan", "Scene", "chosen", "every_scan_beside"]
