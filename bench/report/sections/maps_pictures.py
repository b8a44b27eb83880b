# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of maps, drawn by `curlidar map render` and `curlidar render`."""
from common.digest import digest
from frame.context import OUTPUT, Inside
from frame.tables import Figure
from sections import maps_drive, maps_inputs, maps_surface, pictures
from sections.maps_inputs import built, extracted, map_of, union

WIDTH = 640
ERROR_SCALE_M = .2
SENSOR = "hdl64e-kitti"


def map_picture(context, folder, *options):
    return context.made(".png", [
        context.curlidar, "map", "render", map_of(folder), *options, "--size", f"{WIDTH}x0",
        "--threads", "1", "--quiet", "-o", OUTPUT])


def pictures_of(context):
    """(id, title, caption, Made pictures side by side)."""
    if drive := maps_inputs.kitti(context):
        folder = built(context, drive, *maps_surface.FINE)
        whole = union(context, drive, maps_surface.FINE_M)
        cloud = extracted(context, folder, "--spacing", f"{maps_surface.SPACING_M:g}")
        view = ["--view", "birds-eye", "--extent", "40"]
        yield ("maps-kitti", "The fine map of KITTI 00, frames 0 to 15",
               "All raw returns, and the map as points every 5 cm, from above, coloured by height; "
               f"distance of the map to the nearest raw return, up to {ERROR_SCALE_M:g} m.",
               [pictures.drawn(context, whole, *view, "--title", "raw returns", width=WIDTH),
                pictures.drawn(context, cloud, *view, "--title", "map", width=WIDTH),
                pictures.drawn(context, cloud, *view, "--colour", "error", "--reference", whole,
                               "--max-value", f"{ERROR_SCALE_M:g}", "--title", "its error",
                               width=WIDTH)])
        seen = context.made(".pcd", [
            context.curlidar, "map", "sample", map_of(folder), "--sensor", SENSOR, "--poses",
            drive.poses, "--index", "7", "--threads", "1", "--quiet", "-o", OUTPUT])
        yield ("maps-virtual", "A virtual scan of the map beside the real one",
               "Scan 7 as it was measured, and what the sensor would see in the map from there.",
               [pictures.drawn(context, drive.scans[7], "--distance", "45", "--title", "real",
                               width=WIDTH),
                pictures.drawn(context, seen, "--distance", "45", "--title", "from the map",
                               width=WIDTH)])
    if drive := maps_drive.drive_of(context):
        folder = built(context, drive)
        yield ("maps-drive-above", "The map of the simulated drive",
               "Both laps, rendered from the file; and the exact surface beside it.",
               [map_picture(context, folder),
                pictures.drawn(context, Inside(drive.scans[0].folder, "truth.ply"), "--view",
                               "birds-eye", "--title", "truth", width=WIDTH)])


def measure(context):
    """Draws what is not drawn yet."""
    for name, _, _, parts in pictures_of(context):
        target = context.figure_path(name, "png")
        made_from = digest(name, *(made.path.name for made in parts))
        if context.store.get("maps", made_from) and target.is_file():
            continue
        context.progress(f"maps: {name}")
        pictures.side_by_side(context, [context.make(made) for made in parts], target)
        context.store.add("maps", made_from, {"picture": name}, "curlidar map render",
                          [{"file": target.name}])


def figures(context):
    return [Figure(name, title, caption, "png", "the map's file")
            for name, title, caption, _ in pictures_of(context)
            if context.figure_path(name, "png").is_file()]
