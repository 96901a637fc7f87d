// What the pretend projectors put on the panel and when it shines.
#include <gtest/gtest.h>

#include <cmath>

#include "hal/mock/panel_picture.hpp"
#include "tests/unit/mock/small_rig.hpp"

namespace raysteer::hal::mock {
namespace {

using std::chrono::milliseconds;

TEST(PanelPicture, holds_patterns_bit_exact) {
  const PatternSequence sequence{
      .panel_width = 64,
      .panel_height = 40,
      .blocks = {{.kind = PatternKind::kWhite},
                 {.kind = PatternKind::kGray, .axis = Axis::kY, .bits = 4, .stripe_px = 3, .inverse = true},
                 {.kind = PatternKind::kPhase, .axis = Axis::kX, .steps = 5, .period_px = 17.3}}};
  for (const Pattern& pattern : sequence.patterns()) {
    const auto picture = pattern_picture(pattern, 64, 40, panel_response(1, 0));
    for (int y = 0; y < 40; ++y) {
      for (int x = 0; x < 64; ++x) {
        ASSERT_EQ(std::lround(255 * picture->light(x, y)), std::lround(255 * pattern.value(x, y)));
      }
    }
  }
}

TEST(PanelPicture, gives_light_by_gamma_above_its_black_level) {
  const auto response = panel_response(2.2, 0.001);
  EXPECT_FLOAT_EQ(response[0], 0.001F);
  EXPECT_FLOAT_EQ(response[255], 1);
  EXPECT_NEAR(response[128], 0.001 + 0.999 * std::pow(128 / 255.0, 2.2), 1e-6);
}

TEST(MockProjector, shines_exactly_its_latency_after_the_vblank) {
  RigParameters parameters = small_parameters();
  parameters.projector.latency_frames = 2.25;
  const auto rig = small_rig(parameters);
  ASSERT_TRUE(rig->projector().load(white_and_black()));
  ASSERT_TRUE(rig->projector().light(true));
  ASSERT_TRUE(rig->projector().show(StoredPattern{0}, RigTime(milliseconds(50))));
  run_for(*rig, milliseconds(200));
  const RigTime vblank = (*rig->projector().presented())->stamp;
  const auto spans = rig->light_between(RigTime{}, RigTime(milliseconds(200)));
  ASSERT_EQ(spans.size(), 2U);
  EXPECT_NEAR(static_cast<double>((spans[1].begin - vblank).count()), 2.25 * 16'666'667, 1);
  EXPECT_GT(spans[1].picture->light(3, 3), 0.99F);
}

TEST(MockProjector, warms_its_lamp_and_moves_its_picture_as_it_states) {
  RigParameters parameters = small_parameters();
  parameters.projector.lamp = {.time_constant_s = 10, .on_before_s = 0};
  parameters.projector.warm_up = {.time_constant_s = 10, .on_before_s = 0};
  parameters.projector.drift_per_k = {0.5, 0};
  parameters.room = {.trend_k_per_h = 360};
  parameters.tick = milliseconds(10);
  const auto rig = small_rig(parameters);
  ASSERT_TRUE(rig->projector().light(true));
  rig->advance_to(RigTime(std::chrono::seconds(10)));
  const auto span = rig->light_between(rig->now() - milliseconds(2), rig->now()).at(0);
  EXPECT_NEAR(span.power, 1 - 0.1 * std::exp(-1), 1e-4);
  EXPECT_NEAR(span.drift.x, 1.5 * (1 - std::exp(-1)) + 0.5 * 1, 0.01);
  EXPECT_NEAR(span.drift.y, -1 * (1 - std::exp(-1)), 0.01);
}

TEST(MasterProjector, lights_each_pattern_for_its_exposure_and_triggers_the_cameras) {
  RigParameters parameters = small_parameters();
  parameters.player = PlayerParameters{};
  const auto rig = small_rig(parameters);
  const hal::Rig devices = rig->rig();
  ASSERT_TRUE(devices.projector.load(white_and_black()));
  ASSERT_TRUE(devices.projector.light(true));
  ASSERT_TRUE(devices.cameras.configure({.exposure = milliseconds(10)}));
  ASSERT_TRUE(devices.cameras.start());
  ASSERT_TRUE(devices.trigger.arm(TriggerSource::kExternal));
  ASSERT_TRUE(devices.player->trigger_output(true));
  ASSERT_TRUE(devices.player->play({.first = 0, .count = 2, .exposure = milliseconds(11), .period = milliseconds(30)}));
  run_for(*rig, milliseconds(150));
  EXPECT_EQ(*devices.trigger.count(), 2U);
  const auto white = devices.cameras.next_pair(rig->now());
  const auto black = devices.cameras.next_pair(rig->now());
  ASSERT_TRUE(white && *white && (*white)->left && black && *black && (*black)->left);
  EXPECT_NEAR(std::get<0>((*white)->left->pixels)(5, 5), kWhiteCode, 20);
  EXPECT_LT(std::get<0>((*black)->left->pixels)(5, 5), 8);
}

}  // namespace
}  // namespace raysteer::hal::mock
