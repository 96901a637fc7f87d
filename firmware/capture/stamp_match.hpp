// value: which edge made which frame? The cameras' clock is not ours; what lies between is learnt from edges.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>

#include "hal/base/time.hpp"

namespace raysteer::firmware::capture {

class StampMatch {
 public:
  /// Finds the offset that most frames agree on, within a millisecond: at least two edges at uneven distances, so that
  /// being off by one shows. False, and nothing changes, when fewer than two frames and half of them fit any. Frames
  /// that nobody triggered (some cameras send one when streaming starts) do not fit and do no harm.
  bool learn(std::span<const RigTime> edges, std::span<const CameraTime> frames);
  bool known() const { return known_; }

  /// When the rig's clock would have stamped it.
  RigTime to_rig(CameraTime stamp) const { return RigTime(stamp.time_since_epoch() - offset_); }
  /// A frame that surely belongs to that edge: follows the drift between the clocks.
  void follow(RigTime edge, CameraTime stamp);
  /// How far a stamp may be off at `at`: a millisecond, and the drift since the last frame that was followed.
  std::chrono::nanoseconds tolerance(RigTime at) const;

 private:
  bool known_ = false;
  std::chrono::nanoseconds offset_{};  ///< camera - rig
  RigTime last_{};
};

}  // namespace raysteer::firmware::capture
