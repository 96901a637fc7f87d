// value: a printed calibration target. ("board" in Raysteer is a rig's description; a target is what is waved.)
#pragma once

#include <string>

namespace raysteer {

enum class TargetKind { kChessboard, kCharuco };

/// OpenCV laid even-rowed ChArUco boards out differently before and since 4.6; kAuto finds out which one is seen.
enum class CharucoLayout { kAuto, kLegacy, kCurrent };

struct TargetSpec {
  TargetKind kind = TargetKind::kChessboard;
  int columns = 0;  ///< chessboard: inner corners along x; ChArUco: squares along x
  int rows = 0;
  double square_m = 0;     ///< side of a square in metres; 0: unknown, lengths would have no unit
  double marker_m = 0;     ///< ChArUco: side of a marker in metres
  std::string dictionary;  ///< ChArUco: "5X5_1000"
  CharucoLayout layout = CharucoLayout::kAuto;

  /// Corners a full view has: inner corners of the grid.
  int corner_columns() const { return kind == TargetKind::kCharuco ? columns - 1 : columns; }
  int corner_rows() const { return kind == TargetKind::kCharuco ? rows - 1 : rows; }
  int corners() const { return corner_columns() * corner_rows(); }
  bool operator==(const TargetSpec&) const = default;
};

}  // namespace raysteer
