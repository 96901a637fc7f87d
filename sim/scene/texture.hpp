// value: what is printed on a surface: albedo as a function of metres along it.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <variant>

#include "hal/base/image.hpp"
#include "hal/base/target.hpp"

namespace raysteer::sim::scene {

struct Ink {
  double white = 0.85;
  double black = 0.05;
};

/// A chessboard as calib detects it: uv (0, 0) is its first inner corner, u along `columns`, v along `rows`; the square
/// left above that corner is black. White beyond the outer squares.
struct Chessboard {
  int columns = 0;  ///< inner corners along u
  int rows = 0;     ///< inner corners along v
  double square_m = 0;
  Ink ink;
};

/// A coded datum: white disc around (0, 0) on black, and a ring of `bits` sectors from 2 to 3 radii, white where the
/// code has a one; sector 0 begins at +u and they go towards +v.
struct RingDatum {
  double radius_m = 0.02;  ///< of the inner disc
  unsigned code = 0;
  int bits = 12;
  Ink ink;
};

/// A grey picture spread over a rectangle from (0, 0); albedo outside is that of its nearest pixel.
struct Picture {
  std::shared_ptr<const Image<float>> albedo;
  double pixel_m = 0.001;
};

class Texture {
 public:
  using Kind = std::variant<Chessboard, RingDatum, Picture>;
  Texture(Kind kind) : kind_(std::move(kind)) {}
  const Kind& kind() const { return kind_; }

  /// Mean albedo of the box around `uv`, `size` wide and high (0: at the point itself). Exact for a chessboard; the
  /// others are sampled on a 4x4 grid.
  double albedo(const Eigen::Vector2d& uv, const Eigen::Vector2d& size = Eigen::Vector2d::Zero()) const;

 private:
  Kind kind_;
};

}  // namespace raysteer::sim::scene
