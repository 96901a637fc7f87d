// Where a solved rig's light falls at any look, and how sure that is.
#pragma once

#include <Eigen/Dense>
#include <optional>

#include "calib/model/steered_look.hpp"
#include "calib/steer/solve.hpp"

namespace raysteer::calib::steer {

/// Whose coordinates a point has.
enum class PointFrom {
  kCameras,   ///< measured by the solved cameras: what they are off by moves the point and its prediction together
  kElsewhere  ///< exact in the rig's frame
};

struct Surface {
  Eigen::Vector3d point;   ///< metres, rig frame
  Eigen::Vector3d normal;  ///< unit
};

/// What varies in a prediction besides the calibration.
struct LookState {
  Eigen::Vector2d latent_rad = Eigen::Vector2d::Zero();  ///< known, as after refine_look()
  /// Of the angles, rad^2; no value: an unseen look, the solution's repeatability.
  std::optional<Eigen::Matrix2d> covariance_rad2;
  /// 2 x (cameras' and projector's parameters): how the angles were made to follow the calibration's errors, which is
  /// why a refined look is better than its calibration; empty where they do not.
  Eigen::Matrix<double, 2, Eigen::Dynamic> by_parameters{};
};

struct PanelPrediction {
  Eigen::Vector2d x;           ///< panel px; may lie outside the panel
  Eigen::Matrix2d covariance;  ///< px^2
  /// mm on the surface per px of the panel, in two directions along it; no value without a surface.
  std::optional<Eigen::Matrix2d> mm_per_px;
  /// mm^2 along the surface.
  std::optional<Eigen::Matrix2d> covariance_mm2() const;
};

/// The panel pixel that lights rig-frame point `p` at a command. No value where the point is behind the lens.
std::optional<PanelPrediction> predict(const Solution& solution, const Eigen::Vector2d& command_rad,
                                       const Eigen::Vector3d& p, PointFrom from = PointFrom::kCameras,
                                       const std::optional<Surface>& surface = std::nullopt,
                                       const LookState& state = {});

/// 2 x (cameras' and projector's parameters), px per unit, at a look (calib/model/steered_look.hpp).
Eigen::Matrix<double, 2, Eigen::Dynamic> prediction_by_parameters(const Solution& solution,
                                                                  const model::PixelDerivatives& by,
                                                                  const Eigen::Vector3d& p, PointFrom from);

struct Landing {
  Eigen::Vector3d p;           ///< on the surface, metres
  Eigen::Matrix3d covariance;  ///< m^2, along the surface
};

/// Where panel pixel x lands on a surface at a command. No value where it does not.
std::optional<Landing> land(const Solution& solution, const Eigen::Vector2d& command_rad, const Eigen::Vector2d& x,
                            const Surface& surface, PointFrom from = PointFrom::kCameras, const LookState& state = {});

}  // namespace raysteer::calib::steer
