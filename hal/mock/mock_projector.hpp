// bound to whoever advances the rig: a display projector: pictures at vblank, light some frames later.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "hal/mock/exposure.hpp"
#include "hal/mock/fault.hpp"
#include "hal/mock/history.hpp"
#include "hal/mock/mock_interlock.hpp"
#include "hal/mock/room.hpp"
#include "hal/projector.hpp"

namespace raysteer::hal::mock {

struct ProjectorParameters {
  ProjectorPanel panel{.width = 1920, .height = 1200, .frame_period = std::chrono::nanoseconds(16'666'667)};
  std::chrono::nanoseconds first_vblank{3'000'000};  ///< instant of vblank 0
  double latency_frames = 2;                         ///< from vblank to light; need not be whole
  double gamma = 1;                                  ///< light = code^gamma ...
  double black = 0.0005;                             ///< ... above this, as part of white
  int pictures = 512;                                ///< that its memory holds, patterns and content together

  double lamp_missing_cold = 0.1;  ///< part of the light a cold lamp lacks
  WarmUp lamp{.time_constant_s = 90, .on_before_s = 1'800};

  ProjectorPx drift_warm{1.5, -1};      ///< the picture moves so far from cold to warm ...
  ProjectorPx drift_per_k{0.05, 0.03};  ///< ... and so far per kelvin of the room ...
  WarmUp warm_up{.time_constant_s = 1'200, .on_before_s = 3'600};
  double drift_step_px = 0.01;  ///< ... in such steps, so that a world need not follow each femtopixel
};

class MockProjector : public Projector {
 public:
  MockProjector(const Clock& clock, MockInterlock& interlock, const ProjectorParameters& parameters, const Room& room,
                Faults faults);

  /// Scans out what is due. The interlock must have been advanced to `now` before.
  virtual void advance(RigTime now);

  /// What shone in [begin, end), in order; spans end where anything changes. `mirror` is not filled. Both instants
  /// are not after the last advance() and at most some seconds before.
  std::vector<LightSpan> light_between(RigTime begin, RigTime end) const;

  /// How far the picture stands from where it stood at rig time 0.
  ProjectorPx drift(RigTime at) const;
  const ProjectorParameters& parameters() const { return parameters_; }

 protected:
  using Picture = std::shared_ptr<const PanelPicture>;

  /// kDeviceUnavailable: unplugged, or does not answer this time.
  Status check_answers();
  const Picture& stored(const Shown& what) const;
  /// From `at` on this is lit (nullptr: nothing is). What was to be lit later is forgotten.
  void lit_from(RigTime at, Picture picture) { lit_.set(at, {.upper = picture, .lower = picture}); }
  void forget_waiting() { waiting_.reset(); }
  const Picture& dark() const { return dark_; }

 private:
  /// A frame's light; torn: rows from `split` on are of the other picture.
  struct Lit {
    Picture upper;
    Picture lower;
    int split = 0;
  };
  struct Lamp {
    bool on = false;
    double missing = 0;  ///< part of the light, at this change
  };
  struct Waiting {
    Shown what;
    RigTime at;
  };

  Status do_light(bool on) override;
  Status do_load(const PatternSequence& sequence) override;
  Status do_store(int number, ImageView<const std::uint8_t> picture) override;
  Status do_show(Shown what, RigTime at) override;
  Result<std::optional<Presented>> do_presented() override;

  void switch_lamp(RigTime at, bool on);
  double lamp_missing(RigTime at) const;
  void scan_out(std::uint64_t vblank, RigTime at);

  const MockInterlock& interlock_;
  ProjectorParameters parameters_;
  Room room_;
  Faults faults_;

  std::array<float, 256> response_;
  Picture dark_;
  Picture desktop_;
  std::vector<Picture> patterns_;
  std::map<int, Picture> contents_;

  std::uint64_t next_vblank_ = 0;
  std::optional<Waiting> waiting_;
  std::optional<Presented> presented_;
  History<Lit> lit_;
  History<Lamp> lamp_;
};

}  // namespace raysteer::hal::mock
