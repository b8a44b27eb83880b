# SPDX-License-Identifier: BSD-3-Clause
"""The goals of continuous reconstruction beside what was measured, one row a goal and input."""
from frame.cells import Missing
from sections import continuous_borders, continuous_confidence, goals
from sections.continuous_equal import compared, half_of, line_of

P95_SHARE = .9                        # of edge-aware's, at rings held out
FOUR_TIMES = 4
COMPLETE, COMPLETE_P50 = .97, .037    # of KITTI at K = 4
HALF_P50, HALF_P95 = .025, .20        # of the most trusted half there
AT = {"compact": "1 bit", "compact-profile": "1 bit, profile of other drives",
      "compact-fine": "5 mm", "compact-fine-profile": "5 mm, profile of other drives"}
ONE_BIT = ("compact", "compact-profile")


def why_not(lines, method):
    """Why a method has no figures."""
    for line in lines:
        if line.get("method", method) == method and ("skipped" in line or "failure" in line):
            return line.get("skipped", line.get("failure"))
    return "not measured"


def truth(measured):
    rows = []
    for (scene, sensor), lines in measured.items():
        for factor in dict.fromkeys(line["factor"] for line in lines if "factor" in line):
            ours, edge = (line_of(lines, each, factor) for each in ("compact", "edge-aware"))
            of = f"{scene}, {sensor}, {factor:g} x"
            for key, title in (("p50", "median"), ("p95", "p95")):
                goal = f"simulated, 1 bit: {title} no more than edge-aware's"
                if not ours:
                    rows.append(goals.no_figure(goal, of, why_not(lines, "compact"),
                                                edge["whole"][key]))
                    continue
                figures = compared(ours, edge)
                rows.append(goals.at_most(goal, of, figures[f"equal_{key}"],
                                          figures[f"equal_edge_{key}"]))
    return rows


def held_out(measured):
    """Every scan and K beside interpolation of the raw samples."""
    rows = []
    for (scan, every), lines in measured.items():
        edge = line_of(lines, "edge-aware")
        for method in ONE_BIT:
            ours, of = line_of(lines, method), f"{scan}, K = {every}"
            if not ours and method != ONE_BIT[0]:
                continue
            for key, title, part in (("p50", "median", 1), ("p95", "p95", P95_SHARE)):
                goal = f"held-out rings, {AT[method]}: {title} at most {part:g} of edge-aware's"
                if not ours or not edge:
                    wanted = part * edge["whole"][key] if edge else Missing("no rings held out")
                    rows.append(goals.no_figure(goal, of, why_not(lines, method), wanted))
                    continue
                figures = compared(ours, edge)
                rows.append(goals.at_most(goal, of, figures[f"equal_{key}"],
                                          part * figures[f"equal_edge_{key}"]))
    return rows


def four_times(measured):
    """KITTI at K = 4: completeness, the median at it, the most trusted half."""
    rows = []
    for (scan, every), lines in measured.items():
        if every != FOUR_TIMES or not scan.startswith("kitti"):
            continue
        for method, at in AT.items():
            if not (ours := line_of(lines, method)):
                continue
            whole, half, goal = ours["whole"], half_of(ours), f"KITTI held-out 4x, {at}: "
            rows += [goals.at_least(goal + "completeness", scan, whole["completeness"], COMPLETE),
                     goals.at_most(goal + "median", scan, whole["p50"], COMPLETE_P50)]
            for key, title, wanted in (("half_p50", "median", HALF_P50), ("half_p95", "p95",
                                                                         HALF_P95)):
                title = f"{goal}{title} of the most trusted half"
                rows.append(goals.no_figure(title, scan, half[key], wanted)
                            if isinstance(half[key], Missing)
                            else goals.at_most(title, scan, half[key], wanted))
    return rows


def confidence(by_kind):
    return [goals.at_most(f"confidence, {row['kind']}: told beside observed", row["bin"],
                          row["off"], continuous_confidence.WITHIN)
            for row in continuous_confidence.bins(by_kind)
            if row["count"] >= continuous_confidence.FEWEST]


def borders(measured):
    mean, untrue = ("borders of patches: mean jump of one surface, in D",
                    "borders of patches: untrue jumps over 2 D")
    rows = []
    for name, lines in measured.items():
        line = next((each for each in lines if each.get("method") == "compact"), None)
        if line:
            found = line["borders"]
            rows += [goals.at_most(mean, name, found["mean_of_step"],
                                   continuous_borders.MEAN_WANTED),
                     goals.at_most(untrue, name, found["untrue"], 0)]
        else:
            rows += [goals.no_figure(goal, name, why_not(lines, "compact"), wanted)
                     for goal, wanted in ((mean, continuous_borders.MEAN_WANTED), (untrue, 0))]
    return rows


def rows_of(measured_truth, measured_held_out, measured_borders):
    """`measured_..`: lines of every input, also those that say why there are no figures."""
    by_kind = continuous_confidence.kinds(measured_truth, measured_held_out)
    return [*truth(measured_truth), *held_out(measured_held_out), *four_times(measured_held_out),
            *confidence(by_kind), *borders(measured_borders)]


def tables(measured_truth, measured_held_out, measured_borders, taught):
    rows = rows_of(measured_truth, measured_held_out, measured_borders)
    return [goals.summary("continuous-goals", "Goals of continuous reconstruction", rows),
            goals.table(
                "continuous-goals-all", "All goals, one by one",
                "as the tables below that the figures come from.", rows,
                ["simulated, held-out rings: at equal completeness with edge-aware interpolation "
                 "of the raw samples, both methods ranked by what they trust; the figure wanted is "
                 "that of the interpolation, or its part.",
                 f"Held-out rings: confidence, which ranks, {taught}. KITTI held-out 4x: every "
                 "fourth ring coded, all that is told counts; the most trusted half is one half of "
                 "the returns. A confidence: bins that hold enough lines.",
                 "no figure: the scan or the setting could not be measured, and why."])]
