// value: where light is expected to fall: the floor, or whatever stands in for it before anything was measured.
#pragma once

#include <Eigen/Dense>
#include <optional>

#include "calib/model/virtual_projector.hpp"

namespace raysteer::calib::plan {

/// The plane normal.p = distance_m, rig frame.
struct ScenePlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit
  double distance_m = 0;
};

/// Where panel pixel x lights the plane, rig frame. No value where its light does not meet the plane ahead.
inline std::optional<Eigen::Vector3d> lit_on(const ScenePlane& plane, const model::VirtualProjector& view,
                                             const Eigen::Vector2d& x) {
  const auto ray = view.ray(x);
  if (!ray) {
    return std::nullopt;
  }
  const double towards = plane.normal.dot(*ray);
  const double way = (plane.distance_m - plane.normal.dot(view.centre())) / towards;
  // Light that grazes the plane at less than three degrees lights nothing that could be measured.
  if (!(std::abs(towards) > 0.05 && way > 0)) {
    return std::nullopt;
  }
  return view.centre() + way * *ray;
}

}  // namespace raysteer::calib::plan
