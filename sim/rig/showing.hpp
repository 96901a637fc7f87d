// bound to the caller's thread: content pictures shown at one look of the
// pretend rig and photographed, through the same contracts that firmware uses.
// Each call lets virtual time pass until it is done.
#pragma once

#include <array>
#include <chrono>
#include <functional>

#include "hal/base/image.hpp"
#include "hal/base/result.hpp"
#include "hal/stereo_camera.hpp"
#include "sim/rig/pretend_rig.hpp"

namespace raysteer::sim::rig {

class Showing {
 public:
  /// `settle_timeout`: the board's.
  Showing(PretendRig& rig, std::chrono::nanoseconds settle_timeout)
      : rig_(rig), devices_(rig.devices()), settle_timeout_(settle_timeout) {}

  /// Light on, mirror there and still. kMirrorOutOfRange, before anything
  /// moves; kInterlockOpen; kMirrorNotSettled; kDeviceUnavailable.
  Status aim(const std::array<double, 2>& mirror_rad);

  /// Puts a picture on the panel and waits until it is surely lit. kPanelSize;
  /// kDeviceUnavailable.
  Status show(ImageView<const std::uint8_t> picture);

  /// Whole projector frames, the longest of at most 50 ms that does not
  /// saturate what is shown now.
  Result<std::chrono::microseconds> choose_exposure();

  /// Both eyes, what is shown now. Pairs that are incomplete, damaged or not
  /// exposed as asked are taken again. kDeviceUnavailable; also: not one good
  /// pair in five.
  Result<hal::FramePair> photograph(std::chrono::microseconds exposure);

  int shots() const { return shots_; }
  int reshot() const { return reshot_; }

 private:
  /// Lets time pass until `done`; false: it is not within `longest`.
  Result<bool> wait(std::chrono::nanoseconds longest, const std::function<Result<bool>()>& done);
  Status configure(std::chrono::microseconds exposure);

  PretendRig& rig_;
  hal::Rig devices_;
  std::chrono::nanoseconds settle_timeout_;
  int shots_ = 0;
  int reshot_ = 0;
};

}  // namespace raysteer::sim::rig
