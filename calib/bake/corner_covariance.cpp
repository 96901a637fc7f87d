#include "calib/bake/corner_covariance.hpp"

#include "calib/bake/metric_rectangle.hpp"

namespace raysteer::calib::bake {
namespace {

using Corners = Eigen::Matrix<double, 8, 1>;

/// Where the panel pixels that `believed` bakes truly land.
Corners landed(const look::Solution& truth, const look::Solution& believed, const Eigen::Vector2d& offset_m,
               double width_m, double height_m) {
  Corners all = Corners::Zero();
  const auto corners = level_rectangle(believed.T_rig_plane, offset_m, width_m, height_m).corners();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (const auto x = believed.panel.on_panel(corners[i])) {
      if (const auto p = truth.panel.on_plane(*x)) {
        all.segment<2>(2 * static_cast<Eigen::Index>(i)) = *p;
      }
    }
  }
  return all;
}

}  // namespace

Eigen::Matrix<double, 8, 8> corner_covariance(const look::Solution& solution, const look::Covariance& covariance,
                                              const Eigen::Vector2d& offset_m, double width_m, double height_m) {
  Eigen::Matrix<double, 8, look::kUnknowns> J;
  for (int i = 0; i < look::kUnknowns; ++i) {
    const double step = i >= 12 && i < 16 ? 1e-3 : 1e-6;  // px, and everything else
    const Eigen::Matrix<double, look::kUnknowns, 1> delta = step * Eigen::Matrix<double, look::kUnknowns, 1>::Unit(i);
    J.col(i) = (landed(solution, look::perturbed(solution, delta), offset_m, width_m, height_m) -
                landed(solution, look::perturbed(solution, -delta), offset_m, width_m, height_m)) /
               (2 * step);
  }
  return J * covariance * J.transpose();
}

}  // namespace raysteer::calib::bake
