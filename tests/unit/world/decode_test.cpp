// The decoder on drawn frames: are its errors as large as it says?
#include <gtest/gtest.h>

#include <cmath>

#include "calib/decode/decoder.hpp"
#include "hal/mock/sensor.hpp"
#include "proto/plan/plan.hpp"
#include "sim/optics/light_path.hpp"
#include "tests/support/seed.hpp"
#include "tests/unit/world/small_world.hpp"

namespace raysteer::sim::world {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

TEST(DefaultSequence, decodes_with_the_errors_that_are_predicted) {
  optics::TrueRig rig = rig_named("mock-small");
  optics::TrueCamera& camera = rig.cameras[0];
  optics::LensNumbers numbers = camera.lens.numbers();
  numbers.centre_px -= Vector2d(camera.width / 3.0, camera.height / 3.0);
  camera.lens = optics::Lens(numbers);
  camera.width /= 3;
  camera.height /= 3;
  const Vector3d turn(0.1, -0.15, 0);
  World world(rig, wall(3, 0.6, turn), {.threads = 2});
  const hal::MirrorAngles mirror = mrad(3.003, -2.002);

  const auto sequence = proto::plan::pattern_set("default", rig.projector.width, rig.projector.height);
  ASSERT_TRUE(sequence);
  const Image<float> white = world.draw(exposure(plain(rig, 1), mirror));
  hal::mock::SensorParameters sensor;
  sensor.full_well_e = 1.2 * *std::max_element(white.data(), white.data() + white.size());
  // A camera whose pixels hold ten thousand electrons when the picture's brightest spot nearly fills them.
  const double scale = 10e3 / sensor.full_well_e;
  sensor.full_well_e = 10e3;
  calib::decode::Options options;
  options.read_sigma_dn = sensor.read_noise_e / sensor.full_well_e * 255;
  options.electrons_per_dn = sensor.full_well_e / 255;
  auto decoder = calib::decode::Decoder::make(*sequence, camera.width, camera.height, 8, options);
  ASSERT_TRUE(decoder);
  const std::uint64_t seed = support::seed();
  std::uint64_t frame = 0;
  for (const Pattern& pattern : sequence->patterns()) {
    const bool rows = pattern.block.axis == Axis::kY;
    const auto shown =
        stripes(rig, pattern.block.axis, [&](int i) { return pattern.value(rows ? 0 : i, rows ? i : 0); });
    Image<float> electrons = world.draw(exposure(shown, mirror));
    for (std::size_t i = 0; i < electrons.size(); ++i) {
      electrons.data()[i] *= static_cast<float>(scale);
    }
    const Frame taken = hal::mock::expose(electrons.view(), sensor, 0, seed + ++frame, 2);
    ASSERT_TRUE(decoder->push(std::get<Image<std::uint8_t>>(taken).view()));
  }
  const auto map = decoder->finish();
  ASSERT_TRUE(map);

  const optics::LightPath path(rig, mirror);
  const Vector3d normal = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * Vector3d(0, 0, 1);
  double squares = 0, predicted = 0, whitened = 0;
  double bias[2] = {0, 0};
  int count = 0, gross = 0;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      if (map->mask(x, y) != calib::decode::kValid) {
        continue;
      }
      const Vector3d ray = camera.ray(Vector2d(x, y));
      const Vector3d p = camera.centre() + (Vector3d(0, 0, 3) - camera.centre()).dot(normal) / ray.dot(normal) * ray;
      const auto truth = path.pixel(p);
      ASSERT_TRUE(truth);
      // At the panel's rim blur brings the dark in from outside, in the room as here; no sigma knows of it.
      constexpr double kRim = 8;
      if (truth->x() < kRim || truth->y() < kRim || truth->x() > rig.projector.width - 1 - kRim ||
          truth->y() > rig.projector.height - 1 - kRim) {
        continue;
      }
      for (const auto& [found, variance, wanted] : {std::tuple(map->x(x, y), map->variance_x(x, y), truth->x()),
                                                    {map->y(x, y), map->variance_y(x, y), truth->y()}}) {
        const double error = found - wanted;
        if (std::abs(error) > 1.5) {
          ++gross;
          continue;
        }
        bias[count % 2] += error;
        squares += error * error;
        predicted += variance;
        whitened += error * error / variance;
        ++count;
      }
    }
  }
  ASSERT_GT(count, 10000);
  RecordProperty("rms_px", std::to_string(std::sqrt(squares / count)));
  RecordProperty("predicted_px", std::to_string(std::sqrt(predicted / count)));
  RecordProperty("whitened_rms", std::to_string(std::sqrt(whitened / count)));
  RecordProperty("bias_x_px", std::to_string(2 * bias[0] / count));
  RecordProperty("bias_y_px", std::to_string(2 * bias[1] / count));
  RecordProperty("gross", std::to_string(gross));
  EXPECT_NEAR(std::sqrt(squares / predicted), 1, 0.15);
  EXPECT_LT(gross, count / 1000);
}

}  // namespace
}  // namespace raysteer::sim::world
