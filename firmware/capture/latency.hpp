// pure: how long after its vblank does a picture become light? Measured, since no data sheet tells (algorithms 2.6).
//
// White replaces black at a vblank; an exposure of whole frames begins `delay` after that vblank. As long as it begins
// before the light, it misses a part of it: level = 1 - (latency - delay) / exposure. One exposure on that ramp tells
// the latency; a later one, on the plateau, confirms it.
#pragma once

#include <chrono>
#include <optional>

namespace raysteer::firmware::capture {

class LatencySearch {
 public:
  /// `frame`: of the projector. `exposure`: of the camera, whole frames. `longest`: latency that is believed.
  LatencySearch(std::chrono::nanoseconds frame, std::chrono::nanoseconds exposure, std::chrono::nanoseconds longest);

  /// Where the next exposure begins after white's vblank; nothing when the search has ended.
  std::optional<std::chrono::nanoseconds> next() const;
  /// Its brightness, 0 as under steady black, 1 as under steady white.
  void take(double level);

  /// The light begins so long after the vblank; nothing until confirmed, or when no light came within `longest`.
  std::optional<std::chrono::nanoseconds> latency() const;
  /// The brightness that confirmed it.
  double plateau() const { return plateau_; }

 private:
  enum class Stage { kRamp, kPlateau, kFound, kLost };
  std::chrono::nanoseconds frame_;
  std::chrono::nanoseconds exposure_;
  std::chrono::nanoseconds longest_;
  std::chrono::nanoseconds delay_{};
  Stage stage_ = Stage::kRamp;
  int tries_ = 0;
  double plateau_ = 0;
};

}  // namespace raysteer::firmware::capture
