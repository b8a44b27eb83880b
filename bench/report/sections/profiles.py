# SPDX-License-Identifier: BSD-3-Clause
"""Density profiles fitted to the scans at hand, without the drive that is judged by them, and
confidence taught without it."""
from pathlib import Path

from frame.context import OUTPUT
from frame.scans import every_scan_beside

PROGRAM = "density"
IMAGE = ("--return-trees", "40", "--residual-trees", "0", "--depth", "5")
RINGS = ("--return-trees", "0", "--residual-trees", "0", "--row-confidence-trees", "0")


def drive_of(scan):
    return str(Path(scan.name).parent)


def without_drive(context, scan, kind, *options):
    """The profile as a file to be made; None in quick runs, for scans of sensors that have none,
    and without scans of other drives or the program that fits."""
    if context.quick or not scan.is_kitti or not (context.bin / PROGRAM).is_file():
        return None
    others = [each for each in every_scan_beside(scan)
              if each.is_kitti and drive_of(each) != drive_of(scan)]
    if not others:
        return None
    lines = "".join(f"{drive_of(each)} {each.path}\n" for each in others)
    return context.made(".toml", [context.bin / PROGRAM, kind, context.made_text(".txt", lines),
                                  OUTPUT, *options, "--threads", "1"])


def file_without(context, scan, prefix=""):
    """A file of --left-out that the scan's group had no part in; None where there is none."""
    if context.left_out is None:
        return None
    path = context.left_out / (prefix + drive_of(scan).replace("/", "-") + ".toml")
    return path if path.is_file() else None


def rings_without(context, scan, every):
    """The profile of every K-th ring that other drives taught: that of --left-out, which may know
    confidence, too, or one that is fitted now and does not, for that takes coding them all."""
    return file_without(context, scan, f"rings-{every}-") or without_drive(
        context, scan, "rings", "--every", str(every), *RINGS)


def confidence_without(context, scan):
    return file_without(context, scan)


def confidence_taught(context):
    """By what the confidence of held-out rings was taught, for titles."""
    without = [confidence_without(context, scan) is not None for scan in context.scans]
    if without and all(without):
        return "taught without the scan's own group"
    if any(without):
        return "taught without the scan's own group where that was made, else by these scans too"
    return "taught by these scans too"
