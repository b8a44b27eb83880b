# SPDX-License-Identifier: BSD-3-Clause
"""What is told between the samples beside edge-aware interpolation of the raw samples, at equal
completeness. Ranges of any length count."""
from frame.cells import Missing
from frame.tables import Column, Table, rows_or

HALF = .5  # completeness of the most trusted
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
OURS = {"compact": "curlidar", "compact-profile": "curlidar, profile of other drives",
        "compact-fine": "curlidar at 5 mm",
        "compact-fine-profile": "curlidar at 5 mm, profile of other drives"}


def line_of(lines, method, factor=None):
    """The line of a method that was measured."""
    return next((line for line in lines if line.get("method") == method and "whole" in line
                 and line.get("factor") == factor), None)


def compared(ours, edge):
    """The cells of FIGURES."""
    equal = ours["whole"]["equal"]
    return {**{f"edge_{key}": edge["whole"][key] for key in ("completeness", "p50", "p95")},
            **{key: ours["whole"][key] for key in ("completeness", "p50", "p95")},
            "equal_completeness": equal["completeness"], "equal_p50": equal["p50"],
            "equal_p95": equal["p95"], "equal_edge_p50": equal["other_p50"],
            "equal_edge_p95": equal["other_p95"]}


def truth(measured):
    """`measured`: {(scene, sensor): lines}."""
    rows = []
    for (scene, sensor), lines in measured.items():
        for factor in dict.fromkeys(line["factor"] for line in lines):
            ours, edge = (line_of(lines, each, factor) for each in ("compact", "edge-aware"))
            if ours and edge:
                rows.append({"scene": scene, "sensor": sensor, "factor": factor,
                             "bits": ours["bits_per_point"], **compared(ours, edge)})
    identity = [Column("scene", "scene"), Column("sensor", "sensor"),
                Column("factor", "R", digits="g"), Column("bits", "bits a return", digits=2)]
    return table(
        "continuous-equal-truth", "Between the rings of simulated scans: curlidar at 1 bit a "
        "return beside the raw samples", "rays between the rings that meet a surface within the "
        "sensor's range, 40,000 of each scan and R (quick: 10,000); the scenes have a seed of "
        "their own, which nothing was trained on.", identity, rows,
        [EQUAL])


def half_of(ours):
    """Cells of the most trusted half."""
    half = ours["half"]
    few = Missing(f"{100 * half['completeness']:.0f} % are told")
    enough = half["completeness"] >= HALF - .005
    return {"half_p50": half["p50"] if enough else few, "half_p95": half["p95"] if enough else few}


def held_out_row(ours, edge, calibrated):
    return {"bits": ours["bits_per_point"], **compared(ours, edge),
            "calibrated_p50": calibrated["whole"]["p50"],
            "calibrated_p95": calibrated["whole"]["p95"], **half_of(ours)}


def held_out(measured, taught):
    """`measured`: {(scan, K): lines}. `taught`: what taught confidence, for the title."""
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
        "continuous-equal-held-out", "Rings held out of real scans: curlidar at 1 bit a return "
        f"beside the raw samples; confidence {taught}", "returns of the rings between every K-th, "
        "along their own beams.", identity, rows,
        [EQUAL,
         "Rings calibrated: the median error of each held-out ring taken off, fitted on the other "
         "half of the same scan. The most trusted half: the returns with the highest confidence. "
         "At 5 mm: from a file of that mean error, for what is lost whatever coding loses.",
         "Profile of other drives: tables of the held-out rings, fitted to the scans at hand of "
         "all drives but that of the scan."], more)


def table(name, title, counts, identity, rows, notes, more=()):
    columns = [*identity, *FIGURES, *more]
    rows = rows_or(rows, columns, "no scan was measured")
    return Table(name, title, counts, columns, rows, notes)


def tables(measured_truth, measured_held_out, taught):
    """Truth always; held-out rings if there are any."""
    found = [truth(measured_truth)]
    return [*found, held_out(measured_held_out, taught)] if measured_held_out else found
