#include "firmware/capture/verify.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace raysteer::firmware::capture {
namespace {

const hal::CameraSettings kSettings{.exposure = std::chrono::microseconds(50'000), .gain_db = 3};

std::array<hal::CameraInfo, 2> infos() {
  hal::CameraInfo info{.serial = "one", .width = 6, .height = 4};
  return {info, info};
}

hal::FramePair good_pair() {
  const auto eye = [] {
    hal::EyeFrame frame;
    frame.pixels = Image<std::uint8_t>(6, 4);
    frame.exposure = kSettings.exposure;
    frame.gain_db = kSettings.gain_db;
    return frame;
  };
  return {.left = eye(), .right = eye()};
}

RCode verdict_after(const std::function<void(hal::FramePair&)>& spoil) {
  hal::FramePair pair = good_pair();
  spoil(pair);
  const Status status = verify_pair(pair, infos(), kSettings);
  return status ? RCode::kNone : status.error().rcode;
}

TEST(Pair, as_asked_for_is_accepted) {
  EXPECT_EQ(verdict_after([](hal::FramePair&) {}), RCode::kNone);
  EXPECT_EQ(verdict_after([](hal::FramePair& pair) { pair.left->exposure += std::chrono::microseconds(14); }),
            RCode::kNone);
}

TEST(Pair, that_is_not_as_asked_for_is_named) {
  EXPECT_EQ(verdict_after([](hal::FramePair& pair) { pair.right.reset(); }), RCode::kShotIncomplete);
  EXPECT_EQ(verdict_after([](hal::FramePair& pair) { pair.left->damaged = true; }), RCode::kShotDamaged);
  EXPECT_EQ(verdict_after([](hal::FramePair& pair) { pair.left->automatic = true; }), RCode::kAutomaticExposure);
  EXPECT_EQ(verdict_after([](hal::FramePair& pair) { pair.right->exposure *= 2; }), RCode::kAutomaticExposure);
  EXPECT_EQ(verdict_after([](hal::FramePair& pair) { pair.right->gain_db = 6; }), RCode::kAutomaticExposure);
  EXPECT_EQ(verdict_after([](hal::FramePair& pair) { pair.left->pixels = Image<std::uint8_t>(6, 5); }),
            RCode::kFrameSize);
  EXPECT_EQ(verdict_after([](hal::FramePair& pair) { pair.left->pixels = Image<std::uint16_t>(6, 4); }),
            RCode::kFrameDepth);
}

TEST(Mirror, off_its_command_is_named_with_axis_and_distance) {
  const hal::MirrorAngles command{Radians(0.1), Radians(-0.1)};
  EXPECT_TRUE(verify_mirror({{Radians(0.1001), Radians(-0.1)}, {}}, command, Radians(500e-6)));
  const Status off = verify_mirror({{Radians(0.1), Radians(-0.102)}, {}}, command, Radians(500e-6));
  ASSERT_FALSE(off);
  EXPECT_EQ(off.error().rcode, RCode::kMirrorMoved);
  EXPECT_NE(off.error().note.find("axis 2 stands -2.000 mrad"), std::string::npos) << off.error().note;
}

}  // namespace
}  // namespace raysteer::firmware::capture
