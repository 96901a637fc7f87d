// pure: the surface a rig lights, as a plane to draw on, and the rig's reach there.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calib/assess/rig_difference.hpp"
#include "calib/steer/room.hpp"

namespace raysteer::host::rig {

/// A plane with axes to draw on: x to the right, y up the page.
struct Floor {
  calib::model::Pose T_floor_frame;  ///< from the room, or from the rig's frame where it is tied to none; z = 0 is it
  std::string name;                  ///< "the room's floor (z = 0)"

  /// In the room's or the rig's frame.
  calib::steer::Surface surface() const {
    const calib::model::Pose back = T_floor_frame.inverse();
    return {.point = back.t, .normal = back.q * Eigen::Vector3d::UnitZ()};
  }
  Eigen::Vector2d operator()(const Eigen::Vector3d& p) const { return (T_floor_frame * p).head<2>(); }
};

/// The room's z = 0 where the rig is tied to a room and its light falls there, else the plane through the points that
/// were solved with; nothing where there are none.
std::optional<Floor> floor_of(const calib::steer::InRoom& rig, bool tied);

/// Commands whose light passes the mirrors, spread evenly over those allowed: columns x rows, nothing where none passes
/// or lands on the floor.
struct ReachedCell {
  Eigen::Vector2d command_rad;
  std::array<Eigen::Vector2d, 4> outline_m;  ///< where the picture's middle falls at the cell's corners, on the floor
  double worst_95_mm = 0;  ///< 95 % of errors are below, worst of the picture's middle and of its corners
};

struct Reach {
  std::vector<ReachedCell> cells;
  double median_95_mm = 0;
  double worst_95_mm = 0;
};

/// `tied`: bounds hold for places in the room; else for places as the rig's cameras see them.
Reach reach_on(const Floor& floor, const calib::steer::InRoom& rig, bool tied, int columns = 24, int rows = 16);

/// Where the picture's middle falls at a command.
std::optional<Eigen::Vector2d> middle_on(const Floor& floor, const calib::steer::InRoom& rig,
                                         const Eigen::Vector2d& command_rad);

/// The middle of each cell's picture and its corners, to compare two calibrations at.
std::vector<calib::assess::LitPlace> lit_places(const Reach& reach, const calib::model::SteeredProjector& projector);

}  // namespace raysteer::host::rig
