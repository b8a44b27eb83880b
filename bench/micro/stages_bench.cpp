// SPDX-License-Identifier: BSD-3-Clause
// The paper's pipeline on a simulated HDL-64E scan of a street, stage by stage, on one thread.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "curlidar/codec.hpp"
#include "curlidar/compare.hpp"
#include "curlidar/paper.hpp"
#include "curlidar/sensor.hpp"
#include "curlidar/simulate.hpp"

namespace curlidar {
namespace {

/// The value of a Result, or the end of the benchmark with the reason.
template <class T>
T need(Result<T> result) {
  if (!result) {
    std::fprintf(stderr, "curlidar_bench: %s\n", result.error().message.c_str());
    std::exit(1);
  }
  return std::move(*result);
}

const SensorProfile& sensor() {
  static const SensorProfile profile = need(builtin_sensor("hdl64e-kitti"));
  return profile;
}

const Cloud& street() {
  static const Cloud cloud = need(simulate(*need(make_scene("street")), sensor()));
  return cloud;
}

EncodeSettings settings_of(Profile profile) {
  EncodeSettings settings;
  settings.profile = profile;
  settings.paper = for_profile(settings.paper, profile);
  settings.sensor = sensor();
  settings.attributes.emplace();
  return settings;
}

void count_points(benchmark::State& state, std::size_t points) {
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(points));
}

void detect(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(need(detect_sensor(street())));
  count_points(state, street().size());
}
BENCHMARK(detect)->Unit(benchmark::kMillisecond);

void mesh(benchmark::State& state) {
  const EncodeSettings settings = settings_of(Profile::paper);
  for (auto _ : state) benchmark::DoNotOptimize(need(polar_mesh(street(), settings)));
  count_points(state, street().size());
}
BENCHMARK(mesh)->Unit(benchmark::kMillisecond);

void upsample(benchmark::State& state) {
  const EncodeSettings settings = settings_of(Profile::paper);
  for (auto _ : state) benchmark::DoNotOptimize(need(upsample_scan(street(), settings)));
  count_points(state, street().size());
}
BENCHMARK(upsample)->Unit(benchmark::kMillisecond);

/// Also reports the mean time of each of the encoder's stages, milliseconds.
void encode_profile(benchmark::State& state, Profile profile) {
  const EncodeSettings settings = settings_of(profile);
  for (auto _ : state) {
    const Encoded encoded = need(encode(street(), settings));
    for (const StageTime& stage : encoded.report.stages_ms) {
      state.counters[stage.stage + "_ms"].value += stage.ms;
    }
  }
  for (auto& [name, counter] : state.counters) {
    counter.flags = benchmark::Counter::kAvgIterations;
  }
  count_points(state, street().size());
}
BENCHMARK_CAPTURE(encode_profile, paper, Profile::paper)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(encode_profile, paper_1to1, Profile::paper_1to1)->Unit(benchmark::kMillisecond);

void decode_bytes(benchmark::State& state) {
  const Encoded encoded = need(encode(street(), settings_of(Profile::paper)));
  for (auto _ : state) benchmark::DoNotOptimize(need(decode(encoded.bytes)));
  count_points(state, encoded.report.points_coded);
}
BENCHMARK(decode_bytes)->Unit(benchmark::kMillisecond);

void reconstruct_grid(benchmark::State& state) {
  const Encoded encoded = need(encode(street(), settings_of(Profile::paper)));
  const DecodedScan scan = need(decode(encoded.bytes));
  ReconstructSettings settings;
  settings.rows = static_cast<double>(state.range(0));
  settings.columns = static_cast<double>(state.range(1));
  std::size_t points = 0;
  for (auto _ : state) points = need(reconstruct(scan, settings)).size();
  count_points(state, points);
}
BENCHMARK(reconstruct_grid)
    ->ArgNames({"rows", "columns"})
    ->Args({1, 1})
    ->Args({2, 1})
    ->Args({4, 1})
    ->Args({8, 1})
    ->Args({8, 2})
    ->Unit(benchmark::kMillisecond);

void compare_clouds(benchmark::State& state) {
  const Encoded encoded = need(encode(street(), settings_of(Profile::paper)));
  const Cloud back = need(reconstruct(need(decode(encoded.bytes))));
  for (auto _ : state) benchmark::DoNotOptimize(need(compare(street(), back)));
  count_points(state, street().size() + back.size());
}
BENCHMARK(compare_clouds)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace curlidar
