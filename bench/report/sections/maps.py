# SPDX-License-Identifier: BSD-3-Clause
"""Maps: how large they are. Ours is not measured by this version."""
from frame.cells import Missing
from frame.tables import Column, Table

TITLE = "Maps"
TABLES = ("maps",)
OURS = Missing("not measured by this version")


def measure(_context):
    pass


def tables(context):
    rows = context.published_rows("maps")
    for name in dict.fromkeys(row["map"] for row in rows):
        rows.append({"map": name, "method": "curlidar", "size_mb": OURS})
    rows.sort(key=lambda row: row["map"])  # stable: ours last of its map
    for row in rows:
        row.update(error_m=OURS if row["method"] == "curlidar" else Missing("not published"))
    return [Table(
        "maps", "Sizes of maps",
        "nothing was counted in this run: sizes are those of the files that the methods' authors "
        "name, of all scans of the sequence.",
        [Column("map", "map"), Column("method", "method"), Column("size_mb", "size", "MB", 2),
         Column("error_m", "mean error", "m")],
        rows)]


def figures(_context):
    return []
