#include "firmware/rig/devices.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "tests/support/paths.hpp"

namespace raysteer::firmware::rig {
namespace {

proto::board::Board whole() {
  std::ifstream stream(support::source_root() / "tests" / "data" / "boards" / "whole.toml");
  return *proto::board::read_board(std::string(std::istreambuf_iterator<char>(stream), {}), "whole.toml");
}

Pretend dark() {
  Pretend pretend;
  pretend.scene = [](const hal::mock::Exposure&) { return Image<float>(2448, 2048); };
  return pretend;
}

TEST(Devices, limits_come_from_the_board) {
  proto::board::Board board = whole();
  board.mirror.most_rad = {0.1, 0.05};
  const auto devices = make_devices(board, dark());
  ASSERT_TRUE(devices) << devices.error().message();
  hal::Rig rig = (*devices)->rig();
  EXPECT_EQ(rig.mirror.limits().most, (hal::MirrorAngles{Radians(0.1), Radians(0.05)}));
  const Status beyond = rig.mirror.aim({Radians(0), Radians(0.06)}, rig.clock.now());
  ASSERT_FALSE(beyond);
  EXPECT_EQ(beyond.error().rcode, RCode::kMirrorOutOfRange);
  EXPECT_TRUE(rig.mirror.aim({Radians(0), Radians(0.04)}, rig.clock.now()));
}

TEST(Devices, both_kinds_of_projector_are_fitted_as_the_board_says) {
  proto::board::Board board = whole();
  EXPECT_EQ((*make_devices(board, dark()))->rig().player, nullptr);
  board.projector.kind = proto::board::ProjectorKind::kTriggerMaster;
  EXPECT_NE((*make_devices(board, dark()))->rig().player, nullptr);
}

TEST(Devices, cameras_are_those_of_the_board) {
  const auto devices = make_devices(whole(), dark());
  const auto info = (*devices)->rig().cameras.info(hal::Eye::kRight);
  ASSERT_TRUE(info);
  EXPECT_EQ(info->serial, "MOCK-R");
  EXPECT_EQ(info->width, 2448);
  EXPECT_EQ(info->least_exposure, std::chrono::microseconds(20));
}

TEST(Devices, what_is_not_known_is_refused_with_what_is) {
  proto::board::Board board = whole();
  board.back_end = "mok";
  EXPECT_NE(make_devices(board, dark()).error().note.find("did you mean 'mock'"), std::string::npos);
  board = whole();
  board.mirror.preset = "galvos";
  EXPECT_EQ(make_devices(board, dark()).error().rcode, RCode::kBadValue);
  board = whole();
  board.faults = {{.device = "left", .what = "dorp"}};
  EXPECT_EQ(make_devices(board, dark()).error().rcode, RCode::kBadValue);
}

}  // namespace
}  // namespace raysteer::firmware::rig
