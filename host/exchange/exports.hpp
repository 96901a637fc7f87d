// pure: calibrations as other programs read them.
#pragma once

#include <string>

#include "calib/model/rig.hpp"

namespace raysteer::host::exchange {

/// OpenCV FileStorage YAML: per device NAME_camera_matrix, NAME_distortion (OpenCV's order, 4, 5 or 8), NAME_width,
/// NAME_height, and NAME_R, NAME_T: a point of the first camera goes to this device as R p + T (stereoCalibrate's).
std::string to_opencv_yaml(const calib::model::Rig& rig);

/// Kalibr's camchain.yaml of the cameras: cam0, cam1, ... with intrinsics [fu, fv, pu, pv], distortion_model radtan
/// [k1, k2, p1, p2], and T_cn_cnm1: a point of the camera before goes to this one. Coefficients that Kalibr's model
/// lacks (k3 and on) are refitted, see docs/calibration-format.md.
std::string to_kalibr_camchain(const calib::model::Rig& rig);

}  // namespace raysteer::host::exchange
