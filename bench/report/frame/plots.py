# SPDX-License-Identifier: BSD-3-Clause
"""Plots as SVG that read on light and dark paper: text and axes take the colour of the page."""
import re

import matplotlib

matplotlib.use("svg")
from matplotlib import pyplot  # noqa: E402

from frame import files  # noqa: E402

INK = "#010203"  # drawn with this, then replaced by currentColor
# Each at least 3:1 against white and against the dark page.
COLOURS = ("#d9363e", "#2f7fd0", "#c9730a", "#238b57", "#9a5fd0", "#7d838c", "#0f8f9e", "#cc4b93",
           "#8a7a1f", "#5b74e8")
MARKERS = "osD^vP*X<>"
OURS = COLOURS[0]
STANDALONE = ("<style>:root{color:#222}"
              "@media (prefers-color-scheme:dark){:root{color:#ddd}}</style>")
STYLE = {
    "svg.fonttype": "none", "font.family": "sans-serif", "font.size": 9, "axes.titlesize": 9.5,
    "legend.fontsize": 8, "legend.frameon": False, "axes.grid": True, "grid.alpha": .18,
    "lines.linewidth": 1.5, "lines.markersize": 4, "axes.spines.top": False,
    "axes.spines.right": False, "figure.facecolor": "none", "axes.facecolor": "none",
    "savefig.facecolor": "none", "axes.prop_cycle": matplotlib.cycler(color=COLOURS),
    **dict.fromkeys(("text.color", "axes.edgecolor", "axes.labelcolor", "xtick.color",
                     "ytick.color", "grid.color"), INK)}


def panels(count, columns=3, width=3.4, height=2.7, **options):
    """A figure and the axes of `count` panels, row by row. Every plot starts here."""
    matplotlib.rcParams.update(STYLE)
    columns = min(count, columns)
    rows = -(-count // columns)
    figure, axes = pyplot.subplots(rows, columns, squeeze=False, layout="constrained",
                                   figsize=(width * columns, height * rows), **options)
    for spare in axes.flat[count:]:
        spare.set_axis_off()
    return figure, list(axes.flat[:count])


def colour_of(name, names):
    """The same colour for the same name in all panels; ours is always the first one."""
    others = [other for other in names if not other.startswith("curlidar")]
    return OURS if name not in others else COLOURS[1 + others.index(name) % (len(COLOURS) - 1)]


def save(figure, path):
    """Writes the SVG and closes the figure."""
    name = path.stem
    part = path.with_name(path.name + ".drawn")
    matplotlib.rcParams["svg.hashsalt"] = name
    figure.savefig(part, format="svg", metadata={"Date": None})
    pyplot.close(figure)
    text = part.read_text(encoding="utf-8").replace(INK, "currentColor")
    part.unlink()
    text = re.sub(r"<\?xml.*?\?>|<!DOCTYPE.*?>|<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    text = re.sub(r'(<svg [^>]*>)', lambda found: found[1] + STANDALONE, text, count=1)
    # Ids are unique among all pictures of a page.
    text = re.sub(r'\bid="', f'id="{name}-', text)
    text = re.sub(r'(href="#|url\(#)', rf"\g<1>{name}-", text)
    files.write(path, text.lstrip())


def inline(text):
    """An SVG for within a page: in the page's colours, as wide as there is place but no wider than
    it was drawn."""
    head, _, rest = text.replace(STANDALONE, "").partition(">")
    width = re.search(r' width="([\d.]+)pt"', head)[1]
    head = re.sub(r' (?:width|height)="[^"]*"', "", head)
    return f'{head} style="max-width:{width}pt">{rest}'
