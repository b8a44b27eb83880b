#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""records_test.py FOLDER: the decoders of order and attributes, written from docs/format alone, give
what the twins of a folder of golden chunks say."""
import json
import sys
import unittest
from pathlib import Path

from attributes import Attributes
from container import Corrupt, Unsupported
from order import Grid, Order

FOLDER = Path(__file__).resolve().parents[1] / "golden" / "records"


def grid_of(twin):
    occupied = [[flag == "1" for flag in row] for row in twin["occupied"]]
    columns, flat = twin["columns"], twin["range"]
    ranges = [flat[i * columns:(i + 1) * columns] for i in range(len(occupied))] if flat else None
    return Grid(occupied, columns, twin["loose"], ranges, twin["column_shift"])


class RecordsTest(unittest.TestCase):
    def test_twins(self):
        for file in sorted(FOLDER.glob("*.json")):
            with self.subTest(file.stem):
                twin = json.loads(file.read_text("ascii"))
                grid = grid_of(twin["grid"])
                order = Order(bytes.fromhex(twin["order_payload"]), grid)
                self.check_order(order, twin["order"])
                payload = bytes.fromhex(twin["records_payload"])
                self.check_attributes(Attributes(payload, order, grid), twin["attributes"])
                self.check_cuts(bytes.fromhex(twin["order_payload"]), payload, order, grid)

    def check_order(self, order, twin):
        self.assertEqual("".join(map(str, order.kinds)), twin["kinds"])
        for field in ("width", "height", "type", "record", "odd"):
            self.assertEqual(getattr(order, field), twin[field], field)

    def check_attributes(self, decoded, twin):
        self.assertEqual(len(decoded.attributes), len(twin))
        for found, wanted in zip(decoded.attributes, twin):
            head = wanted["name"], wanted["type"], wanted["components"]
            self.assertEqual(found[:3], head)
            self.assertTrue(found[3] == wanted["bits"], f"{wanted['name']} differs")

    def check_cuts(self, order_payload, payload, order, grid):
        for decode in (lambda: Order(order_payload[:-1], grid),
                       lambda: Order(order_payload + b"\0", grid),
                       lambda: Attributes(payload[:-1], order, grid),
                       lambda: Attributes(payload + b"\0", order, grid)):
            with self.assertRaises((Corrupt, Unsupported)):
                decode()


if __name__ == "__main__":
    if len(sys.argv) > 1 and Path(sys.argv[1]).is_dir():
        FOLDER = Path(sys.argv.pop(1))
    unittest.main()
