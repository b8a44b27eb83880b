# SPDX-License-Identifier: BSD-3-Clause
"""Which scans are measured, and the grid that every codec is given."""
import csv
import json
import subprocess
from dataclasses import dataclass
from pathlib import Path

REFERENCE = "kitti_raw/curl_example/0.pcd"  # the scan of the goals; always first
FEW_CELLS = 3000
LIMITS = ("5", "p90")         # metres; those of the paper's outdoor scans
NEAR_LIMITS = ("0.5", "max")  # for sensors whose returns lie nearer


@dataclass
class Scan:
    name: str  # relative to the data folder where it lies in there
    path: Path
    sensor: str


@dataclass
class Grid:
    """A scan on its rings x 1024 columns, as a file."""
    scan: Scan
    path: Path
    min_range: str
    max_range: str
    cells: int


def from_manifest(data, every):
    """The scans of MANIFEST.tsv, the reference first: one of each dataset and sensor, or every."""
    with open(data / "MANIFEST.tsv", encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file, delimiter="\t")
                if row["channels"] and row["path"].endswith((".pcd", ".bin"))]
    rows.sort(key=lambda row: (row["path"] != REFERENCE, row["path"]))
    scans, seen = [], set()
    for row in rows:
        kind = (row["dataset"], row["sensor"])
        if every or kind not in seen:
            seen.add(kind)
            scans.append(Scan(row["path"], data / row["path"], row["sensor"]))
    return scans


def from_paths(paths, data):
    """Scans named by a person. Names in tables and files never hold the folders of a machine."""
    known = {scan.path.resolve(): scan for scan in from_manifest(data, every=True)} \
        if (data / "MANIFEST.tsv").is_file() else {}
    return [known.get(Path(path).resolve(), Scan(Path(path).name, Path(path), "not stated"))
            for path in paths]


def grids_of(scan, curlidar, folder):
    """The scan within the usual limits, and once more within wider ones if few cells are left."""
    grids = []
    for limits in (LIMITS, NEAR_LIMITS):
        path = folder / f"grid-{limits[1]}.pcd"
        run = subprocess.run(
            [curlidar, "project", scan.path, "--rows", "rings", "--cols", "1024", "--min-range",
             limits[0], "--max-range", limits[1], "--threads", "1", "--json", "-o", path],
            capture_output=True, text=True, check=False)
        if run.returncode != 0:
            raise RuntimeError(run.stderr.strip())
        cells = json.loads(run.stdout)["points"]
        if cells > 0:
            grids.append(Grid(scan, path, *limits, cells))
        if cells >= FEW_CELLS:
            break
    return grids
