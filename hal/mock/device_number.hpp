// value: the number that tells one device's noise from another's. Never changed: bytes depend on it.
#pragma once

namespace raysteer::hal::mock {

struct DeviceNumber {
  static constexpr int kMirrorAim = 1;
  static constexpr int kMirrorSensor = 2;
  static constexpr int kTrigger = 3;
  static constexpr int kEyeStamp = 4;   ///< and 5: left, right
  static constexpr int kEyePixels = 6;  ///< and 7
  static constexpr int kStore = 8;
};

}  // namespace raysteer::hal::mock
