// value: the two devices a point is triangulated from: two cameras, or a camera and a projector.
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <span>
#include <vector>

#include "calib/model/camera.hpp"
#include "calib/model/pose.hpp"
#include "calib/model/rig.hpp"
#include "calib/scene/match.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::scene {

struct TwoViews {
  model::Camera left, right;
  model::Pose T_right_left;
};

/// Two devices of a rig by index. Errors: kCalibrationMismatch (no such device), kBadCalibrationFile (no distance
/// between them).
Result<TwoViews> two_views(const model::Rig& rig, std::size_t left, std::size_t right);

/// The undistorted normalised coordinates of a match. NaN where a lens model ends.
struct RayPair {
  Eigen::Vector2d left, right;

  bool valid() const { return left.allFinite() && right.allFinite(); }
};

/// Rays of the matches, in their order: independent of the pose, so computed once.
std::vector<RayPair> ray_pairs(const TwoViews& views, std::span<const Match> matches);

}  // namespace raysteer::calib::scene
