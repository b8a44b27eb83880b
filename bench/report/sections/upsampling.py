# SPDX-License-Identifier: BSD-3-Clause
"""Upsampling of 16 rings to 64: TULIP's protocol on KITTI, distances to the whole scan, a map."""
from statistics import fmean

from frame.cells import Missing
from frame.tables import Column, Figure, Table, rows_or
from sections import profiles, upsampling_goals
from sections.one_to_one import explain, short
from sections.profiles import drive_of

TITLE = "Upsampling: 16 rings to 64"
TABLES = ("upsampling-goals", "upsampling", "upsampling-drives")
FIGURES = ("mae_m", "both_valid_mae_m", "chamfer_m2", "iou", "f1")
MORE = ("p50", "completeness")
RAW = {"nearest ring": "nearest ring of the image", "edge-aware": "edge-aware in 1/r",
       "rules": "curlidar's rules on the image's rows",
       "rules, tables": "the same with tables of other drives",
       "rules, tables, trees": "with tables and trees of other drives"}
IMAGE = {"decoded image, 1 bit": "the last, image rows from a file at 1 bit a return",
         "decoded image, 2 bit": "image rows from a file at 2 bits a return"}
FILE = {"file, 5 mm": "curlidar, file at 5 mm", "file, 1 bit": "curlidar, file at 1 bit a return"}
PROFILE, EXACT = ", profile", ", given rows exact"
NEAREST = {"paper": "paper, S 4x1", "edge-aware": "edge-aware in 1/r", "compact": "curlidar",
           "compact-field": "curlidar, its field alone"}
EVERY = 4
NO_FILE = Missing("raw samples, no file")
WHAT = {**{method: "image rows as measured" for method in RAW},
        **{method: "image rows, decoded" for method in IMAGE},
        **{method: "a user's file: decode --sensor" for method in FILE}}
COLUMNS = [
    Column("mae_m", "MAE, all pixels", "m"), Column("both_valid_mae_m", "MAE, both valid", "m"),
    Column("chamfer_m2", "Chamfer, sum of squared", "m²"), Column("iou", "IoU", check="share"),
    Column("f1", "F1", check="share"), Column("p50", "median, both valid", "m", 4),
    Column("completeness", "completeness", "share", check="share")]
IDENTITY = [Column("method", "method"), Column("what", "from"),
            Column("bits", "bits a return", digits=2)]
LINES = ["Image rows as measured: what the protocol gives, rows 0, 4, .. 60 of the image, to a "
         "method that predicts the others; `report_measure` alone does that. A user's file: rings "
         "0, 4, .. 60 of the sensor coded as the scan of a sensor of 16 rings, decoded with "
         "--sensor as the whole sensor, its points projected as those of the scan are. Its rings "
         "lie in other rows of the image than those that the protocol gives, so some of the "
         "predicted rows hold what was coded: compare it with the lines of its kind.",
         "Given rows are judged too, by MAE, Chamfer, IoU and F1: as they were decoded, or (given "
         "rows exact) replaced by those of the scan, as if the raw samples were still there."]


def judged(context):
    """The scans of sensors of 64 rings."""
    return [scan for scan in context.scans if scan.is_kitti]


def scores_of(context, scan):
    """Lines of methods."""
    command = [context.bin / "report_measure", "upsampling", scan.path]
    for option, profile in (
            ("--profile", profiles.without_drive(context, scan, "image", *profiles.IMAGE)),
            ("--rings-profile", profiles.without_drive(context, scan, "rings", "--every",
                                                       str(EVERY), *profiles.RINGS))):
        command += [option, profile] if profile else []
    lines = context.measure("upsampling", {"input": scan.name, "part": "protocol"}, command)
    return [line for line in lines if "method" in line]


def distances_of(context, scan):
    return context.measure("upsampling", {"input": scan.name, "part": "nearest"}, [
        context.bin / "report_measure", "nearest", scan.path, "--every", str(EVERY)])


def measure(context):
    for scan in judged(context):
        scores_of(context, scan)
        distances_of(context, scan)
    from sections import upsampling_map  # needs numpy
    upsampling_map.measure(context)


def drive_means(context):
    """{drive: {method: means over its scans}}, with the number of scans."""
    found = {}
    for scan in judged(context):
        for line in scores_of(context, scan):
            found.setdefault(drive_of(scan), {}).setdefault(line["method"], []).append(line)
    return {drive: {method: {**{key: fmean(line[key] for line in lines)
                                for key in (*FIGURES, *MORE)}, "scans": len(lines),
                             "bits": fmean(line["bits_per_point"] for line in lines)
                             if "bits_per_point" in lines[0] else NO_FILE}
                    for method, lines in methods.items()} for drive, methods in found.items()}


def plain_name(method):
    """What the figures of a method stand on, without what was added to it."""
    return method.replace(EXACT, "").replace(PROFILE, "")


def title_of(method):
    name = plain_name(method)
    title = {**RAW, **IMAGE, **FILE}.get(name, f"curlidar, {name}")
    title += ", profile of other drives" if PROFILE in method else ""
    return title + (EXACT if EXACT in method else "")


def described(method):
    return {"method": title_of(method), "what": WHAT.get(plain_name(method), "image rows")}


def tables(context):
    means = drive_means(context)
    found = [upsampling_goals.table(overall(means)), protocol(context, means), drives(means)]
    nearest = nearest_rows(context)
    return [*found, nearest_table(nearest)] if nearest else found


def overall(means):
    """{method: means over drives}, with the number of drives."""
    found = {}
    for method in dict.fromkeys(method for each in means.values() for method in each):
        drives_of = [each[method] for each in means.values() if method in each]
        bits = [each["bits"] for each in drives_of if not isinstance(each["bits"], Missing)]
        found[method] = {**{key: fmean(each[key] for each in drives_of)
                            for key in (*FIGURES, *MORE)}, "drives": len(drives_of),
                         "bits": fmean(bits) if bits else NO_FILE}
    return found


def protocol(context, means):
    not_published = {key: Missing("not published") for key in ("both_valid_mae_m", *MORE)}
    rows = [{**not_published, "drives": "other", "what": "image rows as measured",
             "bits": NO_FILE, **row} for row in context.published_rows("upsampling")]
    rows += [{**described(method), **figures} for method, figures in overall(means).items()]
    if not means:
        why = Missing("no KITTI scan in this run")
        rows += [{**described(method), **dict.fromkeys(
            ("drives", "bits", *FIGURES, *MORE), why)} for method in RAW]
    return Table(
        "upsampling", "16 rings to 64 on KITTI, TULIP's protocol",
        "all pixels of the 64 x 1024 range image within 2 .. 80 m, empty ones included, rows 0, 4, "
        ".. 60 being the input; Chamfer, IoU and F1 (voxels of 0.1 m) count the points of those "
        "pixels; motion of the scans is undone first; means over drives of the means over their "
        "scans.",
        [*IDENTITY, Column("drives", "drives"), *COLUMNS], rows,
        [*LINES, "SuperRso was not run: its network and its weights are not available here; its "
         "row is kept for when they are.",
         "published on another split: not comparable scan by scan.",
         "Profiles, tables and trees were fitted (program `density`) to all scans at hand of other "
         "drives than the one that is judged."])


def drives(means):
    columns = [Column("drive", "drive"), *IDENTITY, Column("scans", "scans"), *COLUMNS]
    rows = [{"drive": drive, **described(method), **figures}
            for drive, methods in means.items() for method, figures in methods.items()]
    return Table("upsampling-drives", "The same, drive by drive",
                 "as above, means over the scans of a drive.", columns,
                 rows_or(rows, columns, "no KITTI scan in this run"))


def nearest_rows(context):
    rows = []
    for scan in judged(context):
        for line in distances_of(context, scan):
            if line.get("method") in NEAREST and "to_scan" in line:
                rows.append({"input": scan.name, "method": NEAREST[line["method"]],
                             "points": line["points"],
                             **{f"{way}_{key}": line[f"{way}_scan"][key]
                                for way in ("to", "from") for key in ("mean", "p50", "p95")},
                             "percentiles": line["to_scan_percentiles"]})
    return rows


def nearest_table(rows):
    columns = [Column("input", "scan"), Column("method", "method"), Column("points", "points")]
    for way, title in (("to", "to the scan"), ("from", "from the scan")):
        columns += [Column(f"{way}_mean", f"{title}: mean", "m", 4),
                    Column(f"{way}_p50", "median", "m", 4), Column(f"{way}_p95", "p95", "m", 3)]
    return Table(
        "upsampling-nearest", "Every 4th ring made 4 times denser: distances to the whole scan",
        "points within the paper's range limits, each to the nearest return of the whole scan, and "
        "every return of the scan within them to the nearest point.", columns, rows,
        ["paper, S 4x1: its upsampling (stages A and B) of the raw returns, on 1024 columns. "
         "curlidar: from its file at 1 bit a return, on the columns of the sensor."])


def figures(context):
    rows = nearest_rows(context)
    found = []
    if rows:
        context.write_data("upsampling-nearest", ["input", "method", "percentile", "distance"], [
            (row["input"], row["method"], percent, distance)
            for row in rows for percent, distance in enumerate(row["percentiles"])])
        draw(context)
        found.append(Figure(
            "upsampling-cdf", "Distances of the upsampled points",
            "Share of the points that lie within a distance of the whole scan, every 4th ring "
            "being given.", "svg", "data/upsampling-nearest.csv"))
    from sections import upsampling_map
    return found + upsampling_map.figures(context)


def draw(context):
    from frame import plots
    rows = context.read_data("upsampling-nearest")
    inputs = list(dict.fromkeys(row["input"] for row in rows))[:5]
    names = list(NEAREST.values())
    figure, axes = plots.panels(len(inputs) + 1)
    for axis, name in zip(axes, inputs):
        for method in names:
            line = [(row["distance"], row["percentile"] / 100) for row in rows
                    if (row["input"], row["method"]) == (name, method)]
            if line:
                axis.plot(*zip(*line), label=method, color=plots.colour_of(method, names),
                          linestyle="--" if "alone" in method else "-")
        axis.set(title=short(name), xlabel="distance (m)", xlim=(0, .3), ylim=(0, 1),
                 ylabel="share of the points")
    explain(axes[len(inputs)], axes[0])
    plots.save(figure, context.figure_path("upsampling-cdf", "svg"))


def check(_context, found):
    """Medians are no more than p95, and an F1 is what its IoU makes it, up to the means."""
    for table in found:
        for row in table.rows:
            if table.id == "upsampling-nearest" and row["to_p50"] > row["to_p95"]:
                yield f"table {table.id}: a median above its p95"
            if table.id == "upsampling-drives" and not isinstance(row["iou"], Missing) and not (
                    row["iou"] <= row["f1"] <= 1):
                yield f"table {table.id}: {row['drive']}: F1 {row['f1']:.3f} below IoU"
