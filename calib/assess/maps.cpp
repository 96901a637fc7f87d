#include "calib/assess/maps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "calib/model/pose.hpp"
#include "calib/model/rig.hpp"

namespace raysteer::calib::assess {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Eigen::Vector2d cell_middle(const model::Camera& camera, int column, int row) {
  return {(column + 0.5) * camera.width / kMapColumns - 0.5, (row + 0.5) * camera.height / kMapRows - 0.5};
}

GridMap empty_map() {
  return {.columns = kMapColumns,
          .rows = kMapRows,
          .values = std::vector<double>(static_cast<std::size_t>(kMapColumns) * kMapRows, kNaN)};
}

// Direction of every cell's middle in the camera's frame; none where the lens model does not reach.
std::vector<std::optional<Eigen::Vector3d>> directions(const model::Camera& camera) {
  std::vector<std::optional<Eigen::Vector3d>> rays;
  for (int row = 0; row < kMapRows; ++row) {
    for (int column = 0; column < kMapColumns; ++column) {
      const auto n = camera.normalize(cell_middle(camera, column, row));
      rays.push_back(n ? std::optional<Eigen::Vector3d>(Eigen::Vector3d(n->x(), n->y(), 1)) : std::nullopt);
    }
  }
  return rays;
}

// d(pixel)/d(fx fy cx cy k...) by central differences: steps that move a pixel by about 1e-3.
Eigen::MatrixXd by_parameters(const model::Camera& camera, const Eigen::Vector3d& p) {
  const model::Device device{.name = {}, .kind = {}, .camera = camera, .T_device_rig = {}};
  const int count = 4 + coefficients(camera.lens);
  Eigen::MatrixXd slope(2, count);
  for (int i = 0; i < count; ++i) {
    const double step = i < 4 ? 1e-3 : 1e-6;
    Eigen::VectorXd delta = Eigen::VectorXd::Zero(count);
    delta[i] = step;
    const auto plus = perturbed(device, delta, false).camera.project(p);
    const auto minus = perturbed(device, -delta, false).camera.project(p);
    slope.col(i) = (*plus - *minus) / (2 * step);
  }
  return slope;
}

}  // namespace

namespace {

// Derivatives of the pixels at all cells and one range: by the parameters, and by a rigid motion of the points.
struct Slopes {
  Eigen::MatrixXd by_parameters;
  Eigen::MatrixXd by_motion;
};

Slopes slopes_at(const model::Camera& camera, const std::vector<Eigen::Vector3d>& rays, double range_m) {
  const bool far = std::isinf(range_m);
  const auto rows = static_cast<Eigen::Index>(2 * rays.size());
  Slopes slopes{.by_parameters = Eigen::MatrixXd(rows, 4 + coefficients(camera.lens)),
                .by_motion = Eigen::MatrixXd::Zero(rows, 6)};
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Eigen::Vector3d p = rays[i].normalized() * (far ? 1 : range_m);
    Eigen::Matrix<double, 2, 3> by_point;
    if (!camera.project(p, by_point)) {
      by_point.setZero();
    }
    const auto at = static_cast<Eigen::Index>(2 * i);
    slopes.by_parameters.middleRows<2>(at) = by_parameters(camera, p);
    for (int axis = 0; axis < 3; ++axis) {
      slopes.by_motion.block<2, 1>(at, axis) = by_point * Eigen::Vector3d::Unit(axis).cross(p);
      if (!far) {
        slopes.by_motion.block<2, 1>(at, 3 + axis) = by_point.col(axis);
      }
    }
  }
  return slopes;
}

}  // namespace

GridMap uncertainty_map(const model::Camera& camera, const Eigen::MatrixXd& covariance, double range_m,
                        double fitted_range_m) {
  GridMap map = empty_map();
  const auto directions_of_cells = directions(camera);
  std::vector<std::size_t> cells;
  std::vector<Eigen::Vector3d> rays;
  for (std::size_t i = 0; i < directions_of_cells.size(); ++i) {
    if (directions_of_cells[i]) {
      cells.push_back(i);
      rays.push_back(*directions_of_cells[i]);
    }
  }
  if (rays.size() < 3) {
    return map;
  }
  const Slopes fitted = slopes_at(camera, rays, fitted_range_m);
  const Eigen::MatrixXd motion = fitted.by_motion.colPivHouseholderQr().solve(fitted.by_parameters);
  const Slopes here = slopes_at(camera, rays, range_m);
  const Eigen::MatrixXd left = here.by_parameters - here.by_motion * motion;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Eigen::MatrixXd slope = left.middleRows<2>(static_cast<Eigen::Index>(2 * i));
    const Eigen::Matrix2d spread = slope * covariance * slope.transpose();
    const double larger = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread).eigenvalues()[1];
    map.values[cells[i]] = std::sqrt(std::max(0.0, larger));
  }
  return map;
}

GridMap difference_map(const model::Camera& first, const model::Camera& second) {
  GridMap map = empty_map();
  const auto rays = directions(first);
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  std::vector<Eigen::Vector2d> differences(rays.size());
  for (int iteration = 0; iteration < 10; ++iteration) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (!rays[i]) {
        continue;
      }
      const Eigen::Vector3d p = turn * *rays[i];
      Eigen::Matrix<double, 2, 3> by_point;
      const auto q = second.project(p, by_point);
      const int column = static_cast<int>(i) % kMapColumns;
      const int row = static_cast<int>(i) / kMapColumns;
      if (!q) {
        continue;
      }
      differences[i] = *q - cell_middle(first, column, row);
      map.values[i] = differences[i].norm();
      Eigen::Matrix<double, 2, 3> by_turn;
      for (int axis = 0; axis < 3; ++axis) {
        by_turn.col(axis) = by_point * Eigen::Vector3d::Unit(axis).cross(p);
      }
      normal += by_turn.transpose() * by_turn;
      right -= by_turn.transpose() * differences[i];
    }
    const Eigen::Vector3d step = normal.ldlt().solve(right);
    if (!step.allFinite()) {
      return empty_map();
    }
    turn = model::rotation_by(step) * turn;
    if (step.norm() < 1e-12) {
      break;
    }
  }
  return map;
}

double quantile(const GridMap& map, double share) {
  std::vector<double> values;
  std::ranges::copy_if(map.values, std::back_inserter(values), [](double value) { return std::isfinite(value); });
  if (values.empty()) {
    return kNaN;
  }
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

}  // namespace raysteer::calib::assess
