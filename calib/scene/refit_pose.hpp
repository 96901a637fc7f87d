// Solves the relative pose of a pair again from the scan's own matches, and says whether the pair moved.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <span>
#include <vector>

#include "calib/model/rig.hpp"
#include "calib/scene/match.hpp"
#include "calib/scene/two_views.hpp"

namespace raysteer::calib::scene {

/// Rotation and direction of the baseline; its length cannot be seen in matches and is kept.
struct PoseRefit {
  model::Pose T_right_left;
  Eigen::Matrix<double, 5, 5> covariance;  ///< rotation (3, left increment, rad), baseline direction (2, rad)
  double moved_rad = 0;                    ///< angle between the calibrated rotation and this one
  double moved_sigma_rad = 0;              ///< one sigma of it, the calibration's own uncertainty included
  double baseline_turned_rad = 0;          ///< angle between the two directions of the baseline
  double chi_square = 0;                   ///< of the move against both uncertainties, 5 degrees of freedom
  double effect_px = 0;                    ///< RMS by which the move changes the disagreement of the matches
  bool moved = false;                      ///< beyond chance, and worth more than 0.25 px RMS
  std::size_t fitted = 0, held_out = 0;    ///< matches
  double held_out_before_px = 0;           ///< 1.4826 MAD of the disagreement of the matches not fitted
  double held_out_after_px = 0;
};

/// Every second 4 x 4 block of projector pixels, as on a chessboard, is held out: footprints of neighbours overlap,
/// so single pixels would not be independent.
inline bool is_held_out(const Match& match) { return ((match.i / 4 + match.j / 4) & 1) != 0; }

/// Fits on the matches that are not held out. The covariance counts a 64 px cell of the left image as one
/// observation, so that what a lens model leaves over does not pass for knowledge.
/// `rig` carries the calibration's covariance of devices `left` and `right` (an empty one counts as exact).
/// Errors: kTooFewMatches, kSolverDiverged, those of two_views().
Result<PoseRefit> refit_pose(const model::Rig& rig, std::size_t left, std::size_t right, std::span<const Match> matches,
                             std::span<const RayPair> rays);

}  // namespace raysteer::calib::scene
