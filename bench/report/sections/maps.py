# SPDX-License-Identifier: BSD-3-Clause
"""Sequences and maps: every goal beside what was measured, and sizes that others have published."""
from frame.cells import Missing
from frame.tables import Column, Table, rows_or
from sections import maps_drive, maps_keyframes, maps_sequences, maps_surface

TITLE = "Sequences and maps"
TABLES = ("maps-goals", "maps-sequences", "maps-surface", "maps-keyframes", "maps-drive",
          "maps-memory", "maps")
NOT_HERE = Missing("KITTI 00 is 3.7 km long; 12 m of it are at hand")
COMMANDS = {
    "sequence": "curlidar encode SCANS --sequence --error 0.05 --attributes none -o F",
    "smallest": "curlidar map build SCANS --poses P " + " ".join(maps_surface.SMALL),
    "fine": "curlidar map build SCANS --poses P " + " ".join(maps_surface.FINE),
    "the paper's": "curlidar map build SCANS --poses P " + " ".join(maps_keyframes.OPTIONS),
    "second": "curlidar map build LAP1 --poses P; curlidar map append MAP LAP2 --poses P",
    "build": "curlidar map build SCANS --poses P --threads 1",
    "memory": "curlidar map build SCANS --poses P --threads 1"}


def measured(context):
    """Rows of each table; what is stored is not measured again."""
    return {"sequences": maps_sequences.rows(context), "surface": maps_surface.rows(context),
            "keyframes": maps_keyframes.rows(context), "drive": maps_drive.rows(context),
            "memory": maps_drive.memory_rows(context)}


def measure(context):
    measured(context)
    from sections import maps_pictures  # needs numpy
    maps_pictures.measure(context)


def command_of(goal):
    return next(command for start, command in COMMANDS.items() if goal.startswith(start))


def goals_table(found):
    rows = [*maps_sequences.goals_of(found["sequences"]), *maps_surface.goals_of(found["surface"]),
            *maps_keyframes.goals_of(found["keyframes"]),
            *maps_drive.goals_of(found["drive"], found["memory"])]
    for row in rows:
        row["command"] = command_of(row["goal"])
    columns = [Column("goal", "goal"), Column("input", "of"),
               Column("measured", "measured", digits=".4g", check="any"),
               Column("wanted", "wanted", digits=".4g"), Column("met", "met"),
               Column("command", "command")]
    return Table("maps-goals", "Sequences and maps: goals",
                 "what the tables below count; options of each command are theirs.", columns,
                 rows_or(rows, columns, "nothing was measured"))


def published(context):
    rows = context.published_rows("maps")
    for name in dict.fromkeys(row["map"] for row in rows):
        rows.append({"map": name, "method": "curlidar", "size_mb": NOT_HERE})
    rows.sort(key=lambda row: row["map"])  # stable: ours last of its map
    return Table(
        "maps", "Sizes of maps of whole sequences, as published",
        "nothing was counted in this run: sizes are those of the files that the methods' authors "
        "name, of all scans of the sequence.",
        [Column("map", "map"), Column("method", "method"), Column("size_mb", "size", "MB", 2)],
        rows)


def tables(context):
    found = measured(context)
    return [goals_table(found), maps_sequences.table(found["sequences"]),
            maps_surface.table(found["surface"]), maps_keyframes.table(found["keyframes"]),
            *maps_drive.tables(found["drive"], found["memory"]), published(context)]


def figures(context):
    from sections import maps_pictures
    return [*maps_drive.figures(context, measured(context)["memory"]),
            *maps_pictures.figures(context)]


def check(_context, found):
    """A sequence is no larger than its scans one by one, and an F-score lies between its parts."""
    for table in found:
        for row in table.rows:
            if isinstance(next(iter(row.values())), Missing):
                continue
            if table.id == "maps-sequences" and not isinstance(row["saving"], Missing) and \
                    row["saving"] < 0:
                yield f"table {table.id}: {row['input']}: the sequence is larger than its scans"
            if table.id in ("maps-surface", "maps-drive") and not isinstance(row["f10"], Missing):
                low, high = sorted((row["within_10"], row["accuracy"]))
                if not low - 1e-9 <= row["f10"] <= high + 1e-9:
                    yield f"table {table.id}: {row['map']}: F10 {row['f10']:.3f} is not between its parts"
