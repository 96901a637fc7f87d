#include "calib/synth/render.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "calib/target/target_geometry.hpp"

namespace raysteer::calib::synth {
namespace {

constexpr int kWidth = 120;
constexpr int kHeight = 96;

Sensor small_sensor() {
  Sensor sensor;
  sensor.camera = {.width = kWidth, .height = kHeight, .fx = 200, .fy = 202, .cx = 61.3, .cy = 46.2};
  sensor.camera.lens = model::LensModel::kBc5;
  sensor.camera.k = {-0.12, 0.06, 1e-3, -8e-4, 0.01};
  return sensor;
}

Lamp small_lamp() {
  Lamp lamp;
  lamp.panel = {.width = 160, .height = 100, .fx = 220, .fy = 221, .cx = 82, .cy = 130};
  lamp.panel.k = {-0.05, 0.01, 5e-4, 3e-4};
  lamp.T_projector_rig.q = Eigen::Quaterniond(Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitY()));
  lamp.T_projector_rig.t = {-0.15, -0.2, 0.02};
  return lamp;
}

Scene wall_at(double z, double albedo = 0.7) {
  model::Pose pose;
  pose.t = {0, 0, z};
  pose.q = Eigen::Quaterniond(Eigen::AngleAxisd(0.2, Eigen::Vector3d(1, 1, 0).normalized()));
  Scene scene;
  scene.plates.push_back(plate(pose, 4, 4, albedo));
  return scene;
}

Pattern constant(PatternKind kind) {
  Pattern pattern;
  pattern.block.kind = kind;
  return pattern;
}

TEST(Render, lit_wall_is_as_bright_as_cosine_and_distance_say) {
  const Scene scene = wall_at(1.3);
  const Sensor sensor = small_sensor();
  const Lamp lamp = small_lamp();
  const View view(scene, sensor, &lamp, 0.05, 1);
  const Image<float> image = view.mean(constant(PatternKind::kWhite));
  const Eigen::Vector3d lamp_place = lamp.T_projector_rig.inverse().t;
  const Eigen::Vector3d normal = scene.plates[0].T_rig_plate.q * Eigen::Vector3d(0, 0, -1);
  int lit = 0;
  for (int y = 2; y < kHeight - 2; y += 5) {
    for (int x = 2; x < kWidth - 2; x += 5) {
      const Eigen::Vector2d& panel = view.truth().x(x, y);
      const bool inside = panel.x() > 4 && panel.y() > 4 && panel.x() < 155 && panel.y() < 95;
      if (!inside) {  // also where there is no coordinate
        continue;
      }
      ++lit;
      const Eigen::Vector3d to_lamp = lamp_place - view.truth().p(x, y);
      const double light = normal.dot(to_lamp) / std::pow(to_lamp.norm(), 3) + 0.05;
      const double expected = sensor.gain * 0.7 * light;
      EXPECT_NEAR(image(x, y), expected, 0.005 * expected) << x << ", " << y;
    }
  }
  EXPECT_GT(lit, 50);
}

TEST(Render, true_panel_coordinate_is_where_the_surface_point_projects) {
  Scene scene = wall_at(1.3);
  model::Pose box;
  box.t = {0.05, 0, 1.1};
  add_box(scene, box, {0.2, 0.1, 0.1}, 0.5);
  scene.balls.push_back({{-0.15, 0.05, 1.1}, 0.08, 0.6});
  const Sensor sensor = small_sensor();
  const Lamp lamp = small_lamp();
  const View view(scene, sensor, &lamp, 0.05, 1);
  int lit = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto q = sensor.camera.project(sensor.T_camera_rig * view.truth().p(x, y));
      ASSERT_TRUE(q.has_value());
      EXPECT_LE((*q - Eigen::Vector2d(x, y)).norm(), 1e-9);
      if (std::isfinite(view.truth().x(x, y).x())) {
        const auto panel = lamp.panel.project(lamp.T_projector_rig * view.truth().p(x, y));
        ASSERT_TRUE(panel.has_value());
        EXPECT_LE((*panel - view.truth().x(x, y)).norm(), 1e-9);
        ++lit;
      }
    }
  }
  EXPECT_GT(lit, kWidth * kHeight / 3);
}

TEST(Render, noise_has_the_variance_of_its_electrons_and_its_electronics) {
  Sensor sensor = small_sensor();
  sensor.electrons_per_dn = 20;
  sensor.read_noise_dn = 1.2;
  sensor.blur_px = 0;
  const View view(wall_at(1.3), sensor, nullptr, 0.7, 1);
  const Pattern white = constant(PatternKind::kWhite);
  const Image<float> mean = view.mean(white);
  double ratio = 0;
  double count = 0;
  for (std::uint32_t k = 0; k < 4; ++k) {
    const Image<std::uint8_t> frame = view.frame<std::uint8_t>(white, {.seed = 5, .frame = k});
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const double dn = mean(x, y);
        const double variance = 1.2 * 1.2 + dn / 20 + 1.0 / 12;
        ratio += (frame(x, y) - dn) * (frame(x, y) - dn) / variance;
        ++count;
      }
    }
  }
  EXPECT_NEAR(ratio / count, 1, 0.03);
}

TEST(Render, bright_light_saturates_and_16_bit_frames_keep_fine_steps) {
  Sensor sensor = small_sensor();
  const Pattern white = constant(PatternKind::kWhite);
  sensor.gain = 4000;
  const View bright(wall_at(1.3), sensor, nullptr, 1, 1);
  EXPECT_EQ(bright.frame<std::uint8_t>(white, {})(60, 48), 255);
  sensor.saturation_dn = 4095;
  sensor.read_noise_dn = 0;
  sensor.electrons_per_dn = 1e12;
  const View deep(wall_at(1.3), sensor, nullptr, 1, 1);
  EXPECT_NEAR(deep.frame<std::uint16_t>(white, {})(60, 48), 2800, 1);
}

TEST(Render, chessboard_corners_lie_where_the_model_projects_them) {
  TargetSpec target{.kind = TargetKind::kChessboard, .columns = 4, .rows = 3, .square_m = 0.06, .dictionary = {}};
  model::Pose pose;
  pose.q = Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, -0.5, 0.1).normalized()));
  pose.t = {-0.09, -0.06, 0.75};
  Scene scene;
  scene.plates.push_back(target_plate(pose, std::make_shared<Print>(target), 0.02));
  Sensor sensor = small_sensor();
  sensor.blur_px = 2;  // so wide that a quadratic follows the saddle
  const View view(scene, sensor, nullptr, 0.7, 1);
  const Image<float> image = view.mean(constant(PatternKind::kWhite));
  for (int id = 0; id < target.corners(); ++id) {
    const auto q = sensor.camera.project(pose * target::corner_position(target, id));
    ASSERT_TRUE(q.has_value());
    // The saddle of a quadratic fitted to the picture about the corner.
    constexpr int kReach = 2;
    const int x0 = static_cast<int>(std::lround(q->x()));
    const int y0 = static_cast<int>(std::lround(q->y()));
    Eigen::MatrixXd A((2 * kReach + 1) * (2 * kReach + 1), 6);
    Eigen::VectorXd grey(A.rows());
    int row = 0;
    for (int dy = -kReach; dy <= kReach; ++dy) {
      for (int dx = -kReach; dx <= kReach; ++dx, ++row) {
        A.row(row) << dx * dx, dx * dy, dy * dy, dx, dy, 1;
        grey[row] = image(x0 + dx, y0 + dy);
      }
    }
    const Eigen::VectorXd c = A.colPivHouseholderQr().solve(grey);
    const Eigen::Matrix2d hessian{{2 * c[0], c[1]}, {c[1], 2 * c[2]}};
    ASSERT_LT(hessian.determinant(), 0) << "corner " << id << " is no saddle";
    const Eigen::Vector2d saddle = Eigen::Vector2d(x0, y0) - hessian.inverse() * Eigen::Vector2d(c[3], c[4]);
    EXPECT_LE((saddle - *q).norm(), 0.06) << "corner " << id;
  }
}

TEST(Render, thing_between_wall_and_projector_throws_a_shadow_and_nothing_else_does) {
  Scene scene = wall_at(1.3);
  const Sensor sensor = small_sensor();
  const Lamp lamp = small_lamp();
  const View without(scene, sensor, &lamp, 0.05, 1);
  // On the line from the lamp to the wall point in the middle of the picture, out of the camera's sight.
  const Eigen::Vector3d lamp_place = lamp.T_projector_rig.inverse().t;
  const Eigen::Vector3d lit = without.truth().p(60, 48);
  scene.balls.push_back({lamp_place + 0.35 * (lit - lamp_place), 0.02, 0.5});
  const View with(scene, sensor, &lamp, 0.05, 1);
  ASSERT_TRUE(std::isfinite(without.truth().x(60, 48).x()));
  EXPECT_FALSE(std::isfinite(with.truth().x(60, 48).x()));
  EXPECT_EQ(with.truth().surface(60, 48), 0) << "the ball must not hide the wall from the camera";
  const Pattern white = constant(PatternKind::kWhite);
  EXPECT_NEAR(with.mean(white)(60, 48), sensor.gain * 0.7 * 0.05, 0.01);

  int shaded = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const Eigen::Vector3d way = without.truth().p(x, y) - lamp_place;
      const Eigen::Vector3d to_ball = scene.balls[0].centre - lamp_place;
      const bool behind = way.cross(to_ball).norm() / way.norm() < scene.balls[0].radius;
      const bool was_lit = std::isfinite(without.truth().x(x, y).x());
      EXPECT_EQ(was_lit && !behind, std::isfinite(with.truth().x(x, y).x())) << x << ", " << y;
      shaded += was_lit && behind ? 1 : 0;
    }
  }
  EXPECT_GT(shaded, 50);
}

TEST(Render, stripes_are_seen_where_the_truth_says_they_are) {
  const Sensor sensor = small_sensor();
  const Lamp lamp = small_lamp();
  const View view(wall_at(1.3), sensor, &lamp, 0.05, 1);
  // A sinusoid decoded from noiseless means: the phase is the panel coordinate, up to the curvature within a footprint.
  PatternBlock block{.kind = PatternKind::kPhase, .axis = Axis::kX, .steps = 8, .period_px = 16};
  const PatternSequence sequence{lamp.panel.width, lamp.panel.height, {block}};
  std::vector<Image<float>> frames;
  for (const Pattern& pattern : sequence.patterns()) {
    frames.push_back(view.mean(pattern));
  }
  int compared = 0;
  for (int y = 3; y < kHeight - 3; ++y) {
    for (int x = 3; x < kWidth - 3; ++x) {
      const Eigen::Vector2d& panel = view.truth().x(x, y);
      if (!(panel.x() > 8 && panel.y() > 8 && panel.x() < 150 && panel.y() < 90)) {
        continue;
      }
      double s = 0;
      double c = 0;
      for (std::size_t k = 0; k < frames.size(); ++k) {
        const double angle = 2 * std::numbers::pi * static_cast<double>(k) / 8;
        s += frames[k](x, y) * std::sin(angle);
        c += frames[k](x, y) * std::cos(angle);
      }
      const double phase_px = 16 * std::atan2(s, c) / (2 * std::numbers::pi);
      EXPECT_NEAR(std::remainder(panel.x() - phase_px, 16), 0, 0.01) << x << ", " << y;
      ++compared;
    }
  }
  EXPECT_GT(compared, 3000);
}

TEST(Render, same_seed_gives_the_same_bytes_whatever_the_threads) {
  const Lamp lamp = small_lamp();
  const View one(wall_at(1.3), small_sensor(), &lamp, 0.05, 1);
  const View two(wall_at(1.3), small_sensor(), &lamp, 0.05, 2);
  const Pattern white = constant(PatternKind::kWhite);
  const NoiseKey key{.seed = 11, .camera = 1, .look = 2, .frame = 3};
  const Image<std::uint8_t> a = one.frame<std::uint8_t>(white, key);
  const Image<std::uint8_t> b = two.frame<std::uint8_t>(white, key);
  EXPECT_TRUE(std::equal(a.data(), a.data() + a.size(), b.data()));
  NoiseKey other = key;
  other.frame = 4;
  const Image<std::uint8_t> c = one.frame<std::uint8_t>(white, other);
  EXPECT_FALSE(std::equal(a.data(), a.data() + a.size(), c.data()));
}

}  // namespace
}  // namespace raysteer::calib::synth
