// bound to capture: what the projector shows, and whether its light is on.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "hal/base/image.hpp"
#include "hal/base/pattern.hpp"
#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/clock.hpp"
#include "hal/interlock.hpp"

namespace raysteer::hal {

struct Dark {
  bool operator==(const Dark&) const = default;
};
/// Pattern `index` of the loaded sequence, in the order of PatternSequence::patterns().
struct StoredPattern {
  int index = 0;
  bool operator==(const StoredPattern&) const = default;
};
/// Content picture `number`, stored with store().
struct ContentFrame {
  int number = 0;
  bool operator==(const ContentFrame&) const = default;
};
using Shown = std::variant<Dark, StoredPattern, ContentFrame>;

struct ProjectorPanel {
  int width = 0;
  int height = 0;
  std::chrono::nanoseconds frame_period{};  ///< between two vblanks
};

/// What the display controller says it scanned out. Light follows some frames later; how many is measured, not known.
struct Presented {
  Shown what;
  std::uint64_t vblank = 0;  ///< its number, counted from the device's start
  RigTime stamp{};           ///< the vblank at which scanning out began
};

/// Contract of every projector. Dark and light off at first, and again when it is destroyed.
class Projector {
 public:
  Projector(const Clock& clock, Interlock& interlock, ProjectorPanel panel);
  Projector(const Projector&) = delete;
  Projector& operator=(const Projector&) = delete;
  virtual ~Projector() = default;

  const ProjectorPanel& panel() const { return panel_; }

  /// Switches the light source. On is refused with kInterlockOpen unless the interlock is closed; an interlock that
  /// cannot be read is open. Off always reaches the device. kDeviceUnavailable.
  Status light(bool on);
  /// Asked for, and the interlock has been closed ever since: once it opened, light stays off until asked for again.
  bool light_is_on();

  /// Replaces the stored patterns; may take seconds on a real device, and shows nothing meanwhile.
  /// kBadSequence; kPanelSize: the sequence is for another panel; kProjectorBusy: patterns are playing;
  /// kDeviceUnavailable; kDeviceFull. When it fails, the old patterns are still there.
  Status load(const PatternSequence& sequence);
  const PatternSequence& loaded() const { return sequence_; }

  /// Stores a grey content picture under a number (0 to 255), replacing an older one. 0 is dark, 255 fully lit, through
  /// the device's response. kPanelSize, kBadValue (number), kDeviceUnavailable, kDeviceFull.
  Status store(int number, ImageView<const std::uint8_t> picture);

  /// Shows `what` from the first vblank at or after `at` on; replaces what is waiting. Never blocks.
  /// kNothingStored: no such pattern or content; kTooLate: `at` has passed, by how much; kDeviceUnavailable;
  /// kProjectorBusy: a sequence is playing.
  Status show(Shown what, RigTime at);

  /// The newest completed presentation; nothing before the first. Never blocks. kDeviceUnavailable.
  Result<std::optional<Presented>> presented() { return do_presented(); }

 protected:
  /// A sequence is playing: show() is refused. For PatternPlayer's back ends.
  virtual bool playing() const { return false; }
  const Clock& clock() const { return clock_; }

 private:
  Status check_stored(const Shown& what) const;

  virtual Status do_light(bool on) = 0;
  virtual Status do_load(const PatternSequence& sequence) = 0;
  virtual Status do_store(int number, ImageView<const std::uint8_t> picture) = 0;
  virtual Status do_show(Shown what, RigTime at) = 0;
  virtual Result<std::optional<Presented>> do_presented() = 0;

  const Clock& clock_;
  Interlock& interlock_;
  ProjectorPanel panel_;
  PatternSequence sequence_;
  std::vector<bool> stored_ = std::vector<bool>(256, false);
  std::optional<RigTime> lit_since_;
};

}  // namespace raysteer::hal
