// value: the unknowns of one adjustment, and the measurements that pull at them. Inside calib/solve and its tests.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "calib/model/rig.hpp"
#include "calib/solve/observations.hpp"

namespace raysteer::calib::solve {

/// Everything that is estimated. The first device's pose is the identity and stays so.
struct State {
  std::vector<model::Device> devices;
  std::vector<model::Pose> T_rig_target;  ///< per view
  /// The target's z is sag.x (1 - u^2) + sag.y (1 - v^2), u and v from -1 to 1 across its corners: how far the middle
  /// stands out against the edges.
  Eigen::Vector2d sag = Eigen::Vector2d::Zero();  ///< metres
};

/// Corner `id` of the target in view `view`, seen by device `device` at q.
struct CornerMeasurement {
  int view = 0;
  int device = 0;
  int id = 0;
  Eigen::Vector2d q;
};

/// The panel pixel x that lights what device `camera` sees at q, on the target in view `view`.
struct PixelMeasurement {
  int view = 0;
  int camera = 0;
  int projector = 0;
  Eigen::Vector2d q;
  Eigen::Vector2d x;
  double sigma_px = 1;  ///< as decoded
};

struct Measurements {
  TargetSpec target;
  std::vector<CornerMeasurement> corners;
  std::vector<PixelMeasurement> pixels;
  /// Per device, px per coordinate: corners are weighted by it.
  std::vector<double> corner_sigma_px;
  /// Single pixels miss the model by this many times what the decoder predicted.
  double pixel_scale = 1;
};

/// A point of the target's surface, with derivatives by the two sags.
Eigen::Vector3d target_point(const TargetSpec& target, const Eigen::Vector2d& sag, int id,
                             Eigen::Matrix<double, 3, 2>* by_sag = nullptr);

}  // namespace raysteer::calib::solve
