#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The evaluation as one report: the paper's tables, today's peers, pictures.

Measures what is not measured yet and writes index.html (one file, pictures inside), report.md,
tables/*.csv, data/*.csv and measurements/*.jsonl. A run that was stopped goes on where it was: what
the same programs have measured of the same input is not measured again.
"""
import argparse
import importlib
import os
import shlex
import shutil
import sys
import tomllib
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]
from frame import interpreter  # noqa: E402

interpreter.ensure_matplotlib()
from frame import check, files, html, machine, markdown, parts, scans  # noqa: E402
from frame.context import Context  # noqa: E402

SECTIONS = ("one_to_one", "continuous", "upsampling", "maps", "timing", "rate_distortion",
            "metrics", "pictures")


PROGRAMS = ("report_measure", "rate_distortion")


class Stop(Exception):
    """The report cannot be made, and why."""


def arguments():
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
    only = parser.add_mutually_exclusive_group()
    only.add_argument("--simulated", action="store_true", help="no real scans")
    only.add_argument("--real", action="store_true", help="no simulated scenes")
    parser.add_argument("--all", action="store_true", help="every scan of CURLIDAR_DATA")
    parser.add_argument("--left-out", type=Path, metavar="DIR",
                        help="what was taught without a group of scans: GROUP.toml tells confidence, "
                             "rings-K-GROUP.toml (if there) is the profile of every K-th ring "
                             "(tools/README.md); the group's scans are judged by them")
    parser.add_argument("--sections", metavar="LIST", default=",".join(SECTIONS),
                        help=f"only these, of {','.join(SECTIONS)}")
    parser.add_argument("--jobs", type=int, default=min(2, os.cpu_count() or 1), metavar="N",
                        help="sections measured at once, one thread each, those that take times "
                             "always alone (default: %(default)s)")
    parser.add_argument("--check", action="store_true",
                        help="also check that the tables are complete and sane; exit code 1 if not")
    options = parser.parse_args()
    options.name = parser.prog
    options.sections = options.sections.split(",")
    if unknown := set(options.sections) - set(SECTIONS):
        parser.error(f"no section is named {unknown.pop()!r}")
    if options.simulated and options.scans:
        parser.error("--simulated leaves real scans out, but some are named")
    return options


def programs():
    """(the command, folder of the measuring programs), as whoever starts this says."""
    curlidar = shutil.which(os.environ.get("CURLIDAR", "curlidar"))
    if curlidar is None:
        raise Stop("the command curlidar was not found: start this as ./dev report or curlidar "
                   "report, or name it in CURLIDAR")
    curlidar = Path(curlidar).resolve()
    folder = Path(os.environ.get("CURLIDAR_REPORT_BIN", curlidar.parent)).resolve()
    for name in PROGRAMS:
        if not os.access(folder / name, os.X_OK):
            raise Stop(f"{folder / name} was not found: build the preset bench (./dev report does)")
    return curlidar, folder


def real_scans(options):
    if options.simulated:
        return []
    data = Path(os.environ.get("CURLIDAR_DATA", HERE.parents[1] / "../shared/data")).resolve()
    found = scans.chosen(options.scans, data, options.all, options.quick)
    if not found and options.real:
        raise Stop(f"no real scans: there is no MANIFEST.tsv in {data}; CURLIDAR_DATA names the "
                   "folder of the scans, or name scans")
    if not found:
        print(f"No MANIFEST.tsv in {data}: simulated scenes only (CURLIDAR_DATA names the folder "
              "of the scans).", file=sys.stderr)
    return found


def context_of(options):
    curlidar, folder = programs()
    scenes = () if options.real else scans.QUICK_SCENES if options.quick else scans.SCENES
    found = real_scans(options)
    published = tomllib.loads((HERE / "published.toml").read_text(encoding="utf-8"))
    options.out.mkdir(parents=True, exist_ok=True)
    return Context(options.out.resolve(), curlidar, folder, found, list(scenes),
                   published, options.quick, options.all,
                   options.left_out.resolve() if options.left_out else None)


def command_of(options, section=None):
    """What makes this report, or a section of it, again; of files only their names."""
    words = [Path(name).name for name in options.scans]
    words += [f"--{name}" for name in ("quick", "simulated", "real", "all")
              if getattr(options, name)]
    if options.left_out:
        words += ["--left-out", options.left_out.name]
    if section or options.sections != list(SECTIONS):
        words += ["--sections", section or ",".join(options.sections)]
    return f"{options.name} {shlex.join(words)}".strip()


def write_report(context, options, done):
    header = machine.header(context, command_of(options))
    files.write(context.out / "report.md", markdown.page(header, done))
    page = html.page(header, done, context.out / "figures")
    files.write(context.out / "index.html", page)
    return page


def make(options):
    context = context_of(options)
    done = [parts.Part(name, importlib.import_module(f"sections.{name}"), command_of(options, name))
            for name in options.sections]
    parts.measure_all(context, done, options.jobs)
    for part in done:
        parts.fill(context, part)
    page = write_report(context, options, done)
    wrong = check.report(context, done, page) if options.check else []
    context.clean()
    for line in wrong:
        print(f"check: {line}", file=sys.stderr)
    if options.check and not wrong:
        print("check: nothing is wrong", file=sys.stderr)
    print(f"{context.store.measured} measured, {context.store.reused} stored already. "
          f"Report: {options.out / 'index.html'}", file=sys.stderr)
    return 1 if wrong or any(part.failure for part in done) else 0


def main():
    options = arguments()
    try:
        return make(options)
    except (Stop, scans.NoScans) as error:
        print(f"report: {error}", file=sys.stderr)
    except OSError as error:
        print(f"report: {error.filename or options.out}: {error.strerror}", file=sys.stderr)
    return 4


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit("Stopped; the same command goes on from here.")
