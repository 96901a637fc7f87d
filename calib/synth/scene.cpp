#include "calib/synth/scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace raysteer::calib::synth {
namespace {

/// Shadow rays stop this share of their length short of both ends, so that a surface does not shade itself.
constexpr double kShadowMargin = 1e-7;

std::optional<double> meet(const Plate& plate, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                           double s_max, Eigen::Vector2d& place) {
  const Eigen::Matrix3d R = plate.T_rig_plate.rotation();
  const double slope = R.col(2).dot(direction);
  if (slope == 0) {
    return std::nullopt;
  }
  const Eigen::Vector3d to_plate = plate.T_rig_plate.t - origin;
  const double s = R.col(2).dot(to_plate) / slope;
  if (!(s > 0) || s >= s_max) {
    return std::nullopt;
  }
  const Eigen::Vector3d on_plate = s * direction - to_plate;
  place = {R.col(0).dot(on_plate), R.col(1).dot(on_plate)};
  const bool inside = place.x() >= plate.u0 && place.x() <= plate.u1 && place.y() >= plate.v0 && place.y() <= plate.v1;
  return inside ? std::optional(s) : std::nullopt;
}

std::optional<double> meet(const Ball& ball, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                           double s_max) {
  const Eigen::Vector3d from_centre = origin - ball.centre;
  const double a = direction.squaredNorm();
  const double b = direction.dot(from_centre);
  const double root = b * b - a * (from_centre.squaredNorm() - ball.radius * ball.radius);
  if (root < 0) {
    return std::nullopt;
  }
  for (const double s : {(-b - std::sqrt(root)) / a, (-b + std::sqrt(root)) / a}) {
    if (s > 0 && s < s_max) {
      return s;
    }
  }
  return std::nullopt;
}

}  // namespace

Plate plate(const model::Pose& T_rig_plate, double width, double height, double albedo) {
  return {T_rig_plate, -width / 2, width / 2, -height / 2, height / 2, albedo, nullptr};
}

Plate target_plate(const model::Pose& T_rig_target, std::shared_ptr<const Print> print, double margin_m) {
  const TargetSpec& target = print->target();
  const double edge = target.square_m + margin_m;
  const double width = target.square_m * (target.corner_columns() - 1);
  const double height = target.square_m * (target.corner_rows() - 1);
  constexpr double kPaper = 0.85;
  return {T_rig_target, -edge, width + edge, -edge, height + edge, kPaper, std::move(print)};
}

void add_box(Scene& scene, const model::Pose& T_rig_box, const Eigen::Vector3d& size, double albedo) {
  for (int axis = 0; axis < 3; ++axis) {
    const int along_u = (axis + 1) % 3;
    const int along_v = (axis + 2) % 3;
    for (const double side : {-0.5, 0.5}) {
      model::Pose T_box_face;
      Eigen::Matrix3d R = Eigen::Matrix3d::Zero();
      R(along_u, 0) = 1;
      R(along_v, 1) = 1;
      R(axis, 2) = 1;
      T_box_face.q = Eigen::Quaterniond(R);
      T_box_face.t[axis] = side * size[axis];
      scene.plates.push_back(plate(T_rig_box * T_box_face, size[along_u], size[along_v], albedo));
    }
  }
}

std::optional<Hit> first_hit(const Scene& scene, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  Hit hit;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < scene.plates.size(); ++i) {
    Eigen::Vector2d place = Eigen::Vector2d::Zero();
    if (const auto s = meet(scene.plates[i], origin, direction, nearest, place)) {
      const Eigen::Vector3d z = scene.plates[i].T_rig_plate.q * Eigen::Vector3d::UnitZ();
      nearest = *s;
      hit.surface = static_cast<int>(i);
      hit.u = place.x();
      hit.v = place.y();
      hit.front = z.dot(direction) > 0;
      hit.normal = hit.front ? Eigen::Vector3d(-z) : z;
    }
  }
  for (std::size_t i = 0; i < scene.balls.size(); ++i) {
    if (const auto s = meet(scene.balls[i], origin, direction, nearest)) {
      nearest = *s;
      hit.surface = static_cast<int>(scene.plates.size() + i);
      hit.normal = (origin + *s * direction - scene.balls[i].centre).normalized();
      hit.front = false;
    }
  }
  if (hit.surface < 0) {
    return std::nullopt;
  }
  hit.s = nearest;
  hit.p = origin + nearest * direction;
  return hit;
}

bool blocked(const Scene& scene, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d way = to - from;
  const Eigen::Vector3d origin = from + kShadowMargin * way;
  const double s_max = 1 - 2 * kShadowMargin;
  for (const Plate& each : scene.plates) {
    Eigen::Vector2d place = Eigen::Vector2d::Zero();
    if (meet(each, origin, way, s_max, place)) {
      return true;
    }
  }
  for (const Ball& each : scene.balls) {
    if (meet(each, origin, way, s_max)) {
      return true;
    }
  }
  return false;
}

double distance_to(const Scene& scene, const Eigen::Vector3d& p) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Plate& each : scene.plates) {
    const Eigen::Vector3d local = each.T_rig_plate.inverse() * p;
    const Eigen::Vector3d on_plate(std::clamp(local.x(), each.u0, each.u1), std::clamp(local.y(), each.v0, each.v1), 0);
    nearest = std::min(nearest, (local - on_plate).norm());
  }
  for (const Ball& each : scene.balls) {
    nearest = std::min(nearest, std::abs((p - each.centre).norm() - each.radius));
  }
  return nearest;
}

}  // namespace raysteer::calib::synth
