# SPDX-License-Identifier: BSD-3-Clause
"""Curves of rate against error. A point is a dict with `error_m` and what it costs."""
import math

# A setting that gives this much less error than asked for counts as reaching it: it costs more.
SLACK = 1.05


def frontier(points, rate="bits_per_cell"):
    """The points that no other beats in both error and rate, by rising error."""
    best, kept = math.inf, []
    for p in sorted(points, key=lambda p: (p["error_m"], p[rate])):
        if p[rate] < best:
            best = p[rate]
            kept.append(p)
    return kept


def rate_at(points, error_m, rate="bits_per_cell", slack=1.):
    """The rate at an error, linear in its logarithm; None outside what was measured. `slack`: how
    many times the error of the last point may be asked for, at that point's rate."""
    kept = frontier(points, rate)
    for a, b in zip(kept, kept[1:]):
        if a["error_m"] <= error_m <= b["error_m"]:
            t = math.log(error_m / a["error_m"]) / math.log(b["error_m"] / a["error_m"])
            return (1 - t) * a[rate] + t * b[rate]
    if kept and kept[-1]["error_m"] <= error_m <= slack * kept[-1]["error_m"]:
        return kept[-1][rate]
    return None


def nearest(points, error_m):
    """The point whose error is nearest in its logarithm; None of no points."""
    return min((p for p in points if p["error_m"] > 0), default=None,
               key=lambda p: abs(math.log(p["error_m"] / error_m)))
