# SPDX-License-Identifier: BSD-3-Clause
"""Maps: built, made longer, asked for points; what a killed build leaves."""

import json
import os
import signal
import subprocess
import time
import unittest

from support import CURLIDAR, FILE, INPUT, USAGE, CommandTest


class MapTest(CommandTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        (cls.folder / "scans").mkdir()
        cls.simulate("scans/0.pcd")
        cls.simulate("scans/1.pcd", "--seed", "1", "--noise", "0.01")
        cls.write_poses("poses.txt", [0, 0])
        cls.write_poses("one.txt", [0])
        result = cls.execute("map", "build", "scans", "--poses", "poses.txt", "-o", "street.curl")
        assert result.returncode == 0, result.stderr.decode()

    @classmethod
    def write_poses(cls, name, places):
        text = "".join(f"1 0 0 {x} 0 1 0 0 0 0 1 0\n" for x in places)
        (cls.folder / name).write_text(text)

    def test_info_tells_where_the_bytes_go(self):
        info = self.run_json("map", "info", "street.curl", "--tiles")
        self.assertEqual(info["bytes"], self.path("street.curl").stat().st_size)
        self.assertEqual(info["bytes"],
                         info["bytes_parts"] + info["bytes_index"] + info["bytes_other"])
        self.assertEqual(len(info["tile_list"]), info["tiles"])
        self.assertEqual(sum(tile["leaves"] for tile in info["tile_list"]), info["leaves"])
        self.assertEqual(info["scans"], 2)
        self.assertIn("surface", self.run_ok("map", "info", "street.curl").decode())

    def test_extract_gives_the_part_that_is_asked_for(self):
        whole = self.run_json("map", "extract", "street.curl", "-o", "all.ply")["points"]
        part = self.run_json("map", "extract", "street.curl", "--box", "0,-5,-5,10,5,5", "-o",
                             "part.csv")["points"]
        self.assertGreater(whole, part)
        self.assertGreater(part, 0)
        rows = self.path("part.csv").read_text().splitlines()
        numbers = [[float(v) for v in row.split(",")[:3]] for row in rows[-part:]]
        self.assertEqual(len(numbers), part)
        self.assertTrue(all(0 <= x <= 10 and -5 <= y <= 5 for x, y, _ in numbers))
        near = self.run_json("map", "extract", "street.curl", "--radius", "0,0,0,8", "--density",
                             "25", "--normals", "-o", "near.ply")["points"]
        self.assertGreater(near, 0)
        self.assertIn(b"normal_z", self.path("near.ply").read_bytes()[:1000])

    def test_a_second_lap_costs_little_and_new_places_are_added(self):
        before = self.path("street.curl").stat().st_size
        again = self.run_json("map", "append", "street.curl", "scans", "--poses", "poses.txt",
                              "-o", "again.curl")
        self.assertLessEqual(again["bytes"], 1.1 * before)
        self.write_poses("far.txt", [500, 500])
        longer = self.run_json("map", "append", "street.curl", "scans", "--poses", "far.txt",
                               "-o", "longer.curl")
        self.assertGreater(longer["bytes"], 1.5 * before)
        self.assertEqual(longer["parts_kept"], self.run_json("map", "info", "street.curl")["tiles"])

    def test_keyframes_become_one_cloud(self):
        built = self.run_json("map", "build", "scans/0.pcd", "scans/1.pcd", "--poses", "poses.txt",
                              "--kind", "scans", "--columns", "512", "-o", "keys.curl")
        self.assertEqual(built["parts"], 2)
        info = self.run_json("map", "info", "keys.curl")
        plain = self.run_json("map", "extract", "keys.curl", "-o", "plain.ply")["points"]
        self.assertEqual(plain, info["points"])
        dense = self.run_json("map", "extract", "keys.curl", "--rows", "4", "-o", "dense.ply")
        fewer = self.run_json("map", "extract", "keys.curl", "--rows", "4", "--dedupe", "0.5",
                              "-o", "fewer.ply")
        self.assertGreater(dense["points"], 2 * plain)
        self.assertLess(fewer["points"], dense["points"])

    def test_what_does_not_fit_is_refused(self):
        self.write_poses("three.txt", [0, 1, 2])
        self.run_fail(INPUT, "map", "build", "scans", "--poses", "three.txt", "-o", "x.curl",
                      says=["3 poses", "2 scans"])
        self.run_fail(USAGE, "map", "build", "scans", "--poses", "poses.txt", "-o", "x.curl",
                      "--every", "0", says="--every")
        self.run_fail(FILE, "map", "info", "none.curl", says="none.curl")
        self.run_fail(FILE, "map", "build", "scans", "--poses", "poses.txt", "-o", "no/x.curl")
        self.run_fail(USAGE, "map", "extract", "street.curl", "--rows", "8", "-o", "x.ply",
                      says="surface map")
        extract = ["map", "extract", "street.curl", "-o", "x.ply"]
        for part in (["--box", "1,2"], ["--box", "0,0,0,1,-1,1"], ["--radius", "0,0,0,0"],
                     ["--tile", "1.5,0"], ["--spacing", "0"]):
            self.run_fail(USAGE, *extract, *part, says=part[0])
        build = ["map", "build", "scans", "--poses", "poses.txt"]
        self.run_fail(USAGE, *build, "--min-range", "9", "--max-range", "8", "-o", "x.curl",
                      says="from 9 to")
        self.run_fail(FILE, "map", "build", "none.pcd", "--poses", "one.txt", "-o", "x.curl",
                      says="none.pcd")
        self.run_fail(FILE, *build[:3], "--poses", "none.txt", "-o", "x.curl", says="none.txt")
        self.run_fail(USAGE, *build[:3], "-o", "x.curl", says="--poses")
        self.run_fail(USAGE, *build, "-o", "scans/0.pcd", says="scans/0.pcd")
        self.run_fail(USAGE, *build, "-o", "poses.txt", says="poses.txt")
        self.run_fail(FILE, *build, "-o", "scans")
        self.run_fail(INPUT, "map", "info", "scans/0.pcd", says="not a .curl file")
        self.run_ok("encode", "scans/0.pcd", "-o", "scan.curl", "--quiet")
        for command in (["info"], ["extract", "-o", "x.ply"], ["render", "-o", "x.png"]):
            self.run_fail(INPUT, "map", command[0], "scan.curl", *command[1:],
                          says="a .curl file of one scan")
        self.assertNotIn("x.curl", self.files())

    def test_a_map_may_be_empty(self):
        result = self.execute("map", "build", "scans", "--poses", "poses.txt", "--min-range", "500",
                              "--max-range", "600", "-o", "empty.curl")
        self.assertEqual(result.returncode, 0, result.stderr.decode())
        self.assertIn(b"--min-range", result.stderr)
        self.assertEqual(self.run_json("map", "info", "empty.curl")["tiles"], 0)
        self.run_fail(INPUT, "map", "render", "empty.curl", says="no surface")
        self.run_fail(INPUT, "map", "compare", "empty.curl", "scans/0.pcd", says="no surface")

    def test_a_map_goes_through_pipes(self):
        data = self.run_ok("map", "build", "scans", "--poses", "poses.txt", "-o", "-", "--quiet")
        self.assertEqual(data, self.path("street.curl").read_bytes())
        self.assertIn(b"tiles", self.run_ok("map", "info", "-", stdin=data))

    def test_a_cut_map_is_refused_or_read_in_part(self):
        data = self.path("street.curl").read_bytes()
        self.path("cut.curl").write_bytes(data[:len(data) * 2 // 3])
        self.run_fail(INPUT, "map", "info", "cut.curl", says="cut off")
        result = self.execute("map", "info", "cut.curl", "--allow-truncated", "--json")
        self.assertEqual(result.returncode, 0)
        self.assertIn(b"walking", result.stderr)

    def run_damaged(self, *arguments):
        """A command over a map with one damaged tile, which goes on without it."""
        result = self.execute(*arguments, "--json")
        message = result.stderr.decode()
        self.assertEqual(result.returncode, INPUT, message)
        self.assertEqual(message.count("warning"), 1, message)
        self.assertIn("tile 0,0", message)
        self.assertIn("the rest of the map", message)
        return json.loads(result.stdout)

    def test_a_damaged_tile_is_named_and_the_others_are_used(self):
        tiles = self.run_json("map", "info", "street.curl", "--tiles")["tile_list"]
        number = [(tile["x"], tile["y"]) for tile in tiles].index((0, 0))
        self.assertGreater(len(tiles), 1)
        data = bytearray(self.path("street.curl").read_bytes())
        first = len(data) - self.run_json("map", "info", "street.curl")["bytes_index"]
        for tile in reversed(tiles[number:]):
            first -= tile["bytes"] + 4
            frame = 2 if tile["bytes"] < 128 else 3
            first -= frame
        data[first + 10] ^= 1
        self.path("hurt.curl").write_bytes(data)
        whole = self.run_json("map", "extract", "street.curl", "-o", "whole.ply")["points"]
        rest = self.run_damaged("map", "extract", "hurt.curl", "-o", "rest.ply")
        self.assertEqual(rest["parts_damaged"], 1)
        self.assertTrue(0 < rest["points"] < whole)
        self.run_damaged("map", "sample", "hurt.curl", "--sensor", "vlp16", "--pose", "0,0,0",
                         "-o", "rest.pcd")
        self.run_damaged("map", "compare", "hurt.curl", "whole.ply")
        self.run_damaged("map", "render", "hurt.curl", "-o", "rest.png", "--size", "160x0")
        # What does not touch it knows nothing of it.
        other = next(tile for tile in tiles if (tile["x"], tile["y"]) != (0, 0))
        self.run_ok("map", "extract", "hurt.curl", "--tile", f"{other['x']},{other['y']}", "-o",
                    "other.ply", "--quiet")
        # A longer map keeps what is whole.
        longer = self.execute("map", "append", "hurt.curl", "scans/0.pcd", "--poses", "one.txt",
                              "-o", "mended.curl")
        self.assertEqual(longer.returncode, 0, longer.stderr.decode())
        self.assertIn(b"made anew", longer.stderr)
        self.run_ok("map", "extract", "mended.curl", "-o", "mended.ply")

    def test_a_build_that_is_ended_leaves_nothing_or_the_old_file(self):
        folder = self.folder / "killed"
        folder.mkdir()
        old = self.path("street.curl").read_bytes()
        self.write_poses("many.txt", [float(i) for i in range(10)])
        ended = 0
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
            for late in (False, True):
                target = folder / f"{int(number)}-{late}.curl"
                target.write_bytes(old)
                code, pid = self.end_append(target, number, late)
                # Nobody can handle SIGKILL: its hidden file stays, and has its name.
                hidden = [name for name in os.listdir(folder) if name.startswith(f".curlidar-{pid}-")]
                if number != signal.SIGKILL:
                    self.assertEqual(hidden, [])
                if code != 0:
                    self.assertEqual(code, -number)
                    self.assertEqual(target.read_bytes(), old)
                    ended += 1
                self.run_ok("map", "info", target)
        self.assertGreater(ended, 0)

    def end_append(self, target, number, late):
        """Appends, and sends the signal soon or when the map is being written."""
        def listening():
            signal.signal(signal.SIGINT, signal.SIG_DFL)
        with subprocess.Popen([CURLIDAR, "map", "append", str(target), *["scans"] * 5, "--poses",
                               "many.txt", "--quiet"], cwd=self.folder,
                              preexec_fn=listening) as process:
            begin = f".curlidar-{process.pid}-"
            while late and process.poll() is None:
                if any(name.startswith(begin) for name in os.listdir(target.parent)):
                    break
                time.sleep(0.002)
            if not late:
                time.sleep(0.05)
            process.send_signal(number)
            return process.wait(), process.pid


if __name__ == "__main__":
    unittest.main()
