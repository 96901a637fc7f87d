// value: a rectangle in metres on a plane, and the pictures that show it there.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <optional>

#include "calib/model/panel_on_plane.hpp"
#include "calib/model/pose.hpp"

namespace raysteer::calib::bake {

/// Places are metres in the plane's frame (x right, y down as seen from the camera, z away from it).
struct MetricRectangle {
  Eigen::Vector2d corner = Eigen::Vector2d::Zero();  ///< top left
  Eigen::Vector2d along{1, 0};                       ///< unit, towards top right
  double width_m = 0.5;
  double height_m = 0.3125;

  Eigen::Vector2d down() const { return {-along.y(), along.x()}; }
  /// Of a place on the rectangle, metres from its top left corner.
  Eigen::Vector2d on_plane(const Eigen::Vector2d& content) const {
    return corner + content.x() * along + content.y() * down();
  }
  Eigen::Vector2d content(const Eigen::Vector2d& p) const {
    return {(p - corner).dot(along), (p - corner).dot(down())};
  }
  /// Top left, top right, bottom right, bottom left.
  std::array<Eigen::Vector2d, 4> corners() const {
    return {on_plane({0, 0}), on_plane({width_m, 0}), on_plane({width_m, height_m}), on_plane({0, height_m})};
  }
};

/// The projection of the camera's x axis on the plane: the direction that looks level to the camera (algorithms 6.1).
Eigen::Vector2d level_axis(const model::Pose& T_camera_plane);

/// A rectangle parallel to the camera's x axis whose middle lies `offset_m` from the plane's origin along that axis and
/// down from it.
MetricRectangle level_rectangle(const model::Pose& T_camera_plane, const Eigen::Vector2d& offset_m, double width_m,
                                double height_m);

/// Exact backward map of a posed projector: panel pixel to metres on the rectangle. No value where it lights no plane.
std::optional<Eigen::Vector2d> content_at(const model::PanelOnPlane& panel, const MetricRectangle& rectangle,
                                          const Eigen::Vector2d& x);

/// What is sent without knowing where the projector stands: the rectangle straight on the panel, its size by the
/// drawing's throw. As a person would, it is slid to where its middle is wanted and turned by quarter turns, or flipped
/// in the projector's menu, until it comes out best.
struct Unwarped {
  Eigen::Vector2d middle_px = Eigen::Vector2d::Zero();
  Eigen::Matrix2d content_by_px =
      Eigen::Matrix2d::Identity();                     ///< metres a panel pixel: a quarter turn or flip, scaled
  Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();  ///< the rectangle's middle as content

  Eigen::Vector2d content(const Eigen::Vector2d& x) const { return middle_m + content_by_px * (x - middle_px); }
  Eigen::Vector2d on_panel(const Eigen::Vector2d& content) const {
    return middle_px + content_by_px.inverse() * (content - middle_m);
  }
};
/// No value when the rectangle's middle is not before the projector.
std::optional<Unwarped> unwarped(const model::PanelOnPlane& panel, const MetricRectangle& rectangle,
                                 double metres_per_px);

}  // namespace raysteer::calib::bake
