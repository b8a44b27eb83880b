# SPDX-License-Identifier: BSD-3-Clause
"""Scans as one sequence beside the same scans one by one, at the same target."""
from dataclasses import dataclass
from statistics import fmean

from frame.cells import Missing
from frame.context import OUTPUT, Inside
from frame.scans import every_scan_beside
from frame.tables import Column, Table, rows_or
from sections import goals, maps_inputs
from sections.maps_inputs import kept, told_by

ERROR_M = .05
SCANS_OF_KITTI = 10


@dataclass(frozen=True)
class Input:
    """Scans one after the other. `still`: the sensor does not move."""
    name: str
    scans: tuple
    still: bool = False


def folder_of(context, test, limit=None):
    """(a scan, all scans of its folder) of the first scan that is as wanted."""
    for scan in context.scans:
        if test(scan):
            around = sorted((each.path for each in every_scan_beside(scan)
                             if each.path.parent == scan.path.parent), key=lambda path: path.name)
            if len(around) > 1:
                return tuple(around[:limit])
    return ()


def inputs(context):
    found = [Input("KITTI 00, ten scans", folder_of(
        context, lambda scan: "kitti_odometry_00" in scan.path.as_posix(), SCANS_OF_KITTI)),
             Input("KITTI raw, drive", folder_of(
                 context, lambda scan: "kitti_raw/sfnd" in scan.path.as_posix())),
             Input("HDL-32E pair", folder_of(context, lambda scan: "HDL-32E" in scan.sensor, 2))]
    found = [each for each in found if each.scans]
    if context.scenes:
        few, sensor = (4, "vlp16") if context.quick else (30, "hdl64e-kitti")
        drive = maps_inputs.simulated(context, "simulated drive", "--sensor", sensor, count=few)
        still = maps_inputs.simulated(context, "simulated, still", "--sensor", sensor, "--still",
                                      count=4 if context.quick else 10)
        found += [Input(f"simulated drive, {sensor}", drive.scans),
                  Input(f"simulated, still, {sensor}", still.scans, True)]
    return found


def settings(item):
    return ["--error", f"{ERROR_M:g}", "--attributes", "none"]


def singles(context, item):
    return kept(context, "encode", *item.scans, *settings(item), "--no-index", "-o", "{}/")


def sequence(context, item, *options):
    return kept(context, "encode", *item.scans, "--sequence", *(["--static"] if item.still else []),
                *settings(item), *options, "-o", "{}/drive.curl")


def reports(told):
    """The report of each scan, in the order of the scans."""
    found = []
    for each in told["said"]:
        found += each["frames"] if "frames" in each else [each]
    return [each for each in found if "points_in" in each]


def raw(context, item, scan):
    """The raw scan number `scan`, for commands."""
    if isinstance(item.scans[0], Inside):
        return Inside(item.scans[0].folder, item.scans[0].pattern, (scan, scan + 1))
    return item.scans[scan]


def nearest(context, item, way, scan, command):
    """The larger of the two directed mean distances between a raw scan and what comes back."""
    back = context.made(".ply", [context.curlidar, "decode", *command, "--threads", "1", "--quiet",
                                 "-o", OUTPUT])
    line = context.measure("maps", {"sequence": item.name, "way": way, "distances of scan": scan}, [
        context.curlidar, "compare", raw(context, item, scan), back, "--json", "--threads", "1",
        "--quiet"])[0]
    return line["symmetric"]["mean"]


def row_of(context, item):
    """One by one and as a sequence."""
    one = told_by(context, "maps", {"sequence": item.name, "way": "one by one"},
                  singles(context, item))
    told = told_by(context, "maps", {"sequence": item.name, "way": "sequence"},
                   sequence(context, item))
    for each in (one, told):
        if "failure" in each:
            return {"input": item.name, "failure": each["failure"]}
    alone, scans = reports(one), reports(told)
    points = sum(each["points_in"] for each in alone)
    last = len(alone) - 1
    row = {"input": item.name, "scans": len(alone), "points": points}
    for way, files, report, command in (
            ("single", one, alone, [Inside(singles(context, item), "*.curl", (last, last + 1))]),
            ("sequence", told, scans, [Inside(sequence(context, item), "drive.curl"), "--scan",
                                       str(last)])):
        size = sum(files["files"].values())
        row |= {f"{way}_bytes": size, f"{way}_bits": 8 * size / points,
                f"{way}_error_m": fmean(each["mean_error_m"] for each in report),
                f"{way}_nearest_m": nearest(context, item, way, last, command),
                f"{way}_s": files["cpu_s"] / len(alone)}
    later = [sum(each["bytes"] for each in report[1:]) for report in (alone, scans)]
    row["saving"] = 1 - row["sequence_bytes"] / row["single_bytes"]
    row["later_saving"] = 1 - later[1] / later[0] if later[0] else Missing("one scan")
    row["cpu_ratio"] = row["sequence_s"] / row["single_s"]
    return row


def rows(context):
    return [row_of(context, item) for item in inputs(context)]


def table(found):
    columns = [
        Column("input", "scans of"), Column("scans", "scans"), Column("points", "points"),
        Column("single_bits", "one by one", "bits a point"),
        Column("sequence_bits", "sequence", "bits a point"),
        Column("saving", "saving", "of all bytes", check="any"),
        Column("later_saving", "saving", "without the first scan", check="any"),
        Column("single_error_m", "mean error one by one", "m", 4),
        Column("sequence_error_m", "of the sequence", "m", 4),
        Column("single_nearest_m", "last scan, NN one by one", "m", 4),
        Column("sequence_nearest_m", "NN of the sequence", "m", 4),
        Column("single_s", "CPU one by one", "s a scan", 2),
        Column("cpu_ratio", "sequence takes", "times that", 2)]
    shown = [row if "failure" not in row else {
        **dict.fromkeys((column.key for column in columns), Missing(row["failure"])),
        "input": row["input"]} for row in found]
    return Table(
        "maps-sequences", "Sequences: scans predicted from the one before",
        f"every return of every scan, without attributes; both at --error {ERROR_M:g}, default "
        "effort, groups of the default length; every byte of the files.", columns,
        rows_or(shown, columns, "no scans that follow each other in this run"),
        ["Mean error: of every return from its own original, as the encoder measured it. NN: the "
         "larger of the two directed mean distances to the nearest neighbour, between the last raw "
         "scan and what `decode` gives back."])


def goals_of(found):
    wanted = {"KITTI 00": .20, "KITTI raw": .22, "simulated drive": .22, "simulated, still": .45}
    rows_ = []
    for row in found:
        if "failure" in row:
            continue
        for name, share in wanted.items():
            if row["input"].startswith(name):
                rows_.append(goals.at_least("sequence at 5 cm: saved of all bytes", row["input"],
                                            row["saving"], share))
        if row["input"] == "HDL-32E pair":
            rows_.append(goals.at_least("sequence at 5 cm: saved of the second scan", row["input"],
                                        row["later_saving"], .30))
        if row["input"].startswith("KITTI 00"):
            rows_.append(goals.at_most("sequence at 5 cm: bits a point", row["input"],
                                       row["sequence_bits"], .46))
    return rows_
