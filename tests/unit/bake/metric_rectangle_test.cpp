#include "calib/bake/metric_rectangle.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "calib/bake/test_card.hpp"
#include "tests/support/pretend_look.hpp"
#include "tests/support/seed.hpp"

namespace raysteer::calib::bake {
namespace {

TEST(PanelOnPlane, goes_to_the_plane_and_back_with_and_without_a_mirror) {
  std::mt19937_64 random(support::seed());
  std::uniform_real_distribution<double> part(0, 1);
  for (const bool mirrored : {false, true}) {
    const model::PanelOnPlane panel = support::pretend_look(random, mirrored).truth.panel;
    for (int i = 0; i < 50; ++i) {
      const Eigen::Vector2d x(640 * part(random), 400 * part(random));
      const auto p = panel.on_plane(x);
      ASSERT_TRUE(p);
      EXPECT_LT((*panel.on_panel(*p) - x).norm(), 1e-8);
    }
  }
}

TEST(PanelOnPlane, flips_its_picture_in_a_mirror) {
  std::mt19937_64 random(support::seed());
  for (const bool mirrored : {false, true}) {
    const model::PanelOnPlane panel = support::pretend_look(random, mirrored).truth.panel;
    const Eigen::Vector2d origin = *panel.on_plane({320, 200});
    const Eigen::Vector2d right = *panel.on_plane({321, 200}) - origin;
    const Eigen::Vector2d down = *panel.on_plane({320, 201}) - origin;
    EXPECT_EQ(right.x() * down.y() - right.y() * down.x() < 0, mirrored);
  }
}

TEST(FlippedLens, sees_the_mirrored_point_at_the_mirrored_pixel) {
  model::Camera lens{.width = 640, .height = 400, .fx = 900, .fy = 905, .cx = 300, .cy = 420};
  lens.k = {0.05, -0.02, 3e-3, -5e-3};
  const Eigen::Vector2d x = *lens.project({0.2, -0.1, 1.3});
  const Eigen::Vector2d y = *model::flipped(lens).project({-0.2, -0.1, 1.3});
  EXPECT_NEAR(y.x(), 639 - x.x(), 1e-9);
  EXPECT_NEAR(y.y(), x.y(), 1e-9);
}

TEST(LevelRectangle, looks_level_and_upright_to_the_camera) {
  std::mt19937_64 random(support::seed());
  const support::PretendLook look = support::pretend_look(random, false);
  const MetricRectangle rectangle = level_rectangle(look.truth.T_rig_plane, {0.45, 0.1}, 0.5, 0.3125);
  const auto corners = rectangle.corners();
  EXPECT_NEAR((corners[1] - corners[0]).norm(), 0.5, 1e-12);
  EXPECT_NEAR((corners[2] - corners[1]).norm(), 0.3125, 1e-12);
  // A level direction has no part along the camera's y but what the plane's slant brings: none of it across the normal.
  const Eigen::Vector3d along = look.truth.T_rig_plane.q * Eigen::Vector3d(rectangle.along.x(), rectangle.along.y(), 0);
  const Eigen::Vector3d normal = look.truth.T_rig_plane.q * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR(along.dot(normal.cross(Eigen::Vector3d::UnitX())), 0, 1e-12);
  EXPECT_GT(along.x(), 0);
  // Top left is seen left of top right and above bottom left.
  const auto q = [&](int i) { return *support::seen(look, 0, corners[static_cast<std::size_t>(i)]); };
  EXPECT_LT(q(0).x(), q(1).x());
  EXPECT_LT(q(0).y(), q(3).y());
}

TEST(PanelPicture, puts_the_cards_corners_where_they_are_wanted) {
  std::mt19937_64 random(support::seed());
  for (const bool mirrored : {false, true}) {
    const support::PretendLook look = support::pretend_look(random, mirrored);
    const model::PanelOnPlane& panel = look.truth.panel;
    // About 0.5 mm a panel pixel here: a small rectangle, so that all of it is on the panel.
    const Eigen::Vector2d middle = *panel.on_plane({320, 200});
    MetricRectangle rectangle{
        .corner = middle - Eigen::Vector2d(0.2, 0.125), .along = {1, 0}, .width_m = 0.4, .height_m = 0.25};
    const TestCard card{.width_m = 0.4, .height_m = 0.25};
    const auto picture = panel_picture(
        card, [&](const Eigen::Vector2d& x) { return content_at(panel, rectangle, x); }, 640, 400, 1.0);
    // The frame is fully lit: its corner is where half of a pixel's square would be. Walk across the left edge's
    // middle.
    const auto light = [&](const Eigen::Vector2d& content) {
      const Eigen::Vector2d x = *panel.on_panel(rectangle.on_plane(content));
      return static_cast<int>(picture(static_cast<int>(std::lround(x.x())), static_cast<int>(std::lround(x.y()))));
    };
    for (const double v : {0.0625, 0.125, 0.1875}) {
      EXPECT_GT(light({0.002, v}), 230);
      EXPECT_LT(light({-0.003, v}), 30);
      EXPECT_GT(light({0.398, v}), 230);
      EXPECT_LT(light({0.403, v}), 30);
    }
    EXPECT_LT(light({0.0825, 0.0825}), 80);
  }
}

TEST(PanelPicture, takes_the_projectors_gamma_back) {
  const TestCard card;
  const auto ground = [](const Eigen::Vector2d&) { return std::optional(Eigen::Vector2d(0.08, 0.08)); };
  const auto picture = panel_picture(card, ground, 8, 8, 2.2);
  EXPECT_NEAR(std::pow(picture(4, 4) / 255.0, 2.2), card.light({0.08, 0.08}), 0.01);
}

TEST(Unwarped, of_a_projector_that_faces_the_plane_is_right) {
  for (const bool mirrored : {false, true}) {
    model::PanelOnPlane panel;
    panel.lens = {.width = 640, .height = 400, .fx = 900, .fy = 900, .cx = 319.5, .cy = 199.5};
    panel.mirrored = mirrored;
    // Turned by a quarter turn, 1.8 m away: 2 mm a pixel.
    panel.T_projector_plane = {model::rotation_by({0, 0, std::numbers::pi / 2}), {0, 0, 1.8}};
    const MetricRectangle rectangle{.corner = {-0.25, -0.15}, .along = {1, 0}};
    const auto sent = unwarped(panel, rectangle, 0.002);
    ASSERT_TRUE(sent);
    for (const Eigen::Vector2d& corner : rectangle.corners()) {
      EXPECT_LT((*panel.on_plane(sent->on_panel(rectangle.content(corner))) - corner).norm(), 1e-9);
    }
  }
}

}  // namespace
}  // namespace raysteer::calib::bake
