// bound to capture: runs a plan on a rig: every look aimed at, every pattern shown, both eyes triggered, each pair
// verified or shot again, verified ones handed to a sink.
//
// A state machine: whoever owns it calls tick(now), about once a millisecond, and advances time in between (a thread
// with a clock on the device, a loop in the pretend rig). It sees the rig only through its contracts.
//
//     auto capture = Capture::make(rig, plan, sequence, options, sink, log);
//     while (capture->tick(now) == State::kRunning) { advance(now); }
//
// In order: light on, patterns loaded; flicker of the ambient light from short exposures of black, which also tie the
// cameras' clock to the trigger line; exposure from white; latency of the projector; then look by look.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "firmware/capture/flicker.hpp"
#include "firmware/capture/sink.hpp"
#include "hal/base/log.hpp"
#include "hal/base/pattern.hpp"
#include "hal/base/result.hpp"
#include "hal/rig.hpp"
#include "proto/plan/plan.hpp"

namespace raysteer::firmware::capture {

enum class State {
  kRunning,
  kWaiting,  ///< for a person: prepare() says what for; go_on() continues
  kDone,     ///< the session is finished
  kFailed,   ///< error() says why; light off, triggers disarmed, what was taken is kept; go_on() tries again from there
};

struct Options {
  std::string rig;  ///< identity, written into the session
  double gain_db = 0;
  int most_retakes = 4;                                  ///< of one shot, and of one look as a whole
  std::chrono::nanoseconds settle_timeout{500'000'000};  ///< the board's
  int longest_latency_frames = 12;
  std::chrono::nanoseconds wanted_exposure{50'000'000};  ///< not longer, if the plan does not say
};

struct Progress {
  int shots_done = 0;
  int shots_total = 0;
  int looks_done = 0;
  int looks_total = 0;
  std::chrono::nanoseconds left{};  ///< estimate, in rig time; zero until the first shot
};

/// What was measured and met; also in the event log.
struct Findings {
  std::optional<Flicker> flicker;
  std::optional<std::chrono::nanoseconds> latency;  ///< of a display projector, after the vblank
  std::chrono::nanoseconds exposure{};              ///< in use
  std::map<RCode, int> retakes;                     ///< shots taken again, and why
  std::map<RCode, int> look_retakes;                ///< looks taken again, and why
  int extra_frames = 0;                             ///< frames nobody triggered, thrown away
};

class Capture {
 public:
  /// Every look is checked against the mirror's limits, the sequence against the panel, before anything moves.
  /// The sequence may lack white and black; they are then shown too, but not recorded. The rig's devices, sink and log
  /// outlive the capture. kBadValue (a plan without looks, options), kBadSequence, kPanelSize, kMirrorOutOfRange (names
  /// the look).
  static Result<Capture> make(const hal::Rig& rig, proto::plan::Plan plan, PatternSequence sequence, Options options,
                              Sink& sink, const EventLog& log);
  Capture(Capture&&) noexcept;
  Capture& operator=(Capture&&) noexcept;
  ~Capture();

  /// Does what is due at `now`; never blocks. Time does not go back.
  State tick(RigTime now);
  /// After kWaiting: the person is ready. After kFailed: tries again; verified shots are not taken again.
  void go_on(RigTime now);

  State state() const;
  const std::string& prepare() const;         ///< kWaiting
  const std::optional<Error>& error() const;  ///< kFailed
  Progress progress() const;
  const Findings& findings() const;

 private:
  class Engine;
  explicit Capture(std::unique_ptr<Engine> engine);
  std::unique_ptr<Engine> engine_;
};

}  // namespace raysteer::firmware::capture
