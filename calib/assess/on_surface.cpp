#include "calib/assess/on_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace raysteer::calib::assess {
namespace {

constexpr double kMillimetres = 1000;

/// Any two unit vectors along the surface.
Eigen::Matrix<double, 3, 2> along(const Eigen::Vector3d& normal) {
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = normal.unitOrthogonal();
  basis.col(1) = normal.cross(basis.col(0));
  return basis;
}

double bound_mm(const steer::Landing& landing, const Eigen::Matrix<double, 3, 2>& basis) {
  return kMillimetres * radius_95(basis.transpose() * landing.covariance * basis);
}

std::optional<ReachCell> reached(const steer::Solution& solution, const steer::Surface& surface,
                                 const Eigen::Vector2d& command_rad) {
  const model::Camera& lens = solution.projector.lens;
  const double right = lens.width - 1;
  const double bottom = lens.height - 1;
  const Eigen::Matrix<double, 3, 2> basis = along(surface.normal);
  const auto middle = steer::land(solution, command_rad, {right / 2, bottom / 2}, surface);
  if (!middle) {
    return std::nullopt;
  }
  ReachCell cell{.command_rad = command_rad, .p = middle->p, .middle_95_mm = bound_mm(*middle, basis)};
  cell.worst_95_mm = cell.middle_95_mm;
  for (const Eigen::Vector2d& x :
       {Eigen::Vector2d(0, 0), Eigen::Vector2d(right, 0), Eigen::Vector2d(0, bottom), Eigen::Vector2d(right, bottom)}) {
    if (const auto corner = steer::land(solution, command_rad, x, surface)) {
      cell.worst_95_mm = std::max(cell.worst_95_mm, bound_mm(*corner, basis));
    }
  }
  return cell;
}

}  // namespace

double radius_95(const Eigen::Matrix2d& covariance) {
  const Eigen::Vector2d variance =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance, Eigen::EigenvaluesOnly).eigenvalues().cwiseMax(0);
  const double large = variance[1];
  if (!(large > 0) || !std::isfinite(large)) {
    return large > 0 ? large : 0;
  }
  // Share within radius r, in units of the large sigma: strips across it, x = r sin t.
  const double ratio = std::sqrt(variance[0] / large);
  const auto share = [&](double r) {
    constexpr int kStrips = 64;
    double sum = 0;
    for (int i = 0; i < kStrips; ++i) {
      const double t = (i + 0.5) * std::numbers::pi / 2 / kStrips;
      const double half = r * std::cos(t);
      sum += std::exp(-std::pow(r * std::sin(t), 2) / 2) * std::erf(half / (ratio * std::numbers::sqrt2)) * half;
    }
    return sum * std::numbers::pi / kStrips / std::sqrt(2 * std::numbers::pi);
  };
  double low = 1.9;
  double high = 2.5;
  for (int i = 0; i < 20; ++i) {
    const double middle = (low + high) / 2;
    (share(middle) < 0.95 ? low : high) = middle;
  }
  return std::sqrt(large) * (low + high) / 2;
}

ReachMap reach_map(const steer::Solution& solution, const steer::Surface& surface, const Eigen::Vector2d& least_rad,
                   const Eigen::Vector2d& most_rad, int columns, int rows) {
  ReachMap map{.columns = columns, .rows = rows, .cells = {}};
  std::vector<double> worst;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const Eigen::Vector2d part((i + 0.5) / columns, (j + 0.5) / rows);
      map.cells.push_back(reached(solution, surface, least_rad + part.cwiseProduct(most_rad - least_rad)));
      if (map.cells.back()) {
        worst.push_back(map.cells.back()->worst_95_mm);
      }
    }
  }
  std::ranges::sort(worst);
  constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
  map.median_95_mm = worst.empty() ? kNothing : worst[worst.size() / 2];
  map.worst_95_mm = worst.empty() ? kNothing : worst.back();
  return map;
}

std::optional<std::vector<CornerBound>> corner_bounds(const steer::InRoom& rig, const Eigen::Vector2d& command_rad,
                                                      std::span<const Eigen::Vector3d> corners_room,
                                                      const Eigen::Vector3d& normal_room,
                                                      const steer::LookState& state) {
  std::vector<CornerBound> bounds;
  for (const Eigen::Vector3d& p : corners_room) {
    const auto predicted = steer::predict_in_room(rig, command_rad, p, normal_room, state);
    if (!predicted) {
      return std::nullopt;
    }
    bounds.push_back({.x = predicted->x, .error_95_mm = radius_95(*predicted->covariance_mm2())});
  }
  return bounds;
}

}  // namespace raysteer::calib::assess
