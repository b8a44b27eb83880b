# SPDX-License-Identifier: BSD-3-Clause
"""What maps are made of: scans with poses, and the commands that make and use maps of them."""
import sys
from dataclasses import dataclass
from pathlib import Path

from frame.context import OUTPUT, Inside
from frame.scans import every_scan_beside

PYTHON = sys.executable
FRAME = Path(__file__).resolve().parents[1] / "frame"
POSES, TOLD = FRAME / "poses.py", FRAME / "told.py"
REFINED = "poses_lidar_refined_0-15.txt"
NEAREST_M, FARTHEST_M = 2.5, 80  # of the returns that count
EVERY_POINT = 100_000_000        # no random subset


@dataclass(frozen=True)
class Drive:
    """Scans with poses. `scans`: Paths, or files of a folder that is made; `poses`: a Path or the
    like; `count`: of scans."""
    name: str
    scans: tuple
    poses: object
    count: int

    def part(self, context, first, last):
        """The scans [first, last) with their poses."""
        if (first, last) == (0, self.count):
            return self
        scans = self.scans[first:last] if len(self.scans) > 1 else (
            Inside(self.scans[0].folder, self.scans[0].pattern, (first, last)),)
        cut = context.made(".txt", [PYTHON, POSES, "slice", self.poses, str(first), str(last),
                                    OUTPUT])
        return Drive(self.name, scans, cut, last - first)


def kitti(context):
    """The drive of real scans that has poses of ours, or None."""
    for scan in context.scans:
        refined = scan.path.parent.parent / REFINED
        if refined.is_file():
            around = sorted((each.path for each in every_scan_beside(scan)
                             if each.path.parent == scan.path.parent), key=lambda path: path.name)
            count = sum(1 for line in refined.read_text(encoding="utf-8").splitlines() if line)
            if len(around) >= count:
                return Drive("KITTI 00", tuple(around[:count]), refined, count)
    return None


def simulated(context, name, *options, count):
    """A drive that `simulate --drive` makes: scans, poses.txt and the exact static surface."""
    folder = context.made("", [
        context.curlidar, "simulate", "--drive", "--scans", str(count), *options, "--threads", "1",
        "--quiet", "-o", OUTPUT])
    return Drive(name, (Inside(folder, "scans/*.bin"),), Inside(folder, "poses.txt"), count)


def kept(context, *words, copied=()):
    """A folder with what a command makes in it ({} in its words) and told.json."""
    return context.made("", [PYTHON, TOLD, "make", OUTPUT, *copied, "--", context.curlidar, *words,
                             "--threads", "1", "--json"])


def told_by(context, section, key, folder):
    """What such a command has said and taken: `said`, `cpu_s`, `peak_rss_bytes`, `files`."""
    return context.measure(section, key, [PYTHON, TOLD, "tell", folder])[0]


def built(context, drive, *options):
    return kept(context, "map", "build", *drive.scans, "--poses", drive.poses, *options, "-o",
                "{}/map.curl")


def appended(context, before, drive, *options):
    """The map of `before` with more scans."""
    return kept(context, "map", "append", "{}/map.curl", *drive.scans, "--poses", drive.poses,
                *options, copied=("--copy", map_of(before), "map.curl"))


def map_of(folder):
    return Inside(folder, "map.curl")


def extracted(context, folder, *options):
    return context.made(".ply", [context.curlidar, "map", "extract", map_of(folder), *options,
                                 "--threads", "1", "--quiet", "-o", OUTPUT])


def union(context, drive, farthest_m=FARTHEST_M, every=0, first=0):
    """The returns of the raw scans in the map's frame; of every `every`-th scan (0: all of them,
    negative: of the others)."""
    return context.made(".npy", [PYTHON, POSES, "union", OUTPUT, str(NEAREST_M), str(farthest_m),
                                 str(every), str(first), drive.poses, *drive.scans])


def compared(context, key, reference, cloud):
    """`curlidar compare`: the reference is `a`."""
    return context.measure("maps", key, [
        context.curlidar, "compare", reference, cloud, "--thresholds", "0.05,0.1,0.2", "--json",
        "--threads", "1", "--quiet"])[0]


def on_surface(context, key, reference, folder, spacing_m):
    """`map compare`: every point of the reference to the map's surface, and points of the map to the
    reference."""
    return context.measure("maps", key, [
        context.curlidar, "map", "compare", map_of(folder), reference, "--spacing", f"{spacing_m:g}",
        "--max-points", str(EVERY_POINT), "--max-reference", str(EVERY_POINT), "--json",
        "--threads", "1", "--quiet"])[0]


def share(distances, threshold_m):
    """Of distances that `map compare` tells, those within one."""
    return next(each["share"] for each in distances["within"]
                if abs(each["threshold"] - threshold_m) < 1e-9)


def f_score(line, threshold_m):
    return next(each["f_score"] for each in line["f_scores"]
                if abs(each["threshold"] - threshold_m) < 1e-9)


def at(line, threshold_m):
    """Precision, recall and F-score of `compare` within a distance."""
    return next(each for each in line["matches"] if abs(each["threshold"] - threshold_m) < 1e-9)


def length_m(context, drive):
    line = context.measure("maps", {"drive": drive.name, "poses of": drive.count},
                           [PYTHON, POSES, "length", drive.poses])[0]
    return line["length_m"]
