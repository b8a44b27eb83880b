# SPDX-License-Identifier: BSD-3-Clause
"""Finds a Python that has what the plots need."""
import importlib.util
import os
import subprocess
import sys

SYSTEM_PYTHON = "/usr/bin/python3"
NEEDED = ("numpy", "matplotlib")


def ensure_matplotlib():
    """Goes on with the system's Python, whose packages come from the distribution, where the first
    one on PATH is another and lacks them."""
    missing = [name for name in NEEDED if importlib.util.find_spec(name) is None]
    if not missing:
        return
    if os.path.realpath(sys.executable) != os.path.realpath(SYSTEM_PYTHON) and \
            os.path.exists(SYSTEM_PYTHON) and \
            subprocess.run([SYSTEM_PYTHON, "-c", "import numpy, matplotlib"], check=False,
                           capture_output=True).returncode == 0:
        os.execv(SYSTEM_PYTHON, [SYSTEM_PYTHON, "-B", *sys.argv])
    print(f"report: Python has no {' and no '.join(missing)}: install the package python3-"
          f"{' and python3-'.join(missing)} (apt-get install "
          f"{' '.join(f'python3-{name}' for name in missing)})", file=sys.stderr)
    sys.exit(4)
