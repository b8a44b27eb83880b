# SPDX-License-Identifier: BSD-3-Clause
"""Patches seen by their borders: jumps between neighbouring cells, of one surface and untrue."""
from frame.cells import Missing
from frame.tables import Column, Table, rows_or

METHODS = {"compact": "curlidar", "compact-field": "curlidar, its field alone",
           "paper": "paper, default"}
MEAN_WANTED = .25  # of the step
PLACES = {"borders": "on borders", "insides": "within blocks"}
COLUMNS = [
    Column("input", "input"), Column("method", "method"), Column("step_m", "step D", "m", 3),
    Column("place", "between cells"), Column("pairs", "pairs"),
    Column("nothing", "of these with a gap"), Column("one_surface", "of one surface"),
    Column("mean_m", "their mean jump", "m", 4), Column("mean_of_step", "in D", digits=2),
    Column("p95_m", "p95", "m", 3), Column("no_jump", "without a true jump"),
    Column("untrue", "of these jumps over 2 D"),
    Column("untrue_share", "share", digits=4, check="share"), Column("met", "as wanted")]


def truth_command(program, scene):
    return [program, "borders-truth", scene.name, scene.sensor, scene.preset, "--seed",
            str(scene.seed)]


def lines_of(context, scenes, scans):
    """{name: lines of methods}; scenes first."""
    program, found = context.bin / "report_measure", {}
    for scene in scenes:
        found[scene.id] = context.measure(
            "continuous", {"input": scene.id, "part": "borders"}, truth_command(program, scene))
    for scan in scans:
        found[scan.name] = context.measure(
            "continuous", {"input": scan.name, "part": "borders"},
            [program, "borders", scan.path])
    return found


def table(measured):
    rows = []
    for name, lines in measured.items():
        for line in lines:
            if why := line.get("failure", line.get("skipped")):
                rows.append({**dict.fromkeys((column.key for column in COLUMNS), Missing(why)),
                             "input": name})
                continue
            for place, title in PLACES.items():
                row = {"input": name, "method": METHODS[line["method"]], "place": title,
                       "step_m": line["step_m"], **line[place]}
                rows.append({**row, "met": verdict(row)})
    return Table(
        "continuous-borders", "Jumps between neighbouring cells, where patches meet and within "
        "them", "pairs of neighbouring cells that both hold a return, up to 10,000 of each kind, "
        "evenly taken; from the return of one to that of the other the field is asked along 17 lines "
        "of sight, from where the beams start.", COLUMNS,
        rows_or(rows, COLUMNS, "no scan was measured"),
        ["A jump is what the largest step on the way is more than the others, in inverse range: a "
         "plane has none. curlidar at 1 bit a return, D being the step of its field; the paper's "
         "jumps are told in the same D. Blocks: the leaves of the one, the patches of the other.",
         "Of one surface: simulated, the exact scene jumps by no more than D / 4 on the way; "
         "real, the original returns of the two cells and those between which the way passes are no "
         "more than 10 % + .3 m apart. Without a true jump: these, and simulated scenes jump by no "
         "more than D.",
         f"Wanted: a mean jump of at most {MEAN_WANTED:g} D, and none over 2 D that is not true."])


def verdict(row):
    wrong = []
    if row["mean_of_step"] > MEAN_WANTED:
        wrong.append(f"mean {row['mean_of_step']:.2f} D")
    if row["untrue"] > 0:
        wrong.append(f"{row['untrue']} untrue")
    return "no: " + ", ".join(wrong) if wrong else "yes"


def check(found):
    """No more pairs are counted than there are, and every method is there."""
    for each in found:
        if each.id != "continuous-borders":
            continue
        rows = [row for row in each.rows if not isinstance(row["pairs"], Missing)]
        for row in rows:
            if row["one_surface"] + row["nothing"] > row["pairs"] or row["untrue"] > row["no_jump"]:
                yield f"table {each.id}: {row['input']}, {row['method']}: parts beyond the whole"
        for name in dict.fromkeys(row["input"] for row in rows):
            methods = {row["method"] for row in rows if row["input"] == name}
            if methods != set(METHODS.values()):
                yield f"table {each.id}: {name}: only {', '.join(sorted(methods))}"
