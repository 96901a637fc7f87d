#include "sim/optics/true_rig.hpp"

#include <string>

namespace raysteer::sim::optics {
namespace {

Eigen::Vector3d vector(const proto::board::Vec3& v) { return {v[0], v[1], v[2]}; }

Eigen::Isometry3d isometry(const proto::board::Pose& pose) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d rotation = vector(pose.rotation);
  if (const double angle = rotation.norm(); angle > 0) {
    T.linear() = Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
  }
  T.translation() = vector(pose.translation);
  return T;
}

Lens lens(const proto::board::Lens& drawn) {
  const auto [k1, k2, p1, p2] = drawn.distortion;
  return Lens({.focal_px = Eigen::Vector2d::Constant(drawn.focal_px),
               .centre_px = {drawn.centre_px[0], drawn.centre_px[1]},
               .distortion = {k1, k2, p1, p2, 0}});
}

Result<Eigen::Vector3d> unit(const proto::board::Vec3& v, const std::string& what) {
  const double length = vector(v).norm();
  if (!(length > 1e-9) || !std::isfinite(length)) {
    return fail(RCode::kBadValue, what + ": expected a direction, got a vector without length");
  }
  return Eigen::Vector3d(vector(v) / length);
}

Status check_lens(const Lens& lens, int width, int height, const std::string& what) {
  if (!lens.covers(width, height)) {
    return fail(RCode::kBadValue, what + ": the distortion folds the picture back inside its " + std::to_string(width) +
                                      "x" + std::to_string(height) + " pixels; expected one that stays monotonic");
  }
  return ok();
}

Result<MirrorPart> mirror_part(const proto::board::MirrorPlane& drawn, const std::string& what) {
  auto axis = unit(drawn.axis, what + ".axis");
  RAYSTEER_TRY(axis);
  auto normal = unit(drawn.normal, what + ".normal");
  RAYSTEER_TRY(normal);
  if (std::abs(axis->dot(*normal)) > 0.9) {
    return fail(RCode::kBadValue, what + ": the axis is nearly the normal; expected it nearly in the mirror");
  }
  return MirrorPart{.axis = *axis,
                    .point = vector(drawn.point),
                    .normal = *normal,
                    .offset_m = drawn.offset_m,
                    .half_size_m = {drawn.size_m[0] / 2, drawn.size_m[1] / 2},
                    .ellipse = drawn.ellipse};
}

Result<TrueMirror> mirror(const proto::board::Mirror& drawn) {
  TrueMirror mirror;
  mirror.head = drawn.kind == proto::board::MirrorKind::kHead;
  if (static_cast<int>(drawn.planes.size()) != mirror.count()) {
    return fail(RCode::kBadValue, "mirror: expected " + std::to_string(mirror.count()) + " planes, got " +
                                      std::to_string(drawn.planes.size()));
  }
  for (std::size_t k = 0; k < drawn.planes.size(); ++k) {
    auto part = mirror_part(drawn.planes[k], "mirror plane " + std::to_string(k + 1));
    RAYSTEER_TRY(part);
    mirror.parts[k] = *part;
  }
  if (mirror.head) {
    auto axis = unit(drawn.outer_axis, "mirror.outer_axis");
    RAYSTEER_TRY(axis);
    mirror.outer_axis = *axis;
    mirror.outer_point = vector(drawn.outer_point);
  }
  return mirror;
}

}  // namespace

Result<TrueRig> rig_as_drawn(const proto::board::Board& board) {
  TrueRig rig;
  if (board.cameras.size() != rig.cameras.size()) {
    return fail(RCode::kBadValue, "board: expected 2 cameras, got " + std::to_string(board.cameras.size()));
  }
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    const proto::board::Camera& drawn = board.cameras[i];
    TrueCamera& camera = rig.cameras[i];
    camera = {.name = drawn.name,
              .width = drawn.width,
              .height = drawn.height,
              .lens = lens(drawn.lens),
              .T_camera_rig = isometry(drawn.T_camera_rig),
              .f_number = drawn.f_number,
              .pixel_m = drawn.pixel_m,
              .quantum_efficiency = drawn.quantum_efficiency};
    RAYSTEER_TRY(check_lens(camera.lens, camera.width, camera.height, "camera '" + camera.name + "'"));
  }
  const proto::board::Projector& drawn = board.projector;
  rig.projector = {.width = drawn.width,
                   .height = drawn.height,
                   .lens = lens(drawn.lens),
                   .T_projector_rig = isometry(drawn.T_projector_rig),
                   .lumens = drawn.lumens,
                   .focus_m = drawn.focus_m,
                   .pupil_m = drawn.pupil_m};
  RAYSTEER_TRY(check_lens(rig.projector.lens, drawn.width, drawn.height, "projector"));
  auto true_mirror = mirror(board.mirror);
  RAYSTEER_TRY(true_mirror);
  rig.mirror = *true_mirror;
  return rig;
}

}  // namespace raysteer::sim::optics
