// bound to capture: shows pictures one after another and causes one edge for each: the two kinds of projector.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "firmware/capture/slot.hpp"
#include "hal/rig.hpp"

namespace raysteer::firmware::capture {

class Timeline {
 public:
  Timeline() = default;
  Timeline(const Timeline&) = delete;
  Timeline& operator=(const Timeline&) = delete;
  virtual ~Timeline() = default;

  /// Works through `slots`, which outlive the run; `exposure` of the cameras.
  virtual Status begin(std::vector<Slot>& slots, std::chrono::nanoseconds exposure, RigTime now) = 0;
  /// Says in the slots what was shown when, and where their edges are due. Errors are the devices'.
  virtual Status tick(RigTime now) = 0;
  /// An edge was seen: the slot it belongs to, or nothing when nobody asked for it. Each edge is asked about once.
  virtual Slot* slot_of(const hal::TriggerEdge& edge) = 0;
  virtual bool done() const = 0;
};

/// A display: show() at predicted vblanks, fire() at the same vblank plus the order's delay.
std::unique_ptr<Timeline> make_display_timeline(const hal::Rig& rig);
/// A trigger-master, which makes its edges itself. The rig has a player.
std::unique_ptr<Timeline> make_player_timeline(const hal::Rig& rig);

}  // namespace raysteer::firmware::capture
