#include "calib/model/panel_on_plane.hpp"

#include <cmath>

namespace raysteer::calib::model {

Eigen::Vector2d PanelOnPlane::counted(const Eigen::Vector2d& x) const {
  return mirrored ? Eigen::Vector2d(lens.width - 1 - x.x(), x.y()) : x;
}

std::optional<Eigen::Vector2d> PanelOnPlane::on_plane(const Eigen::Vector2d& x) const {
  return model::on_plane(lens, T_projector_plane, counted(x));
}

std::optional<Eigen::Vector2d> PanelOnPlane::on_panel(const Eigen::Vector2d& p) const {
  const auto x = lens.project(T_projector_plane * Eigen::Vector3d(p.x(), p.y(), 0));
  return x ? std::optional(counted(*x)) : std::nullopt;
}

Camera flipped(const Camera& lens) {
  Camera other = lens;
  other.cx = lens.width - 1 - lens.cx;
  // x -> -x turns 2 p1 x y + p2 (r^2 + 2 x^2), which moves x, into -p2; p1's part keeps its sign (algorithms 4.3).
  other.k[3] = -lens.k[3];
  return other;
}

std::optional<Eigen::Vector2d> on_plane(const Camera& camera, const Pose& T_camera_plane, const Eigen::Vector2d& q) {
  const auto n = camera.normalize(q);
  if (!n) {
    return std::nullopt;
  }
  const Pose T_plane_camera = T_camera_plane.inverse();
  const Eigen::Vector3d direction = T_plane_camera.q * Eigen::Vector3d(n->x(), n->y(), 1);
  const double s = -T_plane_camera.t.z() / direction.z();
  if (!(s > 0) || !std::isfinite(s)) {
    return std::nullopt;
  }
  return Eigen::Vector2d((T_plane_camera.t + s * direction).head<2>());
}

}  // namespace raysteer::calib::model
