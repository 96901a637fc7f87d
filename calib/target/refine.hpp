// Places corners to sub-pixel on the image; inside calib/target only (OpenCV types).
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace raysteer::calib::target {

/// Moves each corner to the saddle point of grey near it, in place. Returns one flag a corner: true where the place was
/// found within the window and the four squares around it differ enough (`min_contrast`, grey levels).
std::vector<bool> refine_corners(const cv::Mat& frame, std::vector<cv::Point2f>& corners, int half_window,
                                 double min_contrast);

/// Grey at a place, bilinear; the border is repeated.
double grey_at(const cv::Mat& frame, cv::Point2f place);

/// Blur sigma of the edge between two neighbouring corners, px: contrast / (sqrt(2 pi) * steepest slope), across the
/// edge's middle over `reach` px to both sides. 0 where no edge was seen.
double edge_blur(const cv::Mat& frame, cv::Point2f a, cv::Point2f b, float reach);

/// Median; 0 for none.
double median(std::vector<double> values);

}  // namespace raysteer::calib::target
