# SPDX-License-Identifier: BSD-3-Clause
"""Tables and figures as the sections give them."""
import re
from dataclasses import dataclass, field

from frame.cells import BadCell, Cell, Missing, Published, refuse_bad

ID = re.compile(r"[a-z0-9][a-z0-9._-]*\Z")


@dataclass
class Column:
    """`digits`: decimals, or a format such as '.3g'. `check`: what --check asks of the numbers that
    this run measured: 'positive' (not negative), 'share' (in [0, 1]) or 'any'."""
    key: str
    title: str
    unit: str = ""
    digits: int | str = 3
    check: str = "positive"

    def heading(self):
        return f"{self.title} ({self.unit})" if self.unit else self.title


@dataclass
class Table:
    """One table. Keys of rows that no column has are left out when it is written."""
    id: str
    title: str
    counts: str  # which input points the figures count, one sentence
    columns: list[Column]
    rows: list[dict[str, Cell]]
    notes: list[str] = field(default_factory=list)
    command: str = ""  # what reproduces it; empty: the run's own

    def __post_init__(self):
        if not ID.match(self.id):
            raise BadCell(f"table '{self.id}': an id is made of a-z, 0-9, '.', '_' and '-'")
        if not self.rows or not self.columns or not self.counts.strip():
            raise BadCell(f"table {self.id}: no rows, no columns, or it does not say what it "
                          "counts")
        for i, row in enumerate(self.rows, 1):
            for column in self.columns:
                refuse_bad(row.get(column.key), f"table {self.id}, row {i}, column {column.key}")

    def sources(self):
        """The sources of its published figures, in the order of their marks."""
        return list(dict.fromkeys(
            cell.source for row in self.rows for column in self.columns
            if isinstance(cell := row[column.key], Published)))


def rows_or(rows, columns, why):
    """The rows, or one that says in every cell why there is none."""
    return rows or [dict.fromkeys((column.key for column in columns), Missing(why))]


@dataclass
class Figure:
    """A picture that lies in figures/ID.KIND of the report's folder."""
    id: str
    title: str
    caption: str
    kind: str    # 'svg' or 'png'
    source: str  # the CSV that it is drawn from, or what was drawn

    def __post_init__(self):
        if not ID.match(self.id) or self.kind not in ("svg", "png"):
            raise BadCell(f"figure '{self.id}' of kind '{self.kind}'")
