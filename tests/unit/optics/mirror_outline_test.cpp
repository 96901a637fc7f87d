// The outlines that plans and masks believe in against the pretend rig's, which were written apart.
#include "calib/model/mirror_outline.hpp"

#include <gtest/gtest.h>

#include <random>

#include "sim/optics/light_path.hpp"
#include "tests/support/drawn_rig.hpp"
#include "tests/support/seed.hpp"

namespace raysteer::calib::model {
namespace {

TEST(MirrorOutlines, pass_what_the_pretend_rig_passes) {
  std::mt19937_64 random(support::seed());
  std::uniform_real_distribution<double> some(-1, 1);
  for (const char* board : {"mock-galvo", "mock-head", "mock-small", "mock-small-head"}) {
    const auto rig = support::drawn_rig(board);
    const auto truth = sim::optics::rig_as_drawn(rig.board);
    ASSERT_TRUE(truth);
    int passing = 0;
    int all = 0;
    for (int look = 0; look < 100; ++look) {
      const Eigen::Vector2d angles =
          1.6 * Eigen::Vector2d(some(random), some(random)).cwiseProduct(rig.drawing.projector.most_rad);
      const sim::optics::LightPath path(*truth, {Radians(angles.x()), Radians(angles.y())});
      const MirrorOutlines outlines(rig.drawing.projector, angles);
      for (int i = 0; i < 30; ++i) {
        const Camera& lens = rig.drawing.projector.lens;
        const Eigen::Vector2d x(lens.width * (0.5 + 0.8 * some(random)), lens.height * (0.5 + 0.8 * some(random)));
        const auto out = path.leave(x);
        const double slack = outlines.slack(x);
        passing += outlines.passes(x) ? 1 : 0;
        ++all;
        if (std::abs(slack) > 1e-9) {
          EXPECT_EQ(outlines.passes(x), out->passage.through) << board << ", angles " << angles.transpose();
        }
        if (out->passage.through) {
          EXPECT_NEAR(slack, std::min(out->passage.slack[0], out->passage.slack[1]), 1e-9);
        }
      }
    }
    EXPECT_GT(passing, all / 4) << board;
    EXPECT_LT(passing, all * 99 / 100) << board;
  }
}

TEST(MirrorOutlines, a_mirror_without_a_size_has_no_edge) {
  auto rig = support::drawn_rig("mock-galvo");
  rig.drawing.projector.parts[0].size_m.setZero();
  rig.drawing.projector.parts[1].size_m.setZero();
  EXPECT_EQ(MirrorOutlines(rig.drawing.projector, {0.2, 0.2}).passing_part(), 1);
}

TEST(MirrorOutlines, a_mirror_turned_away_passes_nothing) {
  auto rig = support::drawn_rig("mock-head");
  rig.drawing.projector.parts[0].normal *= -1;
  EXPECT_EQ(MirrorOutlines(rig.drawing.projector, {0, 0}).passing_part(), 0);
}

}  // namespace
}  // namespace raysteer::calib::model
