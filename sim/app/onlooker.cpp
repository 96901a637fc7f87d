#include "sim/app/onlooker.hpp"

#include <chrono>

namespace raysteer::sim::app {

world::RoomView beside_the_light(rig::PretendRig& rig) {
  constexpr double kBack = 2.2;
  constexpr double kEyes = 1.7;
  const optics::TrueProjector& panel = rig.truth().rig.projector;
  const ProjectorPx middle((panel.width - 1) / 2.0, (panel.height - 1) / 2.0);
  const auto lit = rig.world().lit_point(rig.mock().mirror().true_angles(rig.now()), middle, rig.now());
  const Eigen::Isometry3d& T_room_rig = rig.world().scene().T_room_rig;
  const Eigen::Vector3d p_rig = lit ? lit->p : Eigen::Vector3d(0, 0, 3);
  const Eigen::Vector3d p_room = T_room_rig * p_rig;
  // Level with the rig's y: its cameras stand side by side along x, so whoever
  // looks along y has both at hand.
  Eigen::Vector3d away = T_room_rig.linear() * Eigen::Vector3d::UnitY();
  away.z() = 0;
  away = away.norm() > 0.1 ? Eigen::Vector3d(away.normalized()) : Eigen::Vector3d(-Eigen::Vector3d::UnitX());
  Eigen::Vector3d eye = p_room + kBack * away;
  eye.z() = kEyes;
  world::RoomView view;
  view.eye = T_room_rig.inverse() * eye;
  view.look_at = p_rig;
  view.up = T_room_rig.linear().transpose() * Eigen::Vector3d::UnitZ();
  return view;
}

hal::mock::Exposure glance(rig::PretendRig& rig) {
  constexpr std::chrono::milliseconds kGlance{50};
  const RigTime begin = rig.now();
  rig.advance_to(begin + kGlance);
  return {.eye = hal::Eye::kLeft,
          .begin = begin,
          .duration = kGlance,
          .light = rig.mock().light_between(begin, begin + kGlance)};
}

}  // namespace raysteer::sim::app
