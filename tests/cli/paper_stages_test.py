# SPDX-License-Identifier: BSD-3-Clause
"""mesh and upsample: the paper's stages before fitting."""

import unittest

from support import CommandTest, ply_header, png_size


class MeshTest(CommandTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.simulate("scan.pcd")

    def test_the_mesh_is_closed(self):
        report = self.run_json("mesh", "scan.pcd")
        self.assertEqual(report["output"], "scan.mesh.ply")
        self.assertEqual(ply_header(self.path("scan.mesh.ply")),
                         {"vertex": report["vertices"], "face": report["triangles"]})
        self.run_ok("mesh", "scan.pcd", "--ascii", "-o", "ascii.ply")
        lines = self.path("ascii.ply").read_text().split("end_header\n")[1].splitlines()
        faces = [tuple(map(int, line.split()[1:])) for line in lines[report["vertices"]:]]
        self.assertEqual(len(faces), report["triangles"])
        edges = {}
        for a, b, c in faces:
            for edge in [(a, b), (b, c), (c, a)]:
                edges[edge] = edges.get(edge, 0) + 1
        self.assertTrue(all(n == 1 for n in edges.values()))
        self.assertTrue(all((b, a) in edges for a, b in edges))

    def test_obj(self):
        report = self.run_json("mesh", "scan.pcd", "-o", "scan.obj")
        lines = self.path("scan.obj").read_text().splitlines()
        self.assertEqual(sum(line.startswith("v ") for line in lines), report["vertices"])
        self.assertEqual(sum(line.startswith("f ") for line in lines), report["triangles"])

    def test_the_same_mesh_in_text_and_binary(self):
        self.run_ok("mesh", "scan.pcd", "-o", "a.ply", "--ascii")
        self.run_ok("mesh", "scan.pcd", "-o", "b.ply")
        self.assertEqual(ply_header(self.path("a.ply")), ply_header(self.path("b.ply")))
        self.run_ok("convert", "a.ply", "a.bin", "--attributes", "none", "--to-format", "csv")
        self.run_ok("convert", "b.ply", "b.bin", "--attributes", "none", "--to-format", "csv")
        self.assertEqual(self.path("a.bin").read_bytes(), self.path("b.bin").read_bytes())


class UpsampleTest(CommandTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.simulate("scan.pcd")

    def test_sixteen_rings_become_sixty_four_rows(self):
        report = self.run_json("upsample", "scan.pcd", "--rows", 4, "--cols", 1)
        self.assertEqual((report["rows"], report["columns"]), (64, 1024))
        self.assertEqual(report["output"], "scan.upsampled.pcd")
        self.assertGreater(report["points"], 1.5 * report["points_gridded"])
        info = self.run_json("info", "scan.upsampled.pcd")
        self.assertEqual((info["height"], info["width"]), (64, 1024))

    def test_masks_as_pictures(self):
        self.run_ok("upsample", "scan.pcd", "--dump-masks", "masks")
        names = self.files("masks")
        self.assertEqual(names, ["scan.cliff-column.png", "scan.cliff-diagonal.png",
                                 "scan.cliff-row.png", "scan.points.png"])
        for name in names:
            self.assertEqual(png_size(self.path("masks") / name), (1024, 16))


if __name__ == "__main__":
    unittest.main()
