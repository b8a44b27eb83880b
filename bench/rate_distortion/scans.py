# SPDX-License-Identifier: BSD-3-Clause
"""Which scans are measured, and the grid that every codec is given."""
import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1]))
from common.manifest import REFERENCE, Scan, from_manifest, from_paths  # noqa: E402, F401

FEW_CELLS = 3000
LIMITS = ("5", "p90")         # metres; those of the paper's outdoor scans
NEAR_LIMITS = ("0.5", "max")  # for sensors whose returns lie nearer


@dataclass
class Grid:
    """A scan on its rings x 1024 columns, as a file."""
    scan: Scan
    path: Path
    min_range: str
    max_range: str
    cells: int


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
