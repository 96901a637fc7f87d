// bound to capture: orders become frame pairs: each picture shown, its edge counted, its two frames found, or said why
// not.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "firmware/capture/slot.hpp"
#include "firmware/capture/stamp_match.hpp"
#include "firmware/capture/timeline.hpp"
#include "hal/rig.hpp"

namespace raysteer::firmware::capture {

/// What came of one order that asked for a shot.
struct Outcome {
  Order order;
  RigTime shown{};
  RigTime edge{};
  std::optional<hal::MirrorReading> mirror;
  hal::FramePair pair;         ///< both eyes, unless `fault`
  std::optional<Error> fault;  ///< kFlipLate, kTriggerEdgeMissing, kTriggerEdgeExtra, kShotIncomplete, kShotApart,
                               ///< kShotSequence
};

class Shooter {
 public:
  explicit Shooter(const hal::Rig& rig);

  /// The cameras were started anew: their counts begin again.
  void streams_started();
  /// Cameras stream with `exposure` and the trigger is armed. `learn`: these orders' edges lie at uneven distances;
  /// their frames teach what lies between the clocks. Errors are the devices'.
  Status begin(const std::vector<Order>& orders, std::chrono::nanoseconds exposure, bool learn, RigTime now);
  Status tick(RigTime now);
  /// In the order of the orders.
  std::optional<Outcome> next();
  bool idle() const { return given_ == slots_.size(); }
  bool clock_known() const { return match_.known(); }
  /// Frames that nobody triggered, thrown away so far.
  int extra_frames() const { return extra_frames_; }

 private:
  Status read_edges();
  Status read_frames(RigTime now);
  void place(std::size_t eye, hal::EyeFrame frame);
  bool complete(const Slot& slot) const;
  RigTime deadline(const Slot& slot) const;
  void judge(Slot& slot, Outcome& outcome);
  void judge_edges(const Slot& slot, Outcome& outcome) const;
  void judge_frames(const Slot& slot, Outcome& outcome);
  bool all_frames_due(RigTime now) const;

  const hal::Rig rig_;
  std::unique_ptr<Timeline> timeline_;
  StampMatch match_;
  std::vector<Slot> slots_;
  std::size_t given_ = 0;
  std::chrono::nanoseconds exposure_{};
  std::chrono::nanoseconds allowance_{};  ///< from an exposure's end to the computer, at most
  bool learning_ = false;
  std::array<std::vector<hal::EyeFrame>, 2> unplaced_;
  std::array<std::optional<std::int64_t>, 2> base_;  ///< frame number - edge number
  std::deque<Outcome> outcomes_;
  int extra_frames_ = 0;
};

}  // namespace raysteer::firmware::capture
