# SPDX-License-Identifier: BSD-3-Clause
"""What was wanted beside what was measured: rows that say whether a goal is met, and their sum."""
from frame.cells import Missing
from frame.tables import Column, Table, rows_or

COLUMNS = [Column("goal", "goal"), Column("input", "of"),
           Column("measured", "measured", digits=4, check="any"),
           Column("wanted", "wanted", digits=4), Column("met", "met")]


def at_most(goal, of, measured, wanted):
    return {"goal": goal, "input": of, "measured": measured, "wanted": wanted,
            "met": said(measured, wanted)}


def at_least(goal, of, measured, wanted):
    return {**at_most(goal, of, measured, wanted), "met": said(wanted, measured, "short")}


def no_figure(goal, of, why, wanted):
    """A goal that could not be judged is not met."""
    return {"goal": goal, "input": of, "measured": Missing(why), "wanted": wanted,
            "met": "no figure"}


def said(value, limit, way="over"):
    """Whether value <= limit, and by how much not."""
    if value <= limit:
        return "yes"
    percent = 100 * (value / limit - 1) if limit > 0 else 0
    return f"no, {percent:.{0 if percent >= 1 else 1}f} % {way}" if percent else "no"


def is_met(row):
    return row["met"] == "yes"


def summary(name, title, rows):
    """How often every goal is met."""
    found = []
    for goal in dict.fromkeys(row["goal"] for row in rows):
        of_goal = [row for row in rows if row["goal"] == goal]
        missed = [row["input"] for row in of_goal if not is_met(row)]
        found.append({"goal": goal, "judged": len(of_goal), "met": len(of_goal) - len(missed),
                      "all": "no" if missed else "yes",
                      "missed": "; ".join(missed) if missed else "none"})
    columns = [Column("goal", "goal"), Column("judged", "judged"), Column("met", "met"),
               Column("all", "all met"), Column("missed", "missed by")]
    return Table(name, title, "the rows of the table of all goals below.", columns,
                 rows_or(found, columns, "nothing was measured"))


def table(name, title, counts, rows, notes=()):
    return Table(name, title, counts, COLUMNS, rows_or(rows, COLUMNS, "nothing was measured"),
                 list(notes))
