// pure: the steering table of a solved rig over all the places of a plane that it reaches.
#pragma once

#include <Eigen/Dense>
#include <optional>

#include "calib/model/pose.hpp"
#include "calib/model/steered_projector.hpp"
#include "proto/lut/steering_table.hpp"

namespace raysteer::calib::bake {

/// Where the mirror stands since it drifted: at (1 + gain) times the angles that its command means, and offset_rad on.
struct MirrorDrift {
  Eigen::Vector2d offset_rad = Eigen::Vector2d::Zero();
  Eigen::Vector2d gain = Eigen::Vector2d::Zero();
};

struct SteeringRequest {
  proto::lut::Frame frame = proto::lut::Frame::kRig;
  model::Pose T_frame_plane{};                           ///< goes into the table as it is
  model::Pose T_rig_plane{};                             ///< the same plane for the solved rig
  std::optional<Eigen::Vector2d> aim_px = std::nullopt;  ///< nothing: the panel's middle
  MirrorDrift drift{};                                   ///< the table's commands make up for it
  double bound_m = 1e-4;                                 ///< asked
  double farthest_m = 20;                                ///< from the plane's origin; no place beyond is tabled
};

/// Each place's command by Newton; cells so small that bilinear interpolation keeps the bound with a quarter to spare
/// at the places where it is worst (middles of cells and of their sides), which are all tried.
/// Errors: kStationOutOfReach (the plane gets no light), kTableBound (too many nodes would be needed), kBadValue.
Result<proto::lut::SteeringTable> bake_steering(const model::SteeredProjector& projector,
                                                const SteeringRequest& request);

/// Where panel pixel `x` lands on the plane at a command, in the plane's coordinates; nothing where it does not.
std::optional<Eigen::Vector2d> landing(const model::SteeredProjector& projector, const model::Pose& T_rig_plane,
                                       const Eigen::Vector2d& x, const Eigen::Vector2d& command_rad);

}  // namespace raysteer::calib::bake
