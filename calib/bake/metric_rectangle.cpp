#include "calib/bake/metric_rectangle.hpp"

#include <limits>

namespace raysteer::calib::bake {

Eigen::Vector2d level_axis(const model::Pose& T_camera_plane) {
  const Eigen::Vector3d x_axis = T_camera_plane.q.conjugate() * Eigen::Vector3d::UnitX();
  return x_axis.head<2>().normalized();
}

MetricRectangle level_rectangle(const model::Pose& T_camera_plane, const Eigen::Vector2d& offset_m, double width_m,
                                double height_m) {
  MetricRectangle rectangle{
      .corner = Eigen::Vector2d::Zero(), .along = level_axis(T_camera_plane), .width_m = width_m, .height_m = height_m};
  rectangle.corner = rectangle.on_plane(offset_m - 0.5 * Eigen::Vector2d(width_m, height_m));
  return rectangle;
}

std::optional<Eigen::Vector2d> content_at(const model::PanelOnPlane& panel, const MetricRectangle& rectangle,
                                          const Eigen::Vector2d& x) {
  const auto p = panel.on_plane(x);
  return p ? std::optional(rectangle.content(*p)) : std::nullopt;
}

std::optional<Unwarped> unwarped(const model::PanelOnPlane& panel, const MetricRectangle& rectangle,
                                 double metres_per_px) {
  const Eigen::Vector2d middle_m = 0.5 * Eigen::Vector2d(rectangle.width_m, rectangle.height_m);
  const auto middle_px = panel.on_panel(rectangle.on_plane(middle_m));
  if (!middle_px) {
    return std::nullopt;
  }
  std::optional<Unwarped> best;
  double least = std::numeric_limits<double>::infinity();
  for (int quarter = 0; quarter < 4; ++quarter) {
    for (const double flip : {1.0, -1.0}) {
      Eigen::Matrix2d turn;
      turn << (quarter == 0) - (quarter == 2), (quarter == 3) - (quarter == 1),  //
          (quarter == 1) - (quarter == 3), (quarter == 0) - (quarter == 2);
      Unwarped trial{.middle_px = *middle_px,
                     .content_by_px = metres_per_px * turn * Eigen::Vector2d(flip, 1).asDiagonal(),
                     .middle_m = middle_m};
      double miss = 0;
      for (const Eigen::Vector2d& corner : rectangle.corners()) {
        const auto p = panel.on_plane(trial.on_panel(rectangle.content(corner)));
        miss += p ? (*p - corner).norm() : std::numeric_limits<double>::max() / 8;
      }
      if (miss < least) {
        least = miss;
        best = trial;
      }
    }
  }
  return best;
}

}  // namespace raysteer::calib::bake
