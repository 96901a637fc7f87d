// bound to whoever advances it: all pretend devices of one rig, wired to each other.
#pragma once

#include <memory>
#include <vector>

#include "hal/mock/manual_clock.hpp"
#include "hal/mock/master_projector.hpp"
#include "hal/mock/mock_interlock.hpp"
#include "hal/mock/mock_mirror.hpp"
#include "hal/mock/mock_projector.hpp"
#include "hal/mock/mock_stereo_camera.hpp"
#include "hal/mock/mock_store.hpp"
#include "hal/mock/mock_trigger.hpp"
#include "hal/rig.hpp"

namespace raysteer::hal::mock {

struct RigParameters {
  std::uint64_t seed = 1;
  Room room;
  InterlockParameters interlock;
  MirrorParameters mirror;
  ProjectorParameters projector;
  std::optional<PlayerParameters> player;  ///< set: a trigger-master projector; else a display
  TriggerParameters trigger;
  StereoParameters cameras;
  StoreParameters store;
  std::vector<Fault> faults;
  std::chrono::nanoseconds tick{100'000};  ///< longest that devices go without hearing of each other
};

class MockRig {
 public:
  /// `scene` answers what the cameras see. kBadValue: a fault's device or word is not known.
  static Result<std::unique_ptr<MockRig>> make(const RigParameters& parameters, SceneFunction scene);

  /// It is `now`: clock first, then every device in the order of the light. Stamps are exact, not those of ticks.
  void advance_to(RigTime now);
  RigTime now() const { return clock_.now(); }

  /// The contracts, for those who must not know that this is a mock.
  hal::Rig rig();

  /// Light that shone in [begin, end) with where the mirror truly stood; a moving mirror is cut into short spans.
  std::vector<LightSpan> light_between(RigTime begin, RigTime end) const;

  ManualClock& clock() { return clock_; }
  MockInterlock& interlock() { return interlock_; }
  MockMirror& mirror() { return mirror_; }
  MockProjector& projector() { return *projector_; }
  MockTrigger& trigger() { return trigger_; }
  MockStereoCamera& cameras() { return cameras_; }
  MockStore& store() { return store_; }
  const RigParameters& parameters() const { return parameters_; }

 private:
  MockRig(const RigParameters& parameters, SceneFunction scene);
  std::unique_ptr<MockProjector> make_projector();

  RigParameters parameters_;
  ManualClock clock_;
  Faults clock_faults_;
  MockInterlock interlock_;
  MockMirror mirror_;
  MasterProjector* player_ = nullptr;  ///< the projector's other face, when it is a master
  std::unique_ptr<MockProjector> projector_;
  MockStereoCamera cameras_;
  MockTrigger trigger_;
  MockStore store_;
};

}  // namespace raysteer::hal::mock
