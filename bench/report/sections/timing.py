# SPDX-License-Identifier: BSD-3-Clause
"""The paper's tables of time: its 1:1-tuned codec beside PCL's, and its default codec by stages."""
from frame.cells import Missing, Published
from frame.tables import Column, Table
from sections.one_to_one import METHODS, again, file_of, table_id, taken_as

TITLE = "Time"
TIMED = True  # measured alone
TABLES = ("timing-stages",)
RUNS, QUICK_RUNS = 9, 3
PEER = ("pcl", "low online")  # what the paper compares with
COUNTS = ("the {points:,} points of the gridded cloud; CPU milliseconds of one thread, median of "
          "{runs} runs in one process, nothing read from files or written to them.")


def chosen(context):
    """The scans that are timed: the first KITTI scan, which is what the paper timed, else the first
    simulated one."""
    kitti = [scan for scan in context.scans if scan.is_kitti]
    return (kitti or context.inputs)[:1]


def measure(context):
    for item in chosen(context):
        lines_of(context, item)


def lines_of(context, item):
    runs = QUICK_RUNS if context.quick else RUNS
    return context.measure("timing", {"input": item.name, "runs": runs}, [
        context.bin / "report_measure", "timing", context.cloud(item), "--runs", str(runs),
        *taken_as(item)])


def seconds_as_ms(cell):
    if not isinstance(cell, Published):
        return cell
    return Published(round(1e3 * cell.value, 3), cell.source)


def name_of(line):
    if line["codec"] == "compact":
        return f"curlidar, {line['setting']}"
    return METHODS[line["codec"], line["setting"]][0]


def codec_row(context, line, peer, copy_ms):
    key = METHODS.get((line["codec"], line["setting"]), (None, ""))[1] or ""
    theirs = (context.published_rows("timing_one_to_one", method=key) or [{}])[0]
    row = {"method": name_of(line)}
    for published in ("extraction_s", "reconstruction_s", "total_s"):
        row[f"published_{published}"] = seconds_as_ms(
            theirs.get(published, Missing("not in the paper")))
    measured = ("encode", "encode_grid", "decode", "total", "encode_ratio", "decode_ratio",
                "copy_ratio")
    if "skipped" in line:
        return {**row, **dict.fromkeys(measured, Missing(line["skipped"]))}
    row.update(encode=line["encode_ms"], encode_grid=line["encode_grid_ms"],
               decode=line["decode_ms"], total=line["encode_grid_ms"] + line["decode_ms"],
               copy_ratio=line["decode_ms"] / copy_ms)
    without = Missing(peer.get("skipped", ""))
    for name, of in (("encode_ratio", "encode_grid_ms"), ("decode_ratio", "decode_ms")):
        row[name] = without if "skipped" in peer else line[of] / peer[of]
    return row


def codec_table(context, item, lines):
    codecs = [line for line in lines if line.get("kind") == "codec"]
    peer = next(line for line in codecs if (line["codec"], line["setting"]) == PEER)
    copy_ms = next(line["ms"] for line in lines if line.get("kind") == "copy")
    return Table(
        table_id("timing-one-to-one", item), f"Time of 1:1 reconstruction, {item.name}",
        COUNTS.format(runs=lines[0]["runs"], points=lines[0]["grid_points"]),
        [Column("method", "codec"), Column("encode", "encode", "ms", 1),
         Column("encode_grid", "of it after gridding", "ms", 1),
         Column("decode", "decode", "ms", 1), Column("total", "both, after gridding", "ms", 1),
         Column("encode_ratio", "encode after gridding, to PCL", "times", 2),
         Column("decode_ratio", "decode, to PCL", "times", 2),
         Column("copy_ratio", "decode, to a copy of the cloud", "times", 0),
         Column("published_extraction_s", "extraction, published", "ms"),
         Column("published_reconstruction_s", "reconstruction, published", "ms"),
         Column("published_total_s", "total, published", "ms")],
        [codec_row(context, line, peer, copy_ms) for line in codecs],
        ["CURL is given the raw scan, the others its gridded cloud; detecting the sensor, the "
         "outlier filter and the projection are left out of 'after gridding'. curlidar searches "
         "the step that reaches its error: several trial encodings.",
         f"PCL: its low online profile, in the same run. A copy: memcpy of the gridded cloud as "
         f"float32, {1e3 * copy_ms:.1f} us."],
        shown(item, lines))


def shown(item, lines):
    return again(item, f"timing {file_of(item)} --runs {lines[0]['runs']}")


def stage_row(context, lines, line):
    stages = {each["stage"]: each["ms"] for each in lines
              if each.get("kind") == "stage" and "factor" not in each}
    theirs = (context.published_rows("timing_continuous", r_row=str(line["factor"])) or [{}])[0]
    row = {"factor": line["factor"], "points": line["points"], **stages,
           "reconstruction": line["ms"],
           "total": stages["upsampling"] + stages["extraction"] + stages["decoding"] + line["ms"]}
    for stage in ("upsampling_s", "extraction_s", "reconstruction_s", "total_s"):
        row[f"published_{stage}"] = seconds_as_ms(theirs.get(stage, Missing("not in the paper")))
    return row


def stage_table(context, item, lines):
    stages = [line for line in lines if line.get("kind") == "stage" and "factor" in line]
    columns = [Column("factor", "R"), Column("points", "points")]
    for name in ("upsampling", "extraction", "decoding", "reconstruction", "total"):
        columns.append(Column(name, name, "ms", 1))
        if name != "decoding":
            columns.append(Column(f"published_{name}_s", "published", "ms"))
    return Table(
        "timing-stages", f"Time of the paper's stages, S = 2x2, {item.name}",
        COUNTS.format(runs=lines[0]["runs"], points=lines[0]["grid_points"]),
        columns, [stage_row(context, lines, line) for line in stages],
        ["Upsampling: mesh and rays; extraction: both passes of the fit; decoding: reading the "
         "file's bytes. The outlier filter and the projection are not counted, as in the paper's "
         "table."],
        shown(item, lines))


def tables(context):
    found = []
    for item in chosen(context):
        lines = lines_of(context, item)
        if "failure" in lines[0]:
            found.append(Table(
                "timing-stages", f"Time, {item.name}", "nothing: the measurement failed.",
                [Column("input", "scan"), Column("ms", "time", "ms")],
                [{"input": item.name, "ms": Missing(lines[0]["failure"])}]))
            continue
        found += [codec_table(context, item, lines), stage_table(context, item, lines)]
    return found


def figures(_context):
    return []


def check(_context, found):
    """Every R was timed."""
    for table in found:
        if table.id == "timing-stages" and len(table.rows) != 5:
            yield "timing-stages: not every R is there"
