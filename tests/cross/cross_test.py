#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Builds a digest program for another machine, or with other compilers, and compares what it prints.

--machine M: with M's cross compiler, run by qemu-user. --compiler C: with C at -O0 and -O3.
Both against the program of the build that is being tested (--native). Exit code 77 (skipped) where
a compiler or qemu is missing, or 1 if CURLIDAR_CROSS_REQUIRED is set.
"""
import argparse
import difflib
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

SKIPPED = 77
QEMU = {"i686": "qemu-i386", "aarch64": "qemu-aarch64", "s390x": "qemu-s390x"}
FLAGS = ["-std=c++20", "-ffp-contract=off"]
# Sizes differ on 32-bit machines, char is unsigned on others: conversions that compile cleanly
# here may lose something there.
WARNINGS = ["-Wall", "-Wextra", "-Wconversion", "-Wno-sign-conversion", "-Werror"]


def missing_tool(*tools):
    for tool in tools:
        if not shutil.which(tool):
            required = os.environ.get("CURLIDAR_CROSS_REQUIRED")
            print(f"{tool} is not installed; ./dev setup cross installs it")
            sys.exit(1 if required else SKIPPED)


def output_of(command):
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\nended with {done.returncode}\n{done.stderr}")
    return done.stdout


def build(options, compiler, flags, folder):
    """The program, linked statically."""
    launcher = [options.launcher] if options.launcher else []
    includes = [f"-I{path}" for path in options.include]
    objects = []
    for source in options.sources:
        objects.append(folder / f"{len(objects)}.o")
        output_of([*launcher, compiler, *FLAGS, *flags, *includes, "-c", source, "-o", objects[-1]])
    program = folder / "program"
    output_of([compiler, "-static", *objects, "-o", program])
    return program


def compare(expected, found, name):
    """Whether the lines are the same; prints those that are not."""
    if expected == found:
        print(f"{name}: {len(found.splitlines())} digests agree")
        return True
    print("\n".join(difflib.unified_diff(expected.splitlines(), found.splitlines(),
                                         "this build", name, lineterm="", n=0)))
    return False


def parse_options():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--machine", choices=QEMU)
    what.add_argument("--compiler")
    parser.add_argument("--native", required=True)
    parser.add_argument("--launcher", default="")
    parser.add_argument("--include", nargs="+", required=True)
    parser.add_argument("--sources", nargs="+", required=True)
    parser.add_argument("--golden", nargs="*", default=[])
    return parser.parse_args()


def main():
    options = parse_options()
    if options.machine:
        compiler, qemu = f"{options.machine}-linux-gnu-g++", [QEMU[options.machine]]
        builds = {options.machine: ["-O2", *WARNINGS]}
    else:
        compiler, qemu = options.compiler, []
        builds = {f"{compiler} {level}": [level] for level in ("-O0", "-O3")}
    missing_tool(compiler, *qemu)
    expected = output_of([options.native, *options.golden])
    if not expected:
        sys.exit(f"{options.native} printed nothing")
    agree = True
    for name, flags in builds.items():
        with tempfile.TemporaryDirectory(prefix="curlidar-cross-") as folder:
            program = build(options, compiler, flags, Path(folder))
            agree &= compare(expected, output_of([*qemu, program, *options.golden]), name)
    sys.exit(0 if agree else 1)


if __name__ == "__main__":
    main()
