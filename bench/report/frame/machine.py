# SPDX-License-Identifier: BSD-3-Clause
"""What the report was made on and from."""
import datetime
import os
import platform
import subprocess
from pathlib import Path


def said_by(*command):
    """The first line that a program prints, or an empty text."""
    try:
        run = subprocess.run([str(part) for part in command], capture_output=True, text=True,
                             check=False, stdin=subprocess.DEVNULL)
    except OSError:
        return ""
    return run.stdout.strip().splitlines()[0] if run.returncode == 0 and run.stdout.strip() else ""


def cpu():
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def commit():
    here = Path(__file__).resolve().parent
    return said_by("git", "-C", here, "describe", "--always", "--dirty") or "not of a checkout"


def peers(context):
    """Which other codecs took part, as the section on rate and distortion has measured them."""
    rows = [line for line in context.store.lines("rate_distortion") if line.get("codec")]
    there = sorted({row["codec"] for row in rows if "bytes" in row} - {"curlidar"})
    absent = sorted({row["codec"] for row in rows if "skipped" in row} - set(there))
    text = ", ".join(there) or "none measured in this run"
    return text + (f"; not there: {', '.join(absent)}" if absent else "")


def header(context, command_line):
    """(name, value) pairs for the head of the report."""
    now = datetime.datetime.now(datetime.timezone.utc)
    scans = ", ".join(scan.name for scan in context.scans) or "none"
    return [
        ("made", f"{now:%Y-%m-%d %H:%M} UTC, {'quick' if context.quick else 'full'} mode"),
        ("made with", f"`{command_line}`"),
        ("version", f"{said_by(context.curlidar, '--version')}, commit {commit()}"),
        ("machine", f"{cpu()}, {len(os.sched_getaffinity(0))} cores, "
                    f"{platform.system()} {platform.machine()}"),
        ("compiler here", said_by("c++", "--version") or "none"),
        ("peer codecs", peers(context)),
        ("real scans", scans),
        ("simulated scenes", ", ".join(f"{scene.name} ({scene.sensor}, seed {scene.seed})"
                                       for scene in context.scenes)),
    ]
