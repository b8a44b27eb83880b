# SPDX-License-Identifier: BSD-3-Clause
"""What --check asks of a report. Every function returns texts that say what is wrong."""
import csv
import re
import xml.etree.ElementTree



def measured(cell):
    return isinstance(cell, (int, float)) and not isinstance(cell, bool)


def cells_of(table):
    """Numbers with signs and shares as their columns say."""
    for i, row in enumerate(table.rows, 1):
        for column in table.columns:
            value = row[column.key]
            if not measured(value) or column.check == "any":
                continue
            if value < 0 or column.check == "share" and value > 1:
                yield f"table {table.id}, row {i}: {column.key} is {value:g}"


def falls(table, by, value, group):
    """Within the rows of a group `value` never rises (by more than 0.1 %) while `by` rises: a rate
    against an error, for example. `group`: keys. Cells that are not numbers of this run are passed
    over."""
    groups = {}
    for row in table.rows:
        if measured(row[by]) and measured(row[value]):
            groups.setdefault(tuple(str(row[key]) for key in group), []).append(
                (row[by], row[value]))
    for name, pairs in groups.items():
        pairs.sort()
        for (x, y), (further, other) in zip(pairs, pairs[1:]):
            if further > x and other > 1.001 * y:
                yield (f"table {table.id}, {', '.join(name)}: {value} rises from {y:g} to "
                       f"{other:g} while {by} rises from {x:g} to {further:g}")


def file_of(table, folder):
    """The CSV is there, whole and without an empty cell."""
    path = folder / f"{table.id}.csv"
    if not path.is_file():
        yield f"table {table.id}: {path.name} was not written"
        return
    with open(path, encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    if len(rows) != 1 + len(table.rows):
        yield f"table {table.id}: {path.name} has {len(rows) - 1} rows, not {len(table.rows)}"
    if any(not cell.strip() or len(row) != len(table.columns) for row in rows for cell in row):
        yield f"table {table.id}: {path.name} has an empty cell"


def figure_of(figure, out):
    """The picture is there and whole, and so is the CSV it was drawn from."""
    path = out / "figures" / f"{figure.id}.{figure.kind}"
    if not path.is_file():
        yield f"figure {figure.id}: {path.name} was not drawn"
    elif figure.kind == "svg":
        try:
            xml.etree.ElementTree.fromstring(path.read_text(encoding="utf-8"))
        except xml.etree.ElementTree.ParseError as error:
            yield f"figure {figure.id}: {error}"
    elif not path.read_bytes().startswith(b"\x89PNG\r\n\x1a\n"):
        yield f"figure {figure.id}: no PNG"
    if figure.source.endswith(".csv") and not (out / figure.source).is_file():
        yield f"figure {figure.id}: its source {figure.source} is not there"


def page_of(text):
    """The page loads nothing: every link leads into it, to a table beside it, or is data."""
    for kind, target in re.findall(r'\b(src|href|xlink:href|srcset|action)="([^"]*)"', text):
        if not re.match(r"#|data:image/png;base64,|tables/[a-z0-9._-]+\.csv\Z", target):
            yield f"index.html: {kind} leads to {target:.60}"
    for found in re.findall(r'@import|url\((?!["\']?#)[^)]*\)|<script|<link|<iframe', text):
        yield f"index.html: {found:.60}"


def part_of(part, context):
    if part.failure:
        yield f"section {part.name} failed: {part.failure}"
        return
    there = {table.id for table in part.tables}
    for wanted in getattr(part.section, "TABLES", ()):
        if wanted not in there:
            yield f"section {part.name}: table {wanted} is missing"
    for table in part.tables:
        yield from cells_of(table)
        yield from file_of(table, context.out / "tables")
    for figure in part.figures:
        yield from figure_of(figure, context.out)
    if hasattr(part.section, "check"):
        yield from part.section.check(context, part.tables)


def report(context, parts, page):
    """Everything that is wrong."""
    wrong = [f"a measurement failed: {failure}" for failure in context.store.failures()]
    names = [table.id for part in parts for table in part.tables]
    names += [figure.id for part in parts for figure in part.figures]
    wrong += [f"{name} is there twice" for name in sorted(set(names)) if names.count(name) > 1]
    for part in parts:
        wrong += part_of(part, context)
    return wrong + list(page_of(page))

