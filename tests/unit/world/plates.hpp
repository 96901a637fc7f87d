// pure: a room of plates, whose rays are met by hand in double precision.
#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <vector>

#include "tests/unit/world/small_world.hpp"

namespace raysteer::sim::world {

struct Plate {
  Eigen::Vector3d place, turn;
  double x0, y0, x1, y1;
  double albedo;

  Eigen::Matrix3d R() const {
    return turn.norm() > 0 ? Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix()
                           : Eigen::Matrix3d::Identity();
  }
};

/// A wall and three plates before it.
inline const std::vector<Plate>& plates() {
  static const std::vector<Plate> all{{{0, 0, 3.1}, {0.05, 0.1, 0}, -9, -9, 9, 9, 0.6},
                                      {{0.1, 0.2, 2.6}, {0.4, -0.2, 0.3}, -0.4, -0.3, 0.3, 0.3, 0.3},
                                      {{-0.4, -0.1, 2.8}, {-0.3, 0.5, 1}, -0.2, -0.3, 0.2, 0.3, 0.8},
                                      {{0.5, -0.3, 2.4}, {0, 0, 0}, -0.1, -0.2, 0.3, 0.2, 0.5}};
  return all;
}

struct Met {
  double distance = std::numeric_limits<double>::infinity();
  std::size_t plate = 0;
  double margin = 1;  ///< to the nearest rim of any plate the ray passes, metres
};

/// The first plate a ray meets farther away than `least`.
inline Met meet(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double least = 0) {
  Met met;
  for (std::size_t i = 0; i < plates().size(); ++i) {
    const Plate& plate = plates()[i];
    const Eigen::Matrix3d R = plate.R();
    const Eigen::Vector3d from = R.transpose() * (origin - plate.place);
    const Eigen::Vector3d along = R.transpose() * direction;
    const double distance = -from.z() / along.z();
    const Eigen::Vector3d at = from + distance * along;
    const double inside = std::min({at.x() - plate.x0, plate.x1 - at.x(), at.y() - plate.y0, plate.y1 - at.y()});
    if (distance > least) {
      met.margin = std::min(met.margin, std::abs(inside));
      if (inside > 0 && distance < met.distance) {
        met.distance = distance;
        met.plate = i;
      }
    }
  }
  return met;
}

inline scene::Scene room_of_plates() {
  scene::Scene room;
  for (const Plate& plate : plates()) {
    room.surfaces.push_back(surface("plate", scene::rectangle(plate.x0, plate.y0, plate.x1, plate.y1), plate.albedo,
                                    plate.place, plate.turn));
  }
  return room;
}

}  // namespace raysteer::sim::world
