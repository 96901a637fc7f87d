// value: one picture's turn on the panel, what was asked for, and what came of it.
#pragma once

#include <array>
#include <chrono>
#include <optional>
#include <vector>

#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/mirror.hpp"
#include "hal/stereo_camera.hpp"
#include "hal/trigger.hpp"

namespace raysteer::firmware::capture {

/// Asked for: show a pattern, expose both cameras.
struct Order {
  int pattern = 0;  ///< of the loaded sequence
  /// Display: from the picture's vblank to the edge. Trigger-master: dark pause before; 0 lets patterns that follow one
  /// another be played in one run.
  std::chrono::nanoseconds delay{};
  /// Display: from the picture's vblank to that of the next picture. Trigger-master: of a pattern's period.
  std::chrono::nanoseconds length{};
  bool shot = true;  ///< false: only shown, to be there before the next; a trigger-master needs none and skips it
};

struct Slot {
  Order order;
  std::optional<RigTime> shown;     ///< vblank, or the command to play
  std::optional<RigTime> expected;  ///< edge
  bool over = false;                ///< nothing more will be said of it by the projector
  std::optional<Error> fault;       ///< the projector's
  std::vector<hal::TriggerEdge> edges;
  std::array<std::vector<hal::EyeFrame>, 2> frames;
  std::optional<hal::MirrorReading> mirror;  ///< when the edge was seen
};

/// An edge further from its due time is nobody's; one within may still be too late, which is said.
inline bool belongs(const hal::TriggerEdge& edge, const Slot& slot) {
  return std::chrono::abs(edge.stamp - *slot.expected) < slot.order.length / 3;
}

}  // namespace raysteer::firmware::capture
