// The pretend rig's eyes at full size: tracing a look, and a further pattern.
//
//   bm_world                        # two threads
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include "tests/unit/world/small_world.hpp"

namespace {

using namespace raysteer;
using namespace raysteer::sim::world;

double peak_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

sim::scene::Scene room() {
  sim::scene::Scene room = wall_and_board(3);
  room.ambient = {.lux = 300, .flicker_hz = 100, .flicker_depth = 0.2};
  return room;
}

/// Both eyes of a new look: primary rays, shadow rays and one pattern.
void bm_look_trace(benchmark::State& state) {
  World world(rig_named("mock-galvo"), room(), {.threads = static_cast<int>(state.range(0))});
  const auto shown = stripes(world.rig(), Axis::kX, [](int x) { return x / 8 % 2; });
  world.set_target_pose(-1);
  double angle = 0;
  for (auto _ : state) {
    angle += 1;
    for (const hal::Eye eye : hal::kEyes) {
      benchmark::DoNotOptimize(world.draw(exposure(shown, mrad(angle, 0), eye)));
    }
  }
  state.counters["peak_MB"] = peak_mb();
}
BENCHMARK(bm_look_trace)->Arg(2)->Iterations(3)->Unit(benchmark::kMillisecond)->UseRealTime();

/// The first look: what the cameras see must be traced too.
void bm_first_look_trace(benchmark::State& state) {
  for (auto _ : state) {
    World world(rig_named("mock-galvo"), room(), {.threads = 2});
    benchmark::DoNotOptimize(world.draw(exposure(plain(world.rig(), 1), mrad(3, 0))));
  }
}
BENCHMARK(bm_first_look_trace)->Iterations(2)->Unit(benchmark::kMillisecond)->UseRealTime();

/// One eye, one more pattern at a known look. kinds: 0 Gray, 1 sinusoid, 2 white, 3 a picture.
void bm_pattern_draw(benchmark::State& state) {
  World world(rig_named("mock-galvo"), room(), {.threads = 2});
  const auto& rig = world.rig();
  const auto shown = state.range(0) == 0 ? stripes(rig, Axis::kX, [](int x) { return x / 8 % 2; })
                     : state.range(0) == 1
                         ? stripes(rig, Axis::kY, [](int y) { return 0.5 + 0.5 * std::cos(y * 0.39); })
                     : state.range(0) == 2 ? plain(rig, 1)
                                           : picture(rig, [](int x, int y) { return (x / 40 + y / 40) % 2; });
  const hal::mock::Exposure taken = exposure(shown, mrad(3.001, 0));
  benchmark::DoNotOptimize(world.draw(taken));
  for (auto _ : state) {
    benchmark::DoNotOptimize(world.draw(taken));
  }
  state.counters["peak_MB"] = peak_mb();
}
BENCHMARK(bm_pattern_draw)->DenseRange(0, 3)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
