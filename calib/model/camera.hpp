// value: a pinhole with a lens; a projector is one too, with light going the other way.
//
// x = f * dist(X/Z) + c, distortion as OpenCV orders it (k1 k2 p1 p2 k3 k4 k5 k6). Pixel (0,0) is the centre of the
// top-left pixel. The principal point may lie outside the image (lens shift); it is also the centre of distortion.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <optional>
#include <string_view>

#include "hal/base/result.hpp"

namespace raysteer::calib::model {

enum class LensModel { kBc4, kBc5, kBc8 };

/// "bc4", "bc5", "bc8"
std::string_view to_string(LensModel lens);
std::optional<LensModel> lens_from_string(std::string_view text);
/// Distortion coefficients in use: 4, 5 or 8.
int coefficients(LensModel lens);

struct Camera {
  int width = 0;
  int height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  LensModel lens = LensModel::kBc4;
  std::array<double, 8> k{};  ///< k1 k2 p1 p2 k3 k4 k5 k6; those the lens model lacks stay 0

  /// Pixel of a point in this camera's frame (metres, z forward). No value behind the camera.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p) const;
  /// The same with derivatives by the point (2x3).
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p, Eigen::Matrix<double, 2, 3>& by_point) const;
  /// Undistorted normalised coordinates (X/Z, Y/Z) of a pixel: Newton, exact to 1e-12 within the lens's valid radius.
  std::optional<Eigen::Vector2d> normalize(const Eigen::Vector2d& q) const;
  /// Distorted normalised coordinates of undistorted ones.
  Eigen::Vector2d distort(const Eigen::Vector2d& n) const;
  Eigen::Vector2d distort(const Eigen::Vector2d& n, Eigen::Matrix2d& by_n) const;
  /// Is the radial polynomial rising out to 1.1 x the farthest corner (64 radii)?
  bool is_monotonic() const;
};

/// Errors: kNotFinite, kBadValue (size or focal length not positive).
Status check(const Camera& camera);

}  // namespace raysteer::calib::model
