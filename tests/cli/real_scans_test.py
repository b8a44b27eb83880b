# SPDX-License-Identifier: BSD-3-Clause
"""The main job on one real scan of each kind, where the data folder is there."""

import unittest

from support import QUICK, CommandTest, data_folder, png_size

# File, rings that --sensor auto finds (None: a scanner without rings), extra encode options.
SCANS = [
    ("kitti_odometry_00/velodyne/000000.bin", 64, []),
    ("kitti_raw/curl_example/0.pcd", 64, []),
    ("velodyne/ndt_omp_hdl32/251370668.pcd", 32, []),
    ("nebula/hesai/xt16/1732848128093928016.pcd", 16, ["--preset", "indoor"]),
    ("ouster_sdk/OS-0-128-U1_v2.3.0_1024x10_frame1491.pcd", 128, ["--preset", "indoor"]),
    ("ouster_sdk/OS-1-32-G_v2.1.1_1024x10_frame638.pcd", 32, ["--preset", "indoor"]),
    ("ouster_sdk/OS-2-32-U0_v2.0.0_1024x10_frame5424.pcd", 32, ["--preset", "indoor"]),
    ("tls_indoor/room_scan1.pcd", None, ["--preset", "indoor"]),
]


class RealScansTest(CommandTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.data = data_folder()
        if cls.data is None:
            raise unittest.SkipTest("no real scans here; set CURLIDAR_DATA to their folder")

    def test_info_encode_decode_compare_render(self):
        scans = [s for s in SCANS if (self.data / s[0]).exists()]
        if not scans:
            self.skipTest("none of the scans is in the data folder")
        for name, rings, options in scans[:2] if QUICK else scans:
            with self.subTest(scan=name):
                self.check(self.data / name, rings, ["--profile", "paper", *options])
                report = self.check(self.data / name, rings, ["--effort", 1])
                self.assertLessEqual(report["mean_error_m"], 0.05)
                self.assertGreater(report["mean_error_m"], 0.95 * 0.05)
                self.assertEqual(report["points_coded"], report["points_in"])
                self.check_bound(self.data / name)

    def check_bound(self, scan):
        self.run_ok("encode", scan, "-o", "bound.curl", "--max-error", 0.02, "--effort", 1)
        proof = self.run_json("verify", "bound.curl", scan)
        self.assertTrue(proof["ok"])
        self.assertLessEqual(proof["max_error_m"], 0.02)
        self.assertTrue(proof["order"] and proof["shape"] and proof["attributes"])

    def check(self, scan, rings, options):
        info = self.run_json("info", scan)
        if rings is not None:
            self.assertEqual(info["rings"], rings)
        report = self.run_json("encode", scan, "-o", "scan.curl", *options)
        self.assertEqual(report["points_in"], info["returns"])
        self.assertGreater(report["points_coded"], 0.1 * report["points_in"])
        decoded = self.run_json("decode", "scan.curl", "-o", "scan.pcd")
        self.assertEqual(decoded["points"], report["points_coded"])
        distances = self.run_json("compare", "scan.pcd", scan)
        self.assertLess(distances["a_to_b"]["p50"], 0.2)
        lattice = report.get("records", {}).get("lattice")
        rows = 1 if lattice == "none" else 2  # points without rings have no field
        self.run_ok("render", "scan.curl", "--rows", rows, "-o", "scan.png", "--size", "400x300")
        self.assertEqual(png_size(self.path("scan.png")), (400, 300))
        return report


if __name__ == "__main__":
    unittest.main()
