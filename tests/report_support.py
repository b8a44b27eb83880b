# SPDX-License-Identifier: BSD-3-Clause
"""What tests of the report's sections share: a context that answers instead of measuring."""
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "bench/report"), str(ROOT / "bench")]
from frame.cells import Published  # noqa: E402
from frame.scans import Scan, Scene  # noqa: E402

KITTI = Scan("kitti_raw/a.pcd", Path("a.pcd"), "HDL-64E")
OTHER = Scan("velodyne/b.pcd", Path("b.pcd"), "HDL-32E")
STREET = Scene("street", "hdl64e-kitti", "outdoor")
ROOM = Scene("room", "os1-64-gen1", "indoor")


class FakeContext:
    """Answers with lines instead of running anything."""

    def __init__(self, answer, scans=(KITTI,), scenes=(ROOM,), quick=False):
        self.answer, self.scans, self.scenes, self.quick = answer, list(scans), list(scenes), quick
        self.bin, self.asked, self.left_out = Path("bin"), [], None
        text = (ROOT / "bench/report/published.toml").read_text(encoding="utf-8")
        self.published = tomllib.loads(text)

    @property
    def inputs(self):
        return [*self.scans, *self.scenes]

    def cloud(self, item):
        return Path(item.id)

    def published_rows(self, table, **wanted):
        return [{key: Published(value, row["source"]) if isinstance(value, (int, float)) else value
                 for key, value in row.items()} for row in self.published[table]
                if all(row.get(key) == value for key, value in wanted.items())]

    def measure(self, _section, key, command):
        self.asked.append([str(part) for part in command])
        return self.answer(key)


def by(table, **wanted):
    found = [row for row in table.rows if all(row[key] == value for key, value in wanted.items())]
    assert len(found) == 1, f"{len(found)} rows are {wanted}"
    return found[0]
