# SPDX-License-Identifier: BSD-3-Clause
"""Upsampling of 16 rings to 64. Ours is not measured by this version."""
from frame.cells import Missing
from frame.tables import Column, Table

TITLE = "Upsampling: 16 rings to 64"
TABLES = ("upsampling",)
OURS = Missing("not measured by this version")
OUR_METHODS = ("linear in inverse range, edge-aware", "paper (stages A and B)", "curlidar")
FIGURES = ("mae_m", "both_valid_mae_m", "chamfer_m2", "iou", "f1")


def measure(_context):
    pass


def tables(context):
    rows = [{"both_valid_mae_m": Missing("not published"), **row}
            for row in context.published_rows("upsampling")]
    rows += [{"method": method, **dict.fromkeys(FIGURES, OURS)} for method in OUR_METHODS]
    return [Table(
        "upsampling", "16 rings to 64 on KITTI, TULIP's protocol",
        "all pixels of the 64 x 1024 range image within 2 .. 80 m, empty ones included, rows 0, 4, "
        ".. 60 being the input; Chamfer, IoU and F1 (voxels of 0.1 m) count the points of those "
        "pixels.",
        [Column("method", "method"), Column("mae_m", "MAE, all pixels", "m"),
         Column("both_valid_mae_m", "MAE, both valid", "m"),
         Column("chamfer_m2", "Chamfer, sum of squared", "m²"),
         Column("iou", "IoU", check="share"), Column("f1", "F1", check="share")],
        rows,
        ["SuperRso was not run: its network and its weights are not available here; its row is "
         "kept for when they are.",
         "published on another split: not comparable scan by scan."])]


def figures(_context):
    return []
