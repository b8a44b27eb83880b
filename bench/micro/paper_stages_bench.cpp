// SPDX-License-Identifier: BSD-3-Clause
// The stages of the paper's pipeline one by one, single thread. The scan is a simulated HDL-64E
// street, or the file named by CURLIDAR_BENCH_SCAN.
#include <benchmark/benchmark.h>

#include <cstdlib>

#include "codec/field_chunks.hpp"
#include "curlidar/reconstruct.hpp"
#include "curlidar/io.hpp"
#include "curlidar/simulate.hpp"
#include "paper/outliers.hpp"
#include "paper/pipeline.hpp"
#include "paper/raycast.hpp"

namespace {

using namespace curlidar;

const Cloud& scan() {
  static const Cloud cloud = [] {
    if (const char* path = std::getenv("CURLIDAR_BENCH_SCAN")) return read_cloud(path).value();
    return simulate(**make_scene("street"), builtin_sensor("hdl64e-kitti").value()).value();
  }();
  return cloud;
}

const Detection& detection() {
  static const Detection found = detect_sensor(scan()).value();
  return found;
}

const PaperStages& stages() {
  static const PaperStages all = run_stages(scan(), detection(), {}, {}, {});
  return all;
}

EncodeSettings paper_settings() {
  EncodeSettings settings;
  settings.profile = Profile::paper;
  return settings;
}

const DecodedScan& decoded() {
  static const DecodedScan once = decode(encode(scan(), paper_settings())->bytes).value();
  return once;
}

void Detect(benchmark::State& state) {
  const Cloud& cloud = scan();
  for (auto _ : state) benchmark::DoNotOptimize(detect_sensor(cloud));
}
void Outliers(benchmark::State& state) {
  const Cloud& cloud = scan();
  for (auto _ : state) benchmark::DoNotOptimize(find_inliers(cloud, 1, 7));
}
void Project(benchmark::State& state) {
  const Lattice& lattice = stages().image.lattice;
  for (auto _ : state) {
    ProjectionCounts counts;
    benchmark::DoNotOptimize(fill_range_image(scan(), detection().ring_of_point, lattice,
                                              RowRule::uniform, 5, 20, {}, counts));
  }
}
void Mesh(benchmark::State& state) {
  const RangeImage& image = stages().image;
  for (auto _ : state) benchmark::DoNotOptimize(make_polar_mesh(image));
}
void Upsample(benchmark::State& state) {
  const PaperStages& ready = stages();
  for (auto _ : state) {
    benchmark::DoNotOptimize(upsample(ready.image, ready.mesh, ready.masks, 2, 2, 0.1, 1));
  }
}
void Fit(benchmark::State& state) {
  const PaperStages& ready = stages();
  for (auto _ : state) benchmark::DoNotOptimize(fit_patches(ready, {}, 1, {}));
}
void EncodeWhole(benchmark::State& state) {
  const Cloud& cloud = scan();
  for (auto _ : state) benchmark::DoNotOptimize(encode(cloud, paper_settings()));
}
void DecodeFile(benchmark::State& state) {
  const auto bytes = encode(scan(), paper_settings())->bytes;
  for (auto _ : state) benchmark::DoNotOptimize(decode(bytes));
}
void Reconstruct(benchmark::State& state) {
  const double rows = static_cast<double>(state.range(0));
  const DecodedScan& file = decoded();
  std::size_t points = 0;
  for (auto _ : state) points += reconstruct(file, {.rows = rows})->size();
  state.SetItemsProcessed(static_cast<std::int64_t>(points));
}

BENCHMARK(Detect)->Unit(benchmark::kMillisecond);
BENCHMARK(Outliers)->Unit(benchmark::kMillisecond);
BENCHMARK(Project)->Unit(benchmark::kMillisecond);
BENCHMARK(Mesh)->Unit(benchmark::kMillisecond);
BENCHMARK(Upsample)->Unit(benchmark::kMillisecond);
BENCHMARK(Fit)->Unit(benchmark::kMillisecond);
BENCHMARK(EncodeWhole)->Unit(benchmark::kMillisecond);
BENCHMARK(DecodeFile)->Unit(benchmark::kMillisecond);
BENCHMARK(Reconstruct)->Arg(1)->Arg(2)->Arg(4)->Arg(8)->Unit(benchmark::kMillisecond);

}  // namespace
