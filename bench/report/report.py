#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The evaluation as one report: the paper's tables, today's peers, pictures.

Measures what is not measured yet and writes index.html (one file, pictures inside), report.md,
tables/*.csv, data/*.csv and measurements/*.jsonl. A run that was stopped goes on where it was: what
the same programs have measured of the same input is not measured again.
"""
import argparse
import importlib
import importlib.util
import os
import shlex
import sys
import tomllib
import traceback
from dataclasses import dataclass, field
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]
from frame import files, machine, markdown, scans  # noqa: E402
from frame.cells import exact  # noqa: E402
from frame.context import Context  # noqa: E402

SECTIONS = ("one_to_one", "continuous", "upsampling", "maps", "timing", "rate_distortion",
            "metrics", "pictures")


@dataclass
class Part:
    """What a section gave."""
    name: str
    title: str
    tables: list = field(default_factory=list)
    figures: list = field(default_factory=list)
    failure: str = ""


def arguments():
    data = os.environ.get("CURLIDAR_DATA", HERE.parents[1] / "../shared/data")
    parser = argparse.ArgumentParser(
        prog=os.environ.get("CURLIDAR_REPORT_NAME", "report.py"), description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scans", nargs="*", metavar="SCANS",
                        help="scans, or folders of them; default: one scan of every dataset and "
                             "sensor in CURLIDAR_DATA")
    parser.add_argument("-o", "--out", type=Path, default=Path("report"), metavar="DIR",
                        help="where the report goes (default: report)")
    parser.add_argument("--quick", action="store_true",
                        help="three simulated scenes and at most one real scan, fewer settings")
    parser.add_argument("--simulated", action="store_true", help="no real scans")
    parser.add_argument("--all", action="store_true", help="every scan of CURLIDAR_DATA")
    parser.add_argument("--sections", metavar="LIST", default=",".join(SECTIONS),
                        help=f"only these, of {','.join(SECTIONS)}")
    parser.add_argument("--data", type=Path, default=Path(data), help=argparse.SUPPRESS)
    parser.add_argument("--curlidar", type=Path, required=True, help=argparse.SUPPRESS)
    parser.add_argument("--bin", type=Path, required=True, help=argparse.SUPPRESS)
    options = parser.parse_args()
    options.sections = options.sections.split(",")
    if unknown := set(options.sections) - set(SECTIONS):
        parser.error(f"no section is named {unknown.pop()!r}")
    return options


def context_of(options):
    real = [] if options.simulated else scans.chosen(
        options.scans, options.data.resolve(), options.all, options.quick)
    scenes = scans.QUICK_SCENES if options.quick else scans.SCENES
    published = tomllib.loads((HERE / "published.toml").read_text(encoding="utf-8"))
    return Context(options.out, options.curlidar.resolve(), options.bin.resolve(), real,
                   list(scenes), published, options.quick, options.all)


def part_of(context, name):
    """Measures a section and asks for its tables and figures. One that fails costs only itself."""
    section = importlib.import_module(f"sections.{name}")
    part = Part(name, section.TITLE)
    try:
        section.measure(context)
        part.tables = section.tables(context)
        for table in part.tables:
            columns = [column.key for column in table.columns]
            files.write_csv(context.out / "tables" / f"{table.id}.csv", columns,
                            [[exact(row[key]) for key in columns] for row in table.rows])
        part.figures = section.figures(context)
    except Exception as error:  # pylint: disable=broad-except
        traceback.print_exc()
        part.failure = f"{type(error).__name__}: {error}"
    return part


def main():
    options = arguments()
    context = context_of(options)
    command_line = shlex.join([Path(sys.argv[0]).name, *sys.argv[1:]])
    parts = []
    for name in options.sections:
        if importlib.util.find_spec(f"sections.{name}") is None:
            context.progress(f"{name}: not there yet")
            continue
        context.progress(f"== {name}")
        parts.append(part_of(context, name))
    header = machine.header(context, command_line)
    files.write(context.out / "report.md", markdown.page(header, parts))
    context.clean()
    context.progress(f"{context.store.measured} measured, {context.store.reused} stored already. "
                     f"Report: {context.out / 'report.md'}")
    return 1 if any(part.failure for part in parts) else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit("Stopped; the same command goes on from here.")
