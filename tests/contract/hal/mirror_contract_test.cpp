// What hal/mirror.hpp promises, for every back end.
#include <cmath>
#include <limits>

#include "tests/contract/hal/back_end.hpp"

namespace raysteer::hal {
namespace {

using std::chrono::milliseconds;

class MirrorContract : public Contract {};
INSTANTIATE_TEST_SUITE_P(Every, MirrorContract, testing::ValuesIn(back_ends()), name_of);

constexpr MirrorAngles kLook{Radians(0.05), Radians(-0.03)};

/// Asks once a tick until it is still, for at most two seconds.
Result<bool> wait_until_settled(Bench& bench) {
  for (int tick = 0; tick < 2'000; ++tick) {
    bench.run(milliseconds(1));
    Result<bool> settled = bench.rig().mirror.settled();
    if (!settled || *settled) {
      return settled;
    }
  }
  return false;
}

TEST_P(MirrorContract, commands_nothing_at_first_and_is_not_settled) {
  const auto rig = bench();
  EXPECT_FALSE(rig->rig().mirror.last_commanded());
  rig->run(milliseconds(100));
  EXPECT_FALSE(*rig->rig().mirror.settled());
}

TEST_P(MirrorContract, settles_where_it_was_told_and_says_so) {
  const auto rig = bench();
  Mirror& mirror = rig->rig().mirror;
  ASSERT_OK(mirror.aim(kLook, rig->now()));
  EXPECT_EQ(mirror.last_commanded(), kLook);
  EXPECT_FALSE(*mirror.settled());
  const Result<bool> settled = wait_until_settled(*rig);
  ASSERT_OK(settled);
  ASSERT_TRUE(*settled);
  const auto reading = mirror.feedback();
  ASSERT_OK(reading);
  EXPECT_NEAR(reading->angles.axis1.raw(), kLook.axis1.raw(), mirror.settle_rule().tolerance.raw());
  EXPECT_NEAR(reading->angles.axis2.raw(), kLook.axis2.raw(), mirror.settle_rule().tolerance.raw());
  EXPECT_LE(reading->stamp, rig->now());
}

TEST_P(MirrorContract, is_settled_only_after_the_rules_whole_window) {
  const auto rig = bench();
  Mirror& mirror = rig->rig().mirror;
  ASSERT_OK(mirror.aim(kLook, rig->now()));
  rig->run(std::chrono::seconds(1));  // still for long, but nobody has looked
  const RigTime first = rig->now();
  EXPECT_FALSE(*mirror.settled());
  while (!*mirror.settled()) {
    rig->run(std::chrono::microseconds(500));
    ASSERT_LT(rig->now() - first, std::chrono::seconds(1));
  }
  EXPECT_GE(rig->now() - first, mirror.settle_rule().window);
}

TEST_P(MirrorContract, is_not_settled_before_the_commands_instant) {
  const auto rig = bench();
  Mirror& mirror = rig->rig().mirror;
  ASSERT_OK(mirror.aim(kLook, rig->now()));
  ASSERT_TRUE(*wait_until_settled(*rig));
  ASSERT_OK(mirror.aim(kLook, rig->now() + milliseconds(50)));
  for (int i = 0; i < 49; ++i) {
    EXPECT_FALSE(*mirror.settled());
    rig->run(milliseconds(1));
  }
}

TEST_P(MirrorContract, does_not_move_before_the_commands_instant) {
  const auto rig = bench();
  Mirror& mirror = rig->rig().mirror;
  ASSERT_OK(mirror.aim(kLook, rig->now() + milliseconds(50)));
  rig->run(milliseconds(49));
  EXPECT_NEAR(mirror.feedback()->angles.axis1.raw(), 0, 1e-3);
}

TEST_P(MirrorContract, replaces_a_command_that_has_not_begun) {
  const auto rig = bench();
  Mirror& mirror = rig->rig().mirror;
  ASSERT_OK(mirror.aim(kLook, rig->now() + milliseconds(50)));
  ASSERT_OK(mirror.aim({Radians(-0.05), Radians(0)}, rig->now() + milliseconds(20)));
  rig->run(std::chrono::seconds(1));
  EXPECT_NEAR(mirror.feedback()->angles.axis1.raw(), -0.05, 1e-3);
}

TEST_P(MirrorContract, refuses_angles_outside_its_limits_on_either_axis_and_keeps_its_command) {
  const auto rig = bench();
  Mirror& mirror = rig->rig().mirror;
  ASSERT_OK(mirror.aim(kLook, rig->now()));
  const MirrorLimits limits = mirror.limits();
  const double beyond = 1e-6;
  for (const MirrorAngles bad : {MirrorAngles{limits.most.axis1 + Radians(beyond), Radians(0)},
                                 MirrorAngles{limits.least.axis1 - Radians(beyond), Radians(0)},
                                 MirrorAngles{Radians(0), limits.most.axis2 + Radians(beyond)},
                                 MirrorAngles{Radians(0), limits.least.axis2 - Radians(beyond)}}) {
    EXPECT_REFUSED(mirror.aim(bad, rig->now()), RCode::kMirrorOutOfRange);
    EXPECT_EQ(mirror.last_commanded(), kLook);
  }
  ASSERT_OK(mirror.aim(limits.most, rig->now()));
  ASSERT_OK(mirror.aim(limits.least, rig->now()));
}

TEST_P(MirrorContract, refuses_what_is_not_a_number) {
  const auto rig = bench();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinity, -infinity}) {
    EXPECT_REFUSED(rig->rig().mirror.aim({Radians(bad), Radians(0)}, rig->now()), RCode::kMirrorOutOfRange);
    EXPECT_REFUSED(rig->rig().mirror.aim({Radians(0), Radians(bad)}, rig->now()), RCode::kMirrorOutOfRange);
  }
  EXPECT_FALSE(rig->rig().mirror.last_commanded());
}

TEST_P(MirrorContract, names_axis_value_and_limits_when_it_refuses) {
  const auto rig = bench();
  const Status refused = rig->rig().mirror.aim({Radians(0), Radians(1.5)}, rig->now());
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().note.find("axis 2 asked to 1500.000 mrad"), std::string::npos) << refused.error().note;
}

TEST_P(MirrorContract, refuses_a_late_command_and_says_how_late) {
  const auto rig = bench();
  rig->run(milliseconds(10));
  const Status late = rig->rig().mirror.aim(kLook, rig->now() - milliseconds(3));
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().rcode, RCode::kTooLate);
  EXPECT_EQ(late.error().detail, 3'000'000);
  EXPECT_NE(late.error().note.find("3.000 ms"), std::string::npos) << late.error().note;
  EXPECT_FALSE(rig->rig().mirror.last_commanded());
}

TEST_P(MirrorContract, says_when_the_device_does_not_answer) {
  const auto rig = bench({{.device = "mirror", .what = "unplug"}});
  EXPECT_REFUSED(rig->rig().mirror.aim(kLook, rig->now()), RCode::kDeviceUnavailable);
  EXPECT_REFUSED(rig->rig().mirror.feedback(), RCode::kDeviceUnavailable);
  EXPECT_REFUSED(rig->rig().mirror.settled(), RCode::kDeviceUnavailable);
  EXPECT_FALSE(rig->rig().mirror.last_commanded());
}

TEST_P(MirrorContract, never_passes_nonsense_of_its_sensor_on_as_an_angle) {
  for (const char* nonsense : {"nan", "rail"}) {
    const auto rig = bench({{.device = "mirror", .what = nonsense, .times = 2}});
    EXPECT_REFUSED(rig->rig().mirror.feedback(), RCode::kMirrorSensor);
    EXPECT_REFUSED(rig->rig().mirror.settled(), RCode::kMirrorSensor);
    EXPECT_OK(rig->rig().mirror.feedback());
  }
}

// The spy: what reaches a back end at all.
class SpyMirror final : public Mirror {
 public:
  explicit SpyMirror(const Clock& clock)
      : Mirror(clock, {.least = {Radians(-0.1), Radians(-0.1)}, .most = {Radians(0.1), Radians(0.1)}}, {}) {}
  int aims = 0;
  MirrorReading reading;

 private:
  Status do_aim(MirrorAngles, RigTime) override {
    ++aims;
    return ok();
  }
  Result<MirrorReading> do_feedback() override { return reading; }
};

TEST_P(MirrorContract, lets_no_unsafe_request_reach_a_back_end) {
  const auto rig = bench();
  rig->run(milliseconds(1));
  SpyMirror spy(rig->rig().clock);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(spy.aim({Radians(0.2), Radians(0)}, rig->now()));
  EXPECT_FALSE(spy.aim({Radians(0), Radians(nan)}, rig->now()));
  EXPECT_FALSE(spy.aim({Radians(0), Radians(0)}, rig->now() - kEarlier));
  EXPECT_EQ(spy.aims, 0);
  EXPECT_TRUE(spy.aim({Radians(0.1), Radians(-0.1)}, rig->now()));
  EXPECT_EQ(spy.aims, 1);
}

TEST_P(MirrorContract, begins_its_window_anew_when_a_reading_leaves_the_tolerance) {
  const auto rig = bench();
  SpyMirror spy(rig->rig().clock);
  ASSERT_OK(spy.aim({}, rig->now()));
  const auto read = [&](double angle) {
    spy.reading = {.angles = {Radians(angle), Radians(0)}, .stamp = rig->now()};
    const bool settled = *spy.settled();
    rig->run(std::chrono::microseconds(400));
    return settled;
  };
  EXPECT_FALSE(read(0));
  EXPECT_FALSE(read(90e-6));
  EXPECT_FALSE(read(-110e-6));  // leaves it
  EXPECT_FALSE(read(0));
  EXPECT_FALSE(read(0));
  EXPECT_FALSE(read(0));
  EXPECT_TRUE(read(0));  // 1.2 ms of quiet, the rule asks for 1 ms
}

}  // namespace
}  // namespace raysteer::hal
