// bound to the caller's thread: a board, a scene and a seed become a rig that
// runs on virtual time.
//
// The seed draws how the rig departs from its drawings; the world shows its
// cameras what they would truly see. Whoever drives it uses devices() only;
// world() and truth() are for those who judge.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "firmware/rig/devices.hpp"
#include "hal/base/result.hpp"
#include "hal/rig.hpp"
#include "proto/board/board.hpp"
#include "sim/rig/truth.hpp"
#include "sim/scene/scene.hpp"
#include "sim/world/world.hpp"

namespace raysteer::sim::rig {

struct PretendOptions {
  std::uint64_t seed = 1;
  std::vector<proto::board::Fault> faults;  ///< besides the board's
  int threads = 1;
};

class PretendRig {
 public:
  /// kBadValue: the board's back end is not a pretend one, or a fault's word is
  /// not known; and what draw_truth() says.
  static Result<std::unique_ptr<PretendRig>> make(const proto::board::Board& board, scene::Scene scene,
                                                  const PretendOptions& options);

  /// What firmware sees.
  hal::Rig devices() { return devices_->rig(); }
  RigTime now() const { return mock_->now(); }
  void advance_to(RigTime now) { mock_->advance_to(now); }

  /// Does what a person is asked to do before a look, at once: "target pose 3".
  /// kBadPrepare.
  Status prepare(std::string_view text);

  world::World& world() { return world_; }
  const Truth& truth() const { return truth_; }
  hal::mock::MockRig& mock() { return *mock_; }
  int target_pose() const { return target_pose_; }

 private:
  PretendRig(Truth truth, scene::Scene scene, int threads);

  Truth truth_;
  world::World world_;
  int target_pose_ = scene::kTargetAway;
  std::unique_ptr<firmware::rig::Devices> devices_;
  hal::mock::MockRig* mock_ = nullptr;
};

}  // namespace raysteer::sim::rig
