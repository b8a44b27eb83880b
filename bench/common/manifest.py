# SPDX-License-Identifier: BSD-3-Clause
"""The real scans of a data folder, as its MANIFEST.tsv lists them."""
import csv
from dataclasses import dataclass
from pathlib import Path

MANIFEST = "MANIFEST.tsv"
REFERENCE = "kitti_raw/curl_example/0.pcd"  # the scan of the stored figures; always first


@dataclass(frozen=True)
class Scan:
    name: str  # relative to the data folder where it lies in there: never a folder of a machine
    path: Path
    sensor: str
    source: str = ""  # the dataset in the manifest's words

    @property
    def dataset(self):
        """The folder of its dataset, such as kitti_raw; of a scan not in a data folder, 'named'."""
        return self.name.split("/")[0] if "/" in self.name else "named"

    @property
    def is_kitti(self):
        return self.dataset.startswith("kitti")

    @property
    def id(self):
        """Its name as part of a file's name."""
        return Path(self.name).with_suffix("").as_posix().replace("/", "-")


def from_manifest(data, every):
    """The scans of MANIFEST.tsv, the reference first: one of each dataset and sensor, or every."""
    with open(data / MANIFEST, encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file, delimiter="\t")
                if row["channels"] and row["path"].endswith((".pcd", ".bin"))]
    rows.sort(key=lambda row: (row["path"] != REFERENCE, row["path"]))
    scans, seen = [], set()
    for row in rows:
        kind = (row["dataset"], row["sensor"])
        if every or kind not in seen:
            seen.add(kind)
            scans.append(Scan(row["path"], data / row["path"], row["sensor"], row["dataset"]))
    return scans


def from_paths(paths, data):
    """Scans named by a person. Names in tables and files never hold the folders of a machine."""
    known = {scan.path.resolve(): scan for scan in from_manifest(data, every=True)} \
        if (data / MANIFEST).is_file() else {}
    return [known.get(Path(path).resolve(), Scan(Path(path).name, Path(path), "not stated"))
            for path in paths]
