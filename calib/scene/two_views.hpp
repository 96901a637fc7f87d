// value: the two devices a point is triangulated from: two cameras, or a camera and a projector.
#pragma once

#include "calib/model/camera.hpp"
#include "calib/model/pose.hpp"
#include "calib/model/rig.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::scene {

struct TwoViews {
  model::Camera left, right;
  model::Pose T_right_left;

  double baseline_m() const { return T_right_left.t.norm(); }
};

/// Two devices of a rig by index. Errors: kBadCalibrationFile (index, or no baseline between them).
Result<TwoViews> two_views(const model::Rig& rig, std::size_t left, std::size_t right);

}  // namespace raysteer::calib::scene
