#include "sim/rig/truth.hpp"

#include <Eigen/Geometry>

#include "hal/base/noise.hpp"

namespace raysteer::sim::rig {
namespace {

using Eigen::Vector3d;
using proto::board::Tolerance;

Vector3d normals(Noise& noise, double sigma) {
  // One after the other: the order in which arguments are evaluated is not
  // fixed.
  const double x = noise.normal();
  const double y = noise.normal();
  const double z = noise.normal();
  return sigma * Vector3d(x, y, z);
}

Eigen::Matrix3d turn(const Vector3d& rotation) {
  const double angle = rotation.norm();
  return angle > 0 ? Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix() : Eigen::Matrix3d::Identity();
}

void disturb(optics::Lens& lens, const Tolerance& tolerance, Noise& noise) {
  optics::LensNumbers numbers = lens.numbers();
  numbers.focal_px *= 1 + tolerance.focal * noise.normal();
  numbers.centre_px.x() += tolerance.centre * numbers.focal_px.x() * noise.normal();
  numbers.centre_px.y() += tolerance.centre * numbers.focal_px.y() * noise.normal();
  numbers.distortion[0] += tolerance.distortion * noise.normal();
  lens = optics::Lens(numbers);
}

// Mounted askew: the device turns and moves in its own frame.
void disturb(Eigen::Isometry3d& T_device_rig, const Tolerance& tolerance, Noise& noise) {
  const Vector3d rotation = normals(noise, tolerance.mount_rad);
  const Vector3d shift = normals(noise, tolerance.mount_m);
  T_device_rig.linear() = turn(rotation) * T_device_rig.linear();
  T_device_rig.translation() += shift;
}

Vector3d askew(const Vector3d& direction, double sigma, Noise& noise) {
  return (turn(normals(noise, sigma)) * direction).normalized();
}

void disturb(optics::MirrorPart& part, const Tolerance& tolerance, Noise& noise) {
  part.axis = askew(part.axis, tolerance.axis_rad, noise);
  part.point += normals(noise, tolerance.position_m);
  part.normal = turn(tolerance.zero_rad * noise.normal() * part.axis) * askew(part.normal, tolerance.axis_rad, noise);
  part.offset_m += tolerance.position_m * noise.normal();
}

hal::mock::CommandCurve draw_curve(double half_range, const Tolerance& tolerance, Noise& noise) {
  hal::mock::CommandCurve curve{.half_range = half_range};
  curve.gain = tolerance.gain * noise.normal();
  curve.quadratic = tolerance.quadratic * noise.normal();
  curve.cubic = tolerance.cubic * noise.normal();
  curve.cross_talk = tolerance.cross_talk * noise.normal();
  return curve;
}

}  // namespace

Result<Truth> draw_truth(const proto::board::Board& board, std::uint64_t seed) {
  Result<optics::TrueRig> drawn = optics::rig_as_drawn(board);
  if (!drawn) {
    return std::move(drawn).error();
  }
  Truth truth{.seed = seed, .rig = *std::move(drawn), .curves = {}};
  const Tolerance& tolerance = board.tolerance;
  Noise noise(seed,
              0x7275);  // a stream of its own: devices draw theirs from the same seed
  disturb(truth.rig.cameras[0].lens, tolerance, noise);
  disturb(truth.rig.cameras[1].lens, tolerance, noise);
  disturb(truth.rig.cameras[1].T_camera_rig, tolerance, noise);
  disturb(truth.rig.projector.lens, tolerance, noise);
  disturb(truth.rig.projector.T_projector_rig, tolerance, noise);
  for (std::size_t k = 0; k < static_cast<std::size_t>(truth.rig.mirror.count()); ++k) {
    disturb(truth.rig.mirror.parts[k], tolerance, noise);
  }
  if (truth.rig.mirror.head) {
    truth.rig.mirror.outer_axis = askew(truth.rig.mirror.outer_axis, tolerance.axis_rad, noise);
    truth.rig.mirror.outer_point += normals(noise, tolerance.position_m);
  }
  for (std::size_t axis = 0; axis < 2; ++axis) {
    truth.curves[axis] = draw_curve(board.mirror.half_range_rad[axis], tolerance, noise);
  }
  return truth;
}

}  // namespace raysteer::sim::rig
