// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/scenes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <utility>

#include "curlidar/simulate.hpp"

namespace curlidar {

namespace {

struct Entry {
  std::string_view name;
  void (*draw)(scenery::Sketch&, std::uint64_t);
};

constexpr std::array<Entry, 5> kScenes{{{"street", scenery::draw_street},
                                        {"room", scenery::draw_room},
                                        {"forest", scenery::draw_forest},
                                        {"corridor", scenery::draw_corridor},
                                        {"newer-college", scenery::draw_college}}};

}  // namespace

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const Entry& entry : kScenes) names.emplace_back(entry.name);
  return names;
}

Result<std::shared_ptr<const Scene>> make_scene(std::string_view name, std::uint64_t seed) {
  for (const Entry& entry : kScenes) {
    if (entry.name != name) continue;
    scenery::Sketch sketch;
    entry.draw(sketch, seed);
    return std::shared_ptr<const Scene>(std::make_shared<scenery::World>(std::move(sketch)));
  }
  return Error{ErrorCode::not_found, fmt::format("no scene named '{}'; there are {}", name,
                                                 fmt::join(scene_names(), ", "))};
}

}  // namespace curlidar
