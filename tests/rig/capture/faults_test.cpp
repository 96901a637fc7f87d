// Faults of the rig during a capture (rows A 11, B 17 to 21, C 22 to 33 of the fault table): what is done, what is
// said, and how fast.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/rig/capture/capture_bench.hpp"

namespace raysteer::support {
namespace {

using firmware::capture::State;

/// One bad thing that a capture copes with.
struct Coped {
  const char* name;
  const char* device;
  const char* what;
  double amount;
  RCode rcode;       ///< why the shot is taken again
  double noticed_s;  ///< at most so long after the fault
  bool display_only = false;
};

// By then a capture is among its patterns; a trigger-master, which needs no latency measured, sooner.
constexpr double kAmongPatterns = 3;
double among_patterns(Kind kind) { return kind == Kind::kDisplay ? kAmongPatterns : 1.5; }

class CopedFault : public testing::TestWithParam<std::tuple<Kind, Coped>> {};

const std::array kCoped{
    Coped{"frame_dropped", "left", "drop", 0, RCode::kShotIncomplete, 0.4},
    Coped{"eye_missed_its_edge", "right", "miss", 0, RCode::kShotIncomplete, 0.4},
    Coped{"frame_arrives_late", "right", "late", 0.25, RCode::kShotIncomplete, 0.4},
    Coped{"stamp_off", "left", "stamp", 5e-3, RCode::kShotApart, 0.3},
    Coped{"edge_missing", "trigger", "miss", 0, RCode::kTriggerEdgeMissing, 0.4},
    Coped{"edge_bounces", "trigger", "double", 0, RCode::kTriggerEdgeExtra, 0.3},
    Coped{"frame_damaged", "left", "damage", 0, RCode::kShotDamaged, 0.3},
    Coped{"automatic_exposure", "right", "auto", 0, RCode::kAutomaticExposure, 0.4},
    Coped{"frame_black", "left", "black", 0, RCode::kWrongPattern, 3},
    Coped{"frame_flashed", "right", "bright", 0, RCode::kWrongPattern, 3},
    Coped{"flip_late", "projector", "late", 0, RCode::kFlipLate, 0.3, true},
    Coped{"first_frame_not_lit", "projector", "drop", 0, RCode::kWrongPattern, 3, true},
    Coped{"picture_torn", "projector", "tear", 0.5, RCode::kWrongPattern, 3, true},
};

INSTANTIATE_TEST_SUITE_P(All, CopedFault,
                         testing::Combine(testing::Values(Kind::kDisplay, Kind::kTriggerMaster),
                                          testing::ValuesIn(kCoped)),
                         [](const auto& one) {
                           return std::string(std::get<1>(one.param).name) +
                                  (std::get<0>(one.param) == Kind::kDisplay ? "_display" : "_trigger_master");
                         });

TEST_P(CopedFault, is_said_and_the_shot_taken_again) {
  const auto& [kind, coped] = GetParam();
  if (coped.display_only && kind == Kind::kTriggerMaster) {
    return;  // a trigger-master has no vblanks to miss
  }
  CaptureBench bench(kind);
  const double at_s = among_patterns(kind);
  bench.fault(coped.device, coped.what, at_s, 1, coped.amount);
  ASSERT_TRUE(bench.make());
  const double noticed = bench.run_to("capture.retake");
  ASSERT_GE(noticed, at_s) << bench.story();
  EXPECT_LT(noticed, at_s + coped.noticed_s) << bench.story();
  EXPECT_TRUE(bench.said("code=" + to_string(coped.rcode))) << bench.story();
  ASSERT_EQ(bench.run(), State::kDone) << bench.story();
  EXPECT_GE(bench.capture->findings().retakes.at(coped.rcode), 1);
  EXPECT_EQ(bench.memory.finished->shots.size(), static_cast<std::size_t>(bench.sequence.frames()));
  // What is kept is what an undisturbed capture would have kept, but for noise.
  CaptureBench sound(kind);
  ASSERT_TRUE(sound.make());
  ASSERT_EQ(sound.run(), State::kDone);
  ASSERT_EQ(sound.capture->findings().exposure, bench.capture->findings().exposure);
  for (const auto& [key, pair] : bench.memory.shots) {
    for (const hal::Eye eye : hal::kEyes) {
      const auto& seen = std::get<Image<std::uint8_t>>(pair.eye(eye)->pixels);
      const auto& wanted = std::get<Image<std::uint8_t>>(sound.memory.shots.at(key).eye(eye)->pixels);
      double difference = 0;
      for (std::size_t i = 0; i < seen.size(); ++i) {
        difference += std::abs(seen.data()[i] - wanted.data()[i]);
      }
      EXPECT_LT(difference / static_cast<double>(seen.size()), 4) << key.second;
    }
  }
}

/// One bad thing that ends a capture.
struct Ending {
  const char* name;
  const char* device;
  const char* what;
  double at_s;
  int times;  ///< 0: for ever
  double amount;
  RCode rcode;
  double ended_s;  ///< at most so long after the fault
  bool display_only = false;
};

class EndingFault : public testing::TestWithParam<std::tuple<Kind, Ending>> {};

const std::array kEndings{
    Ending{"camera_unplugged", "left", "unplug", kAmongPatterns, 1, 0, RCode::kDeviceUnavailable, 0.1},
    Ending{"interlock_opens", "interlock", "open", kAmongPatterns, 1, 0, RCode::kInterlockOpen, 0.0011},
    Ending{"interlock_unreadable", "interlock", "unplug", kAmongPatterns, 1, 0, RCode::kDeviceUnavailable, 0.0011},
    Ending{"projector_unplugged", "projector", "unplug", kAmongPatterns, 1, 0, RCode::kDeviceUnavailable, 0.1},
    Ending{"trigger_unplugged", "trigger", "unplug", kAmongPatterns, 1, 0, RCode::kDeviceUnavailable, 0.0011},
    Ending{"no_edge_comes", "trigger", "miss", kAmongPatterns, 0, 0, RCode::kTriggerEdgeMissing, 30},
    Ending{"no_edge_ever_came", "trigger", "miss", 0, 0, 0, RCode::kTriggerEdgeMissing, 30},
    Ending{"mirror_stuck", "mirror", "stuck", 0, 1, 0, RCode::kMirrorNotSettled, 0.6},
    Ending{"mirror_rings", "mirror", "ring", 0, 1, 2e-3, RCode::kMirrorNotSettled, 0.6},
    Ending{"mirror_sensor_nan", "mirror", "nan", 0, 1, 0, RCode::kMirrorSensor, 0.1},
    Ending{"lamp_off", "projector", "lamp-off", 0, 1, 0, RCode::kNothingLit, 10},
    Ending{"wrong_screen", "projector", "wrong-screen", 0, 1, 0, RCode::kNothingLit, 10},
    Ending{"out_of_focus", "right", "blur", 0, 1, 35, RCode::kOutOfFocus, 20},
    Ending{"exposure_ignored", "left", "ignore", 0, 1, 0, RCode::kCameraSettings, 0.1},
    Ending{"bus_too_narrow", "cameras", "bandwidth", 0, 1, 1e-5, RCode::kBandwidth, 0.1},
    Ending{"display_always_late", "projector", "late", kAmongPatterns, 0, 0, RCode::kFlipLate, 20, true},
};

INSTANTIATE_TEST_SUITE_P(All, EndingFault,
                         testing::Combine(testing::Values(Kind::kDisplay, Kind::kTriggerMaster),
                                          testing::ValuesIn(kEndings)),
                         [](const auto& one) {
                           return std::string(std::get<1>(one.param).name) +
                                  (std::get<0>(one.param) == Kind::kDisplay ? "_display" : "_trigger_master");
                         });

TEST_P(EndingFault, ends_the_capture_with_its_code_light_off_and_nothing_lost) {
  const auto& [kind, ending] = GetParam();
  if (ending.display_only && kind == Kind::kTriggerMaster) {
    return;
  }
  CaptureBench bench(kind);
  const double at_s = ending.at_s > 0 ? among_patterns(kind) : 0;
  bench.fault(ending.device, ending.what, at_s, ending.times, ending.amount);
  ASSERT_TRUE(bench.make());
  ASSERT_EQ(bench.run(), State::kFailed) << bench.story();
  EXPECT_EQ(bench.capture->error()->rcode, ending.rcode) << bench.story();
  EXPECT_LE(bench.seconds(), at_s + ending.ended_s) << bench.story();
  EXPECT_TRUE(bench.said("capture.failed code=" + to_string(ending.rcode))) << bench.story();
  EXPECT_FALSE(bench.rig->projector().light_is_on());
  EXPECT_FALSE(bench.memory.finished);
  ASSERT_TRUE(bench.memory.kept);
  EXPECT_EQ(bench.memory.kept->shots.size(), bench.memory.shots.size());
  EXPECT_EQ(bench.capture->progress().shots_done, static_cast<int>(bench.memory.shots.size()));
}

class CaptureFault : public testing::TestWithParam<Kind> {};

INSTANTIATE_TEST_SUITE_P(Both, CaptureFault, testing::Values(Kind::kDisplay, Kind::kTriggerMaster),
                         [](const auto& one) {
                           return std::string(one.param == Kind::kDisplay ? "display" : "trigger_master");
                         });

TEST_P(CaptureFault, unplugged_camera_that_comes_back_costs_no_verified_shot) {
  CaptureBench bench(GetParam());
  bench.fault("left", "unplug", among_patterns(GetParam()), 1, 0.5);
  ASSERT_TRUE(bench.make());
  ASSERT_EQ(bench.run(), State::kFailed) << bench.story();
  const int taken = bench.capture->progress().shots_done;
  EXPECT_GT(taken, 5);
  bench.now += std::chrono::seconds(1);
  bench.rig->advance_to(bench.now);
  bench.capture->go_on(bench.now);
  ASSERT_EQ(bench.run(), State::kDone) << bench.story();
  EXPECT_EQ(bench.memory.puts, bench.sequence.frames());
}

TEST_P(CaptureFault, swapped_cameras_are_refused) {
  CaptureBench bench(GetParam());
  bench.parameters.cameras.bound = {"one", "two"};
  bench.fault("cameras", "swap", 0);
  ASSERT_TRUE(bench.make());
  ASSERT_EQ(bench.run(), State::kFailed);
  EXPECT_EQ(bench.capture->error()->rcode, RCode::kCameraSerial);
}

TEST_P(CaptureFault, frames_that_nobody_triggered_are_thrown_away) {
  CaptureBench bench(GetParam());
  bench.fault("left", "extra", 0, 0);
  bench.fault("right", "extra", 0, 1);
  ASSERT_TRUE(bench.make());
  ASSERT_EQ(bench.run(), State::kDone) << bench.story();
  EXPECT_GE(bench.capture->findings().extra_frames, 2);
  EXPECT_TRUE(bench.capture->findings().retakes.empty()) << bench.story();
}

TEST_P(CaptureFault, step_of_the_wall_clock_changes_nothing) {
  CaptureBench bench(GetParam());
  bench.fault("clock", "step", among_patterns(GetParam()), 1, -3'600);
  ASSERT_TRUE(bench.make());
  ASSERT_EQ(bench.run(), State::kDone) << bench.story();
  EXPECT_TRUE(bench.capture->findings().retakes.empty());
}

TEST_P(CaptureFault, saturated_scene_is_refused_when_no_exposure_helps) {
  CaptureBench bench(GetParam());
  bench.plan.exposure_us = 50'000;
  bench.plane.white_e_per_s = 4e6;
  ASSERT_TRUE(bench.make());
  ASSERT_EQ(bench.run(), State::kFailed);
  EXPECT_EQ(bench.capture->error()->rcode, RCode::kTooBright) << bench.story();
}

TEST_P(CaptureFault, dark_scene_is_refused) {
  CaptureBench bench(GetParam());
  bench.plan.exposure_us = 50'000;
  bench.plane.white_e_per_s = 9e3;
  bench.plane.ambient_e_per_s = 1e3;
  ASSERT_TRUE(bench.make());
  ASSERT_EQ(bench.run(), State::kFailed);
  EXPECT_EQ(bench.capture->error()->rcode, RCode::kTooDark) << bench.story();
}

TEST_P(CaptureFault, somebody_who_stays_in_the_light_makes_the_look_be_taken_again) {
  CaptureBench bench(GetParam());
  const RigTime comes(std::chrono::milliseconds(GetParam() == Kind::kDisplay ? 3'000 : 1'500));
  bench.plane.somebody = {comes, comes + std::chrono::seconds(3)};
  ASSERT_TRUE(bench.make());
  ASSERT_EQ(bench.run(), State::kDone) << bench.story();
  EXPECT_TRUE(bench.said("code=" + to_string(RCode::kSceneMoved)) ||
              bench.said("code=" + to_string(RCode::kWrongPattern)))
      << bench.story();
}

TEST_P(CaptureFault, knocked_mirror_makes_the_look_be_taken_again_though_its_sensor_sees_nothing) {
  CaptureBench bench(GetParam());
  bench.fault("mirror", "bump", among_patterns(GetParam()), 1, 0.02);
  ASSERT_TRUE(bench.make());
  ASSERT_EQ(bench.run(), State::kDone) << bench.story();
  EXPECT_TRUE(bench.said("capture.look_retake")) << bench.story();
}

TEST(CaptureFaultDisplay, changed_latency_is_found_and_measured_anew) {
  CaptureBench bench(Kind::kDisplay);
  bench.fault("projector", "latency", kAmongPatterns, 1, 2);
  ASSERT_TRUE(bench.make());
  if (bench.run() == State::kFailed) {
    EXPECT_EQ(bench.capture->error()->rcode, RCode::kWrongPattern) << bench.story();
    bench.capture->go_on(bench.now);
  }
  ASSERT_EQ(bench.run(), State::kDone) << bench.story();
  EXPECT_NEAR(static_cast<double>(bench.capture->findings().latency->count()) / 16'666'667, 4, 0.03);
}

}  // namespace
}  // namespace raysteer::support
