# SPDX-License-Identifier: BSD-3-Clause
"""The paper's first comparison: one gridded cloud by every codec, errors in both directions."""
import re

from frame.cells import Missing
from frame.scans import Scene
from frame.tables import Column, Figure, Table

TITLE = "1:1 reconstruction"
TABLES = ("one-to-one",)

# Codec and setting as report_measure names them, how tables do, and the key of published figures.
METHODS = {
    ("paper-global", "degree 64"): ("baseline, degree 64", "baseline"),
    ("pcl", "low online"): ("PCL low online", "pcl-low-online"),
    ("pcl", "mid online"): ("PCL mid online", "pcl-med-online"),
    ("pcl", "high online"): ("PCL high online", "pcl-high-online"),
    ("pcl", "low offline"): ("PCL low offline", "pcl-low-offline"),
    ("pcl", "mid offline"): ("PCL mid offline", "pcl-med-offline"),
    ("pcl", "high offline"): ("PCL high offline", "pcl-high-offline"),
    ("paper", "S 2x2, P_r 4"): ("paper, default", "paper"),
    ("paper-1to1", "S 1x1, P_r 4"): ("paper, tuned for 1:1", "paper-1to1"),
    ("compact", "5 mm"): ("curlidar, 5 mm", None),
    ("compact", "2 cm"): ("curlidar, 2 cm", None),
    ("compact", "5 cm"): ("curlidar, 5 cm", None),
}
DRAWN = ("baseline, degree 64", "PCL low online", "PCL mid offline", "paper, default",
         "paper, tuned for 1:1", "curlidar, 5 mm", "curlidar, 2 cm", "curlidar, 5 cm")
DIRECTIONS = ("to_grid", "from_grid", "to_raw", "from_raw")
NO_CP = Missing("not defined for it")
COUNTS = ("the paper's gridded cloud (as many rows as rings, 1024 columns, its outlier filter and "
          "its range limits), which every codec is given; raw: the raw returns within these "
          "limits.")
# Measured inputs that the means over each dataset of the paper are of.
GROUPS = {
    "KITTI": lambda item: not isinstance(item, Scene) and item.is_kitti,
    "Newer College": lambda item: isinstance(item, Scene) and item.name == "newer-college",
    "INDOOR": lambda item: isinstance(item, Scene) and item.name in ("room", "corridor"),
}


def taken_as(item):
    """Options that say how to take an input: a simulated one is known, a real one is looked at."""
    return ["--sensor", item.sensor, "--preset", item.preset] if isinstance(item, Scene) else []


def file_of(item):
    """Its cloud in a command that a person types."""
    return f"{item.name}.pcd" if isinstance(item, Scene) else item.name


def again(item, measurement):
    """What a person types to measure it again."""
    command = " ".join(["report_measure", measurement, *taken_as(item)])
    if not isinstance(item, Scene):
        return command
    return (f"curlidar simulate --scene {item.name} --sensor {item.sensor} --seed {item.seed} "
            f"-o {file_of(item)} && {command}")


def measure(context):
    for item in context.inputs:
        lines_of(context, item)


def lines_of(context, item):
    return context.measure("one_to_one", {"input": item.name}, [
        context.bin / "report_measure", "one-to-one", context.cloud(item), *taken_as(item)])


def measured(context, item):
    """Why there is nothing, or the line of each method by its name in tables."""
    lines = lines_of(context, item)
    if why := lines[0].get("failure") or "codec" not in lines[0] and lines[0].get("skipped"):
        return Missing(why)
    return {METHODS[line["codec"], line["setting"]][0]: line for line in lines if "codec" in line}


FIGURES = [
    Column("points_out", "points back"), Column("bytes", "bytes"),
    Column("bits_per_point", "bits a point", digits=2),
    Column("percent_of_float32", "of float32 xyz", "%", 2),
    Column("cp_paper_percent", "CP as the paper defines it", "%", 2),
    *(Column(f"{direction}_{kind}", f"{title}, {kind}", "m", 4)
      for direction, title in (("to_grid", "to grid"), ("from_grid", "from grid"))
      for kind in ("mean", "std", "p95")),
    *(Column(f"{direction}_{kind}", f"{title}, {kind}", "m", 4)
      for direction, title in (("to_raw", "to raw"), ("from_raw", "from raw"))
      for kind in ("mean", "p95"))]


def cells_of(line):
    if "skipped" in line:
        return dict.fromkeys((column.key for column in FIGURES), Missing(line["skipped"]))
    row = {key: line[key] for key in ("points_out", "bytes", "bits_per_point",
                                      "percent_of_float32")}
    row["cp_paper_percent"] = line.get("cp_paper_percent", NO_CP)
    for direction in DIRECTIONS:
        row.update({f"{direction}_{kind}": value for kind, value in line[direction].items()})
    return row


def table_of(context, item):
    found = measured(context, item)
    if isinstance(found, Missing):
        rows = [{"method": "all", **dict.fromkeys((c.key for c in FIGURES), found)}]
        notes = []
    else:
        rows = [{"method": method, **cells_of(line)} for method, line in found.items()]
        scan = lines_of(context, item)[0]
        notes = [f"Preset {scan['preset']}: {scan['grid_points']:,} cells of {scan['returns']:,} "
                 f"returns, of which {scan['returns_in_range']:,} lie within "
                 f"{scan['min_range_m']:.1f} .. {scan['max_range_m']:.1f} m."]
    notes.append("Bytes are those of the whole file. CP counts, for CURL, 8 bytes a coefficient "
                 "and 4 bits a cell against 24 bytes a point (doubles); for PCL, its stream "
                 "against 12 (float32).")
    return Table(table_id("one-to-one", item), f"1:1 reconstruction of {item.name}", COUNTS,
                 [Column("method", "codec"), *FIGURES], rows, notes,
                 again(item, f"one-to-one {file_of(item)}"))


def table_id(prefix, item):
    return re.sub(r"[^a-z0-9._-]", "-", f"{prefix}-{item.id}".lower())


MEANS = {"mean_m": lambda line: line["to_grid"]["mean"],
         "std_m": lambda line: line["to_grid"]["std"],
         "from_mean_m": lambda line: line["from_grid"]["mean"],
         "bits_per_point": lambda line: line["bits_per_point"],
         "percent_of_float32": lambda line: line["percent_of_float32"],
         "cp_percent": lambda line: line.get("cp_paper_percent")}


def mean_row(lines):
    """Means over inputs; Missing where there is none."""
    good = [line for line in lines if "skipped" not in line]
    if not good:
        why = lines[0]["skipped"] if lines else "no such input in this run"
        return {"inputs": 0, **dict.fromkeys(MEANS, Missing(why))}
    row = {"inputs": len(good)}
    for key, of in MEANS.items():
        values = [of(line) for line in good]
        row[key] = NO_CP if None in values else sum(values) / len(values)
    return row


def means(context):
    """Beside what the paper published of each of its datasets."""
    rows = []
    for dataset, belongs in GROUPS.items():
        found = [each for item in context.inputs if belongs(item)
                 if not isinstance(each := measured(context, item), Missing)]
        for method, key in METHODS.values():
            published = context.published_rows("one_to_one", dataset=dataset, method=key or "")
            theirs = published[0] if published else {}
            rows.append({
                "dataset": dataset, "method": method,
                **mean_row([each[method] for each in found if method in each]),
                **{f"published_{name}": theirs.get(name, Missing("not in the paper"))
                   for name in ("mean_m", "std_m", "cp_percent")}})
    return Table(
        "one-to-one", "1:1 reconstruction, means beside those of the paper",
        COUNTS + " Errors: from each point back to its nearest in the grid, as the paper has them, "
        "and the mean of the other direction.",
        [Column("dataset", "dataset"), Column("method", "codec"), Column("inputs", "scans"),
         Column("mean_m", "mean", "m", 4), Column("std_m", "std", "m", 4),
         Column("cp_percent", "CP", "%", 2),
         Column("published_mean_m", "mean, published", "m"),
         Column("published_std_m", "std, published", "m"),
         Column("published_cp_percent", "CP, published", "%"),
         Column("from_mean_m", "other direction, mean", "m", 4),
         Column("bits_per_point", "bits a point", digits=2),
         Column("percent_of_float32", "of float32 xyz", "%", 2)],
        rows,
        ["KITTI: the real KITTI scans of this run. Newer College and INDOOR: simulated scenes like "
         "them (newer-college; room, corridor) with the same sensor and settings, not the paper's "
         "data.",
         "The paper's std is over all points of all scans, ours the mean over scans."])


def tables(context):
    return [means(context), *(table_of(context, item) for item in context.inputs)]


def curves(context):
    """Rows of the CSV of errors: the percentiles of every codec, input and direction."""
    for item in context.inputs:
        found = measured(context, item)
        if isinstance(found, Missing):
            continue
        for method, line in found.items():
            if "skipped" in line:
                continue
            for direction in DIRECTIONS:
                for percent, error in enumerate(line[f"{direction}_percentiles"]):
                    yield item.name, method, direction, percent, error


def figures(context):
    rows = list(curves(context))
    if not rows:
        return []
    context.write_data("one-to-one-errors", ["input", "method", "direction", "percent", "error_m"],
                       rows)
    draw_errors(context, "to_grid", "one-to-one-errors-to-grid")
    draw_errors(context, "from_grid", "one-to-one-errors-from-grid")
    sizes = [{"input": item.name, "method": method, "of": of, "percent": line[key]}
             for item in context.inputs if not isinstance(found := measured(context, item), Missing)
             for method, line in found.items()
             for of, key in (("CP of the paper", "cp_paper_percent"),
                             ("float32 xyz", "percent_of_float32")) if key in line]
    context.write_data("one-to-one-sizes", ["input", "method", "of", "percent"], sizes)
    draw_sizes(context)
    return [
        Figure("one-to-one-errors-to-grid", "Errors of the points back",
               "Share of the reconstructed points that lie nearer to the gridded cloud than the "
               "error on the axis; one panel a scan.", "svg", "data/one-to-one-errors.csv"),
        Figure("one-to-one-errors-from-grid", "Errors of what was lost",
               "The other direction: share of the gridded cloud's points with a reconstructed one "
               "nearer than that. Codecs that drop points show it here.", "svg",
               "data/one-to-one-errors.csv"),
        Figure("one-to-one-sizes", "Compression percentage over the scans",
               "Share of the scans that take at most that percentage: left as the paper counts it, "
               "right every byte of the file against float32 coordinates.", "svg",
               "data/one-to-one-sizes.csv")]


def draw_errors(context, direction, name):
    from frame import plots
    rows = [row for row in context.read_data("one-to-one-errors") if row["direction"] == direction]
    inputs = list(dict.fromkeys(row["input"] for row in rows))
    figure, axes = plots.panels(len(inputs) + 1)  # the last one is the legend's
    for axis, each in zip(axes, inputs):
        for method in DRAWN:
            curve = [(row["error_m"], row["percent"]) for row in rows
                     if row["input"] == each and row["method"] == method]
            if curve:
                axis.plot(*zip(*curve), color=colour(method), label=method,
                          linestyle=style(method))
        axis.set(title=short(each), xscale="log", xlim=(5e-4, 1), ylim=(0, 100),
                 xlabel="error (m)", ylabel="points (%)")
        plain_numbers(axis.xaxis, (1,))
    explain(axes[-1], axes[0])
    plots.save(figure, context.figure_path(name, "svg"))


def draw_sizes(context):
    from frame import plots
    rows = context.read_data("one-to-one-sizes")
    figure, axes = plots.panels(3)
    for axis, of in zip(axes, ("CP of the paper", "float32 xyz")):
        for method in DRAWN:
            values = sorted(row["percent"] for row in rows
                            if row["of"] == of and row["method"] == method)
            if values:
                shares = [100 * i / len(values) for i in range(len(values) + 1)]
                axis.step([values[0], *values], shares, where="post", color=colour(method),
                          label=method, linestyle=style(method))
        axis.set(title=of, xscale="log", ylim=(0, 102), xlabel="size (%)", ylabel="scans (%)")
        plain_numbers(axis.xaxis)
    explain(axes[-1], axes[1])
    plots.save(figure, context.figure_path("one-to-one-sizes", "svg"))


def explain(axis, drawn):
    """A panel that holds the legend of another one."""
    axis.set_axis_off()
    axis.legend(*drawn.get_legend_handles_labels(), loc="center left")


def plain_numbers(axis, steps=(1, 2, 5)):
    """Ticks of a logarithmic axis as 0.02, not as powers."""
    from matplotlib import ticker
    axis.set_major_locator(ticker.LogLocator(subs=steps))
    axis.set_major_formatter(ticker.FormatStrFormatter("%g"))
    axis.set_minor_formatter(ticker.NullFormatter())


def short(name):
    """A scan's name as the title of a panel: its dataset, and below the end of its file's name."""
    dataset, _, rest = name.rpartition(".")[0].partition("/") if "/" in name else (name, "", "")
    return f"{dataset}\n{rest if len(rest) <= 30 else '..' + rest[-28:]}" if rest else dataset


def colour(method):
    from frame import plots
    return plots.colour_of(method, DRAWN)


def style(method):
    """Ours share a colour."""
    return {"curlidar, 5 mm": ":", "curlidar, 2 cm": "--"}.get(method, "-")


def check(_context, found):
    """Of our codec a looser error needs no more bits, and every method is there."""
    for table in found[1:]:
        if table.rows[0]["method"] == "all":  # of a scan that the paper's pipeline cannot take
            continue
        bits = {row["method"]: row["bits_per_point"] for row in table.rows}
        ours = [bits.get(f"curlidar, {error}") for error in ("5 cm", "2 cm", "5 mm")]
        if any(isinstance(each, Missing) or each is None for each in ours):
            yield f"table {table.id}: our codec is not there at every error"
        elif ours != sorted(ours):
            yield f"table {table.id}: bits of our codec do not grow as its error shrinks: {ours}"
        if len(table.rows) != len(METHODS):
            yield f"table {table.id}: {len(table.rows)} codecs, not {len(METHODS)}"
