// Where the datums are in the rig's frame: what both eyes saw, look by look, as one place each, with the covariance of
// all of them together.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "calib/model/rig.hpp"
#include "calib/target/datum.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::datum {

/// What the two eyes saw at one moment.
struct View {
  std::string name;                                      ///< of the look, for messages
  std::array<std::vector<target::SeenDatum>, 2> eyes{};  ///< left, right
};

/// A datum's disc in the rig's frame: where the middle of its ellipse is depends on it (target::ellipse_middle).
struct Disc {
  double radius_m = 0;
  Eigen::Vector3d normal = -Eigen::Vector3d::UnitZ();  ///< unit, rig frame
};

struct Measured {
  std::vector<unsigned> codes;     ///< rising; seen by both eyes
  std::vector<Eigen::Vector3d> p;  ///< rig frame, metres; as many
  Eigen::MatrixXd cov;             ///< of p, one after the other: 3N x 3N, m^2; the cameras' share in it
  Eigen::MatrixXd cov_cameras;     ///< of p with the cameras' parameters: 3N x P, in Rig::covariance's order
  double chi_square = 0;           ///< of what the eyes disagree in
  int dof = 0;                     ///< one a datum
  std::vector<unsigned> one_eyed;  ///< seen by one eye only: not used
};

/// Places of all datums that both eyes saw in any of the views; the rig stands still meanwhile. Cameras are
/// `cameras.devices[0]` (left, the rig's frame) and `[1]`; their covariance may be empty (they are exact then). Discs
/// may be left out: then the middles of ellipses are taken for the discs' centres.
/// Errors: kCameraCount; kBadCalibrationFile (a covariance of another size); kNotFinite (places or their covariances);
/// kRigMoved (half of the datums of a view are elsewhere than in the others); kDatumMoved (one datum is);
/// kTooFewMatches (no datum was seen by both eyes); kSolverDiverged (rays that do not meet before the cameras).
Result<Measured> measure(const model::Rig& cameras, const std::vector<View>& views,
                         const std::map<unsigned, Disc>& discs = {});

}  // namespace raysteer::calib::datum
