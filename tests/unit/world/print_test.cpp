// Printed corners, read from a drawn picture, against where they truly are; and a person's view.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "sim/world/png.hpp"
#include "tests/unit/world/small_world.hpp"

namespace raysteer::sim::world {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// cornerSubPix, written here: the point to which all gradients around are at right angles (W. Foerstner, E. Guelch,
/// 1987), with a Gaussian window.
Vector2d corner_near(const Image<float>& image, Vector2d at) {
  constexpr int kReach = 4;
  for (int iteration = 0; iteration < 20; ++iteration) {
    Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
    Vector2d moment = Vector2d::Zero();
    const int cx = static_cast<int>(std::lround(at.x()));
    const int cy = static_cast<int>(std::lround(at.y()));
    for (int y = cy - kReach; y <= cy + kReach; ++y) {
      for (int x = cx - kReach; x <= cx + kReach; ++x) {
        const Vector2d gradient(image(x + 1, y) - image(x - 1, y), image(x, y + 1) - image(x, y - 1));
        const Vector2d q(x, y);
        const Eigen::Matrix2d outer = std::exp(-(q - at).squaredNorm() / 8) * gradient * gradient.transpose();
        sum += outer;
        moment += outer * q;
      }
    }
    at = sum.inverse() * moment;
  }
  return at;
}

TEST(PrintedCorners, are_drawn_where_they_are) {
  const optics::TrueRig rig = rig_named("mock-small");
  scene::Scene room = wall(3, 0.5);
  room.ambient.lux = 500;
  scene::Surface board =
      surface("board", scene::rectangle(-0.15, -0.15, 0.95, 0.75), 0.5, {-0.5, -0.3, 1.9}, {0.25, -0.2, 0.12});
  board.material.texture = scene::Texture(scene::Chessboard{.columns = 9, .rows = 7, .square_m = 0.1, .ink = {}});
  room.surfaces.push_back(board);
  World world(rig, room, {.threads = 2});
  double sum_x = 0, sum_y = 0, squares = 0, worst = 0;
  int count = 0;
  for (const hal::Eye eye : hal::kEyes) {
    const Image<float> drawn = world.draw(exposure(nullptr, {}, eye));
    const optics::TrueCamera& camera = rig.cameras[eye == hal::Eye::kLeft ? 0 : 1];
    for (int j = 0; j < 7; ++j) {
      for (int i = 0; i < 9; ++i) {
        const auto truth = camera.project(board.T_room_surface * Vector3d(0.1 * i, 0.1 * j, 0));
        ASSERT_TRUE(truth);
        if (truth->x() < 10 || truth->y() < 10 || truth->x() > camera.width - 11 || truth->y() > camera.height - 11) {
          continue;
        }
        const Vector2d error = corner_near(drawn, *truth) - *truth;
        sum_x += error.x();
        sum_y += error.y();
        squares += error.squaredNorm() / 2;
        worst = std::max(worst, error.norm());
        ++count;
      }
    }
  }
  ASSERT_GT(count, 80);
  RecordProperty("bias_x_px", std::to_string(sum_x / count));
  RecordProperty("bias_y_px", std::to_string(sum_y / count));
  RecordProperty("rms_px", std::to_string(std::sqrt(squares / count)));
  RecordProperty("worst_px", std::to_string(worst));
  EXPECT_NEAR(sum_x / count, 0, 0.01);
  EXPECT_NEAR(sum_y / count, 0, 0.01);
  // What reading corners of a lens this sharp (0.5 px) costs by itself; the squares are 15 px wide and seen aslant.
  EXPECT_LT(std::sqrt(squares / count), 0.05);
  EXPECT_LT(worst, 0.15);
}

TEST(RoomPicture, shows_a_projected_rectangle_where_its_light_lands) {
  const optics::TrueRig rig = rig_named("mock-small");
  scene::Scene room = wall(3, 0.5);
  room.ambient.lux = 100;
  World world(rig, room, {.threads = 2});
  const auto shown = picture(rig, [](int x, int y) { return x >= 150 && x < 330 && y >= 90 && y < 210; });
  const RoomView view{
      .width = 320, .height = 240, .focal_px = 260, .eye = {0.8, -0.6, 0.3}, .look_at = {0.3, 0, 3}, .up = {0, -1, 0}};
  const hal::MirrorAngles mirror = mrad(0, 0);
  const Image<std::uint8_t> seen = world.room_picture(view, exposure(shown, mirror));
  ASSERT_EQ(seen.width(), 320);
  // Just inside the rectangle's rim it is bright, just outside not.
  const auto level = [&](double x, double y) {
    const auto lit = world.lit_point(mirror, {x, y});
    const auto q = lit ? room_pixel(view, lit->p) : std::nullopt;
    return q && q->x() > 0 && q->y() > 0 && q->x() < 319 && q->y() < 239
               ? static_cast<int>(seen(static_cast<int>(std::lround(q->x())), static_cast<int>(std::lround(q->y()))))
               : -1;
  };
  for (const double y : {100.0, 150.0, 200.0}) {
    EXPECT_GT(level(157, y), 200);
    EXPECT_GT(level(322, y), 200);
    EXPECT_LT(level(142, y), 170);
    EXPECT_LT(level(337, y), 170);
    EXPECT_GT(level(142, y), 20);
  }
}

TEST(Png, is_written_whole_or_not_at_all) {
  Image<std::uint8_t> picture(5, 3);
  picture(2, 1) = 200;
  const std::string bytes = to_png(picture.view());
  EXPECT_EQ(bytes.substr(1, 3), "PNG");
  const auto file = std::filesystem::path(testing::TempDir()) / "world_test.png";
  ASSERT_TRUE(save_png(picture.view(), file.string()));
  EXPECT_EQ(std::filesystem::file_size(file), bytes.size());
  std::filesystem::remove(file);
  const auto nowhere = std::filesystem::path(testing::TempDir()) / "no such folder" / "world_test.png";
  const Status refused = save_png(picture.view(), nowhere.string());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().rcode, RCode::kWriteFailed);
}

}  // namespace
}  // namespace raysteer::sim::world
