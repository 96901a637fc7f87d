#include "host/tour/before_after.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "host/exchange/write_file.hpp"
#include "host/session/image_codec.hpp"
#include "host/tour/canvas.hpp"
#include "host/tour/stroke_font.hpp"

namespace raysteer::host::tour {
namespace {

calib::model::Pose floor_below() {
  // The rig looks straight down on a floor 3.5 m away.
  return {Eigen::Quaterniond::Identity(), {0.2, -0.1, 3.5}};
}

TEST(RoomView, sees_its_aim_in_the_middle_and_right_of_it_to_the_right) {
  const RoomView view{
      .width = 801, .height = 601, .focal_px = 700, .eye = {0, -1, 1}, .look_at = {0, 0, 3}, .up = {0, -1, 0}};
  EXPECT_LT((*view.pixel({0, 0, 3}) - Eigen::Vector2d(400, 300)).norm(), 1e-9);
  EXPECT_GT(view.pixel({0.1, 0, 3})->x(), 400);
  // Up in the picture is the rig's -y: a point at smaller y is above.
  EXPECT_LT(view.pixel({0, -0.1, 3})->y(), 300);
  EXPECT_FALSE(view.pixel({0, -2, -1}));
  // By hand: 0.5 m beside the aim at sqrt(5) m.
  EXPECT_NEAR(view.pixel({0.5, 0, 3})->x(), 400 + 700 * 0.5 / std::sqrt(5.0), 1e-9);
}

TEST(ViewOf, shows_the_whole_rectangle_upright) {
  const calib::bake::MetricRectangle rectangle{.corner = {-0.25, 0.1},
                                               .along = Eigen::Vector2d(0.98, 0.2).normalized()};
  const calib::model::Pose floor = floor_below();
  const RoomView view = view_of(floor, rectangle);
  std::array<Eigen::Vector2d, 4> q;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d p = rectangle.corners()[i];
    q[i] = *view.pixel(floor * Eigen::Vector3d(p.x(), p.y(), 0));
    EXPECT_GT(q[i].x(), 60);
    EXPECT_LT(q[i].x(), view.width - 60);
    EXPECT_GT(q[i].y(), 20);
    EXPECT_LT(q[i].y(), view.height - 60);
  }
  EXPECT_LT(q[0].x(), q[1].x());
  EXPECT_LT(q[0].y(), q[3].y());
}

TEST(BeforeAfter, is_one_picture_of_both_halves_with_rulers_in_place) {
  const calib::bake::MetricRectangle rectangle{.corner = {-0.25, 0.1}, .along = {1, 0}};
  const calib::model::Pose floor = floor_below();
  const RoomView view = view_of(floor, rectangle);
  Image<std::uint8_t> before(view.width, view.height);
  Image<std::uint8_t> after(view.width, view.height);
  before.fill(60);
  after.fill(120);
  const std::string png = before_after_png({before.view(), after.view(), "Before: 35 mm off", "After: 0.42 mm off"},
                                           view, floor, rectangle);
  const auto picture = session::decode_image({reinterpret_cast<const std::uint8_t*>(png.data()), png.size()});
  ASSERT_TRUE(picture) << picture.error().message();
  const auto* grey = std::get_if<Image<std::uint8_t>>(&*picture);
  ASSERT_NE(grey, nullptr);
  EXPECT_EQ(grey->width(), 1600);
  // Floor far from everything drawn; then the ruler's paper between two ticks, 3 cm below the rectangle.
  EXPECT_NEAR((*grey)(5, 5), 66, 8);
  EXPECT_NEAR((*grey)(1595, 5), 124, 8);
  const Eigen::Vector2d p = rectangle.on_plane({0.155, rectangle.height_m + 0.035});
  const Eigen::Vector2d q = *view.pixel(floor * Eigen::Vector3d(p.x(), p.y(), 0));
  EXPECT_GT((*grey)(static_cast<int>(std::lround(q.x())), static_cast<int>(std::lround(q.y()))), 200);
  // RAYSTEER_KEEP=FILE keeps it to look at.
  if (const char* keep = std::getenv("RAYSTEER_KEEP"); keep != nullptr) {
    EXPECT_TRUE(exchange::write_file(keep, png));
  }
}

TEST(StrokeFont, has_every_letter_of_the_captions) {
  for (const char letter :
       std::string_view("Before: sent straight, corners 0123456789 mm off After: baked (at most) cm")) {
    EXPECT_NE(glyph(letter), nullptr) << letter;
  }
  EXPECT_EQ(glyph('\x7f'), nullptr);
}

TEST(Canvas, writes_text_no_wider_than_it_says) {
  Canvas canvas(200, 40, {255, 255, 255});
  canvas.text({20, 30}, "0.42 mm", 14, 1.5, {0, 0, 0});
  const auto last = static_cast<int>(20 + text_width("0.42 mm", 14) + 2);
  bool anything = false;
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 200; ++x) {
      const bool dark = canvas.rgb()[static_cast<std::size_t>(3 * (y * 200 + x))] < 200;
      anything = anything || dark;
      EXPECT_TRUE(!dark || (x >= 18 && x <= last)) << x;
    }
  }
  EXPECT_TRUE(anything);
}

TEST(Canvas, draws_a_line_as_bright_as_it_is_thick) {
  Canvas canvas(40, 40, {0, 0, 0});
  canvas.line({5, 20.3}, {35, 20.3}, 3, {255, 255, 255});
  int light = 0;
  for (int y = 0; y < 40; ++y) {
    light += canvas.rgb()[static_cast<std::size_t>(3 * (y * 40 + 20))];
  }
  EXPECT_NEAR(light / 255.0, 3, 0.02);
}

TEST(Canvas, stays_inside_itself_and_its_clip) {
  Canvas canvas(40, 40, {0, 0, 0});
  canvas.clip(10, 10, 20, 20);
  canvas.line({-1e7, -1e7}, {1e7, 1e7}, 3, {255, 255, 255});
  canvas.fill({Eigen::Vector2d(-1e7, -1e7), {1e7, -1e7}, {1e7, 1e7}, {-1e7, 1e7}}, {9, 9, 9}, 1);
  EXPECT_EQ(canvas.rgb()[static_cast<std::size_t>(3 * (9 * 40 + 9))], 0);
  EXPECT_EQ(canvas.rgb()[static_cast<std::size_t>(3 * (20 * 40 + 20))], 9);
}

}  // namespace
}  // namespace raysteer::host::tour
