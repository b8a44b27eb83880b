# SPDX-License-Identifier: BSD-3-Clause
"""A map of scans of which every 4th ring was given, beside that of the whole scans."""
from pathlib import Path

import numpy

from common.digest import digest
from frame.context import OUTPUT
from frame.tables import Figure
from sections import pictures
from sections.continuous_pictures import PLANES, points_of

POSES = "poses_lidar_refined_0-15.txt"
EVERY = 4
VOXEL_M = .1
ERROR_SCALE_M = .3
EXTENT_M = 35
WIDTH = 640
NAME = "upsampling-map"


def frames(context):
    """(scan, 3 x 4 pose) of the drive that has poses, in the order of its files; none in quick runs
    and where there are less than two."""
    if context.quick:
        return []
    from frame.scans import every_scan_beside
    for scan in context.scans:
        poses = scan.path.parent.parent / POSES
        if poses.is_file():
            around = sorted((each for each in every_scan_beside(scan)
                             if each.path.parent == scan.path.parent), key=lambda each: each.name)
            found = [(each, numpy.array(line.split(), dtype=float).reshape(3, 4))
                     for each, line in zip(around, poses.read_text(encoding="utf-8").splitlines())]
            return found if len(found) > 1 else []
    return []


def images_of(context, scan):
    return context.made(".npy", [context.bin / "report_measure", "range-images", scan.path, OUTPUT,
                                 "--every", str(EVERY), "--factor", str(EVERY)])


def voxels(points):
    """One point of each voxel, the first."""
    _, first = numpy.unique(numpy.floor(points / VOXEL_M).astype(int), axis=0, return_index=True)
    return points[numpy.sort(first)]


def placed(points, pose):
    return points @ pose[:, :3].T + pose[:, 3]


def returns_of(path):
    points = numpy.fromfile(path, dtype="<f4").reshape(-1, 4)[:, :3]
    return points[(points != 0).any(1)]


def maps(context, drive):
    """(of the whole scans, of every 4th ring, of these made denser)."""
    whole, given, denser = [], [], []
    for scan, pose in drive:
        planes = dict(zip(PLANES, numpy.load(context.make(images_of(context, scan)))))
        first = (planes["truth"].shape[0] - 1) % EVERY
        whole.append(placed(returns_of(scan.path), pose))
        for target, step in ((given, EVERY), (denser, 1)):
            target.append(placed(points_of(planes["elevation"], planes["compact"], first % step,
                                           step), pose))
    return [voxels(numpy.concatenate(each)) for each in (whole, given, denser)]


def measure(context):
    drive = frames(context)
    if not drive:
        return
    target = context.figure_path(NAME, "png")
    made_from = digest(NAME, *(images_of(context, scan).path.name for scan, _ in drive),
                       Path(__file__))
    if context.store.get("upsampling", made_from) and target.is_file():
        return
    context.progress("upsampling: the map")
    paths = []
    for name, points in zip(("whole", "given", "denser"), maps(context, drive)):
        paths.append(context.scratch / f"map-{name}.npy")
        numpy.save(paths[-1], points.astype(numpy.float32))
    view = ["--view", "birds-eye", "--extent", str(EXTENT_M)]
    error = ["--colour", "error", "--reference", paths[0], "--max-value", str(ERROR_SCALE_M)]
    drawn = [context.make(pictures.drawn(context, path, *view, *more, "--title", title,
                                         width=WIDTH))
             for path, title, more in ((paths[0], "64 rings", []), (paths[1], "16 rings", []),
                                       (paths[2], "16 made 64", []),
                                       (paths[2], "its error", error))]
    pictures.side_by_side(context, drawn, target)
    context.store.add("upsampling", made_from, {"picture": NAME}, "curlidar render",
                      [{"file": target.name}])


def figures(context):
    drive = frames(context)
    if not drive:
        return []
    return [Figure(
        NAME, "A map of scans made denser",
        f"{len(drive)} scans of {drive[0][0].dataset} in one map (voxels of {VOXEL_M:g} m), from "
        "above, coloured by height: of all rings; of every 4th ring at 1 bit a return; of these "
        "made 4 times denser; the distances of the latter to the first map, up to "
        f"{ERROR_SCALE_M:g} m.", "png", "the coded files of the scans")]
