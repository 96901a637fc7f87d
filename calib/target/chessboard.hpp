// Chessboards; inside calib/target only (OpenCV types).
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "calib/target/target_geometry.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::target {

/// One result a frame, errors as detect().
std::vector<Result<Detection>> detect_chessboard(const TargetSpec& target, std::span<const cv::Mat> frames);

}  // namespace raysteer::calib::target
