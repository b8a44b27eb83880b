# SPDX-License-Identifier: BSD-3-Clause
"""Finds a Python that has what the plots need."""
import importlib.util
import os
import subprocess
import sys

SYSTEM_PYTHON = "/usr/bin/python3"
NEEDED = ("numpy", "matplotlib")


def found():
    """The Python that has what is needed: this one, or the system's, whose packages come from the
    distribution, where the first one on PATH is another. None if neither has."""
    if all(importlib.util.find_spec(name) for name in NEEDED):
        return sys.executable
    code = f"import {', '.join(NEEDED)}"
    other = os.path.realpath(sys.executable) != os.path.realpath(SYSTEM_PYTHON)
    if other and os.path.exists(SYSTEM_PYTHON) and subprocess.run(
            [SYSTEM_PYTHON, "-c", code], check=False, capture_output=True).returncode == 0:
        return SYSTEM_PYTHON
    return None


def ensure_matplotlib():
    """Goes on with a Python that has them, or says what to install and ends the program."""
    python = found()
    if python == sys.executable:
        return
    if python:
        os.execv(python, [python, "-B", *sys.argv])
    missing = [f"python3-{name}" for name in NEEDED if importlib.util.find_spec(name) is None]
    print(f"report: Python lacks what draws the plots: apt-get install {' '.join(missing)}",
          file=sys.stderr)
    sys.exit(4)
