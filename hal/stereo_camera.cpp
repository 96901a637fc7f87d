#include "hal/stereo_camera.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace raysteer::hal {
namespace {

const char* eye_name(Eye eye) { return eye == Eye::kLeft ? "left" : "right"; }
std::size_t index(Eye eye) { return static_cast<std::size_t>(eye); }

/// Cameras round exposure to lines of their sensor and gain to steps of an amplifier; more than that is another value.
bool same_exposure(std::chrono::microseconds asked, std::chrono::microseconds read) {
  return std::abs((read - asked).count()) <= 1 + asked.count() / 100;
}
bool same_gain(double asked_db, double read_db) { return std::abs(read_db - asked_db) <= 0.1; }

Status check_possible(Eye eye, const CameraInfo& camera, const CameraSettings& asked) {
  char note[160];
  if (asked.exposure < camera.least_exposure || asked.exposure > camera.most_exposure) {
    std::snprintf(note, sizeof note, "exposure %lld us, the %s camera can do %lld to %lld us",
                  static_cast<long long>(asked.exposure.count()), eye_name(eye),
                  static_cast<long long>(camera.least_exposure.count()),
                  static_cast<long long>(camera.most_exposure.count()));
    return fail(RCode::kBadValue, note);
  }
  if (!(asked.gain_db >= 0 && asked.gain_db <= camera.most_gain_db)) {
    std::snprintf(note, sizeof note, "gain %g dB, the %s camera can do 0 to %g dB", asked.gain_db, eye_name(eye),
                  camera.most_gain_db);
    return fail(RCode::kBadValue, note);
  }
  return ok();
}

Status check_read_back(Eye eye, const CameraSettings& asked, const CameraSettings& read) {
  if (same_exposure(asked.exposure, read.exposure) && same_gain(asked.gain_db, read.gain_db) &&
      asked.triggered == read.triggered) {
    return ok();
  }
  char note[200];
  std::snprintf(note, sizeof note, "the %s camera was asked for %lld us, %g dB, %s and says %lld us, %g dB, %s",
                eye_name(eye), static_cast<long long>(asked.exposure.count()), asked.gain_db,
                asked.triggered ? "triggered" : "free", static_cast<long long>(read.exposure.count()), read.gain_db,
                read.triggered ? "triggered" : "free");
  return fail(RCode::kCameraSettings, note);
}

}  // namespace

StereoCamera::StereoCamera(std::array<std::string, 2> bound, Pairing pairing)
    : bound_(std::move(bound)), pairing_(pairing) {
  RAYSTEER_CHECK(pairing.tolerance.count() >= 0 && pairing.partner_wait.count() >= 0);
}

Status StereoCamera::check_serials(const std::array<CameraInfo, 2>& found) const {
  const auto& [left, right] = found;
  if (!bound_[0].empty() && left.serial == bound_[1] && right.serial == bound_[0]) {
    return fail(RCode::kCameraSerial,
                "left and right are swapped: '" + left.serial + "' is on the left, the board binds it to the right");
  }
  for (const Eye eye : kEyes) {
    const std::string& wanted = bound_[index(eye)];
    const std::string& serial = found[index(eye)].serial;
    if (!wanted.empty() && serial != wanted) {
      return fail(RCode::kCameraSerial, std::string("the ") + eye_name(eye) + " camera is '" + serial +
                                            "', the board binds '" + wanted + "'");
    }
  }
  return ok();
}

Status StereoCamera::configure(const CameraSettings& settings) {
  if (streaming_) {
    return fail(RCode::kCameraStreaming, "stop the cameras before changing their settings");
  }
  std::array<CameraInfo, 2> found;
  for (const Eye eye : kEyes) {
    Result<CameraInfo> camera = do_info(eye);
    if (!camera) {
      return std::move(camera).error();
    }
    found[index(eye)] = std::move(*camera);
  }
  RAYSTEER_TRY(check_serials(found));
  for (const Eye eye : kEyes) {
    RAYSTEER_TRY(check_possible(eye, found[index(eye)], settings));
  }
  settings_.reset();
  for (const Eye eye : kEyes) {
    Result<CameraSettings> read = do_configure(eye, settings);
    if (!read) {
      return std::move(read).error();
    }
    RAYSTEER_TRY(check_read_back(eye, settings, *read));
  }
  settings_ = settings;
  return ok();
}

Status StereoCamera::start() {
  if (!settings_) {
    return fail(RCode::kNotConfigured, "set exposure and gain first");
  }
  if (streaming_) {
    return ok();
  }
  RAYSTEER_TRY(do_start());
  for (std::optional<EyeFrame>& frame : waiting_) {
    frame.reset();
  }
  streaming_ = true;
  return ok();
}

Status StereoCamera::stop() {
  if (!streaming_) {
    return ok();
  }
  RAYSTEER_TRY(do_stop());
  streaming_ = false;
  return ok();
}

Result<std::optional<FramePair>> StereoCamera::next_pair(RigTime now) {
  if (!streaming_) {
    return fail(RCode::kCameraStreaming, "frames were asked for while the cameras are stopped");
  }
  std::optional<Error> unavailable;
  for (const Eye eye : kEyes) {
    std::optional<EyeFrame>& front = waiting_[index(eye)];
    if (front) {
      continue;
    }
    Result<std::optional<EyeFrame>> next = do_next_frame(eye);
    if (next) {
      front = std::move(*next);
    } else {
      unavailable = with_context(std::move(next).error(), eye_name(eye));
    }
  }
  auto& [left, right] = waiting_;
  if (left && right) {
    const auto apart = right->stamp - left->stamp;
    const bool give_left = apart >= -pairing_.tolerance;  // else its partner comes later, or never
    const bool give_right = apart <= pairing_.tolerance;
    FramePair pair;
    if (give_left) {
      pair.left = std::exchange(left, std::nullopt);
    }
    if (give_right) {
      pair.right = std::exchange(right, std::nullopt);
    }
    return std::optional(std::move(pair));
  }
  const std::optional<EyeFrame>& alone = left ? left : right;
  if (alone && now - alone->arrived >= pairing_.partner_wait) {
    FramePair pair;
    pair.left = std::exchange(left, std::nullopt);
    pair.right = std::exchange(right, std::nullopt);
    return std::optional(std::move(pair));
  }
  if (unavailable) {
    return *std::move(unavailable);
  }
  return std::optional<FramePair>();
}

}  // namespace raysteer::hal
