// pure: the boards in boards/ as read, as drawings and as drawn cameras.
#pragma once

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include "tests/support/ideal_rig.hpp"
#include "tests/support/paths.hpp"

namespace raysteer::support {

struct DrawnRig {
  proto::board::Board board;
  calib::steer::Drawing drawing;
  calib::model::Rig cameras;  ///< as drawn, without covariance
};

inline DrawnRig drawn_rig(const std::string& name) {
  const auto path = source_root() / "boards" / (name + ".toml");
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  auto board = proto::board::read_board(text.str(), path.filename().string());
  if (!board) {
    throw std::runtime_error(board.error().message());
  }
  return {.board = *board, .drawing = drawing_of(*board), .cameras = host::rig::cameras_of(*board)};
}

}  // namespace raysteer::support
