# SPDX-License-Identifier: BSD-3-Clause
"""The demo, as a newcomer runs it."""

import unittest

from support import QUICK, CommandTest, ply_header, png_size


class DemoTest(CommandTest):
    def test_the_demo(self):
        sensor = ["--sensor", "vlp16"] if QUICK else []
        report = self.run_json("demo", *sensor)
        self.assertEqual(self.files("demo-out"),
                         ["demo.png", "original.pcd", "original.ply", "reconstruction_1x.ply",
                          "reconstruction_8x.ply", "scan.curl"])
        self.assertEqual(report["bytes"], self.path("demo-out/scan.curl").stat().st_size)
        width, height = png_size(self.path("demo-out/demo.png"))
        self.assertGreater(width, 2 * height)
        coarse, dense = report["reconstructions"]
        self.assertEqual(ply_header(self.path("demo-out/reconstruction_8x.ply"))["vertex"],
                         dense["points"])
        self.assertGreater(dense["points"], 4 * coarse["points"])
        # The street's surfaces are smooth: a fit that is off by more than this is broken.
        self.assertLess(coarse["exact_error"]["mean"], 0.3)
        # Between 16 rings poles and edges are guesses, and a wrong one is off by metres.
        self.assertLess(dense["exact_error"]["mean"], 1.0 if QUICK else 0.5)

    def test_what_it_tells(self):
        text = self.run_ok("demo", "--sensor", "vlp16", "-o", "elsewhere").decode()
        for words in ["exact error", "8 x 1", "curlidar encode scan.pcd", "elsewhere"]:
            self.assertIn(words, text)


if __name__ == "__main__":
    unittest.main()
