#include "calib/bake/content.hpp"

#include "proto/lut/warp_map.hpp"

namespace raysteer::calib::bake {

Content draped_content(const Station& station) {
  const Eigen::Matrix3d R_plane_rig = station.T_rig_plane.rotation().transpose();
  const Eigen::Vector3d t = -(R_plane_rig * station.T_rig_plane.t);
  Content content{.name = station.name,
                  .content_px = station.content_px,
                  .plane = std::nullopt,
                  .metres_per_px = station.size_m.x() / station.content_px.x(),
                  .tolerance_m = 1e-3 * station.tolerance_mm};
  for (int axis = 0; axis < 2; ++axis) {
    // The rectangle's edge is the outer edge of the outermost pixels.
    const double px_per_m = station.content_px[axis] / station.size_m[axis];
    content.content_rig.row(axis) << px_per_m * R_plane_rig.row(axis),
        px_per_m * t[axis] + 0.5 * station.content_px[axis] - 0.5;
  }
  content.content_rig(2, 3) = 1;
  return content;
}

Content metric_content(const Station& station) {
  Content content = draped_content(station);
  const Eigen::Vector3d normal = station.T_rig_plane.q * Eigen::Vector3d::UnitZ();
  content.plane = {.normal = normal, .distance_m = normal.dot(station.T_rig_plane.t)};
  return content;
}

Content seen_content(std::string name, const model::Pose& T_eye_rig, double focal_px, const Eigen::Vector2d& centre_px,
                     const Eigen::Vector2i& content_px, const std::optional<SurfacePlane>& plane) {
  Eigen::Matrix3d K;
  K << focal_px, 0, centre_px.x(), 0, focal_px, centre_px.y(), 0, 0, 1;
  Content content{.name = std::move(name), .content_px = content_px, .plane = plane};
  content.content_rig << K * T_eye_rig.rotation(), K * T_eye_rig.t;
  return content;
}

Sight sight(const Content& content, const Eigen::Vector2d& uv) {
  const Eigen::Matrix3d A = content.content_rig.leftCols<3>();
  const Eigen::Vector3d b = content.content_rig.col(3);
  if (A.row(2).norm() > 0) {
    const Eigen::Matrix3d back = A.inverse();
    return {.origin = -(back * b), .direction = (back * uv.homogeneous()).normalized()};
  }
  // Parallel ways: the third row is 0 0 0 1, and content lies on the far side of x times y.
  constexpr double kBefore = 50;
  const Eigen::Vector3d direction = A.row(0).cross(A.row(1)).normalized();
  Eigen::Matrix3d rows = A;
  rows.row(2) = direction.transpose();
  return {.origin = rows.inverse() * Eigen::Vector3d(uv.x() - b.x(), uv.y() - b.y(), -kBefore), .direction = direction};
}

Status check(const Station& station) {
  if (!station.T_rig_plane.q.coeffs().allFinite() || !station.T_rig_plane.t.allFinite() ||
      !station.size_m.allFinite() || (station.command_rad && !station.command_rad->allFinite())) {
    return fail(RCode::kNotFinite, "pose, size and command of station '" + station.name + "' must be finite numbers");
  }
  constexpr double kLeast = 1e-3;  // metres
  constexpr double kMost = 100;
  if (!(station.size_m.minCoeff() >= kLeast) || !(station.size_m.maxCoeff() <= kMost)) {
    return fail(RCode::kBadValue, "station '" + station.name + "' is " + std::to_string(station.size_m.x()) + " x " +
                                      std::to_string(station.size_m.y()) + " m; expected 0.001 to 100 m");
  }
  if (!(station.tolerance_mm >= 0)) {
    return fail(RCode::kBadValue, "the tolerance of station '" + station.name + "' must not be negative");
  }
  return ok();
}

Status check(const Content& content) {
  if (content.name.empty() || content.name.size() > proto::lut::kLongestName) {
    return fail(RCode::kBadValue, "a station's name has 1 to 64 bytes, got '" + content.name + "'");
  }
  if (content.content_px.minCoeff() < 1 || content.content_px.maxCoeff() > proto::lut::kLargestSide) {
    return fail(RCode::kBadValue, "the content of station '" + content.name + "' is " +
                                      std::to_string(content.content_px.x()) + " x " +
                                      std::to_string(content.content_px.y()) + " px; expected 1 to 16384");
  }
  if (!content.content_rig.allFinite() ||
      (content.plane && (!content.plane->normal.allFinite() || !std::isfinite(content.plane->distance_m)))) {
    return fail(RCode::kNotFinite, "the placing of content '" + content.name + "' must be finite numbers");
  }
  return ok();
}

}  // namespace raysteer::calib::bake
