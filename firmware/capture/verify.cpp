#include "firmware/capture/verify.hpp"

#include <cmath>
#include <cstdio>
#include <string>
#include <variant>

namespace raysteer::firmware::capture {
namespace {

/// Devices round to lines or clocks; none to more than this.
constexpr double kExposureRounding = 0.005;
constexpr std::chrono::microseconds kExposureStep{50};
constexpr double kGainRounding_db = 0.1;

Status verify_settings(const std::string& name, const hal::EyeFrame& frame, const hal::CameraSettings& asked) {
  if (frame.automatic) {
    return fail(RCode::kAutomaticExposure, "the " + name + " eye's automatic exposure is on");
  }
  const auto off = std::chrono::abs(frame.exposure - asked.exposure);
  if (off > kExposureStep &&
      static_cast<double>(off.count()) > kExposureRounding * static_cast<double>(asked.exposure.count())) {
    return fail(RCode::kAutomaticExposure, "the " + name + " eye exposed for " +
                                               std::to_string(frame.exposure.count()) + " us, " +
                                               std::to_string(asked.exposure.count()) + " us were set");
  }
  if (std::abs(frame.gain_db - asked.gain_db) > kGainRounding_db) {
    return fail(RCode::kAutomaticExposure, "the " + name + " eye's gain is " + std::to_string(frame.gain_db) + " dB, " +
                                               std::to_string(asked.gain_db) + " dB were set");
  }
  return ok();
}

Status verify_pixels(const std::string& name, const hal::EyeFrame& frame, const hal::CameraInfo& info) {
  if (frame.damaged) {
    return fail(RCode::kShotDamaged, "the " + name + " eye's frame " + std::to_string(frame.sequence) + " lacks bytes");
  }
  return std::visit(
      [&](const auto& pixels) -> Status {
        if (pixels.width() != info.width || pixels.height() != info.height) {
          return fail(RCode::kFrameSize, "the " + name + " eye's frame has " + std::to_string(pixels.width()) + " x " +
                                             std::to_string(pixels.height()) + " px, expected " +
                                             std::to_string(info.width) + " x " + std::to_string(info.height));
        }
        const bool wide = sizeof(*pixels.data()) == 2;
        if (wide != (info.bits > 8)) {
          return fail(RCode::kFrameDepth, "the " + name + " eye's frame has " + (wide ? "16" : "8") +
                                              " bits a pixel, the camera says " + std::to_string(info.bits));
        }
        return ok();
      },
      frame.pixels);
}

}  // namespace

Status verify_pair(const hal::FramePair& pair, const std::array<hal::CameraInfo, 2>& infos,
                   const hal::CameraSettings& settings) {
  for (const hal::Eye eye : hal::kEyes) {
    const std::string name = eye == hal::Eye::kLeft ? "left" : "right";
    const std::optional<hal::EyeFrame>& frame = pair.eye(eye);
    if (!frame) {
      return fail(RCode::kShotIncomplete, "the " + name + " eye has no frame");
    }
    RAYSTEER_TRY(verify_settings(name, *frame, settings));
    RAYSTEER_TRY(verify_pixels(name, *frame, infos[static_cast<std::size_t>(eye)]));
  }
  return ok();
}

Status verify_mirror(const hal::MirrorReading& reading, const hal::MirrorAngles& command, Radians tolerance) {
  const std::array off{reading.angles.axis1 - command.axis1, reading.angles.axis2 - command.axis2};
  for (std::size_t axis = 0; axis < off.size(); ++axis) {
    if (std::abs(off[axis].raw()) > tolerance.raw()) {
      char text[96];
      std::snprintf(text, sizeof text, "axis %zu stands %.3f mrad off its command, at most %.3f mrad are allowed",
                    axis + 1, 1e3 * off[axis].raw(), 1e3 * tolerance.raw());
      return fail(RCode::kMirrorMoved, text);
    }
  }
  return ok();
}

}  // namespace raysteer::firmware::capture
