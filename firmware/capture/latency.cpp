#include "firmware/capture/latency.hpp"

#include <cmath>

namespace raysteer::firmware::capture {
namespace {

constexpr double kNoLight = 0.05;   ///< below, an exposure saw next to nothing of the white picture
constexpr double kPlateau = 0.985;  ///< from here on, all of it
constexpr int kMostTries = 3;

}  // namespace

LatencySearch::LatencySearch(std::chrono::nanoseconds frame, std::chrono::nanoseconds exposure,
                             std::chrono::nanoseconds longest)
    : guard_(latency_guard(frame)), exposure_(exposure), longest_(longest) {}

std::optional<LatencySearch::Probe> LatencySearch::next() const {
  switch (stage_) {
    case Stage::kRamp:
      return Probe{delay_, false};
    case Stage::kPlateau:
      return Probe{delay_ + guard_, true};
    case Stage::kFound:
    case Stage::kLost:
      break;
  }
  return std::nullopt;
}

void LatencySearch::take(double level) {
  const std::chrono::nanoseconds missed(std::llround((1 - level) * static_cast<double>(exposure_.count())));
  if (stage_ == Stage::kRamp) {
    if (level > kNoLight) {
      delay_ += missed;
      stage_ = Stage::kPlateau;
    } else {
      // The ramp is as long as the exposure: no step over it.
      delay_ += exposure_ * 9 / 10;
      stage_ = delay_ > longest_ ? Stage::kLost : Stage::kRamp;
    }
  } else if (stage_ == Stage::kPlateau) {
    plateau_ = level;
    if (level >= kPlateau) {
      stage_ = Stage::kFound;
    } else {
      delay_ += missed;
      stage_ = ++tries_ == kMostTries || delay_ > longest_ ? Stage::kLost : Stage::kPlateau;
    }
  }
}

std::optional<std::chrono::nanoseconds> LatencySearch::latency() const {
  return stage_ == Stage::kFound ? std::optional(delay_) : std::nullopt;
}

}  // namespace raysteer::firmware::capture
