#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""predicted_test.py: the decoder of this folder gives what the twins of the predicted golden files
say, each scan from the one before."""
import json
import unittest
from pathlib import Path

from container import Corrupt
from predicted import PredictedScan
from scan import Scan

FOLDER = Path(__file__).resolve().parents[1] / "golden" / "predicted"


class PredictedTest(unittest.TestCase):
    def test_scans_come_back_one_from_the_other(self):
        scan = None
        for file in sorted(FOLDER.glob("*.curl")):
            data = file.read_bytes()
            scan = Scan(data) if scan is None else PredictedScan(data, scan)
            twin = json.loads(file.with_suffix(".json").read_text("ascii"))
            rows = range(0, twin["rows"] * twin["columns"], twin["columns"])
            for field in ("field", "range"):
                wanted = [twin[field][at:at + twin["columns"]] for at in rows]
                self.assertTrue(getattr(scan, field) == wanted, f"{file.name}: {field} differs")

    def test_another_reference_is_refused(self):
        first, last = ((FOLDER / f"street-{k}.curl").read_bytes() for k in (0, 2))
        with self.assertRaises(Corrupt):
            PredictedScan(last, Scan(first))


if __name__ == "__main__":
    unittest.main()
