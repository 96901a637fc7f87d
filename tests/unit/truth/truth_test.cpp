#include "sim/rig/truth.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/support/paths.hpp"
#include "tests/support/seed.hpp"

namespace raysteer::sim::rig {
namespace {

proto::board::Board board() {
  std::ifstream stream(support::source_root() / "boards" / "mock-galvo.toml");
  return *proto::board::read_board(std::string(std::istreambuf_iterator<char>(stream), {}), "mock-galvo.toml");
}

TEST(Truth, same_seed_is_the_same_rig_and_another_seed_another) {
  const scene::Scene room;
  EXPECT_EQ(truth_json(*draw_truth(board(), 7), room), truth_json(*draw_truth(board(), 7), room));
  EXPECT_NE(truth_json(*draw_truth(board(), 7), room), truth_json(*draw_truth(board(), 8), room));
}

TEST(Truth, without_tolerance_the_rig_is_as_drawn) {
  proto::board::Board exact = board();
  exact.tolerance = {};
  const Result<Truth> truth = draw_truth(exact, 3);
  ASSERT_TRUE(truth);
  EXPECT_EQ(truth->rig.projector.lens.numbers().focal_px.x(), exact.projector.lens.focal_px);
  EXPECT_EQ(truth->curves[0].gain, 0);
  EXPECT_EQ(truth->curves[1].half_range, exact.mirror.half_range_rad[1]);
}

// Estimates of a standard deviation from n normal draws scatter by 1 / sqrt(2 n): 5 of those are 0.16 with 500 draws.
TEST(Truth, rigs_scatter_by_the_boards_tolerance) {
  const proto::board::Board drawn = board();
  const std::uint64_t first = support::seed();
  constexpr int kRigs = 500;
  double focal = 0;
  double gain = 0;
  double mount = 0;
  for (std::uint64_t k = 0; k < kRigs; ++k) {
    const Result<Truth> truth = draw_truth(drawn, first + k);
    ASSERT_TRUE(truth);
    focal += std::pow(truth->rig.projector.lens.numbers().focal_px.x() / drawn.projector.lens.focal_px - 1, 2);
    gain += std::pow(truth->curves[0].gain, 2);
    mount += std::pow(
        truth->rig.projector.T_projector_rig.translation().x() - drawn.projector.T_projector_rig.translation[0], 2);
  }
  EXPECT_NEAR(std::sqrt(focal / kRigs) / drawn.tolerance.focal, 1, 0.16);
  EXPECT_NEAR(std::sqrt(gain / kRigs) / drawn.tolerance.gain, 1, 0.16);
  EXPECT_NEAR(std::sqrt(mount / kRigs) / drawn.tolerance.mount_m, 1, 0.16);
}

}  // namespace
}  // namespace raysteer::sim::rig
