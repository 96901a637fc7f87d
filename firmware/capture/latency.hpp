// pure: how long after its vblank does a picture become light? Measured, since no data sheet tells (algorithms 2.6).
//
// White replaces black at a vblank and stays; an exposure of whole frames begins `delay` after that vblank. As long as
// it begins before the light, it misses a part: level = 1 - (latency - delay) / exposure. One exposure on that ramp
// tells the latency; one on the plateau behind it, with black again after white as in a capture, confirms it.
#pragma once

#include <chrono>
#include <optional>

namespace raysteer::firmware::capture {

/// Shots are taken so much later than the light is due, and the picture stays so much longer: room for jitter.
constexpr std::chrono::nanoseconds latency_guard(std::chrono::nanoseconds frame) { return frame / 8; }

class LatencySearch {
 public:
  struct Probe {
    std::chrono::nanoseconds delay{};  ///< from white's vblank to the exposure
    bool as_captured = false;          ///< white is shown only as long as a pattern of a capture
  };

  /// `frame`: of the projector. `exposure`: of the camera, whole frames. `longest`: latency that is believed.
  LatencySearch(std::chrono::nanoseconds frame, std::chrono::nanoseconds exposure, std::chrono::nanoseconds longest);

  /// The next exposure to take; nothing when the search has ended.
  std::optional<Probe> next() const;
  /// Its brightness, 0 as under steady black, 1 as under steady white.
  void take(double level);

  /// The light begins so long after the vblank; nothing until confirmed, or when no light came within `longest`.
  std::optional<std::chrono::nanoseconds> latency() const;
  /// The brightness that confirmed it.
  double plateau() const { return plateau_; }

 private:
  enum class Stage { kRamp, kPlateau, kFound, kLost };
  std::chrono::nanoseconds guard_;
  std::chrono::nanoseconds exposure_;
  std::chrono::nanoseconds longest_;
  std::chrono::nanoseconds delay_{};
  Stage stage_ = Stage::kRamp;
  int tries_ = 0;
  double plateau_ = 0;
};

}  // namespace raysteer::firmware::capture
