# SPDX-License-Identifier: BSD-3-Clause
"""Confidence that is told against what is observed, and what it trades."""
from frame.check import measured as is_number
from frame.tables import Column, Figure, Table, rows_or
from sections.one_to_one import plain_numbers

SIMULATED, HELD_OUT, PROFILE = "simulated", "held-out rings", "held-out rings, with a profile"
BINS = 10
FEWEST = 200       # lines in a bin; of fewer a share says little
WITHIN = .03       # wanted
LEAST_DRAWN = .05  # completeness; of fewer lines a median says little
SHOWN = (0, .25, .5, .75, .9, .95)  # of the trades in the table


def pooled(measured):
    """Ten bins over all inputs: count, sum of told confidence, count of hits."""
    sums = [[0, 0., 0.] for _ in range(BINS)]
    for lines in measured.values():
        for line in lines:
            for total, each in zip(sums, line.get("confidence", ())):
                total[0] += each["count"]
                total[1] += each["count"] * each["told"]
                total[2] += each["count"] * each["observed"]
    return sums


def of_method(measured, method):
    found = {key: [line for line in lines if line.get("method") == method and "confidence" in line]
             for key, lines in measured.items()}
    return {key: lines for key, lines in found.items() if lines}


def kinds(measured_truth, measured_held_out):
    found = {SIMULATED: of_method(measured_truth, "compact"),
             HELD_OUT: of_method(measured_held_out, "compact"),
             PROFILE: of_method(measured_held_out, "compact-profile")}
    return {kind: measured for kind, measured in found.items() if measured}


def bins(measured_by_kind):
    """A row for every bin that holds a line."""
    rows = []
    for kind, measured in measured_by_kind.items():
        for i, (count, told, hits) in enumerate(pooled(measured)):
            if count:
                told, observed = told / count, hits / count
                off = abs(told - observed)
                rows.append({"kind": kind, "bin": f"{i / BINS:.1f} .. {(i + 1) / BINS:.1f}",
                             "count": count, "told": told, "observed": observed, "off": off,
                             "met": "few" if count < FEWEST else "yes" if off <= WITHIN else "no"})
    return rows


def reliability(measured_by_kind, taught):
    rows = bins(measured_by_kind)
    columns = [Column("kind", "lines"), Column("bin", "told confidence"), Column("count", "lines"),
               Column("told", "mean told", "share", check="share"),
               Column("observed", "within 5 cm", "share", check="share"),
               Column("off", "apart"), Column("met", f"within {WITHIN:g}")]
    return Table(
        "continuous-confidence", "Told confidence against the observed share within 5 cm; of real "
        f"scans {taught}",
        "all lines that are told a range, believed or not: rays between the rings of simulated "
        "scans of seeds that nothing was trained on, and returns and gaps of held-out rings.",
        columns, rows_or(rows, columns, "no scan was measured"),
        ["Pooled over all scans, sensors, factors and K. Where no surface is, none is within 5 cm; "
         "in the gaps of held-out rings, where no return came back, neither.",
         "What tells confidence was fitted to simulated scans of other seeds and to held-out rings "
         "of real scans (docs/density.md).",
         f"few: less than {FEWEST} lines."])


def trades(measured):
    """(name, rows) of every line that has them."""
    for key, lines in measured.items():
        for line in lines:
            if "trades" in line:
                name = f"{key[0]} {key[1]}, R = {line['factor']:g}" if "factor" in line \
                    else f"{key[0]}, K = {key[1]}"
                yield name, line["trades"]


def trade_table(measured_by_kind):
    rows = [{"kind": kind, "input": name, **each}
            for kind, measured in measured_by_kind.items() for name, found in trades(measured)
            for each in found if any(abs(each["min_confidence"] - shown) < 1e-6 for shown in SHOWN)]
    columns = [Column("kind", "lines"), Column("input", "input"),
               Column("min_confidence", "least confidence", digits=2, check="share"),
               Column("completeness", "completeness", "share", check="share"),
               Column("p50", "median", "m", 4), Column("p95", "p95", "m", 3),
               Column("within_5cm", "within 5 cm", "share", check="share")]
    return Table(
        "continuous-trade", "What a least confidence leaves (--min-confidence)",
        "lines that meet a surface and are told one with at least the confidence; the share is of "
        "all lines that meet one.",
        columns, rows_or(rows, columns, "no scan was measured"),
        ["data/continuous-trade.csv has every twentieth, as far as some are left."])


def tables(measured_truth, measured_held_out, taught):
    by_kind = kinds(measured_truth, measured_held_out)
    return [reliability(by_kind, taught), trade_table(by_kind)]


def figures(context, measured_truth, measured_held_out):
    by_kind = kinds(measured_truth, measured_held_out)
    bins = [(kind, told / count, hits / count, count) for kind, measured in by_kind.items()
            for count, told, hits in pooled(measured) if count >= FEWEST]
    trade = [(kind, name, *(each[key] for key in ("min_confidence", "completeness", "p50", "p95")))
             for kind, measured in by_kind.items() for name, found in trades(measured)
             for each in found if each["completeness"] >= LEAST_DRAWN]
    if not bins:
        return []
    context.write_data("continuous-confidence", ["kind", "told", "observed", "count"], bins)
    context.write_data("continuous-trade", ["kind", "input", "min_confidence", "completeness",
                                            "p50", "p95"], trade)
    draw(context)
    return [Figure("continuous-trust", "Confidence",
                   "Left: told confidence against the observed share within 5 cm, in ten bins "
                   f"(those of {FEWEST} lines and more); the band is {WITHIN:g} wide on either "
                   "side. Middle and right: median and p95 against completeness as the least "
                   "confidence rises from 0 to .95, one line an input.", "svg",
                   "data/continuous-confidence.csv")]


def draw(context):
    from frame import plots
    figure, axes = plots.panels(3)
    bins, trade = (context.read_data(f"continuous-{each}") for each in ("confidence", "trade"))
    kinds_drawn = list(dict.fromkeys(row["kind"] for row in bins))
    axes[0].fill_between((0, 1), (-WITHIN, 1 - WITHIN), (WITHIN, 1 + WITHIN), alpha=.15,
                         color=plots.COLOURS[5], linewidth=0)
    for i, kind in enumerate(kinds_drawn):
        points = [(row["told"], row["observed"]) for row in bins if row["kind"] == kind]
        axes[0].plot(*zip(*points), marker=plots.MARKERS[i], color=plots.COLOURS[i], label=kind)
    axes[0].set(xlabel="told confidence", ylabel="share within 5 cm", xlim=(0, 1), ylim=(0, 1))
    axes[0].legend(loc="upper left")
    for name in dict.fromkeys((row["kind"], row["input"]) for row in trade):
        rows = [row for row in trade if (row["kind"], row["input"]) == name]
        colour = plots.COLOURS[kinds_drawn.index(name[0])]
        for axis, key in zip(axes[1:], ("p50", "p95")):
            axis.plot([row["completeness"] for row in rows], [row[key] for row in rows],
                      color=colour, linewidth=.8, alpha=.7)
    for axis, key in zip(axes[1:], ("median", "p95")):
        axis.set(xlabel="completeness", ylabel=f"{key} (m)", yscale="log", xlim=(0, 1))
        plain_numbers(axis.yaxis)
    plots.save(figure, context.figure_path("continuous-trust", "svg"))


def check(found):
    """Bins ascend, and so does what is told in them; a higher least confidence leaves no more."""
    for table in found:
        if table.id == "continuous-confidence":
            for kind, told in columns_of(table, ("kind",), "told"):
                if told != sorted(told):
                    yield f"table {table.id}: the bins of {', '.join(kind)} do not ascend"
        if table.id == "continuous-trade":
            for name, left in columns_of(table, ("kind", "input"), "completeness"):
                if left != sorted(left, reverse=True):
                    yield f"table {table.id}: {name[1]}: completeness rises with the confidence"


def columns_of(table, by, key):
    """(group, numbers of a column) for every group of rows."""
    groups = {}
    for row in table.rows:
        if is_number(row[key]):
            groups.setdefault(tuple(row[each] for each in by), []).append(row[key])
    return groups.items()
