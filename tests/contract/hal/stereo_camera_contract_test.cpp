// What hal/stereo_camera.hpp promises, for every back end.
#include <deque>

#include "tests/contract/hal/back_end.hpp"

namespace raysteer::hal {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

class StereoCameraContract : public Contract {
 protected:
  static constexpr CameraSettings kSettings{.exposure = milliseconds(4)};

  /// A rig whose cameras stream and whose trigger is armed.
  std::unique_ptr<Bench> streaming(std::vector<mock::Fault> faults = {}) {
    auto rig = bench(std::move(faults));
    EXPECT_OK(rig->rig().cameras.configure(kSettings));
    EXPECT_OK(rig->rig().cameras.start());
    EXPECT_OK(rig->rig().trigger.arm(TriggerSource::kFired));
    return rig;
  }
  /// Fires `shots` edges 30 ms apart and lets all frames come.
  static void shoot(Bench& rig, int shots) {
    for (int i = 0; i < shots; ++i) {
      ASSERT_OK(rig.rig().trigger.fire(rig.now()));
      rig.run(milliseconds(30));
    }
    rig.run(milliseconds(300));
  }
  static std::vector<FramePair> all_pairs(Bench& rig) {
    std::vector<FramePair> pairs;
    for (;;) {
      auto next = rig.rig().cameras.next_pair(rig.now());
      if (!next || !*next) {
        return pairs;
      }
      pairs.push_back(std::move(**next));
    }
  }
};
INSTANTIATE_TEST_SUITE_P(Every, StereoCameraContract, testing::ValuesIn(back_ends()), name_of);

TEST_P(StereoCameraContract, is_stopped_and_not_configured_at_first) {
  const auto rig = bench();
  StereoCamera& cameras = rig->rig().cameras;
  EXPECT_FALSE(cameras.streaming());
  EXPECT_FALSE(cameras.settings());
  EXPECT_REFUSED(cameras.start(), RCode::kNotConfigured);
  EXPECT_REFUSED(cameras.next_pair(rig->now()), RCode::kCameraStreaming);
  EXPECT_OK(cameras.stop());
}

TEST_P(StereoCameraContract, says_what_it_is) {
  const auto rig = bench();
  for (const Eye eye : kEyes) {
    const auto info = rig->rig().cameras.info(eye);
    ASSERT_OK(info);
    EXPECT_FALSE(info->serial.empty());
    EXPECT_GT(info->width, 0);
    EXPECT_GE(info->bits, 8);
    EXPECT_LE(info->bits, 16);
    EXPECT_LE(info->least_exposure, info->most_exposure);
  }
}

TEST_P(StereoCameraContract, gives_both_eyes_of_each_exposure_once_and_in_order) {
  const auto rig = streaming();
  shoot(*rig, 3);
  const auto pairs = all_pairs(*rig);
  ASSERT_EQ(pairs.size(), 3U);
  for (std::uint32_t i = 0; i < 3; ++i) {
    for (const Eye eye : kEyes) {
      const auto& frame = pairs[i].eye(eye);
      ASSERT_TRUE(frame);
      EXPECT_EQ(frame->sequence, i);
      EXPECT_EQ(frame->exposure, kSettings.exposure);
      EXPECT_EQ(frame->gain_db, 0);
      EXPECT_FALSE(frame->automatic);
      EXPECT_FALSE(frame->damaged);
      EXPECT_LE(frame->arrived, rig->now());
    }
    EXPECT_LT(std::chrono::abs(pairs[i].left->stamp - pairs[i].right->stamp), microseconds(100));
  }
}

TEST_P(StereoCameraContract, gives_frames_of_the_size_and_depth_it_says) {
  const auto rig = streaming();
  shoot(*rig, 1);
  const auto pairs = all_pairs(*rig);
  ASSERT_EQ(pairs.size(), 1U);
  for (const Eye eye : kEyes) {
    const CameraInfo info = *rig->rig().cameras.info(eye);
    const Frame& pixels = pairs[0].eye(eye)->pixels;
    EXPECT_EQ(std::holds_alternative<Image<std::uint8_t>>(pixels), info.bits == 8);
    std::visit(
        [&](const auto& image) {
          EXPECT_EQ(image.width(), info.width);
          EXPECT_EQ(image.height(), info.height);
          for (std::size_t i = 0; i < image.size(); ++i) {
            ASSERT_LT(image.data()[i], 1 << info.bits);
          }
        },
        pixels);
  }
}

TEST_P(StereoCameraContract, stamps_on_a_clock_of_its_own_that_keeps_pace) {
  const auto rig = streaming();
  shoot(*rig, 2);
  const auto pairs = all_pairs(*rig);
  ASSERT_EQ(pairs.size(), 2U);
  const auto apart = pairs[1].left->stamp - pairs[0].left->stamp;
  EXPECT_NEAR(static_cast<double>(apart.count()), 30e6, 0.1e6);
}

TEST_P(StereoCameraContract, gives_no_pair_before_its_frames_have_come) {
  const auto rig = streaming();
  ASSERT_OK(rig->rig().trigger.fire(rig->now()));
  rig->run(milliseconds(3));  // the exposure is not over
  EXPECT_FALSE(rig->rig().cameras.next_pair(rig->now())->has_value());
}

TEST_P(StereoCameraContract, counts_from_zero_and_forgets_unread_frames_at_each_start) {
  const auto rig = streaming();
  StereoCamera& cameras = rig->rig().cameras;
  shoot(*rig, 2);
  ASSERT_OK(cameras.start());  // harmless while streaming
  ASSERT_OK(cameras.stop());
  EXPECT_REFUSED(cameras.next_pair(rig->now()), RCode::kCameraStreaming);
  ASSERT_OK(cameras.start());
  EXPECT_TRUE(all_pairs(*rig).empty());
  shoot(*rig, 1);
  const auto pairs = all_pairs(*rig);
  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_EQ(pairs[0].left->sequence, 0U);
}

TEST_P(StereoCameraContract, runs_freely_at_its_least_period_when_not_triggered) {
  const auto rig = bench();
  StereoCamera& cameras = rig->rig().cameras;
  ASSERT_OK(cameras.configure({.exposure = milliseconds(2), .triggered = false}));
  ASSERT_OK(cameras.start());
  rig->run(milliseconds(400));
  const auto pairs = all_pairs(*rig);
  ASSERT_GT(pairs.size(), 2U);
  const auto apart = pairs[2].left->stamp - pairs[1].left->stamp;
  EXPECT_NEAR(static_cast<double>(apart.count()),
              1e3 * static_cast<double>(cameras.info(Eye::kLeft)->least_period.count()), 50e3);
}

TEST_P(StereoCameraContract, refuses_settings_that_the_cameras_cannot_do) {
  const auto rig = bench();
  StereoCamera& cameras = rig->rig().cameras;
  const CameraInfo info = *cameras.info(Eye::kLeft);
  for (const CameraSettings& bad :
       {CameraSettings{.exposure = info.least_exposure - microseconds(1)},
        CameraSettings{.exposure = info.most_exposure + microseconds(1)},
        CameraSettings{.exposure = milliseconds(1), .gain_db = -0.1},
        CameraSettings{.exposure = milliseconds(1), .gain_db = info.most_gain_db + 0.1},
        CameraSettings{.exposure = milliseconds(1), .gain_db = std::numeric_limits<double>::quiet_NaN()}}) {
    EXPECT_REFUSED(cameras.configure(bad), RCode::kBadValue);
  }
  EXPECT_FALSE(cameras.settings());
  EXPECT_OK(cameras.configure({.exposure = info.least_exposure, .gain_db = info.most_gain_db}));
}

TEST_P(StereoCameraContract, refuses_to_be_configured_while_streaming) {
  const auto rig = streaming();
  EXPECT_REFUSED(rig->rig().cameras.configure(kSettings), RCode::kCameraStreaming);
}

TEST_P(StereoCameraContract, says_that_left_and_right_are_swapped) {
  const auto rig = bench({{.device = "cameras", .what = "swap"}});
  const Status swapped = rig->rig().cameras.configure(kSettings);
  ASSERT_FALSE(swapped);
  EXPECT_EQ(swapped.error().rcode, RCode::kCameraSerial);
  EXPECT_NE(swapped.error().note.find("swapped"), std::string::npos) << swapped.error().note;
}

TEST_P(StereoCameraContract, says_when_a_camera_keeps_other_settings_than_it_was_asked) {
  const auto rig = bench({{.device = "right", .what = "ignore"}});
  StereoCamera& cameras = rig->rig().cameras;
  const Status ignored = cameras.configure(kSettings);
  ASSERT_FALSE(ignored);
  EXPECT_EQ(ignored.error().rcode, RCode::kCameraSettings);
  EXPECT_NE(ignored.error().note.find("right"), std::string::npos) << ignored.error().note;
  EXPECT_FALSE(cameras.settings());
  EXPECT_REFUSED(cameras.start(), RCode::kNotConfigured);
  EXPECT_OK(cameras.configure(kSettings));  // it was a fault of one time
}

TEST_P(StereoCameraContract, says_how_much_bandwidth_is_missing) {
  const auto rig = bench({{.device = "cameras", .what = "bandwidth", .amount = 1e-9}});
  ASSERT_OK(rig->rig().cameras.configure(kSettings));
  const Status full = rig->rig().cameras.start();
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().rcode, RCode::kBandwidth);
  EXPECT_NE(full.error().note.find("MB/s"), std::string::npos);
  EXPECT_FALSE(rig->rig().cameras.streaming());
}

TEST_P(StereoCameraContract, says_when_either_camera_does_not_answer) {
  for (const char* eye : {"left", "right"}) {
    const auto rig = bench({{.device = eye, .what = "unplug"}});
    StereoCamera& cameras = rig->rig().cameras;
    EXPECT_REFUSED(cameras.info(eye == std::string("left") ? Eye::kLeft : Eye::kRight), RCode::kDeviceUnavailable);
    EXPECT_REFUSED(cameras.configure(kSettings), RCode::kDeviceUnavailable);
  }
}

TEST_P(StereoCameraContract, gives_complete_pairs_before_it_says_that_a_camera_was_unplugged) {
  const auto rig = streaming({{.device = "right", .what = "unplug", .from = RigTime(milliseconds(200))}});
  StereoCamera& cameras = rig->rig().cameras;
  shoot(*rig, 2);
  EXPECT_EQ(all_pairs(*rig).size(), 2U);
  EXPECT_REFUSED(cameras.next_pair(rig->now()), RCode::kDeviceUnavailable);
  EXPECT_REFUSED(cameras.stop(), RCode::kDeviceUnavailable);
}

TEST_P(StereoCameraContract, refuses_to_start_when_a_camera_has_gone) {
  const auto rig = bench({{.device = "left", .what = "unplug", .from = RigTime(milliseconds(10))}});
  ASSERT_OK(rig->rig().cameras.configure(kSettings));
  rig->run(milliseconds(20));
  EXPECT_REFUSED(rig->rig().cameras.start(), RCode::kDeviceUnavailable);
}

TEST_P(StereoCameraContract, gives_an_eye_alone_whose_partner_was_lost) {
  for (const char* eye : {"left", "right"}) {
    const auto rig = streaming({{.device = eye, .what = "drop", .from = RigTime(milliseconds(25))}});
    shoot(*rig, 3);
    const auto pairs = all_pairs(*rig);
    ASSERT_EQ(pairs.size(), 3U);
    const bool left_lost = eye == std::string("left");
    EXPECT_EQ(pairs[1].left.has_value(), !left_lost);
    EXPECT_EQ(pairs[1].right.has_value(), left_lost);
    ASSERT_TRUE(pairs[2].left && pairs[2].right);
    EXPECT_EQ(pairs[2].left->sequence, 2U) << "the gap in the count tells of the loss";
  }
}

TEST_P(StereoCameraContract, does_not_pair_frames_whose_stamps_are_apart) {
  const auto rig = streaming({{.device = "left", .what = "stamp", .amount = 5e-3}});
  shoot(*rig, 1);
  const auto pairs = all_pairs(*rig);
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_TRUE(pairs[0].right && !pairs[0].left);
  EXPECT_TRUE(pairs[1].left && !pairs[1].right);
}

/// Frames as a test lays them out: pairing is the contract's own.
class SpyCameras final : public StereoCamera {
 public:
  SpyCameras() : StereoCamera({"L", "R"}, {}) {}
  struct Due {
    CameraTime stamp;
    RigTime arrived;
  };
  std::array<std::deque<Due>, 2> frames;
  int configured = 0;
  int started = 0;

  void lay(Eye eye, int stamp_ms, int arrived_ms) {
    frames[static_cast<std::size_t>(eye)].push_back(
        {CameraTime(milliseconds(stamp_ms)), RigTime(milliseconds(arrived_ms))});
  }

 private:
  Result<CameraInfo> do_info(Eye eye) override {
    return CameraInfo{.serial = eye == Eye::kLeft ? "L" : "R", .most_exposure = milliseconds(100)};
  }
  Result<CameraSettings> do_configure(Eye, const CameraSettings& settings) override { return ++configured, settings; }
  Status do_start() override { return ++started, ok(); }
  Status do_stop() override { return ok(); }
  Result<std::optional<EyeFrame>> do_next_frame(Eye eye) override {
    auto& queue = frames[static_cast<std::size_t>(eye)];
    if (queue.empty()) {
      return std::optional<EyeFrame>();
    }
    std::optional<EyeFrame> front(std::in_place);
    front->stamp = queue.front().stamp;
    front->arrived = queue.front().arrived;
    queue.pop_front();
    return front;
  }
};

TEST(StereoCameraHalf, lets_no_bad_request_reach_a_back_end) {
  SpyCameras spy;
  EXPECT_FALSE(spy.start());
  EXPECT_FALSE(spy.next_pair(RigTime{}));
  EXPECT_FALSE(spy.configure({.exposure = milliseconds(101)}));
  EXPECT_EQ(spy.configured, 0);
  EXPECT_EQ(spy.started, 0);
  ASSERT_OK(spy.configure(CameraSettings{.exposure = milliseconds(1)}));
  ASSERT_OK(spy.start());
  EXPECT_FALSE(spy.configure({.exposure = milliseconds(1)}));
  EXPECT_EQ(spy.configured, 2);
}

TEST(StereoCameraHalf, waits_for_a_partner_no_longer_than_it_says) {
  SpyCameras spy;
  ASSERT_OK(spy.configure(CameraSettings{.exposure = milliseconds(1)}));
  ASSERT_OK(spy.start());
  spy.lay(Eye::kLeft, 10, 20);
  EXPECT_FALSE(spy.next_pair(RigTime(milliseconds(69)))->has_value());
  const auto pair = spy.next_pair(RigTime(milliseconds(70)));
  ASSERT_TRUE(pair && *pair);
  EXPECT_TRUE((*pair)->left && !(*pair)->right);
}

TEST(StereoCameraHalf, pairs_by_stamp_and_not_by_order) {
  SpyCameras spy;
  ASSERT_OK(spy.configure(CameraSettings{.exposure = milliseconds(1)}));
  ASSERT_OK(spy.start());
  spy.lay(Eye::kLeft, 0, 5);  // an extra frame that the right one did not have
  spy.lay(Eye::kLeft, 10, 15);
  spy.lay(Eye::kRight, 10, 16);
  const RigTime now(milliseconds(16));
  const auto first = spy.next_pair(now);
  ASSERT_TRUE(first && *first);
  EXPECT_TRUE((*first)->left && !(*first)->right);
  const auto second = spy.next_pair(now);
  ASSERT_TRUE(second && *second);
  EXPECT_TRUE((*second)->left && (*second)->right);
}

}  // namespace
}  // namespace raysteer::hal
