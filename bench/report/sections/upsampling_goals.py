# SPDX-License-Identifier: BSD-3-Clause
"""The goals of upsampling by TULIP's protocol beside what was measured."""
from sections import goals

WITH_PROFILE = (("MAE", "mae_m", 1.1, goals.at_most), ("Chamfer", "chamfer_m2", .15, goals.at_most),
                ("IoU", "iou", .38, goals.at_least), ("F1", "f1", .55, goals.at_least))
LEAST_IOU = .33  # without a profile
WORSE = .1       # that a file at 1 bit may be
# (name, of the raw samples or a fine file, of the file at 1 bit)
KINDS = (("image rows", "rules, tables, trees", "decoded image, 1 bit"),
         ("a user's file", "file, 5 mm, profile", "file, 1 bit, profile"))


def worse(coded, exact, key, judge):
    """Share by which a figure is worse."""
    return coded[key] / exact[key] - 1 if judge is goals.at_most else 1 - coded[key] / exact[key]


def rows_of(figures):
    """`figures`: {method: means over drives}."""
    rows = []
    for kind, exact, coded in KINDS:
        plain = exact.replace(", profile", "").replace(", tables, trees", "")
        if plain in figures:
            rows.append(goals.at_least("without a profile: IoU", kind, figures[plain]["iou"],
                                       LEAST_IOU))
        if exact not in figures:
            continue
        for title, key, wanted, judge in WITH_PROFILE:
            rows.append(judge(f"profile of other drives: {title}", kind, figures[exact][key],
                              wanted))
        for rows_as in ("", ", given rows exact"):
            basis = figures[exact + rows_as] if exact + rows_as in figures else figures[exact]
            for title, key, _, judge in WITH_PROFILE:
                rows.append(goals.at_most(
                    f"file at 1 bit: {title} worse by", kind + (rows_as or ", rows as decoded"),
                    worse(figures[coded + rows_as], basis, key, judge), WORSE))
    return rows


def table(figures):
    return goals.table(
        "upsampling-goals", "16 rings to 64: goals", "means over the drives of this run.",
        rows_of(figures),
        ["Image rows: the protocol's own, from raw samples. A user's file: at 5 mm, where a file "
         "at 1 bit a return is what is compared with it."])
