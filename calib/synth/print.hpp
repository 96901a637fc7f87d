// value: ink on a plate. Reflectance is constant between straight edges, so a camera pixel's mean can be exact.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "hal/base/target.hpp"

namespace raysteer::calib::synth {

/// The cells of a ChArUco target's markers, border included. Synth knows no dictionary: the caller brings the cells.
struct MarkerCells {
  int side = 0;                     ///< cells along a marker's side: 7 for the 5X5 dictionaries
  std::vector<std::uint8_t> cells;  ///< marker after marker, row by row; 1 is white
  int markers() const { return side > 0 ? static_cast<int>(cells.size()) / (side * side) : 0; }
};

/// A printed target, in the target's own frame: (0, 0) is corner 0, u runs along columns, v along rows.
///
/// A chessboard's top-left square is black. A ChArUco target has markers in its white squares, numbered row by row
/// from the top left; the layouts differ in the top-left square: current: black; legacy: black for an odd number of
/// rows and white, with a marker, for an even one. kAuto is printed as current.
class Print {
 public:
  Print(const TargetSpec& target, MarkerCells markers = {}, double black = 0.04, double white = 0.85);

  /// Reflectance at (u, v) metres; paper white outside the squares.
  double reflectance(double u, double v) const;
  /// Is the reflectance one and the same all over [u0, u1] x [v0, v1]? May say no where it is.
  bool plain(double u0, double u1, double v0, double v1) const;
  const TargetSpec& target() const { return target_; }

 private:
  bool white_square(int column, int row) const { return (column + row + parity_) % 2 != 0; }
  int marker_of(int column, int row) const;
  double marker_edge() const { return 0.5 * (target_.square_m - target_.marker_m); }

  TargetSpec target_;
  MarkerCells markers_;
  double black_, white_;
  int columns_, rows_;  ///< squares
  int parity_ = 0;      ///< 1: the top-left square is white
};

}  // namespace raysteer::calib::synth
