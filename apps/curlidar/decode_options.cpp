// SPDX-License-Identifier: BSD-3-Clause
#include "decode_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "curlidar/reconstruct.hpp"
#include "decode_plan.hpp"

namespace curlidar::app {
namespace {

void add_point_options(CLI::App& app, DecodeCommand& command) {
  const auto factor = number_in(kLeastFactor, kMostFactor);
  const char* group = "Which points";
  app.add_option("--rows", command.rows,
                 "R_row: factor on the coded grid's rows, may be fractional; default 1")
      ->check(factor)
      ->group(group);
  app.add_option("--cols", command.columns, "R_col: the same for columns; default 1")
      ->check(factor)
      ->group(group);
  app.add_option("--density", command.density,
                 "So many points on every square metre of surface, near or far: gaps are filled, "
                 "what is denser is thinned")
      ->check(number_in(kLeastDensity, kMostDensity))
      ->type_name("POINTS_PER_M2")
      ->group(group);
  app.add_option("--directions", command.directions,
                 "A point for each of these N x 3 directions of any length, in their order, NaN "
                 "where there is none")
      ->type_name("FILE.npy")
      ->group(group);
  app.add_option("--sensor", command.sensor,
                 "The scan as another sensor sees it: a built-in name (see 'curlidar sensors'), or "
                 "a .toml or Ouster .json file")
      ->group(group);
  app.add_flag("--mesh", command.mesh,
               "Triangles between neighbouring points of the grid, cliffs cut: PLY or OBJ, by the "
               "extension of -o or --format")
      ->group(group);
  app.add_flag(
         "--keep-originals", command.keep_originals,
         "All returns of the file first, exactly; invented points only around them. (At 1 x 1 "
         "nothing is invented)")
      ->group(group);
  app.add_flag("--organised,--organized", command.organised,
               "Keep the grid: rows x columns points, NaN where there is none")
      ->group(group);
  app.add_option("--max-points", command.max_points, "Refuse to make more points than this")
      ->capture_default_str()
      ->group(group);
}

void add_belief_options(CLI::App& app, DecodeCommand& command) {
  const char* group = "What is believed";
  app.add_option("--min-confidence", command.min_confidence,
                 "Leave invented points out whose range is within 5 cm with a smaller probability "
                 "than this (strategy best)")
      ->check(number_in(0.0, 1.0))
      ->group(group);
  app.add_option("--strategy", command.strategy,
                 "Between the returns: best, or masks (the file's own: cliffs and gaps of the "
                 "paper); default best, of the paper's profiles masks")
      ->group(group);
  app.add_option("--density-profile", command.density_profile,
                 "What scans of the sensor have taught about the places between its rings: a "
                 "built-in name or a .toml file")
      ->type_name("NAME|FILE")
      ->group(group);
  app.add_flag("--no-masks", command.no_masks,
               "A point wherever one can be guessed, also where no surface is to be believed")
      ->group(group);
  app.add_option(
         "--preset", command.preset,
         fmt::format(
             "sparse: scans of 16 or 32 rings at {:g} rows (--rows 4, 2), "
             "--min-confidence {:g}, --strategy best, returns kept; of 64 rings and more, the "
             "returns alone; options given have the last word",
             kSparseRows, kSparseConfidence))
      ->check(CLI::IsMember({"sparse"}))
      ->group(group);
}

void add_attribute_options(CLI::App& app, DecodeCommand& command) {
  const char* group = "What comes with them";
  app.add_option("--attributes", command.attributes,
                 "Attributes to write: all, none, or names such as intensity,ring")
      ->capture_default_str()
      ->group(group);
  app.add_flag(
         "--confidence", command.confidence,
         "Attribute confidence: probability that the range is within 5 cm (strategy best); of "
         "returns 1")
      ->group(group);
  app.add_flag("--normals", command.normals,
               "Attributes normal_x, normal_y, normal_z of the surface, towards the sensor, NaN "
               "where unknown")
      ->group(group);
  app.add_flag("--original", command.original,
               "Attribute original: 1 of returns, 0 of invented points: of all points of grids and "
               "densities without --keep-originals")
      ->group(group);
}

void add_part_options(CLI::App& app, DecodeCommand& command) {
  const char* group = "Which part of the file";
  app.add_option(
         "--scan", command.scan,
         "Of a sequence: scan K, counted from 0, or scans BEGIN .. END-1; default all, into "
         "a directory")
      ->type_name("K|BEGIN:END")
      ->group(group);
  app.add_option("--rings", command.rings,
                 "Only rings BEGIN .. END-1, 0 the highest (compact files)")
      ->type_name("BEGIN:END")
      ->group(group);
  app.add_option("--azimuth", command.azimuth,
                 "Only azimuths from BEGIN counter-clockwise to END, degrees, 0 ahead (compact "
                 "files)")
      ->type_name("BEGIN:END")
      ->group(group);
  app.add_option("--region", command.region, "Both at once, such as 16:48,-45:45")
      ->type_name("RINGS,AZIMUTHS")
      ->group(group);
  app.add_flag("--field-only", command.field_only,
               "Leave residuals and corrections out (compact files)")
      ->group(group);
  app.add_flag("--allow-truncated", command.allow_truncated,
               "Take files that are cut off as far as they go, with a warning of what is missing")
      ->group(group);
}

}  // namespace

void add_decode_options(CLI::App& app, DecodeCommand& command) {
  app.add_option("inputs", command.inputs, ".curl files; - is standard input")->required();
  app.add_option("-o,--output", command.output,
                 "File, or directory for many inputs or scans; default NAME.decoded.pcd beside the "
                 "input, - is standard output");
  app.add_option("--format", command.format,
                 fmt::format("Format of the output: {}; of --mesh ply, obj; default by extension",
                             kFormatNames));
  app.add_option("--encoding", command.encoding,
                 "ascii, binary, binary_compressed (PCD) or binary_big_endian (PLY)")
      ->capture_default_str();
  add_point_options(app, command);
  add_belief_options(app, command);
  add_attribute_options(app, command);
  add_part_options(app, command);
  add_common_options(app, command.common);
}

}  // namespace curlidar::app
