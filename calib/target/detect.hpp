// Finds a calibration target in a camera frame. The only place that knows OpenCV's detectors and their habits.
#pragma once

#include <span>
#include <vector>

#include "calib/target/target_geometry.hpp"
#include "hal/base/image.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::target {

/// Corners of `target` in `frame` (8 bit grey), sub-pixel, in a fixed order and handedness.
///
/// ChArUco corners never come from OpenCV's refinement (0.49 px bias in 4.6): ids and rough places are taken, places
/// are refined on the image. The layout of even-rowed boards is found out when `target.layout` is kAuto.
/// Errors: kTargetNotFound (what was seen instead, as far as it can be told), kWrongTarget, kMirroredTarget.
Result<Detection> detect(const TargetSpec& target, ImageView<const std::uint8_t> frame);

/// The same for all frames of one board, which is better than one by one: the layout of a ChArUco board is decided by
/// all frames together, as a single view may fit both. One result a frame, in their order.
std::vector<Result<Detection>> detect_all(const TargetSpec& target,
                                          std::span<const ImageView<const std::uint8_t>> frames);

}  // namespace raysteer::calib::target
