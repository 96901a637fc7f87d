// pure: the boards in boards/, and commands within their range.
#pragma once

#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include "calib/model/steered_projector.hpp"
#include "proto/board/board.hpp"
#include "tests/support/paths.hpp"

namespace raysteer::support {

inline proto::board::Board board_named(const std::string& name) {
  const auto path = source_root() / "boards" / (name + ".toml");
  std::ifstream stream(path);
  auto board = proto::board::read_board(std::string(std::istreambuf_iterator<char>(stream), {}), name);
  if (!board) {
    throw std::runtime_error(board.error().message());
  }
  return *board;
}

/// A command at shares 0 to 1 of the allowed range.
inline Eigen::Vector2d between(const calib::model::SteeredProjector& projector, double share1, double share2) {
  return projector.least_rad + Eigen::Vector2d(share1, share2).cwiseProduct(projector.most_rad - projector.least_rad);
}

}  // namespace raysteer::support
