#include "calib/target/refine.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace raysteer::calib::target {

double grey_at(const cv::Mat& frame, cv::Point2f place) {
  const float x = std::clamp(place.x, 0.0F, static_cast<float>(frame.cols - 1));
  const float y = std::clamp(place.y, 0.0F, static_cast<float>(frame.rows - 1));
  const int x0 = std::min(static_cast<int>(x), frame.cols - 2);
  const int y0 = std::min(static_cast<int>(y), frame.rows - 2);
  const double u = x - static_cast<float>(x0);
  const double v = y - static_cast<float>(y0);
  const auto* upper = frame.ptr<std::uint8_t>(y0) + x0;
  const auto* lower = frame.ptr<std::uint8_t>(y0 + 1) + x0;
  return (1 - v) * ((1 - u) * upper[0] + u * upper[1]) + v * ((1 - u) * lower[0] + u * lower[1]);
}

double median(std::vector<double> values) {
  if (values.empty()) {
    return 0;
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

namespace {

// Contrast between the two pairs of opposite squares on a small circle: a saddle has two bright and two dark sectors.
double saddle_contrast(const cv::Mat& frame, cv::Point2f corner, float radius) {
  constexpr int kSamples = 16;
  double second_cos = 0;
  double second_sin = 0;
  for (int i = 0; i < kSamples; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSamples;
    const cv::Point2f offset(radius * static_cast<float>(std::cos(angle)),
                             radius * static_cast<float>(std::sin(angle)));
    const double grey = grey_at(frame, corner + offset);
    second_cos += grey * std::cos(2 * angle);
    second_sin += grey * std::sin(2 * angle);
  }
  // A square wave of height h has a fundamental of 4/pi * h/2.
  return std::hypot(second_cos, second_sin) * 2 / kSamples * std::numbers::pi / 2;
}

}  // namespace

std::vector<bool> refine_corners(const cv::Mat& frame, std::vector<cv::Point2f>& corners, int half_window,
                                 double min_contrast) {
  std::vector<bool> good(corners.size(), false);
  if (corners.empty()) {
    return good;
  }
  const std::vector<cv::Point2f> rough = corners;
  cv::cornerSubPix(frame, corners, cv::Size(half_window, half_window), cv::Size(-1, -1),
                   cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 40, 0.001));
  const auto margin = static_cast<float>(half_window + 1);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const cv::Point2f q = corners[i];
    // cornerSubPix puts a corner back exactly where it was when it runs away.
    const bool moved_little = cv::norm(q - rough[i]) <= half_window;
    const bool inside = q.x >= margin && q.y >= margin && q.x < static_cast<float>(frame.cols) - margin &&
                        q.y < static_cast<float>(frame.rows) - margin;
    good[i] = q != rough[i] && moved_little && inside &&
              saddle_contrast(frame, q, static_cast<float>(half_window)) >= min_contrast;
  }
  return good;
}

double edge_blur(const cv::Mat& frame, cv::Point2f a, cv::Point2f b, float reach) {
  const cv::Point2f along = b - a;
  const auto length = static_cast<float>(cv::norm(along));
  if (length < 1) {
    return 0;
  }
  const cv::Point2f across(-along.y / length, along.x / length);
  const cv::Point2f middle = (a + b) * 0.5F;
  const double contrast = std::abs(grey_at(frame, middle + across * reach) - grey_at(frame, middle - across * reach));
  if (contrast < 20) {
    return 0;
  }
  constexpr float kStep = 0.25F;
  double steepest = 0;
  for (float s = -reach; s < reach; s += kStep) {
    const double slope = (grey_at(frame, middle + across * (s + 0.5F)) - grey_at(frame, middle + across * (s - 0.5F)));
    steepest = std::max(steepest, std::abs(slope));
  }
  return contrast / (std::sqrt(2 * std::numbers::pi) * steepest);
}

}  // namespace raysteer::calib::target
