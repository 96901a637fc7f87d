// One way to lay measured datums over surveyed ones, and how well it fits. Inside calib/datum only.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "calib/model/pose.hpp"

namespace raysteer::calib::datum {

/// Surveyed and measured places of the same N datums; covariances 3N x 3N, m^2.
struct Pairs {
  std::vector<Eigen::Vector3d> surveyed;  ///< room
  std::vector<Eigen::Vector3d> normals;   ///< room, unit
  std::vector<Eigen::Vector3d> measured;  ///< rig
  Eigen::MatrixXd cov_surveyed;
  Eigen::MatrixXd cov_measured;

  std::size_t size() const { return surveyed.size(); }
};

/// What a fit may explain besides a pose.
struct Freedom {
  bool scale = false;
  std::vector<std::size_t> moved;  ///< datums that stand somewhere else
};

struct Fit {
  model::Pose T_room_rig;
  double scale = 1;                    ///< room metres a rig metre
  std::vector<Eigen::Vector3d> moved;  ///< where they stand minus where the survey says, room; as in Freedom::moved
  Eigen::MatrixXd cov;                 ///< of the increment: rotation, translation, scale if free, moves
  Eigen::MatrixXd gain;                ///< the increment an added measured error gives, room axes: p x 3N
  std::vector<Eigen::Vector3d> misses;
  Eigen::VectorXd sigmas;  ///< of each coordinate of the misses, before the fit
  double chi_square = 0;
  int dof = 0;
  bool faces = false;  ///< the rig stands before all datums' faces
};

/// No value when the datums left cannot fix it: fewer than three, in a line, or fewer equations than unknowns.
std::optional<Fit> fit(const Pairs& pairs, const Freedom& freedom);

/// chi-square that one in 100,000 good fits exceeds (Wilson and Hilferty, 1931).
double acceptable(int dof);
/// One in 1000: worth asking whether one thing alone explains it.
double unsuspicious(int dof);

}  // namespace raysteer::calib::datum
