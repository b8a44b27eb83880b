# SPDX-License-Identifier: BSD-3-Clause
"""What people do with the field: scans of few rings made denser by the preset for them, and scans
as another sensor sees them."""
from frame.cells import Missing
from frame.tables import Column, Table, rows_or

SPARSE = {64: (4, 2), 32: (2,)}      # every K-th of so many rings
OTHERS, QUICK_OTHERS = ("vlp16", "os1-128"), ("vlp16",)
SEEN = ("hdl64e-kitti",)             # sensors that are seen as others
FIGURES = [Column("p50", "median", "m", 4), Column("p95", "p95", "m", 3),
           Column("within_5cm", "within 5 cm", "share", check="share"),
           Column("completeness", "completeness", "share", check="share"),
           Column("no_surface", "points where there is no surface")]


def factors_of(scan):
    """The K of a scan, by what its sensor is called."""
    return next((factors for rings, factors in SPARSE.items()
                 if f"{rings}E" in scan.sensor.replace("-", "")), ())


def sparse_of(context, scan, every):
    return context.measure("continuous", {"input": scan.name, "part": "sparse", "every": every}, [
        context.bin / "report_measure", "sparse", scan.path, "--every", str(every)])


def others_of(context):
    return QUICK_OTHERS if context.quick else OTHERS


def seen_as(context, scene, other):
    return context.measure("continuous", {"input": scene.id, "part": "as sensor", "other": other}, [
        context.bin / "report_measure", "as-sensor", scene.name, scene.sensor, scene.preset, other,
        "--seed", str(scene.seed)])


def measure(context, scenes):
    """`scenes`: with their own sensors, of seeds that nothing was trained on."""
    tables(context, scenes)


def sparse_rows(context):
    rows = []
    for scan in context.scans:
        for every in factors_of(scan)[:1 if context.quick else None]:
            for line in sparse_of(context, scan, every):
                if "failure" not in line:
                    rows.append({"input": scan.name, **line,
                                 "from_p50": line["from_held_out"]["p50"],
                                 "from_p95": line["from_held_out"]["p95"]})
    return rows


def sparse_table(context):
    columns = [Column("input", "scan"), Column("rings_coded", "rings coded"),
               Column("rows", "rows made"), Column("bits_per_point", "bits a return", digits=2),
               Column("points", "points"), *FIGURES,
               Column("from_p50", "left-out returns to the cloud: median", "m", 4),
               Column("from_p95", "p95", "m", 3)]
    return Table(
        "continuous-sparse", "Sensors of few rings: --preset sparse",
        "along the beams of the rings that were left out: what is told with the preset's least "
        "confidence of 0.2; and every return of these rings to the nearest point of the cloud, the "
        "coded returns among its points.", columns,
        rows_or(sparse_rows(context), columns, "no scan of 32 or 64 rings in this run"),
        ["Every 2nd or 4th ring of the scan is coded at 1 bit a return, as that of a sensor of 32 "
         "or 16 rings, and decoded with --preset sparse: 64 rows; with --rows besides: 128.",
         "Errors along the beams are those of the field, whatever rows are made of it."])


def sensor_rows(context, scenes):
    return [{"input": scene.name, "sensor": scene.sensor, "other": other, **line}
            for scene in scenes[:1] if scene.sensor in SEEN for other in others_of(context)
            for line in seen_as(context, scene, other) if "failure" not in line]


def sensor_table(context, scenes):
    columns = [Column("input", "scene"), Column("sensor", "coded sensor"),
               Column("other", "seen as"), Column("setting", "file"),
               Column("bits_per_point", "bits a return", digits=2), Column("points", "points"),
               *FIGURES, Column("all_completeness", "completeness, all beams", "share",
                                check="share")]
    return Table(
        "continuous-sensor", "A scan as another sensor sees it: --sensor",
        "the beams of the other sensor that lie between the outermost rings of the coded one, each "
        "against what it meets in the exact scene from where it leaves.", columns,
        rows_or(sensor_rows(context, scenes), columns, "no scene of the sensor in this run"),
        ["Completeness, all beams: also of those that look above or below what was scanned."])


def tables(context, scenes):
    return [sparse_table(context), sensor_table(context, scenes)]


def check(found):
    """What is told between the rings is no worse at the median than at p95."""
    for table in found:
        if table.id in ("continuous-sparse", "continuous-sensor"):
            for row in table.rows:
                if not isinstance(row["p95"], Missing) and row["p50"] > row["p95"]:
                    yield f"table {table.id}: a median above its p95"
