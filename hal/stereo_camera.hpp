// bound to capture: two cameras on one trigger line.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "hal/base/frame.hpp"
#include "hal/base/result.hpp"
#include "hal/base/time.hpp"

namespace raysteer::hal {

enum class Eye { kLeft, kRight };
inline constexpr std::array kEyes{Eye::kLeft, Eye::kRight};

/// What one camera is.
struct CameraInfo {
  std::string serial;
  int width = 0;
  int height = 0;
  int bits = 8;  ///< of a pixel, 8 to 16; more than 8 come in 16
  std::chrono::microseconds least_exposure{};
  std::chrono::microseconds most_exposure{};
  double most_gain_db = 0;
  std::chrono::microseconds least_period{};  ///< between two exposures' beginnings, read-out included
};

/// Asked for both eyes alike, exposure and gain fixed: automatic control ruins structured light.
struct CameraSettings {
  std::chrono::microseconds exposure{};
  double gain_db = 0;
  bool triggered = true;  ///< else free running at the least period
};

/// One frame of one eye. Exposure and gain are what the device says it used, not what was asked.
struct EyeFrame {
  Frame pixels;
  std::uint32_t sequence = 0;  ///< the camera's own count from start(); a gap means lost frames
  CameraTime stamp{};          ///< beginning of the exposure, camera clock (both eyes share it)
  RigTime arrived{};           ///< when the rig's computer had it
  std::chrono::microseconds exposure{};
  double gain_db = 0;
  bool automatic = false;  ///< automatic exposure or gain was on
  bool damaged = false;    ///< the device says that bytes are missing
};

/// Both eyes of one exposure. An eye whose frame never came is empty.
struct FramePair {
  std::optional<EyeFrame> left;
  std::optional<EyeFrame> right;
  const std::optional<EyeFrame>& eye(Eye which) const { return which == Eye::kLeft ? left : right; }
};

/// Contract. Pairs the two eyes here, once for every back end: frames belong together when their stamps differ by no
/// more than `pairing_tolerance`; a frame whose partner has not come when a later one of that eye has, or
/// `partner_wait` after it arrived, is delivered alone.
class StereoCamera {
 public:
  struct Pairing {
    std::chrono::microseconds tolerance{500};
    std::chrono::milliseconds partner_wait{50};
  };
  /// `bound` are the serial numbers of the left and right camera that the board file names; empty: any.
  StereoCamera(std::array<std::string, 2> bound, Pairing pairing);
  StereoCamera(const StereoCamera&) = delete;
  StereoCamera& operator=(const StereoCamera&) = delete;
  virtual ~StereoCamera() = default;

  /// What the camera at this eye is. kDeviceUnavailable.
  Result<CameraInfo> info(Eye eye) { return do_info(eye); }

  /// Sets both eyes and reads back. Streaming must be stopped.
  /// kBadValue: exposure or gain outside what the cameras can do; kCameraSerial: an eye is not the camera the board
  /// file binds (swapped cables are said as such); kCameraStreaming; kDeviceUnavailable; kCameraSettings: what was
  /// read back differs from what was asked by more than 1 % + 1 us of exposure or 0.1 dB. After any error but
  /// kCameraStreaming, kBadValue and kCameraSerial the cameras count as not configured.
  Status configure(const CameraSettings& settings);
  const std::optional<CameraSettings>& settings() const { return settings_; }

  /// Begins streaming; sequence numbers count from 0 and unread frames are forgotten. Harmless while streaming.
  /// kNotConfigured; kDeviceUnavailable; kBandwidth: both cameras do not fit the bus; says needed and available.
  Status start();
  /// Harmless when stopped. kDeviceUnavailable.
  Status stop();
  bool streaming() const { return streaming_; }

  /// The oldest pair not yet given, if there is one at `now`. Never blocks.
  /// kCameraStreaming: not streaming; kDeviceUnavailable: unplugged; pairs already complete are given first.
  Result<std::optional<FramePair>> next_pair(RigTime now);

 private:
  Status check_serials(const std::array<CameraInfo, 2>& found) const;

  virtual Result<CameraInfo> do_info(Eye eye) = 0;
  virtual Result<CameraSettings> do_configure(Eye eye, const CameraSettings& settings) = 0;  ///< returns what it reads
  virtual Status do_start() = 0;
  virtual Status do_stop() = 0;
  virtual Result<std::optional<EyeFrame>> do_next_frame(Eye eye) = 0;

  std::array<std::string, 2> bound_;
  Pairing pairing_;
  std::optional<CameraSettings> settings_;
  bool streaming_ = false;
  std::array<std::optional<EyeFrame>, 2> waiting_;  ///< the next of each eye, until its partner is there
};

}  // namespace raysteer::hal
