# SPDX-License-Identifier: BSD-3-Clause
"""The paper's map: fields of keyframes, reconstructed denser, beside the scans in between."""
from frame.context import OUTPUT
from frame.tables import Column, Table, rows_or
from sections import goals, maps_inputs
from sections.maps_inputs import at, built, compared, extracted, told_by, union
from sections.maps_surface import shown

EVERY = 5  # scans to a keyframe
COLUMNS_OF_GRID = 1024
ROWS = 8
OPTIONS = ("--kind", "scans", "--every", str(EVERY), "--min-range", "2.5", "--max-range", "80",
           "--columns", str(COLUMNS_OF_GRID))
WAYS = (("keyframes, 8x rows", ("--rows", str(ROWS))), ("keyframes as coded", ()))


def gridded(context, drive):
    """Points of the keyframes on the grid that is coded."""
    return sum(context.measure("maps", {"keyframe": i}, [
        context.curlidar, "project", scan, "--rows", "rings", "--cols", str(COLUMNS_OF_GRID),
        "--min-range", "2.5", "--max-range", "80", "-o",
        context.scratch / "gridded.pcd", "--threads", "1", "--json"])[0]["points"]
               for i, scan in enumerate(drive.scans) if i % EVERY == 0)


def row_of(context, drive, name, options):
    folder = built(context, drive, *OPTIONS)
    told = told_by(context, "maps", {"map of": drive.name, "built": "keyframes"}, folder)
    if "failure" in told:
        return {"map": name, "failure": told["failure"]}
    others = union(context, drive, every=-EVERY)
    line = compared(context, {"map of": drive.name, "distances": name}, others,
                    extracted(context, folder, *options))
    if "failure" in line:
        return {"map": name, "failure": line["failure"]}
    size = told["files"]["map.curl"]
    return {"map": name, "bytes": size, "metre": size / maps_inputs.length_m(context, drive),
            "points": line["points_b"], "times": line["points_b"] / gridded(context, drive),
            **{f"within_{threshold}": at(line, threshold / 100)["precision"]
               for threshold in (5, 10, 20)},
            "covers_10": at(line, .1)["recall"], "cpu_s": told["cpu_s"]}


def rows(context):
    drive = maps_inputs.kitti(context)
    return [row_of(context, drive, *way) for way in WAYS] if drive else []


COLUMNS = [Column("map", "map"), Column("bytes", "bytes"),
           Column("metre", "bytes a metre", digits=0), Column("points", "points"),
           Column("times", "times those of the gridded keyframes", digits=2),
           *(Column(f"within_{threshold}", f"within {threshold} cm", check="share")
             for threshold in (5, 10, 20)),
           Column("covers_10", "the other scans within 10 cm of it", check="share"),
           Column("cpu_s", "build", "CPU s", 2)]


def table(found):
    return Table(
        "maps-keyframes", "The paper's map: keyframes 0, 5, 10 and 15 of KITTI 00",
        f"points of the map beside all raw returns (2.5 to 80 m) of the other 12 scans; grids of 64 x "
        f"{COLUMNS_OF_GRID} cells.", COLUMNS,
        rows_or([shown(row, COLUMNS) for row in found], COLUMNS,
                "no drive of real scans with poses in this run"),
        ["The paper: 71 MB for KITTI 00, 3.7 km long, about 19,000 bytes a metre."])


def goals_of(found):
    for row in found[:1]:
        if "failure" not in row:
            yield goals.at_most("the paper's map: bytes", "keyframes, 8x rows", row["bytes"], 30000)
            yield goals.at_least("the paper's map: times the points", "keyframes, 8x rows",
                                 row["times"], 5)
            yield goals.at_least("the paper's map: within 10 cm of the others", "keyframes, 8x rows",
                                 row["within_10"], .89)
