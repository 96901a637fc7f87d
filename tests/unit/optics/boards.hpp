// pure: the boards in boards/ as rigs.
#pragma once

#include <fstream>
#include <sstream>
#include <string>

#include "proto/board/board.hpp"
#include "sim/optics/true_rig.hpp"
#include "tests/support/paths.hpp"

namespace raysteer::sim::optics {

inline const std::array<std::string, 4> kBoards{"mock-galvo", "mock-head", "mock-small", "mock-small-head"};

inline proto::board::Board board_named(const std::string& name) {
  const auto path = support::source_root() / "boards" / (name + ".toml");
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  auto board = proto::board::read_board(text.str(), path.filename().string());
  if (!board) {
    throw std::runtime_error(board.error().message());
  }
  return *board;
}

inline TrueRig rig_named(const std::string& name) {
  auto rig = rig_as_drawn(board_named(name));
  if (!rig) {
    throw std::runtime_error(rig.error().message());
  }
  return *rig;
}

inline hal::MirrorAngles degrees(double axis1, double axis2) {
  constexpr double kDegree = 3.14159265358979323846 / 180;
  return {Radians(axis1 * kDegree), Radians(axis2 * kDegree)};
}

}  // namespace raysteer::sim::optics
