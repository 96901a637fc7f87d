// ChArUco boards in both of OpenCV's layouts; inside calib/target only (OpenCV types).
#pragma once

#include <opencv2/aruco.hpp>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "calib/target/target_geometry.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::target {

/// One result a frame, errors as detect(); the frames decide together which layout the board has.
std::vector<Result<Detection>> detect_charuco(const TargetSpec& target, std::span<const cv::Mat> frames);

/// Is the dictionary known, and are the markers smaller than the squares? Errors: kBadValue.
Status check_charuco(const TargetSpec& target);

/// The dictionary of a target that check_charuco accepts.
cv::Ptr<cv::aruco::Dictionary> dictionary_of(const TargetSpec& target);

/// Column and row of the square that carries marker `id` (row by row from the top left), or (-1, -1) when the board has
/// no such marker. Both layouts agree where the number of rows is odd.
cv::Point marker_square(const TargetSpec& target, CharucoLayout layout, int id);

}  // namespace raysteer::calib::target
