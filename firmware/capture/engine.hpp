// bound to capture: the stages of a capture. Private to firmware/capture.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/decode/sequence_check.hpp"
#include "firmware/capture/capture.hpp"
#include "firmware/capture/grid.hpp"
#include "firmware/capture/latency.hpp"
#include "firmware/capture/references.hpp"
#include "firmware/capture/shooter.hpp"

namespace raysteer::firmware::capture {

/// What was taken of the present look.
struct LookRecord {
  std::optional<References> references;
  std::vector<std::optional<EyeSamples>> samples;                     ///< of each frame of the sequence that is taken
  std::vector<std::optional<proto::session::Shot>> shots;             ///< as well
  std::vector<int> retakes;                                           ///< of each frame
  std::vector<std::unique_ptr<calib::decode::SequenceCheck>> checks;  ///< of each eye
  int late_flips = 0;
};

class Capture::Engine {
 public:
  Engine(const hal::Rig& rig, proto::plan::Plan plan, PatternSequence sequence, Options options, Sink& sink,
         const EventLog& log);

  State tick(RigTime now);
  void go_on(RigTime now);
  State state() const { return state_; }
  const std::string& prepare() const { return plan_.looks[look_].prepare; }
  const std::optional<Error>& error() const { return error_; }
  Progress progress() const;
  const Findings& findings() const { return findings_; }

 private:
  enum class Stage { kOpen, kSettle, kAmbient, kReferences, kLatency, kPatterns, kClosing };

  Status step(RigTime now);
  Status watch_interlock();
  Status open(RigTime now);
  Status enter_look(RigTime now);
  Status aim(RigTime now);
  Status settle(RigTime now);
  Status run_over(RigTime now);

  Status begin_ambient(RigTime now);
  Status end_ambient(RigTime now);
  Status begin_references(RigTime now);
  Status end_references(RigTime now);
  Status adopt_references(References references, RigTime now);
  Status begin_latency(RigTime now);
  Status end_latency(RigTime now);
  Status begin_patterns(RigTime now);
  Status end_patterns(RigTime now);
  Status begin_closing(RigTime now);
  Status end_closing(RigTime now);
  Status end_look(RigTime now);
  Status finish();

  // Shots
  Status configure(std::chrono::nanoseconds exposure);
  Status shoot(std::vector<Order> orders, bool learn, RigTime now);
  /// Verified, or retaken; the present run goes on unless the cameras must be set anew.
  Status take(Outcome outcome, RigTime now);
  std::optional<Error> verify(const Outcome& outcome) const;
  Status put(int index, Outcome& outcome, EyeSamples samples);
  EyeSamples sample(const hal::FramePair& pair) const;
  Status retake_run(const Error& why, RigTime now);
  Status retake_look(const Error& why, RigTime now);
  Status count_retake(int index, const Error& why);

  // Times
  std::chrono::nanoseconds frame() const { return rig_.projector.panel().frame_period; }
  bool display() const { return rig_.player == nullptr; }
  std::chrono::nanoseconds whole_frames(std::chrono::nanoseconds time) const;
  std::chrono::nanoseconds hold() const { return options_.longest_latency_frames * frame(); }
  std::chrono::nanoseconds slot_length() const;
  Order pattern_order(int pattern) const;
  Order held_order(int pattern, bool shot) const;
  std::optional<std::chrono::nanoseconds> choose(std::chrono::nanoseconds most, std::chrono::nanoseconds wanted) const;
  bool exposure_fixed() const { return plan_.exposure_us.has_value(); }

  // Manifest
  proto::session::Manifest blank_manifest() const;
  proto::session::Manifest manifest() const;
  Status adopt_earlier(const proto::session::Manifest& earlier);

  void make_safe();
  void stop(Error error);
  void fresh_look();
  void begin_record(References references);
  const proto::plan::PlannedLook& look() const { return plan_.looks[look_]; }
  int frames() const { return static_cast<int>(patterns_.size()); }

  hal::Rig rig_;
  proto::plan::Plan plan_;
  PatternSequence sequence_;  ///< recorded
  PatternSequence shown_;     ///< with white and black, if the sequence lacks them
  std::vector<Pattern> patterns_;
  /// Nothing but black is asked for: pictures by the room's light, which then takes white's place in every judgement.
  bool dark_ = false;
  int white_ = 0;
  int black_ = 0;
  Options options_;
  Sink& sink_;
  const EventLog& log_;

  State state_ = State::kRunning;
  Stage stage_ = Stage::kOpen;
  std::optional<Error> error_;
  Findings findings_;
  std::optional<proto::session::Manifest> manifest_;

  Shooter shooter_;
  std::array<hal::CameraInfo, 2> infos_;
  std::array<Grid, 2> grids_;
  hal::CameraSettings settings_;
  std::vector<Outcome> outcomes_;  ///< of the present run, where its stage looks at them together
  std::vector<EyeSamples> seen_;   ///< by them
  int run_retakes_ = 0;
  bool just_started_ = false;  ///< the cameras, since the last run
  int exposure_tries_ = 0;
  std::chrono::nanoseconds most_exposure_{};  ///< that did not saturate
  std::optional<LatencySearch> search_;

  std::size_t look_ = 0;
  std::vector<bool> look_done_;
  bool prepared_ = false;
  RigTime aimed_{};
  RigTime now_{};
  LookRecord record_;
  int look_retakes_ = 0;
  int shots_done_ = 0;
  std::optional<RigTime> began_;
  int shots_at_start_ = 0;
};

}  // namespace raysteer::firmware::capture
