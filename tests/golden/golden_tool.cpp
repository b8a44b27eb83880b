// SPDX-License-Identifier: BSD-3-Clause
// What tests/golden/make.py needs beside the command:
//   golden_tool twin FILE.curl                  prints the JSON twin of a compact file
//   golden_tool recode IN.curl OUT.curl CHANGES codes the image of IN once more, with what the JSON
//                                               object CHANGES says: settings that the command
//                                               chooses itself, other rows, other cells
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

#include "compact/ray_chunk.hpp"
#include "compact/scan_encoder.hpp"
#include "golden/twin.hpp"

namespace curlidar {
namespace {

using test::Json;

std::vector<std::byte> read_file(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  const std::vector<char> text{std::istreambuf_iterator<char>(stream), {}};
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

int fail(const std::string& what) {
  std::fprintf(stderr, "golden_tool: %s\n", what.c_str());
  return 1;
}

/// Sets `field` if `changes` names it.
template <typename Field>
void change(const Json& changes, const char* name, Field& field) {
  if (changes.contains(name)) changes.at(name).get_to(field);
}

/// The first rows and columns only, without the cells that `changes` empties.
compact::Image changed_image(const compact::DecodedScan& scan, const Json& changes) {
  compact::Image image{scan.parameters.rows, scan.parameters.columns, {}};
  change(changes, "rows", image.rows);
  change(changes, "columns", image.columns);
  std::vector<std::uint32_t> empty;
  change(changes, "empty_rows", empty);
  std::vector<std::uint32_t> only;
  change(changes, "only_cell", only);
  for (std::uint32_t row = 0; row < image.rows; ++row) {
    for (std::uint32_t column = 0; column < image.columns; ++column) {
      const bool kept = std::find(empty.begin(), empty.end(), row) == empty.end() &&
                        (only.empty() || (only[0] == row && only[1] == column));
      image.range.push_back(kept ? scan.range[std::size_t{row} * scan.parameters.columns + column]
                                 : 0);
    }
  }
  return image;
}

/// Rays as a twin has them, with their shifts: of the rows that there are, or of a frozen table.
void set_rays(compact::RowTable& table, const Json& changes) {
  compact::RayTable& rays = table.rays.emplace();
  change(changes, "slots", rays.slots);
  change(changes, "firings", rays.firings);
  change(changes, "unit", rays.range_unit_q48);
  change(changes, "azimuth_shift", rays.azimuth_shift);
  change(changes, "height_shift", rays.height_shift);
  change(changes, "lateral_shift", rays.lateral_shift);
  change(changes, "phase_shift", rays.phase_shift);
  change(changes, "turn_shift", rays.turn_shift);
  change(changes, "move_shift", rays.move_shift);
  for (const Json& ray : changes.value("rays", Json::array())) {
    rays.rays.push_back({ray[0], ray[1], ray[2], ray[3]});
  }
  if (changes.contains("motion")) {
    const Json& numbers = changes.at("motion");
    compact::Motion& m = rays.motion;
    std::size_t i = 0;
    for (auto* part : {&m.turn, &m.move, &m.turn2, &m.move2, &m.rigid_turn, &m.rigid_move}) {
      numbers.at(i++).get_to(*part);
    }
  }
  table.height.clear();
  table.turn_columns = static_cast<std::uint32_t>(rays.firings.size());
  table.first_column = table.height_shift = 0;
  std::uint32_t frozen = 0;
  change(changes, "table", frozen);
  if (frozen != 0) compact::use_beam_table(frozen, table);
}

compact::RowTable changed_table(compact::RowTable table, const Json& changes) {
  std::size_t rows = table.elevation.size();
  change(changes, "rows", rows);
  table.elevation.resize(rows);
  if (!table.height.empty()) table.height.resize(rows);
  if (!table.range_offset.empty()) table.range_offset.resize(rows);
  change(changes, "elevation", table.elevation);
  change(changes, "height", table.height);
  change(changes, "range_offset", table.range_offset);
  change(changes, "elevation_shift", table.elevation_shift);
  change(changes, "height_shift", table.height_shift);
  change(changes, "offset_shift", table.offset_shift);
  change(changes, "turn_columns", table.turn_columns);
  change(changes, "first_column", table.first_column);
  if (changes.contains("rays")) set_rays(table, changes.at("rays"));
  compact::round_to_shifts(table);
  return table;
}

compact::ScanSettings changed_settings(const compact::ScanParameters& p, const Json& changes) {
  compact::ScanSettings settings;
  settings.steps = {p.step, p.residual_step, p.lattice_q32, p.root_log2, p.smallest_leaf};
  settings.bands = settings.sectors = 1;
  settings.index = false;
  change(changes, "step", settings.steps.step);
  change(changes, "residual_step", settings.steps.residual_step);
  change(changes, "lattice", settings.steps.lattice_q32);
  change(changes, "root_log2", settings.steps.root_log2);
  change(changes, "smallest_leaf", settings.steps.smallest_leaf);
  change(changes, "bands", settings.bands);
  change(changes, "sectors", settings.sectors);
  change(changes, "index", settings.index);
  change(changes, "effort", settings.effort);
  return settings;
}

int recode(const std::string& in, const std::string& out, const Json& changes) {
  const std::vector<std::byte> bytes = read_file(in);
  const Result<PartialContainer> file = read_container_prefix(bytes);
  if (!file) return fail(file.error().message);
  const auto scan = compact::decode_scan(test::chunks_of(file.value()));
  if (!scan) return fail(scan.error().message);
  const auto encoded = compact::encode_scan(changed_image(scan.value(), changes),
                                            changed_table(scan.value().table, changes),
                                            changed_settings(scan.value().parameters, changes));
  if (!encoded) return fail(encoded.error().message);
  const std::vector<std::byte> recoded = test::file_of(encoded.value().chunks);
  std::ofstream stream(out, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(recoded.data()),
               static_cast<std::streamsize>(recoded.size()));
  return stream.flush() ? 0 : fail("cannot write " + out);
}

int twin(const std::string& path) {
  const auto twin = test::twin_of(read_file(path));
  if (!twin) return fail(path + ": " + twin.error().message);
  std::fputs(test::to_text(twin.value()).c_str(), stdout);
  return 0;
}

}  // namespace
}  // namespace curlidar

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.size() == 2 && arguments[0] == "twin") return curlidar::twin(arguments[1]);
  if (arguments.size() == 4 && arguments[0] == "recode") {
    return curlidar::recode(arguments[1], arguments[2], curlidar::test::Json::parse(arguments[3]));
  }
  std::fputs("usage: golden_tool twin FILE.curl | recode IN.curl OUT.curl CHANGES\n", stderr);
  return 2;
}
