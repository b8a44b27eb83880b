#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What a user gets from `cmake --install`: a package that another project finds and links, and an
executable that runs when it is copied alone.

usage: install_test.py CMAKE BUILD_DIR CXX VERSION
"""
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

CMAKE, BUILD_DIR, CXX, VERSION = sys.argv[1], Path(sys.argv[2]).resolve(), *sys.argv[3:5]
CONSUMER = Path(__file__).resolve().parent / "consumer"


def run(*command, **options):
    return subprocess.run([str(part) for part in command], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, timeout=900, check=False, **options)


class InstallTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory(prefix="install test ", dir=BUILD_DIR)
        cls.addClassCleanup(cls.scratch.cleanup)
        cls.prefix = Path(cls.scratch.name) / "prefix"
        done = run(CMAKE, "--install", BUILD_DIR, "--prefix", cls.prefix)
        assert done.returncode == 0, done.stdout

    def configure(self, version):
        build = Path(self.scratch.name) / f"consumer {version}"
        return build, run(CMAKE, "-S", CONSUMER, "-B", build, "-G", "Ninja",
                          f"-DCMAKE_PREFIX_PATH={self.prefix}", f"-DCMAKE_CXX_COMPILER={CXX}",
                          f"-DCURLIDAR_WANTED_VERSION={version}")

    def test_consumer_finds_links_and_runs(self):
        build, done = self.configure(VERSION)
        self.assertEqual(done.returncode, 0, done.stdout)
        done = run(CMAKE, "--build", build)
        self.assertEqual(done.returncode, 0, done.stdout)
        done = run(build / "consumer")
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn(f"curlidar {VERSION}", done.stdout)

    def test_report_runs_from_where_it_is_installed(self):
        if not (self.prefix / "libexec/curlidar/report_measure").is_file():
            self.skipTest("built without benchmarks")
        out = Path(self.scratch.name) / "report"
        clean = {key: value for key, value in os.environ.items() if not key.startswith("CURLIDAR")}
        done = run(self.prefix / "bin/curlidar", "report", "--quick", "--simulated", "--sections",
                   "maps", "--check", "-o", out, env=clean)
        if "apt-get install" in done.stdout and os.environ.get("CI") != "true":
            self.skipTest(done.stdout)
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertTrue((out / "index.html").is_file())

    def test_scripts_that_the_report_starts_are_installed(self):
        if not (self.prefix / "libexec/curlidar/report_measure").is_file():
            self.skipTest("built without benchmarks")
        scripts = self.prefix / "share/curlidar"
        self.assertTrue((scripts / "peers/external.py").is_file())
        for name in ("raw/line.py", "rate_distortion/lines.py"):
            done = run(sys.executable, "-B", scripts / name)  # its imports are there too
            self.assertIn("usage:", done.stdout)

    def test_other_version_is_refused(self):
        _, done = self.configure("99.0")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("99.0", done.stdout)
        self.assertIn(f"version: {VERSION}", done.stdout)

    def test_package_names_no_path_of_the_build_machine(self):
        files = list(self.prefix.rglob("curlidarTargets*.cmake"))
        self.assertEqual(len(files), 2)
        for file in files:
            for word in (str(CONSUMER.parents[2]), "libzstd", "libpng", "libz."):
                self.assertNotIn(word, file.read_text(), file)

    def test_executable_runs_when_copied_alone(self):
        alone = Path(self.scratch.name) / "alone"
        alone.mkdir()
        shutil.copy(self.prefix / "bin" / "curlidar", alone)
        done = run(alone / "curlidar", "--version", cwd="/", env={})
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn(VERSION, done.stdout)
        shutil.rmtree(alone)

    @unittest.skipUnless(shutil.which("ldd"), "no ldd on this system")
    def test_executable_needs_only_the_c_library(self):
        done = run("ldd", self.prefix / "bin" / "curlidar")
        names = {os.path.basename(line.split()[0]) for line in done.stdout.splitlines()}
        allowed = ("linux-vdso", "ld-linux", "libc.so", "libm.so")
        self.assertEqual([name for name in names if not name.startswith(allowed)], [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
