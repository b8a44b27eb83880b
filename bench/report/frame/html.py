# SPDX-License-Identifier: BSD-3-Clause
"""The report as one HTML file: pictures inside, light and dark, nothing loaded from elsewhere."""
import base64
import itertools
import re
from html import escape

from frame import plots
from frame.cells import Missing, Published, plain
from frame.markdown import mark_of

STYLE = """
:root{color-scheme:light dark;--paper:#fff;--ink:#1f2328;--soft:#59636e;--line:#d5dae0;
--band:#f5f7f9;--link:#0a5cc0;--bad:#b3261e}
@media (prefers-color-scheme:dark){:root{--paper:#15171c;--ink:#dfe3e8;--soft:#98a2ae;
--line:#343a42;--band:#1c2027;--link:#7ab4ff;--bad:#ff8a80}}
*{box-sizing:border-box}
body{margin:0 auto;max-width:76rem;padding:1.5rem 1rem 4rem;background:var(--paper);
color:var(--ink);font:15px/1.5 system-ui,sans-serif}
a{color:var(--link)}h1{font-size:1.7rem;margin:.2em 0}h2{margin-top:3rem;padding-top:1rem;
border-top:1px solid var(--line)}h3{margin:2rem 0 .3rem}
dl{display:grid;grid-template-columns:max-content 1fr;gap:.15rem 1rem;margin:1rem 0}
dt{color:var(--soft)}dd{margin:0;overflow-wrap:anywhere}
nav ul{columns:18rem;padding-left:1.2rem}
.scroll{overflow-x:auto;margin:.6rem 0}
table{border-collapse:collapse;font-size:13.5px;font-variant-numeric:tabular-nums}
th,td{padding:.3rem .6rem;border-bottom:1px solid var(--line);text-align:left;
vertical-align:top}
thead th{border-bottom:2px solid var(--line);vertical-align:bottom}
tbody tr:nth-child(even){background:var(--band)}
td.number{text-align:right;white-space:nowrap}td.text,td.missing{min-width:8rem}
td.missing{color:var(--soft)}
sup{color:var(--link);line-height:0}
.counts,.notes,figcaption{color:var(--soft);font-size:13.5px;max-width:60rem}
.counts{margin:.2rem 0}.notes{padding-left:1.2rem}
figure{margin:1.5rem 0}figure svg{width:100%;height:auto}figure img{max-width:100%;height:auto}
.failed{color:var(--bad)}code{font-size:.92em;overflow-wrap:anywhere}
"""


def marked_up(text):
    """Escaped, with `code` as such."""
    return re.sub(r"`([^`]*)`", r"<code>\1</code>", escape(text))


def cell_html(cell, column, sources):
    text = escape(plain(cell, column.digits))
    value = cell
    if isinstance(cell, Published):
        value = cell.value
        text += (f'<sup title="published: {escape(cell.source, quote=True)}">'
                 f"{mark_of(cell.source, sources)}</sup>")
    kind = "text" if isinstance(value, str) else "number"
    return f'<td class="{kind}">{text}</td>'


def row_html(row, columns, sources):
    """Cells side by side that miss for the same reason are one."""
    out = []
    for cell, group in itertools.groupby(
            columns, lambda column: row[column.key] if isinstance(row[column.key], Missing)
            else column.key):
        group = list(group)
        if isinstance(cell, Missing):
            out.append(f'<td class="missing" colspan="{len(group)}">{escape(plain(cell, 0))}</td>')
        else:
            out += [cell_html(row[column.key], column, sources) for column in group]
    return f"<tr>{''.join(out)}</tr>"


def table_html(table):
    sources = table.sources()
    heads = "".join(f'<th scope="col">{escape(column.heading())}</th>' for column in table.columns)
    rows = "\n".join(row_html(row, table.columns, sources) for row in table.rows)
    notes = [f"<sup>{mark_of(source, sources)}</sup> published: {escape(source)}"
             for source in sources]
    notes += [marked_up(note) for note in table.notes]
    notes.append(f'<a href="tables/{table.id}.csv">CSV</a>; again: '
                 f"<code>{escape(table.command)}</code>")
    return (f'<h3 id="table-{table.id}">{escape(table.title)}</h3>\n'
            f'<p class="counts">Counted: {marked_up(table.counts)}</p>\n'
            f'<div class="scroll" tabindex="0"><table><thead><tr>{heads}</tr></thead>\n'
            f"<tbody>\n{rows}\n</tbody></table></div>\n"
            '<ul class="notes">' + "".join(f"<li>{note}</li>" for note in notes) + "</ul>")


def figure_html(figure, folder):
    path = folder / f"{figure.id}.{figure.kind}"
    if figure.kind == "svg":
        picture = plots.inline(path.read_text(encoding="utf-8"))
    else:
        data = base64.b64encode(path.read_bytes()).decode()
        picture = (f'<img alt="{escape(figure.title, quote=True)}" loading="lazy" '
                   f'src="data:image/png;base64,{data}">')
    return (f'<figure id="figure-{figure.id}">{picture}<figcaption><b>{escape(figure.title)}.</b> '
            f"{marked_up(figure.caption)} (Drawn from {escape(figure.source)}.)</figcaption>"
            "</figure>")


def section_html(part, folder):
    out = [f'<section id="{part.name}"><h2>{escape(part.title)}</h2>']
    if part.failure:
        out.append(f'<p class="failed">This section failed: {escape(part.failure)}</p>')
    out += map(table_html, part.tables)
    out += [figure_html(figure, folder) for figure in part.figures]
    return "\n".join([*out, "</section>"])


def page(header, parts, folder):
    """`header`: (name, value) pairs; `folder`: where the pictures lie."""
    about = "".join(f"<dt>{escape(name)}</dt><dd>{marked_up(value)}</dd>"
                    for name, value in header)
    contents = "".join(f'<li><a href="#{part.name}">{escape(part.title)}</a></li>'
                       for part in parts)
    sections = "\n".join(section_html(part, folder) for part in parts)
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>curlidar: the report</title>
<meta name="viewport" content="width=device-width,initial-scale=1">
<style>{STYLE}</style></head><body>
<h1>curlidar: the report</h1>
<dl>{about}</dl>
<nav><ul>{contents}</ul></nav>
<p class="counts">† marks published figures: they were not measured by this run. Everything else
was, with the command under each table. <i>n/a</i> says why a figure is missing.</p>
{sections}
</body></html>
"""
