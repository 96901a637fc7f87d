// value: a named place to augment: a rectangle in metres on a plane, and the content it shows.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <optional>
#include <string>

#include "calib/model/pose.hpp"

namespace raysteer::calib::bake {

/// The rectangle's middle is the origin of its plane's frame; x runs along its width as the content's x does, y along
/// its height as the content's y (down), z away from who reads it.
struct Station {
  std::string name;
  model::Pose T_rig_plane{};
  Eigen::Vector2d size_m{0.5, 0.3125};
  Eigen::Vector2i content_px{800, 500};  ///< they fill the rectangle from edge to edge
  std::optional<Eigen::Vector2d> command_rad =
      std::nullopt;  ///< nothing: the one that shows the rectangle in the panel's middle
  /// The command at whose angles the mirror truly stands when it is told command_rad, once dots have said so
  /// (calib/steer/refine.hpp); nothing: it does as it is told.
  std::optional<Eigen::Vector2d> stands_as_rad = std::nullopt;
  double tolerance_mm = 0;  ///< 0: none asked
};

inline constexpr std::array<const char*, 4> kCornerNames{"top left", "top right", "bottom right", "bottom left"};

/// The rectangle's corners in the order of their names, rig frame.
inline std::array<Eigen::Vector3d, 4> corners(const Station& station) {
  const Eigen::Vector2d half = 0.5 * station.size_m;
  return {station.T_rig_plane * Eigen::Vector3d(-half.x(), -half.y(), 0),
          station.T_rig_plane * Eigen::Vector3d(half.x(), -half.y(), 0),
          station.T_rig_plane * Eigen::Vector3d(half.x(), half.y(), 0),
          station.T_rig_plane * Eigen::Vector3d(-half.x(), half.y(), 0)};
}

}  // namespace raysteer::calib::bake
