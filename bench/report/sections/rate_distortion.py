# SPDX-License-Identifier: BSD-3-Clause
"""Bits against error: ours and the peer codecs, on the gridded cloud and on raw scans."""
import math
import shutil

from common import curves
from frame.cells import Missing, Published
from frame.tables import Column, Figure, Table
from sections.rate_distortion_curves import (
    IMAGES, NOT_REACHED, OURS, QUICK_SETTINGS, TITLES, TOOLS, errors_of, grid_curves,
    inputs_of, key_of, length, lines_of, raw_curves, title_of)

TITLE = "Bits against error, beside the peer codecs"
TIMED = True  # measured alone
TABLES = ("rate-distortion",)
TIMES_AT_M, BACK_AT_M = .01, (.005, .05)


def measure(context):
    for part in ("grid", "raw"):
        for item in inputs_of(context, part):
            lines_of(context, item, part)


def style_of(codec):
    """(name that colours it, line style): codecs look the same in all plots."""
    base, _, columns = codec.rpartition("-")
    if columns.isdigit() and base in IMAGES:
        return base, {"1024": ":", "4096": "--"}.get(columns, "-")
    return codec, "--" if codec.endswith("effort 9") else "-"


def rank(codec):
    """Its place in legends: ours first, the variants of a codec side by side."""
    names = list(TITLES)
    base = style_of(codec)[0]
    return names.index(base) if base in names else len(names), codec


# Tables -----------------------------------------------------------------------------------------

def columns_of(context, unit, kind):
    columns = [Column("codec", "codec")]
    columns += [Column("error_kind", "error is of")] if kind else []
    columns += [Column(key_of(e), length(e), unit, 2) for e in errors_of(context)]
    columns += [Column("back_" + key_of(e), f"points back near {length(e)}", "", 0)
                for e in BACK_AT_M]
    return columns + [Column("encode_ms", f"encode near {length(TIMES_AT_M)}", "CPU ms", 1),
                      Column("decode_ms", "decode", "CPU ms", 1)]


def row_of(context, found, codec):
    return {"codec": title_of(codec),
            "error_kind": next((p.get("error_kind", "nearest").replace("_", " ")
                                for p in found.points[codec]), found.reasons.get(codec)),
            **{key_of(e): found.bits_at(codec, e) for e in errors_of(context)},
            **{"back_" + key_of(e): found.near(codec, e, "back") for e in BACK_AT_M},
            **{key: found.near(codec, TIMES_AT_M, key) for key in ("encode_ms", "decode_ms")}}


def stored_rows(context, item):
    """Rows of what is not on this machine: as stored for the scan they were measured on, and
    elsewhere why there is none."""
    absent = {tool: name for tool, name in TOOLS.items() if not shutil.which(tool)}
    keys = [column.key for column in columns_of(context, "", False)]
    stored = context.published_rows("rate_distortion", scan=item.name)
    rows = [{**dict.fromkeys(keys, Missing("not stored")),
             **{key_of(e): NOT_REACHED for e in errors_of(context)}, **row,
             "codec": f"{row['codec']} (stored)"}
            for row in stored if row["tool"] in ("", *absent)]
    if not stored:
        rows += [{**dict.fromkeys(keys, Missing(f"{tool} is not on the PATH")), "codec": name}
                 for tool, name in absent.items()]
    return rows


RAW_NOTES = [
    "error: the larger of the two directed means of nearest-neighbour distances, raw returns to "
    "decoded points and back; bits: every byte of the stream over the raw returns, interpolated "
    "linearly in the logarithm of the error between measured settings, never beyond them",
    "range images lose the returns that share a cell, and PCL keeps one point of a voxel: see "
    "points back. Points left out flatter the error",
    "rows of range images are cones fitted to the true rings, given to the decoder for nothing",
    "times of the peers are of their library's calls, ours and those of other programs of the "
    "whole command with its files, all on one thread; near: at the setting whose error is nearest"]
GRID_NOTES = [
    "error: of each cell's own range where the decoder keeps cells (range images, ours), of each "
    "own point where it keeps their order, otherwise the larger of the two directed means of "
    "nearest-neighbour distances, which flatters who drops points",
    "range images and ours get the grid's directions; rates count every byte of the stream"]


def table_id(part, item, number=0):
    return f"rate-distortion-{part}-{item.id.lower()}" + (f"-{number + 1}" if number else "")


def raw_table(context, item):
    found = raw_curves(context, item)
    rows = [row_of(context, found, codec) for codec in sorted(found.points, key=rank)]
    return Table(table_id("raw", item), f"Bits at matched error, raw scan: {item.name}",
                 f"all {found.total:,} returns of the scan as its file is ({item.sensor}).",
                 columns_of(context, "bit/return", False), rows + stored_rows(context, item),
                 RAW_NOTES)


def grid_tables(context, item):
    for number, (heading, found) in enumerate(grid_curves(context, item)):
        rows = [row_of(context, found, codec) for codec in sorted(found.points, key=rank)]
        yield Table(table_id("grid", item, number),
                    f"Bits at matched error, gridded: {item.name}",
                    f"the {found.total:,} occupied cells of the true rings x 1024 columns "
                    f"({heading}).", columns_of(context, "bit/cell", True), rows, GRID_NOTES)


def value_of(cell):
    """A number of a cell, measured or stored; infinite where there is none."""
    value = cell.value if isinstance(cell, Published) else cell
    return value if isinstance(value, (int, float)) else math.inf


def best_peer(context, item, found, error_m):
    """(bits, name) of the peer that needs the fewest bits, stored ones included."""
    peers = [(found.bits_at(codec, error_m), title_of(codec)) for codec in found.points
             if not codec.startswith(OURS)]
    peers += [(row[key_of(error_m)], row["codec"]) for row in stored_rows(context, item)]
    best = min(peers, default=(NOT_REACHED, ""), key=lambda peer: value_of(peer[0]))
    return best if value_of(best[0]) < math.inf else (NOT_REACHED, NOT_REACHED)


def summary_rows(context):
    for item in inputs_of(context, "raw"):
        found = raw_curves(context, item)
        for error_m in errors_of(context):
            best, peer = best_peer(context, item, found, error_m)
            row = {"input": item.name, "error": length(error_m), "best": best, "peer": peer,
                   "ours": found.bits_at(OURS, error_m),
                   "effort_9": found.bits_at(f"{OURS}, effort 9", error_m)}
            shares = [100 * value_of(row[key]) / value_of(best) for key in ("ours", "effort_9")]
            row["share"], row["share_9"] = (
                share if math.isfinite(share) and share > 0 else NOT_REACHED for share in shares)
            yield row


def tables(context):
    if not context.inputs:
        return []
    columns = [Column("input", "input"), Column("error", "mean error"),
               Column("ours", "curlidar", "bit/return", 2),
               Column("effort_9", "effort 9", "bit/return", 2),
               Column("best", "best peer", "bit/return", 2), Column("peer", "which"),
               Column("share", "curlidar / peer", "%", 0),
               Column("share_9", "effort 9 / peer", "%", 0)]
    if context.quick:
        columns = [column for column in columns if not column.key.endswith("9")]
    summary = Table("rate-distortion", "Raw scans, every return: ours and the best peer",
                    "all returns of each scan as its file is.", columns,
                    list(summary_rows(context)), RAW_NOTES[:2])
    if context.quick:
        summary.notes.append(
            f"quick: at most {QUICK_SETTINGS} settings of each peer; the fewer they are, the more "
            "bits the line between two of them shows")
    return [summary, *(raw_table(context, item) for item in inputs_of(context, "raw")),
            *(table for item in inputs_of(context, "grid") for table in grid_tables(context, item))]


# Figures ----------------------------------------------------------------------------------------

CURVE_COLUMNS = ("input", "codec", "setting", "error_m", "bits", "p95_m", "back", "encode_ms",
                 "decode_ms")


def stored_points(context, item):
    """The points of stored curves, of the scan they were measured on."""
    for row in stored_rows(context, item):
        for error_m in errors_of(context):
            cell = row[key_of(error_m)]
            if "curve" in row and isinstance(cell, Published):
                yield {**dict.fromkeys(CURVE_COLUMNS, ""), "input": item.name,
                       "codec": row["curve"], "setting": "stored", "error_m": error_m,
                       "bits": float(cell.value)}


def write_curves(context):
    """data/rate-distortion-raw.csv and -grid.csv."""
    for part in ("raw", "grid"):
        rows = []
        for item in inputs_of(context, part):
            found = [("", raw_curves(context, item))] if part == "raw" \
                else grid_curves(context, item)
            for heading, each in found:
                name = f"{item.name}, {heading}" if heading else item.name
                rows += [{**dict.fromkeys(CURVE_COLUMNS, ""), "input": name, "codec": codec, **{
                    key: value for key, value in p.items()
                    if key in CURVE_COLUMNS and value is not None}}
                    for codec, points in each.points.items() for p in points]
            rows += stored_points(context, item) if part == "raw" else []
        context.write_data(f"rate-distortion-{part}", CURVE_COLUMNS, rows)


def draw_panel(axes, title, rows):
    from frame import plots
    for codec in sorted({row["codec"] for row in rows}, key=rank):
        name, line = style_of(codec)
        points = curves.frontier([row for row in rows if row["codec"] == codec], "bits")
        ours = codec.startswith(OURS)
        axes.plot([1e3 * p["error_m"] for p in points], [p["bits"] for p in points], line,
                  alpha=.6 if points[0]["setting"] == "stored" else 1,
                  color=plots.colour_of(name, list(TITLES)), marker="o", markersize=3,
                  linewidth=2.2 if ours else 1.2, zorder=3 if ours else 2,
                  label=title_of(codec) + (" †" if points[0]["setting"] == "stored" else ""))
    axes.set(title=title, xscale="log", yscale="log", xlim=(.8, 125))
    axes.set_xticks([1, 2, 5, 10, 20, 50, 100], ["1 mm", "2", "5", "1 cm", "2", "5", "10 cm"])
    axes.set_xticks([], minor=True)
    axes.set_yticks([.25, .5, 1, 2, 4, 8, 16], ["¼", "½", "1", "2", "4", "8", "16"])
    axes.set_yticks([], minor=True)


def draw(context, part, unit):
    from frame import plots
    name = f"rate-distortion-{part}"
    rows = context.read_data(name)
    inputs = list(dict.fromkeys(row["input"] for row in rows))
    figure, panels = plots.panels(len(inputs) + 1)  # the last one is the legend's
    for axes, each in zip(panels, inputs):
        draw_panel(axes, each, [row for row in rows if row["input"] == each])
        axes.set_ylabel(unit)
    handles = {label: handle for axes in panels
               for handle, label in zip(*axes.get_legend_handles_labels())}
    panels[-1].set_axis_off()
    panels[-1].legend(handles.values(), handles.keys(), loc="center left")
    plots.save(figure, context.figure_path(name, "svg"))
    return name


def figures(context):
    if not context.inputs:
        return []
    write_curves(context)
    return [Figure(draw(context, "raw", "bits a return"), "Raw scans, every return",
                   "Mean nearest-neighbour error (the larger direction) across, bits a return "
                   "upwards; points that another setting beats are left out; †: stored, not "
                   "measured by this run", "svg",
                   "data/rate-distortion-raw.csv"),
            Figure(draw(context, "grid", "bits a cell"), "The gridded cloud",
                   "Mean error across, bits an occupied cell upwards", "svg",
                   "data/rate-distortion-grid.csv")]


# --check ----------------------------------------------------------------------------------------

def check(context, _tables):
    """Our codec needs fewer bits the more error it may make, drops no return, and keeps to the
    error that was asked for."""
    for item in inputs_of(context, "raw"):
        found = raw_curves(context, item)
        for codec, points in found.points.items():
            if not codec.startswith(OURS):
                continue
            rising = sorted(points, key=lambda p: p["error_m"])
            for a, b in zip(rising, rising[1:]):
                if b["bits"] > a["bits"]:
                    yield f"{item.name}: {codec} needs more bits at {b['setting']} than at " \
                          f"{a['setting']}"
            for p in points:
                if p["back"] != found.total:
                    yield f"{item.name}: {codec} gives back {p['back']} of {found.total} returns"
                if p["error_m"] > float(p["setting"].split()[-1]):
                    yield f"{item.name}: {codec} at {p['setting']} is off by {p['error_m']:g} m"
