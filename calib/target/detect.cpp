#include "calib/target/detect.hpp"

#include <opencv2/core.hpp>
#include <string>
#include <utility>

#include "calib/target/charuco.hpp"
#include "calib/target/chessboard.hpp"

namespace raysteer::calib::target {

std::vector<Result<Detection>> detect_all(const TargetSpec& target,
                                          std::span<const ImageView<const std::uint8_t>> frames) {
  const auto all = [&](Error error) {
    return std::vector<Result<Detection>>(frames.size(), Result<Detection>(std::move(error)));
  };
  if (target.corner_columns() < 3 || target.corner_rows() < 3) {
    return all(fail(RCode::kBadValue, "a target needs at least 3x3 inner corners, not " +
                                          std::to_string(target.corner_columns()) + "x" +
                                          std::to_string(target.corner_rows())));
  }
  std::vector<cv::Mat> pixels;
  for (const auto& frame : frames) {
    if (frame.width() < 32 || frame.height() < 32) {
      return all(fail(RCode::kTargetNotFound,
                      "a frame is too small: " + std::to_string(frame.width()) + "x" + std::to_string(frame.height())));
    }
    // OpenCV has no constant image headers; the detectors only read.
    pixels.emplace_back(frame.height(), frame.width(), CV_8UC1, const_cast<std::uint8_t*>(frame.data()),
                        static_cast<std::size_t>(frame.stride()));
  }
  try {
    return target.kind == TargetKind::kCharuco ? detect_charuco(target, pixels) : detect_chessboard(target, pixels);
  } catch (const cv::Exception& exception) {
    return all(fail(RCode::kTargetNotFound, "the detector gave up: " + exception.err));
  }
}

Result<Detection> detect(const TargetSpec& target, ImageView<const std::uint8_t> frame) {
  return std::move(detect_all(target, {&frame, 1}).front());
}

}  // namespace raysteer::calib::target
