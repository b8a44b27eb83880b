# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the built command share. Standard library only."""

import json
import os
import pathlib
import shutil
import struct
import subprocess
import tempfile
import unittest

CURLIDAR = os.environ.get("CURLIDAR") or shutil.which("curlidar")
QUICK = bool(os.environ.get("CURLIDAR_TEST_QUICK"))

# The documented exit codes.
OK, INTERNAL, USAGE, INPUT, FILE = 0, 1, 2, 3, 4


def data_folder():
    """Folder of real scans: $CURLIDAR_DATA, or shared/data beside the project; None if absent."""
    if os.environ.get("CURLIDAR_DATA"):
        folder = pathlib.Path(os.environ["CURLIDAR_DATA"])
        return folder if folder.is_dir() else None
    for parent in pathlib.Path(__file__).resolve().parents:
        folder = parent / "shared" / "data"
        if folder.is_dir():
            return folder
    return None


class CommandTest(unittest.TestCase):
    """Runs the command in a scratch folder of the class, which is removed afterwards."""

    @classmethod
    def setUpClass(cls):
        if not CURLIDAR:
            raise unittest.SkipTest("set CURLIDAR to the built command")
        cls._scratch = tempfile.TemporaryDirectory(prefix="curlidar-test-")
        cls.folder = pathlib.Path(cls._scratch.name)
        cls.addClassCleanup(cls._scratch.cleanup)

    @classmethod
    def execute(cls, *arguments, stdin=b""):
        """Runs the command, whatever comes of it."""
        return subprocess.run([CURLIDAR, *map(str, arguments)], input=stdin, cwd=cls.folder,
                              capture_output=True, timeout=300)

    def run_ok(self, *arguments, stdin=b""):
        """Runs the command, which must succeed without a word on stderr; gives its stdout."""
        result = self.execute(*arguments, stdin=stdin)
        self.assertEqual(result.returncode, OK, result.stderr.decode(errors="replace"))
        self.assertEqual(result.stderr, b"")
        return result.stdout

    def run_json(self, *arguments, stdin=b""):
        return json.loads(self.run_ok(*arguments, "--json", stdin=stdin))

    def run_fail(self, code, *arguments, stdin=b"", says=()):
        """Runs the command, which must fail with `code` and one line on stderr that has `says`."""
        result = self.execute(*arguments, stdin=stdin)
        message = result.stderr.decode()
        self.assertEqual(result.returncode, code, message)
        self.assertEqual(message.count("\n"), 1, message)
        self.assertTrue(message.startswith("curlidar: error: "), message)
        for text in [says] if isinstance(says, str) else says:
            self.assertIn(text, message)
        return result

    def path(self, name):
        return self.folder / name

    def files(self, folder="."):
        """Names of all files in a folder of the scratch folder."""
        return sorted(p.name for p in (self.folder / folder).iterdir() if p.is_file())

    @classmethod
    def simulate(cls, name, *arguments):
        """A small scan: a VLP-16 in a street."""
        result = cls.execute("simulate", "--sensor", "vlp16", "-o", name, *arguments)
        assert result.returncode == 0, result.stderr.decode()
        return cls.folder / name


def read_kitti(path):
    """The points of a KITTI .bin file: (x, y, z, intensity) tuples."""
    return list(struct.iter_unpack("<4f", pathlib.Path(path).read_bytes()))


def write_kitti(path, points):
    pathlib.Path(path).write_bytes(b"".join(struct.pack("<4f", *p) for p in points))


def png_size(path):
    """Width and height of a PNG file."""
    head = pathlib.Path(path).read_bytes()[:24]
    assert head[:8] == b"\x89PNG\r\n\x1a\n" and head[12:16] == b"IHDR", head
    return struct.unpack(">II", head[16:24])


def ply_header(path):
    """Element counts of a PLY file: {"vertex": n, ...}."""
    head = pathlib.Path(path).read_bytes().split(b"end_header\n")[0].decode()
    return {line.split()[1]: int(line.split()[2]) for line in head.splitlines()
            if line.startswith("element ")}
