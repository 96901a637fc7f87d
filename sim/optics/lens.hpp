// value: a true lens: pinhole with Brown-Conrady distortion, both ways, in double precision.
//
// Written apart from calib/model on purpose: a test compares the two. Formulas: D. C. Brown, "Decentering Distortion of
// Lenses" (1966), with the coefficients' order and signs of OpenCV (k1, k2, p1, p2, k3).
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <optional>

namespace raysteer::sim::optics {

struct LensNumbers {
  Eigen::Vector2d focal_px = Eigen::Vector2d::Ones();
  Eigen::Vector2d centre_px = Eigen::Vector2d::Zero();  ///< principal point; may lie outside the picture
  std::array<double, 5> distortion{};                   ///< k1, k2, p1, p2, k3
};

/// The same for a camera, where light comes in, and a projector, where it goes out.
class Lens {
 public:
  Lens() : Lens(LensNumbers{}) {}
  explicit Lens(const LensNumbers& numbers);
  const LensNumbers& numbers() const { return numbers_; }

  /// Pixel of a point in the lens's frame (x right, y down, z forward). Nothing for points behind it, or so far off the
  /// axis that the distortion has folded back.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p) const;

  /// Unit direction of a pixel, the exact inverse of project() (Newton to the last bits). NaN where there is none.
  Eigen::Vector3d ray(const Eigen::Vector2d& pixel) const;

  /// Has every pixel of a picture a ray?
  bool covers(int width, int height) const;

 private:
  LensNumbers numbers_;
  double widest_squared_ = std::numeric_limits<double>::infinity();  ///< (tan of the angle off axis)^2 of the fold
};

}  // namespace raysteer::sim::optics
