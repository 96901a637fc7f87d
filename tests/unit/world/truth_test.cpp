// Where light lands, against planes worked out in double precision.
#include <gtest/gtest.h>

#include <random>

#include "sim/optics/light_path.hpp"
#include "tests/support/seed.hpp"
#include "tests/unit/world/plates.hpp"

namespace raysteer::sim::world {
namespace {

using Eigen::Vector3d;

class LitPoints : public testing::TestWithParam<const char*> {};

TEST_P(LitPoints, lie_on_the_surface_within_ten_micrometres_and_lead_back_to_their_pixel) {
  const optics::TrueRig rig = rig_named(GetParam());
  World world(rig, room_of_plates(), {.threads = 1});
  std::mt19937_64 random(support::seed());
  std::uniform_real_distribution<double> unit(0, 1);
  double worst_m = 0, worst_px = 0;
  int met = 0, compared = 0, hidden = 0;
  for (int look = 0; look < 10; ++look) {
    const hal::MirrorAngles mirror = mrad(-100 + 200 * unit(random), -100 + 200 * unit(random));
    const optics::LightPath path(rig, mirror);
    for (int i = 0; i < 500; ++i) {
      const ProjectorPx x(unit(random) * (rig.projector.width - 1), unit(random) * (rig.projector.height - 1));
      const auto ray = path.leave({x.x, x.y});
      ASSERT_TRUE(ray);
      const auto lit = world.lit_point(mirror, x);
      if (!ray->passage.through) {
        EXPECT_FALSE(lit);
        continue;
      }
      const Met expected = meet(ray->origin, ray->direction);
      if (expected.margin < 1e-5) {
        continue;  // on a rim, either side is right
      }
      EXPECT_EQ(lit.has_value(), std::isfinite(expected.distance));
      if (!lit || !std::isfinite(expected.distance)) {
        continue;
      }
      ++met;
      EXPECT_EQ(lit->surface, expected.plate);
      worst_m = std::max(worst_m, (lit->p - (ray->origin + expected.distance * ray->direction)).norm());
      if (const auto back = world.panel_pixel(mirror, lit->p)) {
        worst_px = std::max(worst_px, std::hypot(back->x - x.x, back->y - x.y));
        ++compared;
      }
      // The same ray goes on: what it would meet behind is in shadow.
      const Vector3d behind = lit->p + 0.05 * ray->direction;
      hidden += world.panel_pixel(mirror, behind) ? 0 : 1;
    }
  }
  ASSERT_GT(met, 3000);
  EXPECT_LE(worst_m, 1e-5);
  EXPECT_LE(worst_px, 1e-6);
  EXPECT_GT(compared, met - met / 100);  // grazing rays may find their own plate in the way
  EXPECT_EQ(hidden, met);
}

INSTANTIATE_TEST_SUITE_P(BothMirrors, LitPoints, testing::Values("mock-galvo", "mock-head"),
                         [](const auto& each) { return each.index == 0 ? "galvo" : "head"; });

}  // namespace
}  // namespace raysteer::sim::world
