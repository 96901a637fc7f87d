// bm_sensor: electrons of one 2448 x 2048 frame become 8-bit numbers with shot and read noise: ours by threads, and the
// same arithmetic with the standard library's generator and normal distribution as the baseline.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "hal/mock/sensor.hpp"

namespace {

using namespace raysteer;

Image<float> ramp() {
  Image<float> electrons(2448, 2048);
  for (int y = 0; y < electrons.height(); ++y) {
    for (int x = 0; x < electrons.width(); ++x) {
      electrons(x, y) = static_cast<float>(4 * x);
    }
  }
  return electrons;
}

void bm_sensor_expose(benchmark::State& state) {
  const Image<float> electrons = ramp();
  std::uint64_t key = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        hal::mock::expose(electrons.view(), {.response = {}}, 0, ++key, static_cast<int>(state.range(0))));
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(electrons.size()));
}
BENCHMARK(bm_sensor_expose)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

void bm_sensor_standard_library(benchmark::State& state) {
  const Image<float> electrons = ramp();
  const hal::mock::SensorParameters sensor;
  const auto read = static_cast<float>(sensor.read_noise_e * sensor.read_noise_e);
  const float black = 2;
  const float scale = 253 / static_cast<float>(sensor.full_well_e);
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  for (auto _ : state) {
    Image<std::uint8_t> out = Image<std::uint8_t>::uninitialised(electrons.width(), electrons.height());
    for (std::size_t i = 0; i < out.size(); ++i) {
      const float mean = electrons.data()[i];
      const float noisy = mean + std::sqrt(mean + read) * normal(random);
      out.data()[i] = static_cast<std::uint8_t>(std::clamp(black + scale * noisy + 0.5F, 0.F, 255.F));
    }
    benchmark::DoNotOptimize(out.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(electrons.size()));
}
BENCHMARK(bm_sensor_standard_library)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
