// value: a projector that looks into steered mirrors; one set of numbers that predicts every look.
//
// docs/mirror-model.md: a flat mirror reflects the
// projector's pose; mirrors turn about lines; commands become angles by a curve. Mirrors are in the projector's frame
// P.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <string_view>

#include "calib/model/camera.hpp"
#include "calib/model/pose.hpp"
#include "calib/model/virtual_projector.hpp"

namespace raysteer::calib::model {

/// A flat mirror that turns about a line.
struct MirrorPart {
  Eigen::Vector3d axis = Eigen::Vector3d::UnitY();     ///< unit, direction of the line
  Eigen::Vector3d point = Eigen::Vector3d::Zero();     ///< on the line, metres
  Eigen::Vector3d normal = -Eigen::Vector3d::UnitZ();  ///< at rest, unit, towards the light
  double offset_m = 0;                                 ///< of the surface from `point`, along the normal
  Eigen::Vector2d size_m{0, 0};                        ///< outline: full width across the axis, length along it
  bool ellipse = true;                                 ///< outline: ellipse or rectangle
};

/// From command to mechanical angle of one axis:
/// angle = half_range ((1 + gain) u + quadratic u^2 + cubic u^3 + cross_talk u_other), u = command / half_range.
struct CommandCurve {
  double half_range = 1;  ///< rad
  double gain = 0;
  double quadratic = 0;
  double cubic = 0;
  double cross_talk = 0;
};

enum class MirrorKind {
  kGalvoPair,  ///< two mirrors; light meets parts[0] first; axis k turns parts[k]
  kHead        ///< one mirror, parts[0], on the inner axis (axis 2), which the outer axis (axis 1) carries
};

struct SteeredProjector {
  Camera lens;  ///< its width and height are the panel's
  Pose T_projector_rig;
  MirrorKind kind = MirrorKind::kGalvoPair;
  std::array<MirrorPart, 2> parts;
  Eigen::Vector3d outer_axis = Eigen::Vector3d::UnitZ();  ///< head only, unit
  Eigen::Vector3d outer_point = Eigen::Vector3d::Zero();  ///< head only, metres
  std::array<CommandCurve, 2> curves;
  Eigen::Vector2d least_rad{-1, -1};  ///< commands that are allowed
  Eigen::Vector2d most_rad{1, 1};

  /// Mechanical angles of a command, radians.
  Eigen::Vector2d angles(const Eigen::Vector2d& command_rad) const;
  VirtualProjector at_angles(const Eigen::Vector2d& angles_rad) const;
  VirtualProjector at(const Eigen::Vector2d& command_rad) const { return at_angles(angles(command_rad)); }
  bool in_range(const Eigen::Vector2d& command_rad) const {
    return (command_rad.array() >= least_rad.array()).all() && (command_rad.array() <= most_rad.array()).all();
  }
};

}  // namespace raysteer::calib::model
