#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the built-in sensor profiles (profiles/*.toml) from calibration files.

    tools/make_profiles.py --calibration DIR [--kitti hdl64e_kitti.npz] [--output profiles]

DIR holds the calibration files of tier4/nebula (Apache-2.0), found in its repository under
nebula_decoders/calibration/{velodyne,hesai}, by their original names. The beam angles in them are
facts of the sensors. The npz holds per-ring arrays T (tangent of the elevation), O (height of the
beam's origin on the spin axis, m), h (sideways offset, m) and c (azimuth offset, degrees), fitted
to KITTI scans; without it profiles/hdl64e-kitti.toml stays as it is. Needs PyYAML, no network.

Conventions. Profiles count azimuth counter-clockwise seen from above, Velodyne and Hesai count
clockwise:
- Velodyne's driver turns a beam to (encoder - rot_correction) clockwise, which is
  +rot_correction counter-clockwise. Its vert_offset_correction is perpendicular to the beam; the
  profile keeps the height where the beam's line meets the spin axis, vert_offset / cos(elevation).
  A positive horiz_offset_correction moves the beam to the left, as in the profile.
- Hesai's azimuth column is added clockwise, so its sign turns.
"""
import argparse
import ast
import csv
import math
import struct
import zipfile
from pathlib import Path

SOURCE = "tier4/nebula (Apache-2.0), {}; beam angles are facts of the sensor"

# name: (file, description, columns in a turn, (fov up, fov down) or None for the outermost rings,
#        (min, max) range in metres)
VELODYNE = {
    "hdl64e-s2": ("calibration_HDL64e_s2.yaml", "Velodyne HDL-64E S2, one unit at 10 Hz", 2083,
                  None, (0.9, 120)),
    "hdl64e-s3": ("calibration_HDL64e_s3.yaml", "Velodyne HDL-64E S3, one unit at 10 Hz", 2083,
                  None, (0.9, 120)),
    "hdl32e": ("calibration_HDL32.yaml", "Velodyne HDL-32E at 10 Hz", 2170, None, (0.9, 120)),
    "vlp16": ("calibration_VLP16.yaml", "Velodyne VLP-16 (Puck) at 10 Hz", 1808, None, (0.4, 130)),
    "vlp32c": ("calibration_VLP32.yaml", "Velodyne VLP-32C (Ultra Puck) at 10 Hz", 1808, None,
               (0.4, 200)),
    "vls128": ("calibration_VLS128.yaml", "Velodyne VLS-128 (Alpha Prime) at 10 Hz", 1876, None,
               (0.4, 300)),
}
HESAI = {
    "pandar40p": ("calibration_Pandar40P.csv", "Hesai Pandar40P at 10 Hz", 1800, None, (0.3, 230)),
    "pandar64": ("calibration_Pandar64.csv", "Hesai Pandar64 at 10 Hz", 1800, None, (0.3, 230)),
    "pandar128": ("calibration_Pandar128E4X.csv", "Hesai Pandar128 E4X at 10 Hz", 1800, None,
                  (0.3, 230)),
    "pandarqt64": ("calibration_PandarQT64.csv", "Hesai PandarQT64 at 10 Hz", 600, None, (0.1, 60)),
    "pandarqt128": ("calibration_PandarQT128.csv", "Hesai QT128 at 10 Hz", 900, None, (0.05, 60)),
    "pandarxt16": ("calibration_PandarXT16.csv", "Hesai PandarXT-16 at 10 Hz", 2000, None,
                   (0.05, 130)),
    "pandarxt32": ("calibration_PandarXT32.csv", "Hesai PandarXT-32 at 10 Hz", 2000, None,
                   (0.05, 130)),
}
# name: (encoder positions of a turn, range unit in metres) where nominal beams are exact, as scans
# that drivers made of them show
LATTICES = {"hdl32e": (36000, 0.002), "pandarxt16": (2000, 0.004)}
# name: (rings, fov up, fov down, description, range)
UNIFORM = {
    f"{model}-{rings}": (rings, half, -half,
                         f"Ouster {model.upper()}-{rings}, evenly over the nominal field of view; "
                         "the unit's metadata is more exact", limits)
    for model, half, limits in (("os0", 45.0, (0.3, 120)), ("os1", 22.5, (0.3, 240)),
                                ("os2", 11.25, (0.8, 480)))
    for rings in (32, 64, 128)
}
UNIFORM["os1-64-gen1"] = (
    64, 17.743, -15.594, "Ouster OS1-64 of the first generation, as in Newer College", (0.3, 120))


def shortest(value, digits=6):
    """A decimal without trailing zeros."""
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def array(key, values, digits=6):
    texts = [shortest(v, digits) for v in values]
    lines = ["  " + ", ".join(texts[i:i + 8]) + "," for i in range(0, len(texts), 8)]
    return "\n".join([f"{key} = [", *lines, "]"])


def write(directory, name, description, source, columns, fov, limits, rings):
    text = [f"# {line}" for line in source]
    text += [f'name = "{name}"', f'description = "{description}"', f"columns = {columns}",
             f"fov_up_deg = {fov[0]!r}", f"fov_down_deg = {fov[1]!r}",
             f"min_range_m = {limits[0]}", f"max_range_m = {limits[1]}"]
    if name in LATTICES:
        slots, unit = LATTICES[name]
        text += [f"slots = {slots}", f"range_unit_m = {unit}"]
    text += ["", "[rings]", rings, ""]
    (directory / f"{name}.toml").write_text("\n".join(text), encoding="utf-8")


def ring_table(rings):
    """The [rings] table of (elevation, azimuth offset, vertical offset, horizontal offset)."""
    keys = ("elevation_deg", "azimuth_offset_deg", "vertical_offset_m", "horizontal_offset_m")
    columns = list(zip(*rings))
    return "\n".join(array(key, column) for i, (key, column) in enumerate(zip(keys, columns))
                     if i == 0 or any(shortest(v) != "0" for v in column))


def top_to_bottom(rings):
    """Sorted by elevation; profiles need strictly descending ones, so ties would be a mistake."""
    rings = sorted(rings, key=lambda ring: -ring[0])
    assert all(float(shortest(a[0])) > float(shortest(b[0])) for a, b in zip(rings, rings[1:]))
    return rings


def velodyne_rings(path):
    import yaml
    rings = []
    for laser in yaml.safe_load(path.read_text())["lasers"]:
        elevation = laser["vert_correction"]
        rings.append((math.degrees(elevation), math.degrees(laser["rot_correction"]),
                      laser.get("vert_offset_correction", 0) / math.cos(elevation),
                      laser.get("horiz_offset_correction", 0)))
    return top_to_bottom(rings)


def hesai_rings(path):
    rows = [row for row in csv.reader(path.read_text().splitlines()[1:]) if len(row) >= 3]
    return top_to_bottom([(float(row[1]), -float(row[2]), 0, 0) for row in rows])


def read_npz(path):
    """Arrays of float64 in a numpy archive, without needing numpy."""
    arrays = {}
    with zipfile.ZipFile(path) as archive:
        for entry in archive.namelist():
            data = archive.read(entry)
            start = 10 + struct.unpack("<H", data[8:10])[0]
            header = ast.literal_eval(data[10:start].decode())
            assert header["descr"] == "<f8" and len(header["shape"]) == 1
            values = struct.unpack(f"<{header['shape'][0]}d", data[start:])
            arrays[entry.removesuffix(".npy")] = values
    return arrays


def write_tables(calibration, directory):
    for kinds, reader in ((VELODYNE, velodyne_rings), (HESAI, hesai_rings)):
        for name, (file, description, columns, fov, limits) in kinds.items():
            rings = reader(calibration / file)
            fov = fov or (float(shortest(rings[0][0])), float(shortest(rings[-1][0])))
            write(directory, name, description, [SOURCE.format(file) + "."], columns, fov, limits,
                  ring_table(rings))


def write_uniform(directory):
    for name, (rings, up, down, description, limits) in UNIFORM.items():
        write(directory, name, description, ["Nominal figures of the manufacturer's data sheet."],
              1024, (up, down), limits, f"uniform = {rings}  # evenly over the field of view")
    # Rows 3, 7, ... 63 of the 64: refined four times, with the last row fixed, they give all 64.
    step = 2 * 16.6 / 63
    write(directory, "superrso16", "16 of the 64 rows of SuperRso, for densification",
          ["Every fourth of 64 rows that lie evenly over +-16.6 degrees; four times as many rows",
           "up from the last one are the 64 again."],
          1024, (16.6 - 3 * step, -16.6), (0, 120), "uniform = 16  # evenly over the field of view")


def write_kitti(path, directory):
    data = read_npz(path)
    rings = top_to_bottom([(math.degrees(math.atan(t)), c, o, h)
                           for t, c, o, h in zip(data["T"], data["c"], data["O"], data["h"])])
    write(directory, "hdl64e-kitti",
          "Velodyne HDL-64E of the KITTI car at 10 Hz, fitted to its scans",
          ["Fitted to KITTI scans (each ring is a cone to a few tenths of a millimetre); azimuth",
           "offsets are known modulo the 0.09 degree step of the encoder. The field of view is the",
           "nominal one of the CURL paper."],
          2083, (2.0, -24.9), (0.9, 120), ring_table(rings))


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--calibration", type=Path, required=True,
                        help="folder of calibration files")
    parser.add_argument("--kitti", type=Path, help="npz with T, O, h and c of KITTI's HDL-64E")
    parser.add_argument("--output", type=Path, default=Path("profiles"))
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    write_tables(options.calibration, options.output)
    write_uniform(options.output)
    if options.kitti:
        write_kitti(options.kitti, options.output)


if __name__ == "__main__":
    main()
