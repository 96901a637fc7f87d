#include "sim/rig/pretend_rig.hpp"

#include <utility>

namespace raysteer::sim::rig {

PretendRig::PretendRig(Truth truth, scene::Scene scene, int threads)
    : truth_(std::move(truth)), world_(truth_.rig, std::move(scene), {.threads = threads}) {
  world_.set_target_pose(target_pose_);
}

Result<std::unique_ptr<PretendRig>> PretendRig::make(const proto::board::Board& board, scene::Scene scene,
                                                     const PretendOptions& options) {
  Result<Truth> truth = draw_truth(board, options.seed);
  if (!truth) {
    return std::move(truth).error();
  }
  std::unique_ptr<PretendRig> rig(new PretendRig(*std::move(truth), std::move(scene), options.threads));
  firmware::rig::Pretend pretend{
      .seed = options.seed,
      .curves = rig->truth_.curves,
      .faults = options.faults,
      .scene = [world = &rig->world_](const hal::mock::Exposure& exposure) { return world->draw(exposure); },
      .threads = options.threads};
  auto devices = firmware::rig::make_devices(board, std::move(pretend));
  if (!devices) {
    return std::move(devices).error();
  }
  rig->devices_ = *std::move(devices);
  rig->mock_ = rig->devices_->pretend();
  if (rig->mock_ == nullptr) {
    return fail(RCode::kBadValue, "board '" + board.name + "': back_end '" + board.back_end + "' is not a pretend one");
  }
  return rig;
}

Status PretendRig::prepare(std::string_view text) {
  const Result<int> pose = world_.scene().target_pose(text, target_pose_);
  if (!pose) {
    return pose.error();
  }
  target_pose_ = *pose;
  world_.set_target_pose(target_pose_);
  return ok();
}

}  // namespace raysteer::sim::rig
