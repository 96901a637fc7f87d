// How the pretend mirror moves and errs, against closed forms and statistics.
#include <gtest/gtest.h>

#include <cmath>

#include "hal/mock/manual_clock.hpp"
#include "hal/mock/mock_mirror.hpp"
#include "hal/mock/seconds.hpp"
#include "tests/support/seed.hpp"

namespace raysteer::hal::mock {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

/// A mirror without any error or limit but those a test adds.
MirrorParameters ideal() {
  MirrorParameters mirror;
  for (AxisParameters& axis : mirror.axes) {
    axis.dynamics = {.delay_s = 0, .rate = kUnlimited, .acceleration = kUnlimited, .natural = 1'000, .damping = 0.7};
    axis.sensor.noise = 0;
    axis.errors = {
        .repeatability = 0, .hysteresis = 0, .warm_offset = 0, .warm_gain = 0, .room_offset = 0, .room_gain = 0};
    axis.command_step = 0;
  }
  return mirror;
}

struct Rig {
  explicit Rig(const MirrorParameters& parameters, std::uint64_t seed = 1, const Room& room = {},
               std::vector<Fault> faults = {})
      : mirror(clock, parameters, room, seed, Faults(faults, "mirror")) {}
  void run(std::chrono::nanoseconds time, std::chrono::nanoseconds tick = microseconds(100)) {
    for (const RigTime end = clock.now() + time; clock.now() < end;) {
      clock.advance_to(std::min(end, clock.now() + tick));
      mirror.advance(clock.now());
    }
  }
  void aim(double axis1, double axis2 = 0) { ASSERT_TRUE(mirror.aim({Radians(axis1), Radians(axis2)}, clock.now())); }
  double angle1() const { return mirror.true_angles(clock.now()).axis1.raw(); }
  ManualClock clock;
  MockMirror mirror;
};

/// Unit step of x'' = w^2 (1 - x) - 2 z w x'.
double step_response(double w, double z, double t) {
  const double wd = w * std::sqrt(1 - z * z);
  return 1 - std::exp(-z * w * t) * (std::cos(wd * t) + z * w / wd * std::sin(wd * t));
}

TEST(MockMirror, answers_a_step_as_a_second_order_loop_does) {
  for (const double damping : {0.3, 0.7}) {
    MirrorParameters parameters = ideal();
    parameters.axes[0].dynamics.damping = damping;
    parameters.axes[0].dynamics.delay_s = parameters.axes[1].dynamics.delay_s = 300e-6;
    Rig rig(parameters);
    rig.aim(0.1);
    for (int i = 0; i < 60; ++i) {
      rig.run(microseconds(137));
      const RigTime at = rig.clock.now() - microseconds(100);  // the newest whole step is not younger
      const double t = seconds(at) - 300e-6;
      const double angle = rig.mirror.true_angles(at).axis1.raw();
      // Between steps of 0.1 ms positions are interpolated: 1/8 step^2 w^2 of the way at most.
      EXPECT_NEAR(angle, t < 0 ? 0 : 0.1 * step_response(1'000, damping, t), 0.1 * 0.002) << t;
    }
  }
}

TEST(MockMirror, turns_no_faster_than_its_rate_and_arrives_when_it_should) {
  MirrorParameters parameters = ideal();
  parameters.axes[0].dynamics = {.delay_s = 0, .rate = 2, .acceleration = 100, .natural = 2'000, .damping = 1};
  Rig rig(parameters);
  rig.aim(0.2);
  double before = 0;
  double fastest = 0;
  double arrived = 0;
  for (int i = 0; i < 1'500; ++i) {
    rig.run(microseconds(100));
    fastest = std::max(fastest, (rig.angle1() - before) / 100e-6);
    before = rig.angle1();
    if (arrived == 0 && std::abs(before - 0.2) < 1e-4) {
      arrived = seconds(rig.clock.now());
    }
  }
  EXPECT_NEAR(fastest, 2, 0.02);
  // Trapezoid: way / rate + rate / acceleration, and the loop's lag 2 z / w with its tail behind it.
  EXPECT_NEAR(arrived, 0.2 / 2 + 2.0 / 100 + 2 / 2'000.0, 0.003);
  EXPECT_NEAR(before, 0.2, 1e-6);
}

TEST(MockMirror, moves_the_same_however_often_it_is_advanced) {
  const MirrorParameters parameters = *mirror_preset("galvo");
  Rig fine(parameters);
  Rig coarse(parameters);
  fine.aim(0.1, -0.05);
  coarse.aim(0.1, -0.05);
  fine.run(milliseconds(3), microseconds(7));
  coarse.run(milliseconds(3), milliseconds(3));
  for (const auto at : {microseconds(500), microseconds(1'111), microseconds(2'900)}) {
    EXPECT_EQ(fine.mirror.true_angles(RigTime(at)), coarse.mirror.true_angles(RigTime(at)));
  }
}

TEST(MockMirror, rests_where_the_command_curve_says) {
  MirrorParameters parameters = ideal();
  parameters.axes[0].curve = {
      .half_range = 0.2, .gain = 0.02, .quadratic = 0.003, .cubic = -0.004, .cross_talk = 0.001};
  parameters.axes[1].curve.half_range = 0.1;
  Rig rig(parameters);
  rig.aim(0.1, -0.05);
  rig.run(milliseconds(50));
  EXPECT_NEAR(rig.angle1(), 0.2 * (1.02 * 0.5 + 0.003 * 0.25 - 0.004 * 0.125 - 0.001 * 0.5), 1e-9);
  EXPECT_NEAR(rig.mirror.feedback()->angles.axis1.raw(), 0.1, 20e-6) << "the sensor knows nothing of the curve";
}

TEST(MockMirror, rounds_commands_to_its_steps) {
  MirrorParameters parameters = ideal();
  parameters.axes[0].command_step = 1e-3;
  Rig rig(parameters);
  rig.aim(0.0124);
  rig.run(milliseconds(50));
  EXPECT_NEAR(rig.angle1(), 0.012, 1e-9);
}

TEST(MockMirror, stops_at_its_mechanical_stop) {
  MirrorParameters parameters = ideal();
  parameters.axes[0].travel = 0.15;
  Rig rig(parameters);
  rig.aim(0.2);
  rig.run(milliseconds(50));
  EXPECT_DOUBLE_EQ(rig.angle1(), 0.15);
}

TEST(MockMirror, repeats_as_its_preset_says) {
  for (const auto& [preset, wanted] : {std::pair{"head", 20e-6}, std::pair{"galvo", 20e-6}}) {
    MirrorParameters parameters = *mirror_preset(preset);
    for (AxisParameters& axis : parameters.axes) {
      axis.dynamics.rate = axis.dynamics.acceleration = kUnlimited;
      axis.dynamics.natural = 1e4;  // repeatability does not depend on it; the test shall not take long
      axis.dynamics.delay_s = 0;
    }
    Rig rig(parameters, support::seed());
    double sum = 0;
    double squares = 0;
    constexpr int kVisits = 400;
    for (int i = 0; i < kVisits; ++i) {
      rig.aim(i % 2 == 0 ? 0.1 : -0.1);
      rig.run(milliseconds(4), milliseconds(4));
      const MirrorAngles mean = rig.mirror.mean_angles(*rig.mirror.last_commanded(), rig.clock.now());
      const double off = rig.mirror.true_angles(rig.clock.now()).axis2.raw() - mean.axis2.raw();
      sum += off;
      squares += off * off;
    }
    // Five standard deviations of a mean and of a spread of 400 draws.
    EXPECT_NEAR(sum / kVisits, 0, 5 * wanted / std::sqrt(kVisits)) << preset;
    EXPECT_NEAR(std::sqrt(squares / kVisits), wanted, 5 * wanted / std::sqrt(2 * kVisits)) << preset;
  }
}

TEST(MockMirror, rests_to_one_side_or_the_other_by_where_it_came_from) {
  MirrorParameters parameters = ideal();
  parameters.axes[0].errors.hysteresis = 100e-6;
  Rig rig(parameters);
  rig.aim(-0.1);
  rig.run(milliseconds(50));
  rig.aim(0.02);
  rig.run(milliseconds(50));
  EXPECT_NEAR(rig.angle1(), 0.02 + 100e-6, 1e-8);
  rig.aim(0.1);
  rig.run(milliseconds(50));
  rig.aim(0.02);
  rig.run(milliseconds(50));
  EXPECT_NEAR(rig.angle1(), 0.02 - 100e-6, 1e-8);
}

TEST(MockMirror, drifts_as_it_and_the_room_warm_up) {
  MirrorParameters parameters = ideal();
  parameters.axes[0].errors.warm_offset = 100e-6;
  parameters.axes[0].errors.room_offset = 10e-6;
  parameters.axes[0].errors.room_gain = 50e-6;
  parameters.warm_up = {.time_constant_s = 600, .on_before_s = 0};
  Rig rig(parameters, 1, {.trend_k_per_h = 6});
  rig.aim(0.1);
  rig.run(std::chrono::seconds(600), std::chrono::seconds(1));
  // One kelvin in ten minutes.
  const double expected = 100e-6 * (1 - std::exp(-1)) + 10e-6 + 50e-6 * 0.1;
  EXPECT_NEAR(rig.angle1(), 0.1 + expected, parameters.drift_step);
}

TEST(MockMirror, reads_with_the_noise_it_states) {
  MirrorParameters parameters = ideal();
  parameters.axes[0].sensor = {.offset = 30e-6, .gain = 1e-3, .noise = 5e-6, .rail = 1};
  Rig rig(parameters, support::seed());
  rig.aim(0.1);
  rig.run(milliseconds(50));
  double sum = 0;
  double squares = 0;
  constexpr int kReadings = 2'000;
  for (int i = 0; i < kReadings; ++i) {
    const double off = rig.mirror.feedback()->angles.axis1.raw() - (0.1 * 1.001 + 30e-6);
    sum += off;
    squares += off * off;
  }
  EXPECT_NEAR(sum / kReadings, 0, 5 * 5e-6 / std::sqrt(kReadings));
  EXPECT_NEAR(std::sqrt(squares / kReadings), 5e-6, 5 * 5e-6 / std::sqrt(2 * kReadings));
}

TEST(MockMirror, is_the_same_with_the_same_seed_and_another_with_another) {
  const auto rest = [](std::uint64_t seed) {
    Rig rig(*mirror_preset("galvo"), seed);
    rig.aim(0.1);
    rig.run(milliseconds(20));
    return rig.mirror.true_angles(rig.clock.now());
  };
  EXPECT_EQ(rest(1), rest(1));
  EXPECT_NE(rest(1), rest(2));
}

TEST(MockMirror, has_the_faults_it_knows) {
  const auto after = [](const char* what, bool moved) {
    std::vector<Fault> faults{{.device = "mirror", .what = what, .from = RigTime(milliseconds(100))}};
    Rig rig(ideal(), 1, {}, faults);
    rig.run(milliseconds(110));
    if (moved) {
      EXPECT_TRUE(rig.mirror.aim({Radians(0.1), Radians(0)}, rig.clock.now())) << what;
    }
    rig.run(milliseconds(100));
    return rig.mirror.true_angles(rig.clock.now() - milliseconds(3)).axis1.raw();
  };
  EXPECT_NEAR(after("stuck", true), 0, 1e-9);
  EXPECT_NEAR(after("bump", false), 1e-3, 1e-9);
  EXPECT_NEAR(after("sensor", false), 0, 1e-9);
  EXPECT_GT(std::abs(after("ring", false)), 1e-6);
}

TEST(MockMirror, is_so_much_slower_when_its_servo_folds_back) {
  MirrorParameters parameters = ideal();
  parameters.axes[0].dynamics = {.delay_s = 0, .rate = 2, .acceleration = 1e4, .natural = 5'000, .damping = 1};
  const auto reached = [&](std::vector<Fault> faults) {
    Rig rig(parameters, 1, {}, std::move(faults));
    rig.aim(0.2);
    rig.run(milliseconds(20));
    return rig.angle1();
  };
  EXPECT_NEAR(reached({}), 2 * 0.02, 0.002);
  EXPECT_NEAR(reached({{.device = "mirror", .what = "hot", .amount = 4}}), 2 * 0.02 / 4, 0.002);
}

TEST(MockMirror, refuses_so_many_commands_and_then_obeys) {
  Rig rig(ideal(), 1, {}, {{.device = "mirror", .what = "refuse", .times = 2}});
  EXPECT_FALSE(rig.mirror.aim({}, rig.clock.now()));
  EXPECT_FALSE(rig.mirror.aim({}, rig.clock.now()));
  EXPECT_TRUE(rig.mirror.aim({}, rig.clock.now()));
}

TEST(MirrorPreset, suggests_the_nearest_known) {
  const auto none = mirror_preset("galvos");
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().note.find("did you mean 'galvo'"), std::string::npos) << none.error().note;
}

}  // namespace
}  // namespace raysteer::hal::mock
