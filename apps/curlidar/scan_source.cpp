// SPDX-License-Identifier: BSD-3-Clause
#include "scan_source.hpp"

#include <fmt/format.h>

#include <utility>

#include "common_scans.hpp"

namespace curlidar::app {

ScanSource::ScanSource(const std::vector<std::string>& inputs, const Settings& settings)
    : settings_(settings) {
  for (const std::string& path : list_scans(inputs)) {
    if (!is_sequence_file(path)) {
      scans_.push_back({path, {}});
      continue;
    }
    const std::size_t count = sequence(path).scans();
    for (std::size_t k = 0; k < count; ++k) scans_.push_back({path, k});
  }
}

ScanSource::~ScanSource() = default;

std::string ScanSource::name(std::size_t index) const {
  const Scan& scan = scans_[index];
  return scan.in_sequence ? fmt::format("{}, scan {}", scan.path, *scan.in_sequence) : scan.path;
}

SequenceFile& ScanSource::sequence(const std::string& path) {
  if (!open_ || open_path_ != path) {
    SequenceReadOptions options;
    options.threads = settings_.threads;
    open_.emplace(need(SequenceFile::open(path, options)));
    open_path_ = path;
  }
  return *open_;
}

Cloud ScanSource::cloud(std::size_t index) {
  const Scan& scan = scans_[index];
  if (!scan.in_sequence) return load_cloud(scan.path, settings_.format);
  return need(reconstruct(need(sequence(scan.path).decode(*scan.in_sequence)), {}));
}

ScanStamp ScanSource::stamp(std::size_t index) {
  const Scan& scan = scans_[index];
  if (!scan.in_sequence) return {};
  return need(sequence(scan.path).scan(*scan.in_sequence)).stamp;
}

bool ScanSource::has_poses() {
  for (std::size_t i = 0; i < size(); ++i) {
    if (!scans_[i].in_sequence || !stamp(i).T_map_sensor) return false;
  }
  return size() > 0;
}

}  // namespace curlidar::app
