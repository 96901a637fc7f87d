// One look solved: the plane that a board lies on, and the projector posed against it by discs shown beside the board.
//
// Everything at once, by the measurements' own noise: the discs' places on the panel are known exactly, so each disc is
// a ray of the projector that meets the plane and is seen again by every camera. Both eyes therefore say where the
// plane is under the discs too, not only under the board.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "calib/model/camera.hpp"
#include "calib/model/panel_on_plane.hpp"
#include "calib/model/pose.hpp"
#include "calib/model/rig.hpp"
#include "calib/target/discs.hpp"
#include "calib/target/target_geometry.hpp"
#include "hal/base/result.hpp"
#include "hal/base/target.hpp"

namespace raysteer::calib::look {

/// What one calibrated camera saw.
struct Sight {
  model::Camera camera;
  model::Pose T_camera_rig;
  std::vector<target::Corner> corners;
  std::vector<target::Disc> discs;
};

/// How far a projector's lens may be from its drawing, one standard deviation.
struct LensPrior {
  double focal = 0.02;       ///< relative
  double aspect = 0.002;     ///< relative, fx against fy
  double centre = 0.02;      ///< of the focal length
  double radial = 0.03;      ///< k1 and k2
  double tangential = 1e-3;  ///< p1 and p2
};

struct Input {
  TargetSpec target;
  target::DiscGrid grid;
  std::vector<Sight> sights;
  model::Camera drawing;  ///< of the projector's lens, BC4
  LensPrior prior;
};

/// plane 6 (left increment of T_rig_plane), projector 6 (of T_projector_plane), then fx fy cx cy k1 k2 p1 p2
constexpr int kUnknowns = 20;
using Covariance = Eigen::Matrix<double, kUnknowns, kUnknowns>;

struct Solution {
  model::Pose T_rig_plane;                     ///< the frame of the board: z = 0 is the plane, z away from the cameras
  model::PanelOnPlane panel;                   ///< the projector as the plane sees it, in a mirror or not
  Covariance covariance = Covariance::Zero();  ///< the cameras taken as exact
  double corner_rms_px = 0;                    ///< per coordinate, kept ones
  double disc_rms_px = 0;
  int corners = 0;  ///< kept
  int discs = 0;    ///< seen by at least one camera and kept
  int left_out = 0;
  double leave_one_out_mm = 0;  ///< RMS, each disc in each camera against the solution without it, on the plane
};

/// Errors: kTooFewCorrespondences (no camera with 6 corners and 6 discs), kLookNotSolved (does not converge, or a
/// quarter of the measurements disagree).
Result<Solution> solve_look(const Input& input);

/// The solution's covariance with that of the cameras added: sight i is device i of `rig`, whose covariance is moved
/// through the adjustment to first order.
Covariance with_cameras(const Input& input, const Solution& solution, const model::Rig& rig);

/// A solution moved by `delta` in the order of kUnknowns.
Solution perturbed(const Solution& solution, const Eigen::Matrix<double, kUnknowns, 1>& delta);

}  // namespace raysteer::calib::look
