// What a camera sees, against every ray thrown one by one; and what must not change it.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "sim/optics/light_path.hpp"
#include "sim/world/light.hpp"
#include "tests/support/seed.hpp"
#include "tests/unit/world/plates.hpp"

namespace raysteer::sim::world {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using hal::mock::Exposure;

optics::TrueRig small_rig(const std::string& board = "mock-small") {
  optics::TrueRig rig = rig_named(board);
  for (optics::TrueCamera& camera : rig.cameras) {  // the middle of the picture
    optics::LensNumbers numbers = camera.lens.numbers();
    numbers.centre_px -= Vector2d(camera.width / 3.0, camera.height / 3.0);
    camera.lens = optics::Lens(numbers);
    camera.width /= 3;
    camera.height /= 3;
  }
  return rig;
}

/// No value that rounds either way.
double sine(int x) { return 0.49 + 0.48 * std::cos(2 * std::numbers::pi * x / 12); }

/// Throws rays through one pixel: over its square and its lens's blur, and on the panel over the projector's blur.
class OneByOne {
 public:
  OneByOne(const optics::TrueRig& rig, hal::MirrorAngles mirror, const hal::mock::PanelPicture& picture)
      : rig_(rig), path_(rig, mirror), picture_(picture) {}

  double electrons(int x, int y, int rays, std::mt19937_64& random) const {
    const optics::TrueCamera& camera = rig_.cameras[0];
    std::uniform_real_distribution<double> square(-0.5, 0.5);
    std::normal_distribution<double> normal;
    double sum = 0;
    for (int i = 0; i < rays; ++i) {
      const Vector2d q(x + square(random) + camera.blur_px * normal(random),
                       y + square(random) + camera.blur_px * normal(random));
      const Vector3d ray = camera.ray(q);
      const Met met = meet(camera.centre(), ray);
      if (!std::isfinite(met.distance)) {
        continue;
      }
      const Vector3d p = camera.centre() + met.distance * ray;
      Vector3d facing = plates()[met.plate].R().col(2);
      facing *= facing.dot(ray) > 0 ? -1 : 1;
      const auto by = path_.lit_by(p);
      const Vector3d way = path_.centre() - p;
      if (facing.dot(way) <= 0 || !by || !by->passage.through) {
        continue;
      }
      const Vector3d to_mirror = by->origin - p;
      if (meet(p, to_mirror, 1e-6).distance < 1) {
        continue;
      }
      const double blur = projector_blur_px(rig_.projector, by->distance_m * by->off_axis_cosine);
      const int column = static_cast<int>(std::lround(by->x.x() + blur * normal(random)));
      const int row = static_cast<int>(std::lround(by->x.y() + blur * normal(random)));
      if (column < 0 || row < 0 || column >= picture_.width || row >= picture_.height) {
        continue;
      }
      const double lux = panel_intensity(rig_.projector, by->x) * facing.dot(way.normalized()) / way.squaredNorm();
      sum += plates()[met.plate].albedo / std::numbers::pi * electrons_per_luminance(camera, q) * lux *
             picture_.light(column, row) * 0.010;
    }
    return sum / rays;
  }

 private:
  const optics::TrueRig& rig_;
  optics::LightPath path_;
  const hal::mock::PanelPicture& picture_;
};

class Drawing : public testing::TestWithParam<int> {};

TEST_P(Drawing, is_what_rays_thrown_one_by_one_gather) {
  const optics::TrueRig rig = small_rig(GetParam() % 2 == 0 ? "mock-small" : "mock-small-head");
  const hal::MirrorAngles mirror = mrad(5.003, -7.002);
  std::shared_ptr<hal::mock::PanelPicture> shown;
  switch (GetParam() / 2) {
    case 0:
      shown = stripes(rig, Axis::kX, sine);
      break;
    case 1:
      shown = stripes(rig, Axis::kY, [](int y) { return y / 5 % 2; });
      break;
    case 2:
      shown = plain(rig, 1);
      break;
    default:
      shown = picture(rig, [](int x, int y) { return sine(x) * (y / 7 % 2); });
  }
  World world(rig, room_of_plates(), {.threads = 1});
  const Image<float> drawn = world.draw(exposure(shown, mirror));
  const Image<float> white = world.draw(exposure(plain(rig, 1), mirror));
  const OneByOne reference(rig, mirror, *shown);

  std::mt19937_64 random(support::seed());
  std::uniform_int_distribution<int> column(3, rig.cameras[0].width - 4);
  std::uniform_int_distribution<int> row(3, rig.cameras[0].height - 4);
  // At edges, and anywhere.
  double squares[2] = {0, 0}, sum[2] = {0, 0};
  int count[2] = {0, 0};
  constexpr int kRays = 1500;
  while (count[0] < 60 || count[1] < 40) {
    const int x = column(random), y = row(random);
    float least = white(x, y), most = least;
    for (const auto& [dx, dy] : {std::pair(-1, 0), {1, 0}, {0, -1}, {0, 1}}) {
      least = std::min(least, white(x + dx, y + dy));
      most = std::max(most, white(x + dx, y + dy));
    }
    if (most < 50) {
      continue;
    }
    const int kind = least < 0.8F * most ? 1 : 0;
    if (count[kind] >= (kind == 0 ? 60 : 40)) {
      continue;
    }
    const double error = (drawn(x, y) - reference.electrons(x, y, kRays, random)) / most;
    sum[kind] += error;
    squares[kind] += error * error;
    ++count[kind];
  }
  // A reference of 1500 rays scatters by 1.2 % of a pixel that is white or dark by halves.
  RecordProperty("mean_error", std::to_string(sum[0] / count[0]));
  RecordProperty("rms_error", std::to_string(std::sqrt(squares[0] / count[0])));
  RecordProperty("mean_error_at_edges", std::to_string(sum[1] / count[1]));
  RecordProperty("rms_error_at_edges", std::to_string(std::sqrt(squares[1] / count[1])));
  EXPECT_NEAR(sum[0] / count[0], 0, 0.015);
  EXPECT_LT(std::sqrt(squares[0] / count[0]), 0.035);  // stripes 4 camera px apart alias a little in its blur
  EXPECT_NEAR(sum[1] / count[1], 0, 0.025);
  EXPECT_LT(std::sqrt(squares[1] / count[1]), 0.05);
}

INSTANTIATE_TEST_SUITE_P(Pictures, Drawing, testing::Range(0, 8));

bool same(const Image<float>& a, const Image<float>& b) {
  return a.size() == b.size() && std::equal(a.data(), a.data() + a.size(), b.data());
}

TEST(Exposures, give_the_same_bytes_with_one_thread_and_two_and_whatever_was_drawn_before) {
  const optics::TrueRig rig = small_rig();
  const auto shown = stripes(rig, Axis::kX, sine);
  World one(rig, room_of_plates(), {.threads = 1});
  World two(rig, room_of_plates(), {.threads = 2});
  static_cast<void>(two.draw(exposure(shown, mrad(5.0004, -7))));
  static_cast<void>(two.draw(exposure(shown, mrad(30, -7))));
  const Exposure taken = exposure(shown, mrad(5.0012, -7));
  EXPECT_TRUE(same(one.draw(taken), two.draw(taken)));
  EXPECT_TRUE(same(one.draw(taken), one.draw(taken)));
  EXPECT_FALSE(same(one.draw(taken), one.draw(exposure(shown, mrad(5.2, -7)))));
}

TEST(Exposures, add_up_over_spans_torn_rows_and_dark_gaps) {
  const optics::TrueRig rig = small_rig();
  const hal::MirrorAngles mirror = mrad(5, -7);
  World world(rig, room_of_plates(), {.threads = 1});
  const auto shown = stripes(rig, Axis::kY, [](int y) { return y / 5 % 2; });
  const auto other = stripes(rig, Axis::kX, sine);
  const Image<float> a = world.draw(exposure(shown, mirror));
  const Image<float> b = world.draw(exposure(other, mirror));

  Exposure split = exposure(shown, mirror);
  split.light.push_back(split.light[0]);
  split.light[0].end = at_ms(102);
  split.light[1].begin = at_ms(106);  // dark in between
  split.light[1].end = at_ms(109);
  split.light[1].picture = other;
  const Image<float> both = world.draw(split);

  Exposure torn = exposure(shown, mirror);
  torn.light.push_back(torn.light[0]);
  torn.light[0].end_row = 141;
  torn.light[1].first_row = 141;
  const Image<float> mended = world.draw(torn);
  for (std::size_t i = 0; i < both.size(); ++i) {
    // Beside bright edges a camera's blur dips below zero and is cut off there, which does not add up.
    EXPECT_NEAR(both.data()[i], 0.2F * a.data()[i] + 0.3F * b.data()[i], 100 + 1e-4F * both.data()[i]);
    EXPECT_NEAR(mended.data()[i], a.data()[i], 100 + 1e-3F * a.data()[i]);
  }
}

TEST(Mirrors, that_turn_a_little_move_the_picture_as_tracing_anew_would) {
  const optics::TrueRig rig = small_rig();
  World world(rig, wall_and_board(3), {.threads = 1});
  const auto shown = stripes(rig, Axis::kX, sine);
  // 4.9 urad off the grid of traced angles on either side: nearly the same place, from two traced looks.
  const Image<float> above = world.draw(exposure(shown, mrad(5.00499, -7)));
  const Image<float> below = world.draw(exposure(shown, mrad(5.00501, -7)));
  const Image<float> traced = world.draw(exposure(shown, mrad(5, -7)));
  double across = 0, moved = 0, light = 0;
  for (std::size_t i = 0; i < above.size(); ++i) {
    across += std::abs(above.data()[i] - below.data()[i]);
    moved += std::abs(above.data()[i] - traced.data()[i]);
    light += above.data()[i];
  }
  EXPECT_GT(moved, 0.001 * light);
  EXPECT_LT(across, 0.05 * moved);
}

TEST(Drift, moves_the_picture_and_lamp_power_scales_it) {
  const optics::TrueRig rig = small_rig();
  World world(rig, wall(3), {.threads = 1});
  const hal::MirrorAngles mirror = mrad(5, -7);
  const auto shifted = stripes(rig, Axis::kX, [](int x) { return sine(x - 3); });
  Exposure drifted = exposure(stripes(rig, Axis::kX, sine), mirror);
  drifted.light[0].drift = {3, 0};
  drifted.light[0].power = 0.5;
  const Image<float> a = world.draw(drifted);
  const Image<float> b = world.draw(exposure(shifted, mirror));
  int compared = 0;
  for (int y = 40; y < a.height() - 40; y += 5) {
    for (int x = 40; x < a.width() - 40; x += 5) {
      EXPECT_NEAR(a(x, y), 0.5F * b(x, y), 0.002F * b(x, y) + 0.05F);
      ++compared;
    }
  }
  EXPECT_GT(compared, 100);
}

scene::Scene with_walker() {
  scene::Scene room = wall(3);
  scene::Surface walker = surface("walker", scene::rectangle(-0.15, -0.6, 0.15, 0.6), 0.3, {0, 0, 2.2});
  walker.path = {{.time_s = 0, .position = {-6, 0, 0}}, {.time_s = 1.2, .position = {6, 0, 0}}};
  room.surfaces.push_back(walker);
  return room;
}

TEST(Walkers, are_seen_with_their_shadow_and_gone_without_a_trace) {
  const optics::TrueRig rig = small_rig();
  const auto white = plain(rig, 1);
  const auto at = [&](double ms) {
    Exposure taken = exposure(white, mrad(0, 0));
    taken.begin += std::chrono::milliseconds(static_cast<int>(ms) - 100);
    return taken;
  };
  World empty(rig, wall(3), {.threads = 1});
  World walked(rig, with_walker(), {.threads = 1});
  const Image<float> nobody = empty.draw(at(10));
  EXPECT_TRUE(same(nobody, walked.draw(at(10))));
  const Image<float> somebody = walked.draw(at(600));
  EXPECT_TRUE(same(nobody, walked.draw(at(1150))));
  EXPECT_TRUE(same(somebody, walked.draw(at(600))));
  int darker = 0;
  for (std::size_t i = 0; i < nobody.size(); ++i) {
    darker += somebody.data()[i] < 0.7F * nobody.data()[i] ? 1 : 0;
  }
  EXPECT_GT(darker, 1000);
  // The same for who asks about points.
  const auto lit = walked.lit_point(mrad(0, 0), {240, 150}, at_ms(10));
  ASSERT_TRUE(lit);
  EXPECT_EQ(lit->surface, 0U);
  bool hidden = false;
  for (double ms = 560; ms < 660 && !hidden; ms += 2) {
    hidden = !walked.panel_pixel(mrad(0, 0), lit->p, at_ms(ms));
  }
  EXPECT_TRUE(hidden);
}

TEST(Interreflection, is_what_the_lit_wall_sends_to_its_neighbour) {
  const optics::TrueRig rig = small_rig();
  // A wall before the rig, and one that stands up from it on the right: only the first is lit.
  scene::Scene corner = wall(3, 0.7);
  corner.surfaces.push_back(surface("side", scene::rectangle(0, -3, 1.2, 3), 0.5, {0.7, 0, 3}, {0, 1.5707963, 0}));
  World direct(rig, corner, {.threads = 1});
  World bounced(rig, corner, {.threads = 2, .interreflection = true});
  const auto shown = stripes(rig, Axis::kX, [](int x) { return x < 240; });
  const Exposure taken = exposure(shown, mrad(0, 0));
  const Image<float> without = direct.draw(taken);
  const Image<float> with = bounced.draw(taken);

  // The sum over the lit wall, in small pieces, for points of the side wall.
  const optics::TrueCamera& camera = rig.cameras[0];
  const optics::LightPath path(rig, mrad(0, 0));
  int compared = 0;
  for (int y = 20; y < camera.height - 20; y += 12) {
    for (int x = camera.width - 40; x < camera.width - 3; x += 2) {
      const Vector3d ray = camera.ray(Vector2d(x, y));
      const Vector3d p = camera.centre() + (0.7 - camera.centre().x()) / ray.x() * ray;
      if (p.z() > 2.85 || p.z() < 2.2 || without(x, y) > 1) {
        continue;
      }
      double lux = 0;
      constexpr double kPiece = 0.02;
      for (double wall_y = -2; wall_y < 2; wall_y += kPiece) {
        for (double wall_x = -2; wall_x < 0.7; wall_x += kPiece) {
          const Vector3d at(wall_x, wall_y, 3);
          const auto by = path.lit_by(at);
          if (!by || !by->passage.through || by->x.x() < 0 || by->x.x() > 239.5 || by->x.y() < 0 || by->x.y() > 299) {
            continue;
          }
          const Vector3d way = at - p;
          const Vector3d back = path.centre() - at;
          const double arrives = panel_intensity(rig.projector, by->x) * -back.normalized().z() / back.squaredNorm();
          lux += 0.7 / std::numbers::pi * arrives * std::max(0.0, -way.x()) * way.z() / std::pow(way.squaredNorm(), 2) *
                 kPiece * kPiece;
        }
      }
      const double expected = 0.5 / std::numbers::pi * electrons_per_luminance(camera, Vector2d(x, y)) * lux * 0.010;
      EXPECT_NEAR(with(x, y) / expected, 1, 0.1) << x << " " << y;
      ++compared;
    }
  }
  EXPECT_GT(compared, 20);
}

TEST(Room, without_a_surface_is_dark) {
  const optics::TrueRig rig = small_rig();
  World world(rig, {}, {.threads = 2});
  const Image<float> electrons = world.draw(exposure(plain(rig, 1), mrad(0, 0)));
  EXPECT_EQ(*std::max_element(electrons.data(), electrons.data() + electrons.size()), 0);
  EXPECT_FALSE(world.lit_point(mrad(0, 0), {100, 100}));
}

}  // namespace
}  // namespace raysteer::sim::world
