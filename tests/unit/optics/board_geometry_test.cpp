// What the boards' drawings promise: docs of boards/*.toml.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "sim/optics/light_path.hpp"
#include "tests/unit/optics/boards.hpp"

namespace raysteer::sim::optics {
namespace {

constexpr double kFloor = 3.5;

struct Reach {
  Eigen::Array2d least = Eigen::Array2d::Constant(99);
  Eigen::Array2d most = Eigen::Array2d::Constant(-99);
  double slack = 1;
  int cut = 0;
  int seen_by_both = 0;
  int rays = 0;
};

Reach reach(const TrueRig& rig, hal::MirrorAngles angles) {
  const LightPath path(rig, angles);
  Reach reach;
  constexpr int kParts = 8;
  for (int i = 0; i <= kParts; ++i) {
    for (int j = 0; j <= kParts; ++j) {
      const auto out = path.leave(
          {-0.5 + rig.projector.width * i / double{kParts}, -0.5 + rig.projector.height * j / double{kParts}});
      const Eigen::Vector3d p = out->origin + (kFloor - out->origin.z()) / out->direction.z() * out->direction;
      reach.least = reach.least.min(p.head<2>().array());
      reach.most = reach.most.max(p.head<2>().array());
      reach.slack = std::min({reach.slack, out->passage.slack[0], out->passage.slack[1]});
      reach.cut += out->passage.through ? 0 : 1;
      reach.seen_by_both += std::ranges::all_of(rig.cameras, [&](const TrueCamera& camera) {
        const auto q = camera.project(p);
        return q && q->x() > 0 && q->y() > 0 && q->x() < camera.width - 1 && q->y() < camera.height - 1;
      });
      ++reach.rays;
    }
  }
  return reach;
}

TEST(Boards, at_rest_the_whole_panel_reaches_the_floor_within_both_pictures) {
  for (const std::string& name : kBoards) {
    const Reach rest = reach(rig_named(name), {});
    std::printf("%s at rest: x %.2f to %.2f m, y %.2f to %.2f m, least slack %.2f\n", name.c_str(), rest.least.x(),
                rest.most.x(), rest.least.y(), rest.most.y(), rest.slack);
    EXPECT_EQ(rest.cut, 0) << name;
    EXPECT_GT(rest.slack, 0.15) << name;
    EXPECT_EQ(rest.seen_by_both, rest.rays) << name;
    // Throw ratio 2: about 0.95 mm per pixel of 1920 x 1200.
    EXPECT_NEAR(rest.most.x() - rest.least.x(), 1.82, 0.05) << name;
    EXPECT_NEAR(rest.most.y() - rest.least.y(), 1.14, 0.06) << name;
  }
}

TEST(Boards, outlines_cut_corners_only_near_the_range_s_ends) {
  for (const std::string& name : kBoards) {
    const TrueRig rig = rig_named(name);
    const auto range = board_named(name).mirror.most_rad;
    const auto at = [&](double share1, double share2) {
      return reach(rig, {Radians(share1 * range[0]), Radians(share2 * range[1])});
    };
    for (const double i : {-0.5, 0.0, 0.5}) {
      for (const double j : {-0.5, 0.0, 0.5}) {
        EXPECT_EQ(at(i, j).cut, 0) << name << " at " << i << ", " << j;
      }
    }
    int cut = 0;
    int rays = 0;
    Reach all;
    for (const double i : {-1.0, 1.0}) {
      for (const double j : {-1.0, 1.0}) {
        const Reach end = at(i, j);
        cut += end.cut;
        rays += end.rays;
        all.least = all.least.min(end.least);
        all.most = all.most.max(end.most);
      }
    }
    std::printf("%s at the ends: x %.2f to %.2f m, y %.2f to %.2f m, %d %% cut\n", name.c_str(), all.least.x(),
                all.most.x(), all.least.y(), all.most.y(), 100 * cut / rays);
    EXPECT_GT(cut, 0) << name;
    EXPECT_LT(cut, rays / 2) << name;
  }
}

TEST(Boards, the_small_ones_are_the_big_ones_with_wider_pixels) {
  for (const auto& [big, small] : {std::pair{"mock-galvo", "mock-small"}, std::pair{"mock-head", "mock-small-head"}}) {
    const TrueRig a = rig_named(big);
    const TrueRig b = rig_named(small);
    const auto angles = degrees(3, -2);
    const auto from = LightPath(a, angles).leave({403, 811});
    const auto to = LightPath(b, angles).leave({(403 + 0.5) / 4 - 0.5, (811 + 0.5) / 4 - 0.5});
    EXPECT_LT((from->direction - to->direction).norm(), 1e-12);
    EXPECT_LT((from->origin - to->origin).norm(), 1e-12);
    const Eigen::Vector3d p(0.4, -0.3, 3);
    EXPECT_LT(((a.cameras[1].project(p)->array() + 0.5) / 4 - 0.5 - b.cameras[1].project(p)->array()).matrix().norm(),
              1e-9);
  }
}

TEST(RigAsDrawn, refuses_a_board_that_cannot_be) {
  auto board = board_named("mock-galvo");
  board.cameras.pop_back();
  EXPECT_EQ(rig_as_drawn(board).error().rcode, RCode::kBadValue);
  board = board_named("mock-galvo");
  board.cameras[1].lens.distortion[0] = -0.5;
  EXPECT_NE(rig_as_drawn(board).error().note.find("'right'"), std::string::npos);
  board = board_named("mock-head");
  board.mirror.planes[0].normal = board.mirror.planes[0].axis;
  EXPECT_EQ(rig_as_drawn(board).error().rcode, RCode::kBadValue);
  board.mirror.planes.clear();
  EXPECT_EQ(rig_as_drawn(board).error().rcode, RCode::kBadValue);
}

}  // namespace
}  // namespace raysteer::sim::optics
