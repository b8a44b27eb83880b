# SPDX-License-Identifier: BSD-3-Clause
"""The report as Markdown, its pictures linked."""
from frame.cells import Published, plain

MARK = "†"


def mark_of(source, sources):
    """A dagger, numbered where a table has several sources."""
    return MARK if len(sources) == 1 else f"{MARK}{sources.index(source) + 1}"


def cell_text(cell, column, sources):
    mark = f" {mark_of(cell.source, sources)}" if isinstance(cell, Published) else ""
    return plain(cell, column.digits) + mark


def escaped(text):
    return text.replace("|", "\\|").replace("\n", " ")


def lines_of(table):
    sources = table.sources()
    yield f"### {table.title}\n"
    yield f"Counted: {table.counts}\n"
    yield "| " + " | ".join(escaped(column.heading()) for column in table.columns) + " |"
    yield "|" + "---|" * len(table.columns)
    for row in table.rows:
        yield "| " + " | ".join(escaped(cell_text(row[column.key], column, sources))
                                for column in table.columns) + " |"
    yield ""
    for source in sources:
        yield f"- {mark_of(source, sources)} published: {source}"
    for note in table.notes:
        yield f"- {note}"
    if table.command:
        yield f"- again: `{table.command}`"
    yield ""


def page(header, parts):
    """`header`: (name, value) pairs; `parts`: sections with title, tables, figures, failure."""
    lines = ["# curlidar: the report", ""]
    lines += [f"- {name}: {value}" for name, value in header]
    for part in parts:
        lines += ["", f"## {part.title}", ""]
        if part.failure:
            lines += [f"This section failed: {part.failure}", ""]
        for table in part.tables:
            lines += lines_of(table)
        for figure in part.figures:
            lines += [f"![{figure.title}](figures/{figure.id}.{figure.kind})", "",
                      f"{figure.title}. {figure.caption} (Drawn from {figure.source}.)", ""]
    return "\n".join(lines).rstrip() + "\n"
