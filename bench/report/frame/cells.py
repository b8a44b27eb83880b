# SPDX-License-Identifier: BSD-3-Clause
"""What may stand in a cell of a table, and how it prints. A cell is never empty."""
import math
from dataclasses import dataclass


class BadCell(ValueError):
    """A cell is empty or holds what is no figure."""


class Missing(str):
    """Why there is no figure: Missing("PCL was not found when this was built")."""


@dataclass(frozen=True)
class Published:
    """A figure that this run has not measured, and where it comes from."""
    value: float | int | str
    source: str


Cell = float | int | str | Missing | Published


def refuse_bad(cell, where):
    """Raises BadCell for None, an empty text, and numbers that are not finite."""
    value = cell.value if isinstance(cell, Published) else cell
    if isinstance(value, (bool, int, float)):
        if not math.isfinite(value):
            raise BadCell(f"{where}: {value} is no figure; say Missing(reason)")
    elif not isinstance(value, str):
        raise BadCell(f"{where}: {type(value).__name__} is no cell; say Missing(reason)")
    elif not value.strip():
        raise BadCell(f"{where}: the cell is empty; say Missing(reason)")


def number(value, digits):
    """`digits`: decimals, or a format such as '.3g'. What is not zero never prints as zero."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return f"{value:,}"
    if isinstance(digits, str):
        return format(value, digits)
    text = f"{value:.{digits}f}"
    return f"{value:.1e}" if value != 0 and float(text) == 0 else text


def plain(cell, digits):
    """The cell as text; a published figure without its mark."""
    if isinstance(cell, Missing):
        return f"n/a ({cell})"
    if isinstance(cell, Published):
        return cell.value if isinstance(cell.value, str) else f"{cell.value:g}"  # as it was printed
    return cell if isinstance(cell, str) else number(cell, digits)


def exact(cell):
    """The cell for a CSV: all digits that matter, published and missing ones marked."""
    if isinstance(cell, Missing):
        return f"n/a ({cell})"
    if isinstance(cell, Published):
        return f"{exact(cell.value)} (published)"
    return f"{cell:.6g}" if isinstance(cell, float) else str(cell)
