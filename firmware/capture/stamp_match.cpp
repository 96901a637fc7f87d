#include "firmware/capture/stamp_match.hpp"

#include <algorithm>
#include <cstddef>

namespace raysteer::firmware::capture {
namespace {

using std::chrono::nanoseconds;

constexpr nanoseconds kTolerance{1'000'000};
/// Quartz is better than 100 ppm.
constexpr int kDriftPart = 10'000;

}  // namespace

bool StampMatch::learn(std::span<const RigTime> edges, std::span<const CameraTime> frames) {
  std::size_t most = 1;
  nanoseconds best{};
  RigTime last{};
  for (const RigTime edge : edges) {
    for (const CameraTime frame : frames) {
      const nanoseconds offset = frame.time_since_epoch() - edge.time_since_epoch();
      std::size_t fitting = 0;
      for (const RigTime other : edges) {
        fitting += std::ranges::any_of(frames, [&](CameraTime stamp) {
          return std::chrono::abs(stamp.time_since_epoch() - offset - other.time_since_epoch()) <= kTolerance;
        });
      }
      if (fitting > most) {
        most = fitting;
        best = offset;
        last = edge;
      }
    }
  }
  if (most < 2 || 2 * most < edges.size()) {
    return false;
  }
  known_ = true;
  offset_ = best;
  last_ = last;
  return true;
}

void StampMatch::follow(RigTime edge, CameraTime stamp) {
  offset_ = stamp.time_since_epoch() - edge.time_since_epoch();
  last_ = std::max(last_, edge);
}

nanoseconds StampMatch::tolerance(RigTime at) const {
  return kTolerance + std::max(at - last_, nanoseconds(0)) / kDriftPart;
}

}  // namespace raysteer::firmware::capture
