#include "host/rig/drawing.hpp"

#include <cmath>
#include <string>

namespace raysteer::host::rig {
namespace {

namespace board = proto::board;
using calib::model::Camera;
using calib::model::Pose;

Eigen::Vector3d vector(const board::Vec3& v) { return {v[0], v[1], v[2]}; }

Pose pose(const board::Pose& drawn) {
  return {calib::model::rotation_by(vector(drawn.rotation)), vector(drawn.translation)};
}

Camera camera(const board::Lens& lens, int width, int height) {
  const auto [k1, k2, p1, p2] = lens.distortion;
  return {.width = width,
          .height = height,
          .fx = lens.focal_px,
          .fy = lens.focal_px,
          .cx = lens.centre_px[0],
          .cy = lens.centre_px[1],
          .k = {k1, k2, p1, p2}};
}

Result<Eigen::Vector3d> unit(const board::Vec3& v, const std::string& what) {
  const double length = vector(v).norm();
  if (!(length > 1e-9) || !std::isfinite(length)) {
    return fail(RCode::kBadValue, what + ": expected a direction, got a vector without length");
  }
  return Eigen::Vector3d(vector(v) / length);
}

}  // namespace

Result<calib::steer::Drawing> drawing_of(const board::Board& board) {
  calib::steer::Drawing drawing;
  calib::model::SteeredProjector& projector = drawing.projector;
  projector.lens = camera(board.projector.lens, board.projector.width, board.projector.height);
  projector.T_projector_rig = pose(board.projector.T_projector_rig);
  const bool head = board.mirror.kind == board::MirrorKind::kHead;
  projector.kind = head ? calib::model::MirrorKind::kHead : calib::model::MirrorKind::kGalvoPair;
  const std::size_t planes = head ? 1 : 2;
  if (board.mirror.planes.size() != planes) {
    return fail(RCode::kBadValue, "mirror: expected " + std::to_string(planes) + " planes, got " +
                                      std::to_string(board.mirror.planes.size()));
  }
  for (std::size_t k = 0; k < planes; ++k) {
    const board::MirrorPlane& plane = board.mirror.planes[k];
    const std::string what = "mirror plane " + std::to_string(k + 1);
    const auto axis = unit(plane.axis, what + ".axis");
    RAYSTEER_TRY(axis);
    const auto normal = unit(plane.normal, what + ".normal");
    RAYSTEER_TRY(normal);
    projector.parts[k] = {.axis = *axis,
                          .point = vector(plane.point),
                          .normal = *normal,
                          .offset_m = plane.offset_m,
                          .size_m = {plane.size_m[0], plane.size_m[1]},
                          .ellipse = plane.ellipse};
  }
  if (head) {
    const auto axis = unit(board.mirror.outer_axis, "mirror.outer_axis");
    RAYSTEER_TRY(axis);
    projector.outer_axis = *axis;
    projector.outer_point = vector(board.mirror.outer_point);
  }
  for (std::size_t k = 0; k < 2; ++k) {
    projector.curves[k].half_range = board.mirror.half_range_rad[k];
    projector.least_rad[static_cast<Eigen::Index>(k)] = board.mirror.least_rad[k];
    projector.most_rad[static_cast<Eigen::Index>(k)] = board.mirror.most_rad[k];
  }
  const board::Tolerance& drawn = board.tolerance;
  calib::steer::Tolerance& tolerance = drawing.tolerance;
  tolerance.axis_rad = drawn.axis_rad;
  tolerance.position_m = drawn.position_m;
  tolerance.zero_rad = drawn.zero_rad;
  tolerance.gain = drawn.gain;
  tolerance.quadratic = drawn.quadratic;
  tolerance.cubic = drawn.cubic;
  tolerance.cross_talk = drawn.cross_talk;
  tolerance.focal = drawn.focal;
  tolerance.centre = drawn.centre;
  tolerance.distortion = drawn.distortion;
  tolerance.mount_rad = drawn.mount_rad;
  tolerance.mount_m = drawn.mount_m;
  return drawing;
}

calib::model::Rig cameras_of(const board::Board& board) {
  calib::model::Rig rig;
  for (const board::Camera& drawn : board.cameras) {
    rig.devices.push_back({.name = drawn.name,
                           .camera = camera(drawn.lens, drawn.width, drawn.height),
                           .T_device_rig = pose(drawn.T_camera_rig)});
  }
  return rig;
}

}  // namespace raysteer::host::rig
