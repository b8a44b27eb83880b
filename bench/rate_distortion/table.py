# SPDX-License-Identifier: BSD-3-Clause
"""The table of goals: ours beside the best peer at the same error."""
import math

from measure import EFFORTS, OURS, TARGETS_M
from scans import LIMITS, REFERENCE

from common.curves import rate_at

# Bits a cell on the reference scan: at effort 9, at the default effort, and of the best open peer
# when the goals were set.
GOALS = {.05: (.62, .75, 1.66), .02: (1.35, 1.6, 2.34), .01: (2.2, 2.6, 3.03),
         .005: (3.3, 3.7, 3.9), .002: (4.75, 5.0, 5.15)}


def bits_at(points, error_m):
    """Bits a cell at an error, linear in its logarithm; None outside what was measured."""
    return rate_at(points, error_m)


def best_peer(points, error_m):
    """(bits a cell, codec) of the best peer at an error; (None, None) if none reaches it."""
    codecs = sorted({p["codec"] for p in points} - {OURS})
    found = [(bits, codec) for codec in codecs
             if (bits := bits_at([p for p in points if p["codec"] == codec], error_m)) is not None]
    return min(found, default=(None, None))


def is_reference(p):
    return p["scan"] == REFERENCE and (p["min_range"], p["max_range"]) == LIMITS


def goals_at(points, target_m, peer_bits):
    """Bits a cell for each of EFFORTS. Scans other than the reference have no goals of their own:
    there it is the same share of the best peer."""
    *goals, reference_peer = GOALS[target_m]
    if is_reference(points[0]):
        return goals
    return [None if peer_bits is None else goal / reference_peer * peer_bits for goal in goals]


def number(value):
    return "-" if value is None else f"{value:.2f}"


def length(metres):
    return f"{metres * 1e3:g} mm" if metres < .01 else f"{metres * 1e2:g} cm"


def lines_of(points, ours):
    """The table of one grid, as Markdown, and how many goals were missed; `ours`: whether our
    codec took part, so that a figure it failed to reach is a goal missed."""
    first = points[0]
    lines = [f"**{first['scan']}**, {first['sensor']}: {first['cells']:,} cells of "
             f"{first['rows']} x {first['cols']}, {first['min_range']} m .. {first['max_range']}",
             "",
             "| mean error | effort 9 | reached | goal | default | reached | goal | best peer "
             "| effort 9 / peer |",
             "|---|---|---|---|---|---|---|---|---|"]
    missed = 0
    for target_m in TARGETS_M:
        peer_bits, codec = best_peer(points, target_m)
        goals = goals_at(points, target_m, peer_bits)
        cells, share = [], "-"
        for effort, goal in zip(EFFORTS, goals):
            own = next((p for p in points if p["codec"] == OURS and p["effort"] == effort
                        and p["target_m"] == target_m), None)
            bits = own and own["bits_per_cell"]
            cells += [number(bits), f"{own['error_m'] * 1e3:.2f} mm" if own else "-", number(goal)]
            if ours and goal:
                missed += bits is None or bits > goal
            if bits and peer_bits and effort == EFFORTS[0]:
                share = f"{100 * bits / peer_bits:.0f} %"
        peer = "-" if codec is None else f"{number(peer_bits)} {codec}"
        lines.append(f"| {length(target_m)} | {' | '.join(cells)} | {peer} | {share} |")
    return lines, missed
