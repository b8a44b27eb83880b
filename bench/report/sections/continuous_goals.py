# SPDX-License-Identifier: BSD-3-Clause
"""What is told between the samples beside edge-aware interpolation of the raw samples, at equal
completeness, and whether the goals are met. Ranges of any length count."""
from frame.cells import Missing
from frame.tables import Column, Table, rows_or

P95_SHARE = .9          # of edge-aware's, at rings held out
HALF = .5               # completeness of the most trusted
HALF_P50, HALF_P95 = .025, .20
EQUAL = ("At equal completeness: of the lines that meet a surface both methods keep as many as the "
         "one that tells fewer, each those that it trusts most: curlidar by its confidence, "
         "interpolation by how near the ranges on the two rings are to each other. Where curlidar "
         "tells less, interpolation is cut to what curlidar tells.")
FIGURES = [
    Column("edge_completeness", "edge-aware: completeness", "share", check="share"),
    Column("edge_p50", "median", "m", 4), Column("edge_p95", "p95", "m", 3),
    Column("completeness", "curlidar: completeness", "share", check="share"),
    Column("p50", "median", "m", 4), Column("p95", "p95", "m", 3),
    Column("equal_completeness", "at equal completeness", "share", check="share"),
    Column("equal_edge_p50", "edge-aware: median", "m", 4),
    Column("equal_edge_p95", "p95", "m", 3),
    Column("equal_p50", "curlidar: median", "m", 4), Column("equal_p95", "p95", "m", 3)]
OURS = {"compact": "curlidar", "compact-profile": "curlidar, profile of other drives"}
MET = [Column("median_met", "median no worse"), Column("p95_met", "p95 as wanted")]


def line_of(lines, method, factor=None):
    return next((line for line in lines if line["method"] == method
                 and line.get("factor") == factor), None)


def compared(ours, edge):
    """The cells of FIGURES."""
    equal = ours["whole"]["equal"]
    return {**{f"edge_{key}": edge["whole"][key] for key in ("completeness", "p50", "p95")},
            **{key: ours["whole"][key] for key in ("completeness", "p50", "p95")},
            "equal_completeness": equal["completeness"], "equal_p50": equal["p50"],
            "equal_p95": equal["p95"], "equal_edge_p50": equal["other_p50"],
            "equal_edge_p95": equal["other_p95"]}


def verdict(row, p95_share):
    """Cells of MET."""
    return {"median_met": said(row["equal_p50"], row["equal_edge_p50"]),
            "p95_met": said(row["equal_p95"], p95_share * row["equal_edge_p95"])}


def said(value, limit):
    """By how much a goal is missed."""
    return "yes" if value <= limit else f"no, {100 * (value / limit - 1):.0f} % over"


def truth(measured):
    """`measured`: {(scene, sensor): lines}."""
    rows = []
    for (scene, sensor), lines in measured.items():
        for factor in dict.fromkeys(line["factor"] for line in lines):
            ours, edge = (line_of(lines, each, factor) for each in ("compact", "edge-aware"))
            if ours and edge:
                row = compared(ours, edge)
                rows.append({"scene": scene, "sensor": sensor, "factor": factor,
                             "bits": ours["bits_per_point"], **row, **verdict(row, 1)})
    identity = [Column("scene", "scene"), Column("sensor", "sensor"),
                Column("factor", "R", digits="g"), Column("bits", "bits a return", digits=2)]
    return table(
        "continuous-goals-truth", "Between the rings of simulated scans: curlidar at 1 bit a "
        "return beside the raw samples", "rays between the rings that meet a surface within the "
        "sensor's range, 40,000 of each scan and R (quick: 10,000); the scenes have a seed of "
        "their own, which nothing was trained on.", identity, rows,
        ["Wanted: median and p95 at equal completeness no more than those of edge-aware "
         "interpolation.", EQUAL])


def held_out_row(ours, edge, calibrated):
    row, half = compared(ours, edge), ours["half"]
    few = Missing(f"{100 * half['completeness']:.0f} % are told")
    enough = half["completeness"] >= HALF - .005
    return {"bits": ours["bits_per_point"], **row,
            "calibrated_p50": calibrated["whole"]["p50"],
            "calibrated_p95": calibrated["whole"]["p95"],
            "half_p50": half["p50"] if enough else few,
            "half_p95": half["p95"] if enough else few, **verdict(row, P95_SHARE)}


def held_out(measured):
    """`measured`: {(scan, K): lines}."""
    rows = []
    for (scan, every), lines in measured.items():
        edge, calibrated = (line_of(lines, each) for each in (
            "edge-aware", "edge-aware-calibrated"))
        for method, title in OURS.items():
            if ours := line_of(lines, method):
                rows.append({"scan": scan, "every": every, "method": title,
                             **held_out_row(ours, edge, calibrated)})
    identity = [Column("scan", "scan"), Column("every", "K"), Column("method", "method"),
                Column("bits", "bits a return", digits=2)]
    more = [Column("calibrated_p50", "edge-aware, rings calibrated: median", "m", 4),
            Column("calibrated_p95", "p95", "m", 3),
            Column("half_p50", "curlidar's most trusted half: median", "m", 4),
            Column("half_p95", "p95", "m", 3)]
    return table(
        "continuous-goals-held-out", "Rings held out of real scans: curlidar at 1 bit a return "
        "beside the raw samples", "returns of the rings between every K-th, in their exact "
        "directions.", identity, rows,
        [f"Wanted: at equal completeness the median no more than that of edge-aware interpolation, "
         f"the p95 no more than {P95_SHARE:g} of its.", EQUAL,
         "Rings calibrated: the median error of each held-out ring taken off, fitted on the other "
         "half of the same scan. The most trusted half: the returns with the highest "
         f"confidence; wanted on KITTI at K = 4: {HALF_P50} and {HALF_P95} m.",
         "Profile of other drives: tables of the held-out rings, fitted to the scans at hand of all "
         "drives but that of the scan."], more)


def table(name, title, counts, identity, rows, notes, more=()):
    columns = [*identity, *FIGURES, *more, *MET]
    rows = rows_or(rows, columns, "no scan was measured")
    return Table(name, title, counts, columns, rows, notes)


def tables(measured_truth, measured_held_out):
    """Truth always; held-out rings if there are any."""
    found = [truth(measured_truth)]
    return [*found, held_out(measured_held_out)] if measured_held_out else found
