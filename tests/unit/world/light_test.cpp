// A flat grey wall against the closed form, written out here by hand: fall-off, cosines, response, lamp, ambient light.
#include "sim/world/light.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/optics/light_path.hpp"
#include "tests/unit/world/small_world.hpp"

namespace raysteer::sim::world {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

/// Lenses without distortion, for which the formulas are those of a textbook.
optics::TrueRig straight(const std::string& board) {
  optics::TrueRig rig = rig_named(board);
  const auto flatten = [](optics::Lens& lens) {
    optics::LensNumbers numbers = lens.numbers();
    numbers.distortion = {};
    lens = optics::Lens(numbers);
  };
  flatten(rig.projector.lens);
  for (optics::TrueCamera& camera : rig.cameras) {
    flatten(camera.lens);
    camera.width /= 2;  // half the view in pixels of the same size: tests also run under sanitizers
    camera.height /= 2;
  }
  return rig;
}

/// Electrons per lux and second of a matt surface, at a pixel.
double per_lux(const optics::TrueCamera& camera, double albedo, int x, int y) {
  const auto& lens = camera.lens.numbers();
  const double tan_x = (x - lens.centre_px.x()) / lens.focal_px.x();
  const double tan_y = (y - lens.centre_px.y()) / lens.focal_px.y();
  const double cosine = 1 / std::sqrt(1 + tan_x * tan_x + tan_y * tan_y);
  const double luminance = albedo / pi;
  const double on_sensor = pi / 4 * luminance / (camera.f_number * camera.f_number) * std::pow(cosine, 4);
  return on_sensor * camera.pixel_m * camera.pixel_m * 0.9 * 9.397e15 * camera.quantum_efficiency;
}

class LightOnAWall : public testing::TestWithParam<const char*> {};

TEST_P(LightOnAWall, is_that_of_the_closed_form) {
  const optics::TrueRig rig = straight(GetParam());
  const hal::MirrorAngles look = mrad(12, -9);
  constexpr double kAlbedo = 0.55;
  const Vector3d turn(0.2, -0.25, 0);
  World world(rig, wall(3, kAlbedo, turn), {.threads = 1});
  auto shown = plain(rig, 0.5);
  for (std::size_t i = 0; i < 256; ++i) {
    shown->response[i] = static_cast<float>(0.01 + 0.99 * std::pow(static_cast<double>(i) / 255, 2.2));
  }
  hal::mock::Exposure taken = exposure(shown, look, hal::Eye::kRight);
  taken.light[0].power = 0.8;
  const Image<float> electrons = world.draw(taken);

  const optics::TrueCamera& camera = rig.cameras[1];
  const optics::LightPath path(rig, look);
  const Vector3d normal = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * Vector3d(0, 0, -1);
  double ratio = 0, worst = 0;
  int count = 0;
  for (int y = 4; y < camera.height - 4; y += 3) {
    for (int x = 4; x < camera.width - 4; x += 3) {
      const Vector3d ray = camera.ray(Eigen::Vector2d(x, y));
      const Vector3d p = camera.centre() + (Vector3d(0, 0, 3) - camera.centre()).dot(normal) / ray.dot(normal) * ray;
      const auto by = path.lit_by(p);
      const bool inside = by && by->passage.through && by->x.x() > 8 && by->x.y() > 8 &&
                          by->x.x() < rig.projector.width - 9 && by->x.y() < rig.projector.height - 9;
      // Where a mirror's outline cuts the picture, the camera's blur mixes.
      if (!inside || by->passage.slack[0] < 0.03 || by->passage.slack[1] < 0.03) {
        continue;
      }
      const Vector3d way = path.centre() - p;
      const double off_axis = by->off_axis_cosine;
      const double lumens = rig.projector.lumens / (rig.projector.width * rig.projector.height);
      const auto focal = rig.projector.lens.numbers().focal_px;
      const double candela = lumens * focal.x() * focal.y() * std::pow(off_axis, rig.projector.fall_off - 3);
      const double lux = candela * normal.dot(way.normalized()) / way.squaredNorm();
      const double code = 128.0 / 255;
      const double light = 0.8 * (0.01 + 0.99 * std::pow(code, 2.2));
      const double expected = per_lux(camera, kAlbedo, x, y) * lux * light * 0.010;
      ratio += electrons(x, y) / expected;
      worst = std::max(worst, std::abs(electrons(x, y) / expected - 1));
      ++count;
    }
  }
  ASSERT_GT(count, 500);
  RecordProperty("mean_ratio", std::to_string(ratio / count));
  RecordProperty("worst", std::to_string(worst));
  EXPECT_NEAR(ratio / count, 1, 0.005);
  EXPECT_LT(worst, 0.01);
}

INSTANTIATE_TEST_SUITE_P(BothMirrors, LightOnAWall, testing::Values("mock-small", "mock-small-head"),
                         [](const auto& each) { return each.index == 0 ? "galvo" : "head"; });

TEST(AmbientLight, flickers_and_needs_no_projector) {
  const optics::TrueRig rig = straight("mock-small");
  scene::Scene room = wall(2, 0.4);
  room.ambient = {.lux = 700, .flicker_hz = 100, .flicker_depth = 0.3};
  World world(rig, std::move(room), {.threads = 1});
  for (const double begin_ms : {0.0, 2.5, 1234.5, 86400e3 + 6.0}) {
    hal::mock::Exposure dark = exposure(nullptr, {});
    dark.begin = at_ms(begin_ms);
    dark.duration = std::chrono::milliseconds(4);
    const Image<float> electrons = world.draw(dark);
    double lux_s = 0;
    for (int i = 0; i < 4000; ++i) {
      lux_s += 700 * (1 + 0.3 * std::sin(2 * pi * 100 * (begin_ms + 1e-3 * (i + 0.5)) * 1e-3)) * 1e-6;
    }
    const int x = 100, y = 90;
    EXPECT_NEAR(electrons(x, y) / (per_lux(rig.cameras[0], 0.4, x, y) * lux_s), 1, 1e-3) << begin_ms << " ms";
  }
}

TEST(Gloss, is_brightest_where_the_wall_mirrors_the_light_and_loses_none) {
  const Vector3d normal(0, 0, 1);
  const Vector3d light = Vector3d(0.3, 0, 1).normalized();
  const Vector3d mirrored(-light.x(), 0, light.z());
  EXPECT_GT(gloss_lobe(0.1, 0.1, normal, light, mirrored),
            2 * gloss_lobe(0.1, 0.1, normal, light, Vector3d(-0.1, 0, 1).normalized()));
  // What leaves, over all directions, is the share that was asked for, when light falls steeply on a narrow lobe.
  double sum = 0;
  constexpr int kSteps = 2000;
  for (int i = 0; i < kSteps; ++i) {
    const double angle = (i + 0.5) / kSteps * pi / 2;
    const Vector3d out(std::sin(angle), 0, std::cos(angle));
    sum += gloss_lobe(0.1, 0.1, normal, normal, out) * std::cos(angle) * 2 * pi * std::sin(angle) * pi / 2 / kSteps;
  }
  EXPECT_NEAR(sum, 0.1, 0.005);
}

TEST(Defocus, is_a_quarter_of_the_blur_disc) {
  const optics::TrueRig rig = rig_named("mock-galvo");
  const optics::TrueProjector& projector = rig.projector;
  EXPECT_NEAR(projector_blur_px(projector, projector.focus_m), kProjectorLensBlurPx, 1e-12);
  const double disc = projector.lens.numbers().focal_px.x() * projector.pupil_m * (1 / 2.0 - 1 / projector.focus_m);
  EXPECT_NEAR(projector_blur_px(projector, 2), std::hypot(kProjectorLensBlurPx, disc / 4), 1e-9);
}

}  // namespace
}  // namespace raysteer::sim::world
