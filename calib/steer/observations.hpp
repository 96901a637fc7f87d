// value: what both eyes saw of the projector's light, look by look; everything the steered rig is solved from.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/rig.hpp"

namespace raysteer::calib::steer {

/// One projector pixel on a surface, seen by both cameras.
struct LitPoint {
  Eigen::Vector2d x;                     ///< panel px
  std::array<Eigen::Vector2d, 2> q;      ///< camera px: left, right
  Eigen::Matrix2d cov_x;                 ///< px^2; zero where x is known exactly
  std::array<Eigen::Matrix2d, 2> cov_q;  ///< px^2
};

struct Look {
  std::string name;
  Eigen::Vector2d command_rad = Eigen::Vector2d::Zero();
  std::optional<Eigen::Vector2d> feedback_rad;  ///< what the mirror's sensor said, if it has one
  std::vector<LitPoint> points;
};

/// Looks in the order they were taken.
struct Observations {
  model::Rig cameras;  ///< left (the rig's frame), right; with their covariance, which becomes a prior
  std::vector<Look> looks;
};

}  // namespace raysteer::calib::steer
