// pure: where light falls by a rig's calibration against where an earlier one would have put it, in millimetres.
//
// Both calibrations answer the same question: where does panel pixel x land at this command? What the answers differ by
// is split in two: what the old rig would do if it had been moved as a whole, which six numbers say, and what is left:
// a change inside the rig (mrcal takes the implied rotation out of a difference for the same reason).
#pragma once

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "calib/steer/predict.hpp"
#include "calib/steer/room.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::assess {

/// One panel pixel at one command.
struct LitPlace {
  Eigen::Vector2d command_rad;
  Eigen::Vector2d x;  ///< panel px
};

struct MovedPlace {
  LitPlace lit;
  Eigen::Vector3d p;         ///< where it lands by the calibration of now, metres, the surface's frame
  Eigen::Vector3d moved_m;   ///< from where the earlier one puts it to there
  Eigen::Vector3d inside_m;  ///< of it, what no movement of the rig as a whole explains
  double chance_95_mm = 0;   ///< 95 % of differences are shorter where both calibrations are of the same rig
  bool beyond_chance() const { return 1e3 * moved_m.norm() > chance_95_mm; }
};

struct RigDifference {
  std::vector<MovedPlace> places;  ///< those that both calibrations put on the surface, in the given order
  double mean_mm = 0, p95_mm = 0, max_mm = 0;
  double whole_rms_mm = 0;   ///< explained by the rig moving as a whole
  double inside_rms_mm = 0;  ///< left then
  double beyond_chance = 0;  ///< share of places; about 0.05 where nothing moved
  /// That movement, a left increment of the rig's pose (rotation, radians; translation, metres) about the places'
  /// middle.
  Eigen::Matrix<double, 6, 1> whole = Eigen::Matrix<double, 6, 1>::Zero();
};

/// A rig that is not tied to a room, as if its own frame were one.
steer::InRoom in_own_frame(const steer::Solution& solution);

/// `surface`: a plane in the room that both are tied to, or in the rig's frame after in_own_frame(). What the mirror
/// does from visit to visit is no part of `chance_95_mm`. Errors: kCalibrationMismatch (another kind of mirror or size
/// of panel), kTooFewCorrespondences (fewer than 6 places that both put on the surface).
Result<RigDifference> rig_difference(const steer::InRoom& now, const steer::InRoom& before,
                                     const steer::Surface& surface, std::span<const LitPlace> places);

}  // namespace raysteer::calib::assess
