#include "calib/look/board_plane.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "calib/solve/closed_form.hpp"

namespace raysteer::calib::look {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double kMostMissPx = 0.5;
constexpr std::size_t kFewest = 6;

struct Normal {
  Matrix6 h = Matrix6::Zero();
  Vector6 g = Vector6::Zero();
  double whitened = 0;  ///< squares
  double squares_px = 0;
  int corners = 0;
};

/// No value where a corner is behind an eye.
std::optional<Normal> normal_equations(const TargetSpec& target, std::span<const Sight> sights,
                                       const model::Pose& T_rig_plane) {
  Normal normal;
  for (const Sight& sight : sights) {
    for (const target::Corner& corner : sight.corners) {
      const Eigen::Vector3d turned = T_rig_plane.q * target::corner_position(target, corner.id);
      Eigen::Matrix<double, 2, 3> by_point;
      const auto q = sight.camera.project(sight.T_camera_rig * (turned + T_rig_plane.t), by_point);
      if (!q) {
        return std::nullopt;
      }
      by_point *= sight.T_camera_rig.rotation();
      const double sigma = std::max(corner.sigma_px, 0.01);
      Eigen::Matrix<double, 2, 6> by;
      // exp([w]) R x + t + d: the cross product w x R x, row by row.
      for (int row = 0; row < 2; ++row) {
        by.row(row) << turned.cross(by_point.row(row).transpose()).transpose(), by_point.row(row);
      }
      const Eigen::Vector2d miss = *q - corner.q;
      normal.h += by.transpose() * by / (sigma * sigma);
      normal.g += by.transpose() * miss / (sigma * sigma);
      normal.whitened += miss.squaredNorm() / (sigma * sigma);
      normal.squares_px += miss.squaredNorm();
      ++normal.corners;
    }
  }
  return normal;
}

}  // namespace

std::optional<model::Pose> plane_start(const TargetSpec& target, const Sight& sight) {
  std::vector<Eigen::Vector2d> on_board, normalised;
  for (const target::Corner& corner : sight.corners) {
    if (const auto n = sight.camera.normalize(corner.q)) {
      on_board.emplace_back(target::corner_position(target, corner.id).head<2>());
      normalised.push_back(*n);
    }
  }
  if (on_board.size() < 6) {
    return std::nullopt;
  }
  const auto H = solve::homography(on_board, normalised);
  if (!H) {
    return std::nullopt;
  }
  return sight.T_camera_rig.inverse() * solve::plane_pose(*H, 1, Eigen::Vector2d::Zero());
}

Result<BoardPlane> board_plane(const TargetSpec& target, std::span<const Sight> sights) {
  const auto most = std::ranges::max_element(sights, {}, [](const Sight& sight) { return sight.corners.size(); });
  const auto start = most == sights.end() ? std::nullopt : plane_start(target, *most);
  if (!start) {
    return fail(RCode::kTooFewCorrespondences, "no eye sees " + std::to_string(kFewest) + " corners of the board");
  }
  BoardPlane found{.T_rig_plane = *start, .covariance = Matrix6::Zero()};
  auto normal = normal_equations(target, sights, found.T_rig_plane);
  // Gauss-Newton: the start is a pixel or two off, and a board's pose is nearly linear over that.
  for (int round = 0; normal && round < 20; ++round) {
    const Vector6 step = -normal->h.ldlt().solve(normal->g);
    found.T_rig_plane = model::moved_by(found.T_rig_plane, step);
    normal = normal_equations(target, sights, found.T_rig_plane);
    if (step.norm() < 1e-10) {
      break;
    }
  }
  if (!normal || !found.T_rig_plane.t.allFinite()) {
    return fail(RCode::kLookNotSolved, "the board's pose does not converge");
  }
  found.corners = normal->corners;
  found.rms_px = std::sqrt(normal->squares_px / (2 * normal->corners));
  if (!(found.rms_px <= kMostMissPx)) {
    return fail(RCode::kLookNotSolved, "the board's corners miss one plane by " + std::to_string(found.rms_px) +
                                           " px; expected at most " + std::to_string(kMostMissPx) +
                                           ": is it flat, the one stated, and are the cameras as calibrated?");
  }
  const double scatter = normal->whitened / std::max(1, 2 * normal->corners - 6);
  found.covariance = std::max(1.0, scatter) * normal->h.ldlt().solve(Matrix6::Identity());
  return found;
}

}  // namespace raysteer::calib::look
