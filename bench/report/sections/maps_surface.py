# SPDX-License-Identifier: BSD-3-Clause
"""Surface maps of KITTI 00: bytes and distances to all raw returns."""
from frame.cells import Missing
from frame.tables import Column, Table, rows_or
from sections import goals, maps_inputs
from sections.maps_inputs import built, f_score, on_surface, share, told_by, union

SPACING_M = .05
FINE_M = 40          # range of the fine map and of what it is compared with
SMALL = ("--quality", "small")
FINE = ("--quality", "fine", "--max-range", str(FINE_M))
# (name, options, range of the reference)
MAPS = (("small", SMALL, 80), ("small, every 2nd scan", (*SMALL, "--every", "2"), 80),
        ("fine", FINE, FINE_M), ("fine, 80 m", FINE[:2], 80))
CURVE = tuple((f"fine, {weight:g} m a bit", (*FINE, "--metres-per-bit", f"{weight:g}"), FINE_M)
              for weight in (.1, .07, .03, .02))


def row_of(context, drive, name, options, range_m):
    folder = built(context, drive, *options)
    told = told_by(context, "maps", {"map of": drive.name, "built": name}, folder)
    if "failure" in told:
        return {"map": name, "failure": told["failure"]}
    line = on_surface(context, {"map of": drive.name, "to its surface": name},
                      union(context, drive, range_m), folder, SPACING_M)
    if "failure" in line:
        return {"map": name, "failure": line["failure"]}
    return {"map": name, "options": " ".join(options) or "none", "bytes": told["files"]["map.curl"],
            "metre": told["files"]["map.curl"] / maps_inputs.length_m(context, drive),
            "mean_m": line["completeness"]["mean"],
            "within_5": share(line["completeness"], .05),
            "within_10": share(line["completeness"], .1),
            "accuracy": share(line["accuracy"], .1),
            "f5": f_score(line, .05), "f10": f_score(line, .1),
            "cpu_s": told["cpu_s"]}


def rows(context):
    drive = maps_inputs.kitti(context)
    if drive is None:
        return []
    return [row_of(context, drive, *each) for each in (*MAPS, *CURVE)]


def goals_of(found):
    rows_ = []
    for row in found:
        if "failure" in row:
            continue
        if row["map"] == "small":
            rows_ += [goals.at_most("smallest map: bytes", "small", row["bytes"], 14000),
                      goals.at_most("smallest map: mean of raw to map, m", "small", row["mean_m"],
                                    .05),
                      goals.at_least("smallest map: raw within 10 cm", "small", row["within_10"],
                                     .95)]
        if row["map"] == "fine":
            rows_ += [goals.at_most("fine map: bytes", "fine", row["bytes"], 30000),
                      goals.at_least("fine map: F10 within 40 m", "fine", row["f10"], .97)]
    return rows_


COLUMNS = [Column("map", "map"), Column("options", "options of map build"), Column("bytes", "bytes"),
           Column("metre", "bytes a metre", digits=0), Column("mean_m", "raw to map, mean", "m", 4),
           Column("within_5", "raw within 5 cm", check="share"),
           Column("within_10", "raw within 10 cm", check="share"),
           Column("accuracy", "map within 10 cm of raw", check="share"),
           Column("f5", "F5", check="share"), Column("f10", "F10", check="share"),
           Column("cpu_s", "build", "CPU s", 2)]


def table(found):
    return Table(
        "maps-surface", "Surface maps of KITTI 00, frames 0 to 15",
        "every raw return from 2.5 m to 80 m (to 40 m where --max-range says so) of all 16 scans, "
        "moved by the refined poses, to the map's surface; back from points of the map every 5 cm "
        "(`map compare`).",
        COLUMNS, rows_or([shown(row, COLUMNS) for row in found], COLUMNS,
                         "no drive of real scans with poses in this run"))


def shown(row, columns, name="map"):
    """A row that failed says why in every cell."""
    if "failure" not in row:
        return row
    return {**dict.fromkeys((column.key for column in columns), Missing(row["failure"])),
            name: row[name]}
