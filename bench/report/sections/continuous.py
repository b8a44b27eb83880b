# SPDX-License-Identifier: BSD-3-Clause
"""Between the samples: simulated scans against exact truth, real ones against rings held out."""
from dataclasses import replace

from frame.cells import Missing
from frame.tables import Column, Figure, Table
from sections import (continuous_borders, continuous_confidence, continuous_equal,
                      continuous_goals, continuous_uses, profiles)
from sections.one_to_one import explain, plain_numbers, short, table_id, taken_as

TITLE = "Continuous reconstruction"
TABLES = ("continuous-goals", "continuous-goals-all", "continuous-equal-truth",
          "continuous-confidence", "continuous-trade", "continuous-borders",
          "continuous-sparse", "continuous-sensor", "continuous-published")
FACTORS, QUICK_FACTORS = (2, 4, 8), (2, 8)
HELD_OUT = (2, 4)  # every K-th ring coded
NO_FILE = Missing("raw samples, no file")
METHODS = {"baseline": "baseline", "paper": "paper", "compact": "curlidar",
           "compact-profile": "curlidar, profile of other drives",
           "compact-fine": "curlidar at 5 mm",
           "compact-fine-profile": "curlidar at 5 mm, profile of other drives",
           "compact-field": "curlidar, its field alone", "linear": "linear in 1/r",
           "edge-aware": "edge-aware in 1/r",
           "edge-aware-calibrated": "edge-aware, rings calibrated"}
ALWAYS = {"paper", "compact", "compact-field", "linear", "edge-aware"}
FIGURES = [
    Column("points", "points"), Column("mean", "mean", "m", 4), Column("p50", "median", "m", 4),
    Column("p95", "p95", "m", 4), Column("rms", "rms", "m", 4),
    Column("within_5cm", "within 5 cm", "share", check="share"),
    Column("completeness", "completeness", "share", check="share"),
    Column("no_surface", "points where there is no surface")]
IDENTITY = [Column("method", "method"), Column("setting", "setting"),
            Column("bits_per_point", "bits a return", digits=2)]
SENSORS = ("hdl64e-kitti", "os1-64-gen1", "vlp16")
SEED = 101  # of scenes that nothing was trained on


def factors_of(context):
    return QUICK_FACTORS if context.quick else FACTORS


def scenes_of(context):
    """Every scene with its own sensor first; in full mode with the others too, in quick mode the
    first one with the sparsest."""
    scenes = [own(scene) for scene in context.scenes]
    more = [(scene, sensor) for scene in scenes for sensor in SENSORS if sensor != scene.sensor]
    if context.quick:
        more = [(scene, SENSORS[-1]) for scene in scenes[:1]]
    return scenes + [replace(scene, sensor=sensor) for scene, sensor in more]


def measure(context):
    from sections import continuous_pictures  # needs numpy
    measure_lines(context)
    continuous_pictures.measure(context, drawn_items(context))


def measure_lines(context):
    for scene in scenes_of(context):
        truth_of(context, scene)
    for scan in context.scans:
        for every in HELD_OUT:
            held_out_of(context, scan, every)
    borders_of(context)
    continuous_uses.measure(context, own_scenes(context))


def own_scenes(context):
    return [own(scene) for scene in context.scenes]


def drawn_items(context):
    """What pictures show: the first real scan whose rings are known and the first scenes."""
    scans = [scan for scan in context.scans if not left_out(held_out_of(context, scan, 2))]
    return scans[:1] + [own(scene) for scene in context.scenes[:1 if context.quick else 3]]


def borders_of(context):
    """Scenes with their own sensors, and the real scans whose rings are known."""
    scans = [scan for scan in context.scans if not left_out(held_out_of(context, scan, 2))]
    return continuous_borders.lines_of(context, own_scenes(context), scans)


def truth_lines(context):
    """{(scene, sensor): lines} of what was measured."""
    return {(scene.name, scene.sensor): truth_of(context, scene) for scene in scenes_of(context)}


def held_out_lines(context):
    """{(scan, K): lines}, also of the scans whose rings could not be held out."""
    return {(scan.name, every): held_out_of(context, scan, every)
            for scan in context.scans for every in HELD_OUT}


def methods_in(measured):
    """The lines of methods that were measured, of the inputs that have any."""
    found = {key: [line for line in lines if "whole" in line] for key, lines in measured.items()}
    return {key: lines for key, lines in found.items() if lines}


def truth_of(context, scene):
    return context.measure("continuous", {"input": scene.id, "part": "truth"}, truth_command(
        context, context.bin / "report_measure", scene))


def truth_command(context, program, scene):
    return [program, "truth", scene.name, scene.sensor, scene.preset, "--factors",
            ",".join(map(str, factors_of(context))), "--seed", str(scene.seed),
            *(["--rays", "10000"] if context.quick else ["--baseline", "1"])]


def held_out_of(context, scan, every):
    command = held_out_command(context.bin / "report_measure", scan, scan.path, every)
    profile = profiles.rings_without(context, scan, every)
    confidence = profiles.confidence_without(context, scan)
    return context.measure("continuous", {"input": scan.name, "part": "held out", "every": every},
                           command + (["--profile", profile] if profile else [])
                           + (["--confidence", confidence] if confidence else []))


def held_out_command(program, scan, path, every):
    return [program, "held-out", path, "--every", str(every), *taken_as(scan)]


def cells_of(line, columns):
    """A method's cells; all the same where it could not be measured."""
    who = {"method": METHODS[line["method"]], "setting": line["setting"]}
    if "skipped" in line:
        why = Missing(line["skipped"])
        return {**dict.fromkeys((column.key for column in columns), why), **who}
    return {**line, **who, "bits_per_point": line.get("bits_per_point", NO_FILE)}


def truth_table(context, scene):
    columns = [*IDENTITY, Column("factor", "R", digits="g"), *FIGURES]
    lines = truth_of(context, scene)
    notes = ["All methods are asked along the same rays, of which a sample evenly spread is "
             "taken. linear, edge-aware: interpolation of the raw samples themselves; edge-aware "
             "takes the nearer sample alone where two ranges differ by more than 20 %.",
             "curlidar: every return at 1 bit a return. Errors along the ray. Completeness: share "
             "of the rays which meet a surface within the limits that get a point. Sensors of "
             "fewer than 64 rings: rows of the paper's methods are the rings, their cliffs that "
             "much higher."]
    if "failure" in lines[0]:
        rows = [failed(lines[0], columns)]
    else:
        rows = [cells_of(line, columns) for line in lines if "method" in line]
        notes.insert(0, said_of(lines[0]))
    return Table(table_id("continuous-truth", scene),
                 f"Between the rows of the simulated scan {scene.name} ({scene.sensor}), against "
                 "the exact scene",
                 "points told within the paper's range limits in the directions of R times the "
                 "rings that lie on no ring, on the sensor's columns, each against the surface "
                 "that its own ray meets.",
                 columns, rows, notes, shown(truth_command(context, "report_measure", scene)))


def held_out_table(context, scan, found):
    columns = [Column("every", "K"), *IDENTITY, *FIGURES]
    rows, notes = [], []
    for every, lines in found.items():
        if "failure" in lines[0]:
            rows.append({**failed(lines[0], columns), "every": every})
            continue
        rows += [{**cells_of(line, columns), "every": every} for line in lines if "method" in line]
        first = lines[0]
        if "method" not in first and "skipped" not in first:
            notes.append(f"K = {every}: {first['returns_coded']:,} returns of "
                         f"{first['rings_coded']} of {first['rings']} rings coded, "
                         f"{first['returns_held_out']:,} held out; {said_of(first)}")
    notes += ["The paper's rows are these rings, since its even rows would miss them, its cliffs "
              "between rows K times as high, and its columns no more than the sensor's. Bits are "
              "of each coded return.",
              "Points where there is no surface: told in the gaps of those rings, where no return "
              "came back between two others; a dropout counts as one too.",
              "Rings calibrated: with the median error of each held-out ring taken off, fitted on "
              "the other half of this scan (sectors of 10 degrees by turns). No method can know "
              "it from the coded rings."]
    return Table(table_id("continuous-held-out", scan), f"Rings held out of {scan.name}",
                 "returns of the rings between every K-th, along their own beams as far as these "
                 "are known, where a method predicts a range within the paper's limits; motion of "
                 "the scan is undone first.",
                 columns, rows, notes,
                 shown(held_out_command("report_measure", scan, scan.name, "K")))


def failed(line, columns):
    return {**dict.fromkeys((column.key for column in columns), Missing(line["failure"])),
            "method": "all", "setting": "all"}


def said_of(line):
    preset = f"preset {line['preset']}, " if "preset" in line else ""
    return f"{preset}limits {line['min_range_m']:.1f} .. {line['max_range_m']:.1f} m."


def shown(command):
    return " ".join(map(str, command))


def left_out(lines):
    """Why no ring of a scan can be held out; empty if one can."""
    return lines[0].get("skipped", "") if "method" not in lines[0] else ""


def published(context):
    """The paper's table beside what its method reaches here, at R = 2, 4, 8."""
    likes = {"Newer College": "newer-college", "INDOOR": "room"}
    rows = []
    for row in context.published_rows("continuous"):
        scene = next((each for each in context.scenes if each.name == likes[row["dataset"]]), None)
        ours = truth_means(context, own(scene), row["method"]) if scene else {}
        why = Missing("not measured in a quick run" if scene
                      else f"the scene {likes[row['dataset']]} is not in this run")
        rows.append({**row, **{f"ours_{factor}": ours.get(factor, why) for factor in FACTORS}})
    columns = [Column("dataset", "dataset"), Column("method", "method"),
               Column("cp_percent", "CP, published", "%")]
    for factor in FACTORS:
        columns += [Column(f"mean_{factor}_m", f"R = {factor}: mean, published", "m"),
                    Column(f"std_{factor}_m", "std, published", "m"),
                    Column(f"ours_{factor}", "mean here", "m", 4)]
    return Table(
        "continuous-published", "The paper's continuous reconstruction, published and here",
        "published: all points of each sequence against its survey map; here: the points between "
        "the rows of one simulated scan like it (newer-college, room), along their rays.",
        columns, rows,
        ["Other data and another measure: only the order of the methods compares. Errors of many "
         "metres as published cannot occur here: ranges that a fit takes out of the scan's limits "
         "are no points, and a patch never has more coefficients than samples."])


def own(scene):
    """The scene as no profile has seen it."""
    return replace(scene, seed=SEED)


def truth_means(context, scene, method):
    """{R: mean} of a method as published.toml names it: 'paper S=2x1'."""
    def is_it(line):
        named = f"{line['method']} {line['setting']}".replace("S ", "S=")
        return method in (named, line["method"])

    return {line["factor"]: line["mean"] for line in truth_of(context, scene)
            if "mean" in line and is_it(line)}


def tables(context):
    found = [truth_table(context, scene) for scene in scenes_of(context)]
    reasons = []
    for scan in context.scans:
        lines = {every: held_out_of(context, scan, every) for every in HELD_OUT}
        usable = {every: each for every, each in lines.items() if not left_out(each)}
        reasons += [{"input": scan.name, "every": every, "why": left_out(each)}
                    for every, each in lines.items() if left_out(each)]
        if usable:
            found.append(held_out_table(context, scan, usable))
    if reasons:
        found.append(Table(
            "continuous-left-out", "Scans whose rings were not held out", "no points.",
            [Column("input", "scan"), Column("every", "K"), Column("why", "why not")], reasons))
    taught = profiles.confidence_taught(context)
    all_lines = truth_lines(context), held_out_lines(context)
    measured = [methods_in(each) for each in all_lines]
    return [*continuous_goals.tables(*all_lines, borders_of(context), taught),
            *continuous_equal.tables(*measured, taught),
            *continuous_confidence.tables(*measured, taught),
            continuous_borders.table(borders_of(context)),
            *continuous_uses.tables(context, own_scenes(context)), *found, published(context)]


def drawn(line):
    return f"{METHODS[line['method']]}, {line['setting']}" if line["method"] == "paper" \
        else METHODS[line["method"]]


NAMES = ("curlidar", "curlidar, profile of other drives", "curlidar, its field alone", "baseline",
         "paper, S 1x1", "paper, S 2x1", "paper, S 2x2", "linear in 1/r", "edge-aware in 1/r",
         "edge-aware, rings calibrated")


def figures(context):
    truth = [(scene.id, line["factor"], drawn(line), line["p50"], line["p95"],
              line["completeness"])
             for scene in scenes_of(context) for line in truth_of(context, scene) if "mean" in line]
    held = [(scan.name, every, drawn(line), line["p50"], line["p95"], line["completeness"])
            for scan in context.scans for every in HELD_OUT
            for line in held_out_of(context, scan, every)
            if "mean" in line and "fine" not in line["method"]]
    found = []
    for name, rows, axis, title, caption in (
            ("continuous-truth", truth, "R, times the rows", "Error between the rows",
             "Points between the rings of simulated scans, against exact truth."),
            ("continuous-held-out", held, "K, every K-th ring coded", "Error at rings held out",
             "Ranges predicted in the directions of returns that were held out.")):
        if rows:
            context.write_data(name, ["input", "factor", "method", "p50", "p95",
                                      "completeness"], rows)
            draw(context, name, axis)
            found.append(Figure(name, title, caption + " Two panels a scan: the p95, and "
                                "the share of the directions that got a point.", "svg",
                                f"data/{name}.csv"))
    from sections import continuous_pictures
    found += continuous_confidence.figures(context, *map(methods_in, (
        truth_lines(context), held_out_lines(context))))
    return found + continuous_pictures.figures(context, drawn_items(context))


def draw(context, name, label):
    from frame import plots
    rows = context.read_data(name)
    inputs = list(dict.fromkeys(row["input"] for row in rows))
    per_row = min(4, len(inputs) + 1)
    places = per_row * -(-(len(inputs) + 1) // per_row)  # the one after the last is the legend's
    figure, axes = plots.panels(2 * places, columns=per_row, width=2.9, height=2.3)
    low, high = min(row["p95"] for row in rows), max(row["p95"] for row in rows)
    for i in range(places):
        above = 2 * per_row * (i // per_row) + i % per_row
        if i >= len(inputs):
            axes[above].set_axis_off()
            axes[above + per_row].set_axis_off()
            continue
        each = inputs[i]
        for key, axis in (("p95", axes[above]), ("completeness", axes[above + per_row])):
            for method in NAMES:
                line = sorted((row["factor"], row[key]) for row in rows
                              if row["input"] == each and row["method"] == method)
                if line:
                    axis.plot(*zip(*line), marker=plots.MARKERS[NAMES.index(method)], label=method,
                              color=plots.colour_of(method, NAMES),
                              linestyle={NAMES[1]: "-.", NAMES[2]: "--"}.get(method, "-"))
            axis.set(xscale="log", xlabel=label)
            axis.set_xticks(FACTORS, [str(factor) for factor in FACTORS])
            axis.minorticks_off()
        axes[above].set(title=short(each), yscale="log", ylabel="p95 (m)",
                        ylim=(low / 1.3, high * 1.3))
        plain_numbers(axes[above].yaxis)
        axes[above + per_row].set(ylim=(0, 1.03), ylabel="completeness")
    last = len(inputs)
    explain(axes[2 * per_row * (last // per_row) + last % per_row], axes[0])
    plots.save(figure, context.figure_path(name, "svg"))


def check(_context, found):
    """A median is no more than the p95, every table has every method, confidences are told in
    ascending bins."""
    yield from continuous_confidence.check(found)
    yield from continuous_borders.check(found)
    yield from continuous_uses.check(found)
    for table in found:
        if not table.id.startswith(("continuous-truth", "continuous-held-out")):
            continue
        methods = {row["method"] for row in table.rows}
        if not methods >= {METHODS[method] for method in ALWAYS}:
            yield f"table {table.id}: only {', '.join(sorted(methods))}"
        for row in table.rows:
            if not isinstance(row["p95"], Missing) and row["p50"] > row["p95"]:
                yield f"table {table.id}: a median above its p95"
