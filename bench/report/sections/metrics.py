# SPDX-License-Identifier: BSD-3-Clause
"""Our codec at four errors, in all the measures that the literature uses."""
from common.digest import digest
from frame import files
from frame.cells import Missing
from frame.check import falls
from frame.context import OUTPUT
from frame.tables import Column, Table

TITLE = "Our codec in the metrics of the literature"
TABLES = ("metrics-distances", "metrics-quality")
TARGETS_M = (.05, .02, .01, .005)
QUICK_TARGETS_M = (.05, .01)
THRESHOLDS_M = (.02, .05, .1, .2)
IMAGE = (64, 1024)


def targets(context):
    return QUICK_TARGETS_M if context.quick else TARGETS_M


def sensor_file(context, item):
    """The sensor that the command sees in the raw scan, as a profile that projects raw and decoded
    clouds to the same pixels; Missing if no rings are told."""
    info = context.measure("metrics", {"input": item.name, "part": "sensor"},
                           [context.curlidar, "info", context.cloud(item), "--json"])[0]
    if "failure" in info or info.get("pattern") != "spinning" or not info.get("elevations_deg"):
        return Missing("the sensor's rings cannot be told")
    elevations = ", ".join(f"{value:.9g}" for value in info["elevations_deg"])
    text = (f'name = "seen"\npattern = "spinning"\ncolumns = {info["columns"]}\n'
            f"fov_up_deg = {info['fov_up_deg']:.9g}\nfov_down_deg = {info['fov_down_deg']:.9g}\n"
            f"[rings]\nelevation_deg = [{elevations}]\n")
    return files.write(context.scratch / f"{digest(text)}.toml", text)


def projected(context, cloud, sensor):
    """The file of an image of a cloud."""
    return context.made(".pcd", [
        context.curlidar, "project", cloud, "--sensor", sensor, "--rows", str(IMAGE[0]), "--cols",
        str(IMAGE[1]), "--min-range", "0", "--max-range", "max", "--threads", "1", "--quiet", "-o",
        OUTPUT])


def steps_of(context, item, target_m, sensor):
    """(part, command) of everything that is measured of one coded file."""
    cloud = context.cloud(item)
    coded = context.made(".curl", [
        context.curlidar, "encode", cloud, "--error-nn", f"{target_m:g}", "--attributes", "none",
        "--threads", "1", "--quiet", "-o", OUTPUT])
    decoded = context.made(".pcd", [context.curlidar, "decode", coded, "--threads", "1", "--quiet",
                                    "-o", OUTPUT])
    compare = [context.curlidar, "compare", "--threads", "1", "--json"]
    thresholds = ",".join(f"{value:g}" for value in THRESHOLDS_M)
    yield "file", [context.curlidar, "info", coded, "--json"]
    yield "own", [context.curlidar, "verify", coded, cloud, "--threads", "1", "--json"]
    yield "distances", [*compare, "--planes", "--thresholds", thresholds, cloud, decoded]
    if not isinstance(sensor, Missing):
        yield "images", [*compare, "--images", projected(context, cloud, sensor),
                         projected(context, decoded, sensor)]


def measure(context):
    for item in context.inputs:
        sensor = sensor_file(context, item)
        for target_m in targets(context):
            for part, command in steps_of(context, item, target_m, sensor):
                context.measure("metrics", {"input": item.name, "target_m": target_m, "part": part},
                                command)


def figures_of(parts):
    """The cells of one coded file from what its parts printed."""
    failure = next((parts[name]["failure"] for name in ("file", "own", "distances")
                    if "failure" in parts[name]), None)
    if failure:
        return dict.fromkeys((column.key for column in DISTANCES + QUALITY if column.key not in
                              ("input", "target_m")), Missing(failure))
    file, own, distances = parts["file"], parts["own"], parts["distances"]
    points = distances["points_a"]
    row = {"points": points, "bits": 8 * file["bytes"] / points,
           "float_percent": 100 * file["bytes"] / (12 * points),
           "own_m": own["mean_error_m"], "points_back": distances["points_b"]}
    for name, direction in (("to_decoded", "a_to_b"), ("to_raw", "b_to_a")):
        row.update({f"{name}_{kind}_m": distances[direction][kind]
                    for kind in ("mean", "std", "p95", "max")})
    row.update(d1_db=psnr(distances["point_to_point"]), d2_db=psnr(distances["point_to_plane"]),
               rms_mm=1e3 * distances["point_to_point"]["rms"],
               plane_rms_mm=1e3 * distances["point_to_plane"]["rms"],
               chamfer_m2=distances["chamfer_m2"], chamfer_m=distances["chamfer_m"])
    for match in distances["matches"]:
        row[f"f_{round(1e3 * match['threshold'])}"] = match["f_score"]
        row[f"complete_{round(1e3 * match['threshold'])}"] = match["recall"]
    images = parts.get("images", {"failure": "the sensor's rings cannot be told"})
    for key, name in (("mae_all_m", "mae_all"), ("mae_both_m", "mae_both")):
        row[key] = Missing(images["failure"]) if "failure" in images else images["images"][name]
    return row


def psnr(error):
    return Missing("infinite: no error") if error["psnr_db"] is None else error["psnr_db"]


KEYS = [Column("input", "scan"), Column("target_m", "asked for", "m", ".3g")]
DISTANCES = [
    *KEYS, Column("points", "points"), Column("points_back", "points back"),
    Column("bits", "bits a point", digits=2), Column("float_percent", "of float32", "%", 2),
    Column("to_decoded_mean_m", "raw to decoded, mean", "m", 4),
    Column("to_decoded_std_m", "std", "m", 4), Column("to_decoded_p95_m", "p95", "m", 4),
    Column("to_decoded_max_m", "max", "m", 2),
    Column("to_raw_mean_m", "decoded to raw, mean", "m", 4), Column("to_raw_std_m", "std", "m", 4),
    Column("to_raw_p95_m", "p95", "m", 4), Column("to_raw_max_m", "max", "m", 2),
    Column("own_m", "to its own original, mean", "m", 4)]
QUALITY = [
    *KEYS, Column("bits", "bits a point", digits=2), Column("d1_db", "D1 PSNR", "dB", 2),
    Column("rms_mm", "RMS of it", "mm", 2), Column("d2_db", "D2 PSNR", "dB", 2),
    Column("plane_rms_mm", "RMS of it", "mm", 2),
    Column("chamfer_m2", "Chamfer, sum of squared", "m²", 5),
    Column("chamfer_m", "Chamfer, mean of means", "m", 4),
    *(Column(f"f_{mm}", f"F at {mm // 10} cm", check="share") for mm in (20, 50, 100, 200)),
    Column("complete_50", "complete within 5 cm", check="share"),
    Column("mae_all_m", "MAE, all pixels", "m"), Column("mae_both_m", "MAE, both valid", "m")]


def rows_of(context):
    parts = {}
    for line in context.measured("metrics"):
        if line["part"] != "sensor":
            parts.setdefault((line["input"], line["target_m"]), {})[line["part"]] = line
    return [{"input": name, "target_m": target_m, **figures_of(found)}
            for (name, target_m), found in parts.items()]


def tables(context):
    rows = rows_of(context)
    notes = [f"simulated: {', '.join(scene.name for scene in context.scenes)}"]
    return [
        Table("metrics-distances", "Distances to the nearest neighbour, both ways",
              "every return of the raw scan, each decoded back; attributes are not coded.",
              DISTANCES, rows,
              ["What is asked for (`encode --error-nn`) is the larger of the two means."] + notes),
        Table("metrics-quality", "PSNR, Chamfer, F-score, completeness, images",
              "every return of the raw scan, each decoded back; for the MAE, images of 64 x 1024 "
              "pixels over the scan's own field of view, an empty pixel counting as range 0.",
              QUALITY, rows,
              ["PSNR is 10 log10(3 peak² / MSE) of the worse direction, as MPEG's pc_error has it, "
               "with a peak of 59.70 m as the literature on KITTI takes it; RMS in mm beside it.",
               "D2 is along the normals of the raw scan, estimated from 12 neighbours.",
               "The F-score joins the shares of returns, of either cloud, that have a neighbour "
               "within the threshold in the other."] + notes)]


def figures(_context):
    return []


def check(context, found):
    """Bits fall as the error grows; what was asked for is kept; nobody drops points."""
    distances = found[0]
    yield from falls(distances, "target_m", "bits", ["input"])
    for row in distances.rows:
        if isinstance(row["bits"], Missing):
            continue
        if max(row["to_decoded_mean_m"], row["to_raw_mean_m"]) > 1.001 * row["target_m"]:
            yield f"metrics, {row['input']}: more than {row['target_m']:g} m"
        if row["points"] != row["points_back"]:
            yield f"metrics, {row['input']}: {row['points_back']} of {row['points']} points"
    if len(distances.rows) != len(context.inputs) * len(targets(context)):
        yield "metrics: not every scan is there at every error"
