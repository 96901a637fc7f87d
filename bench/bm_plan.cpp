// The plan of looks: asked for are 16 of 13 x 13 within a second on one core.
#include <benchmark/benchmark.h>

#include "calib/plan/looks.hpp"
#include "tests/support/drawn_rig.hpp"

namespace {

using namespace raysteer;

void bm_looks_plan(benchmark::State& state, const char* board) {
  const auto rig = support::drawn_rig(board);
  calib::plan::LookOptions options;
  options.looks = static_cast<int>(state.range(0));
  const calib::plan::ScenePlane floor{.normal = Eigen::Vector3d::UnitZ(), .distance_m = support::kFloorDepth};
  for (auto _ : state) {
    benchmark::DoNotOptimize(calib::plan::plan_looks(rig.drawing, rig.cameras, floor, options));
  }
}
BENCHMARK_CAPTURE(bm_looks_plan, galvo, "mock-galvo")->Arg(16)->Arg(25)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_looks_plan, head, "mock-head")->Arg(16)->Arg(25)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
