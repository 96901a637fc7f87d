#include <gtest/gtest.h>

#include "tests/unit/mock/small_rig.hpp"

namespace raysteer::hal::mock {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

TEST(MockRig, takes_a_pair_that_shows_the_white_pattern) {
  const auto rig = small_rig();
  const hal::Rig devices = rig->rig();
  ASSERT_TRUE(devices.mirror.aim({Radians(0.05), Radians(-0.02)}, rig->now()));
  run_for(*rig, milliseconds(30));
  ASSERT_TRUE(devices.projector.load(white_and_black()));
  ASSERT_TRUE(devices.projector.light(true));
  ASSERT_TRUE(devices.projector.show(StoredPattern{0}, rig->now()));
  ASSERT_TRUE(devices.cameras.configure({.exposure = milliseconds(10)}));
  ASSERT_TRUE(devices.cameras.start());
  ASSERT_TRUE(devices.trigger.arm(TriggerSource::kFired));
  run_for(*rig, milliseconds(20));
  const auto presented = devices.projector.presented();
  ASSERT_TRUE(presented && presented->has_value());
  const RigTime light = (*presented)->stamp + 2 * devices.projector.panel().frame_period;
  ASSERT_TRUE(devices.trigger.fire(light + milliseconds(1)));
  run_for(*rig, milliseconds(100));
  auto pair = devices.cameras.next_pair(rig->now());
  ASSERT_TRUE(pair) << pair.error().message();
  ASSERT_TRUE(pair->has_value());
  for (const Eye eye : kEyes) {
    ASSERT_TRUE((*pair)->eye(eye));
    const auto& pixels = std::get<Image<std::uint8_t>>((*pair)->eye(eye)->pixels);
    EXPECT_NEAR(pixels(10, 10), kWhiteCode, 20);
  }
}

}  // namespace
}  // namespace raysteer::hal::mock
