// One candidate datum on the grey image: its disc's outline to sub-pixel, then its ring. Inside calib/target only
// (OpenCV types).
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "calib/target/datum.hpp"

namespace raysteer::calib::target {

/// Measures the datum whose disc is about q + shape * (cos, sin). No value where there is none.
std::optional<SeenDatum> measure_datum(const cv::Mat1f& grey, Eigen::Vector2d q, Eigen::Matrix2d shape);

}  // namespace raysteer::calib::target
