# SPDX-License-Identifier: BSD-3-Clause
"""A simulated drive of two laps: bytes a metre, the second lap, exact truth, speed, memory."""
from frame.cells import Missing
from frame.context import Inside
from frame.tables import Column, Figure, Table, rows_or
from sections import goals, maps_inputs
from sections.maps_inputs import appended, built, f_score, on_surface, share, told_by
from sections.maps_surface import SPACING_M, shown

SENSOR, QUICK_SENSOR = "hdl64e-kitti", "vlp16"
SCANS, QUICK_SCANS = 240, 8  # of two laps
LAPS = 2
PARTS = (.25, .5, 1, 2)      # laps whose builds are measured
MEMORY_GROWTH = 1.25         # that peaks may have from half a lap to two laps
FIGURE = "maps-length"


def drive_of(context):
    """Two laps, or None in runs of real scans only."""
    if not context.scenes:
        return None
    return maps_inputs.simulated(
        context, "two laps", "--laps", str(LAPS), "--truth", "--sensor",
        QUICK_SENSOR if context.quick else SENSOR,
        count=QUICK_SCANS if context.quick else SCANS)


def ways(context, drive):
    """(name, folder with map.curl, laps that it saw)."""
    lap = drive.count // LAPS
    first, second = drive.part(context, 0, lap), drive.part(context, lap, drive.count)
    one = built(context, first)
    return (("lap one", one, first), ("lap two appended", appended(context, one, second), drive),
            ("both laps at once", built(context, drive), drive),
            ("both, moving things left out", built(context, drive, "--still"), drive))


def row_of(context, drive, name, folder, seen):
    told = told_by(context, "maps", {"drive": drive.name, "built": name}, folder)
    if "failure" in told:
        return {"map": name, "failure": told["failure"]}
    truth = Inside(drive.scans[0].folder, "truth.ply")
    line = on_surface(context, {"drive": drive.name, "to its surface": name}, truth, folder,
                      SPACING_M)
    if "failure" in line:
        return {"map": name, "failure": line["failure"]}
    size = told["files"]["map.curl"]
    return {"map": name, "scans": seen.count, "length_m": maps_inputs.length_m(context, seen),
            "bytes": size, "metre": size / maps_inputs.length_m(context, seen),
            "mean_m": line["completeness"]["mean"],
            "within_10": share(line["completeness"], .1),
            "accuracy": share(line["accuracy"], .1), "f10": f_score(line, .1),
            "ghosts": 1 - share(line["accuracy"], .2), "cpu_s": told["cpu_s"],
            "scans_a_second": Missing("appended") if "appended" in name else
            seen.count / told["cpu_s"]}


def rows(context):
    drive = drive_of(context)
    return [row_of(context, drive, *way) for way in ways(context, drive)] if drive else []


def memory_rows(context):
    """Peaks of builds of parts of the drive."""
    drive, found = drive_of(context), []
    for laps in PARTS if drive else ():
        count = max(round(laps * drive.count / LAPS), 1)
        part = drive.part(context, 0, count)
        told = told_by(context, "maps", {"drive": drive.name, "laps": laps}, built(context, part))
        if "failure" in told:
            found.append({"laps": laps, "failure": told["failure"]})
            continue
        found.append({"laps": laps, "scans": count, "length_m": maps_inputs.length_m(context, part),
                      "bytes": told["files"]["map.curl"],
                      "peak_mb": told["peak_rss_bytes"] / 1e6, "cpu_s": told["cpu_s"],
                      "scans_a_second": count / told["cpu_s"]})
    return found


COLUMNS = [Column("map", "map of"), Column("scans", "scans"),
           Column("length_m", "way", "m", 0), Column("bytes", "bytes"),
           Column("metre", "bytes a metre of way", digits=0),
           Column("mean_m", "truth to map, mean", "m", 4),
           Column("within_10", "truth within 10 cm", check="share"),
           Column("accuracy", "map within 10 cm of truth", check="share"),
           Column("f10", "F10", check="share"),
           Column("ghosts", "map beyond 20 cm", check="share"),
           Column("cpu_s", "this command", "CPU s", 1),
           Column("scans_a_second", "scans a second", "one core", 2)]
MEMORY = [Column("laps", "laps"), Column("scans", "scans"), Column("length_m", "way", "m", 0),
          Column("bytes", "bytes of the map"), Column("peak_mb", "peak memory", "MB", 0),
          Column("cpu_s", "CPU", "s", 1), Column("scans_a_second", "scans a second", "one core", 2)]


def tables(drive_rows, memory):
    none = "no simulated scenes in this run"
    return [Table(
        "maps-drive", "A simulated drive of two laps",
        "points of the exact surface of what does not move, where the scans have seen it, to the "
        "map's surface, and points of the map every 5 cm back to them (`map compare`).", COLUMNS,
        rows_or([shown(row, COLUMNS) for row in drive_rows], COLUMNS, none)), Table(
            "maps-memory", "Builds of parts of it",
            "one `map build` each, one thread; peak memory is that of the process as the system "
            "tells it, CPU time of the whole command.", MEMORY,
            rows_or([shown(row, MEMORY, "laps") for row in memory], MEMORY, none))]


def goals_of(drive_rows, memory):
    by_name = {row["map"]: row for row in drive_rows if "failure" not in row}
    if {"lap one", "lap two appended"} <= set(by_name):
        first, both = by_name["lap one"]["bytes"], by_name["lap two appended"]["bytes"]
        yield goals.at_most("second lap: bytes beside the first's", "appended", both / first - 1, .1)
    if {"lap one", "both laps at once"} <= set(by_name):
        first, both = by_name["lap one"]["bytes"], by_name["both laps at once"]["bytes"]
        yield goals.at_most("second lap: bytes beside the first's", "built together",
                            both / first - 1, .1)
        yield goals.at_least("build speed: scans a second on one core", "both laps",
                             by_name["both laps at once"]["scans_a_second"], 5.)
    peaks = {row["laps"]: row["peak_mb"] for row in memory if "failure" not in row}
    if {.5, 2} <= set(peaks):
        yield goals.at_most("memory: peak of two laps beside half a lap's", "map build",
                            peaks[2] / peaks[.5], MEMORY_GROWTH)


def figures(context, memory):
    found = [row for row in memory if "failure" not in row]
    if not found:
        return []
    keys = ["laps", "length_m", "bytes", "peak_mb"]
    context.write_data(FIGURE, keys, found)
    draw(context)
    return [Figure(FIGURE, "Memory and size against the length of the drive",
                   "Peak memory of `map build` and bytes of the map; the second lap is on the same "
                   "streets as the first.", "svg", f"data/{FIGURE}.csv")]


def draw(context):
    from frame import plots
    rows_ = context.read_data(FIGURE)
    figure, axes = plots.panels(2)
    for axis, key, scale, title in ((axes[0], "peak_mb", 1, "peak memory of the build (MB)"),
                                    (axes[1], "bytes", 1e-3, "size of the map (kB)")):
        axis.plot([row["length_m"] for row in rows_], [scale * row[key] for row in rows_],
                  marker="o", color=plots.OURS)
        axis.set(xlabel="length of the way (m)", title=title, ylim=(0, None), xlim=(0, None))
    plots.save(figure, context.figure_path(FIGURE, "svg"))
