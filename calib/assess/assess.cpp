#include "calib/assess/assess.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "calib/assess/leave_out.hpp"
#include "calib/assess/maps.hpp"
#include "calib/assess/verdict.hpp"

namespace raysteer::calib::assess {
namespace {

constexpr int kCoverageColumns = 5;  // algorithms 1.3
constexpr int kCoverageRows = 4;
constexpr double kCornersPerCell = 100;
constexpr double kCorrelated = 0.95;

std::vector<Parameter> parameter_rows(const model::Rig& rig, std::size_t d) {
  const Eigen::VectorXd values = parameters(rig.devices[d], d > 0);
  std::vector<Parameter> rows;
  for (int i = 0; i < rig.count(d); ++i) {
    const int at = rig.offset(d) + i;
    const std::string& name = rig.parameters[static_cast<std::size_t>(at)];
    const int lens = coefficients(rig.devices[d].camera.lens);
    const char* unit = i < 4 ? "px" : i < 4 + lens ? "" : i < 7 + lens ? "rad" : "m";
    double value = values[i];
    if (i >= 4 + lens && i < 7 + lens) {
      // The increment is zero by definition; what people want to see is the rotation itself.
      const Eigen::AngleAxisd turn(rig.devices[d].T_device_rig.q);
      value = (turn.angle() * turn.axis())[i - 4 - lens];
    }
    rows.push_back({.name = name, .value = value, .sigma = std::sqrt(rig.covariance(at, at)), .unit = unit});
  }
  return rows;
}

Coverage coverage_of(const solve::Solution& solution, std::size_t d) {
  const model::Device& device = solution.rig.devices[d];
  Coverage coverage;
  coverage.corners = {.columns = kCoverageColumns,
                      .rows = kCoverageRows,
                      .values = std::vector<double>(kCoverageColumns * kCoverageRows, 0)};
  for (const solve::Residual& residual : solution.devices[d].residuals) {
    if (residual.kept) {
      const int column = static_cast<int>((residual.q.x() + 0.5) * kCoverageColumns / device.camera.width);
      const int row = static_cast<int>((residual.q.y() + 0.5) * kCoverageRows / device.camera.height);
      const int cell =
          std::clamp(row, 0, kCoverageRows - 1) * kCoverageColumns + std::clamp(column, 0, kCoverageColumns - 1);
      coverage.corners.values[static_cast<std::size_t>(cell)] += 1;
    }
  }
  coverage.cells_short = static_cast<int>(
      std::ranges::count_if(coverage.corners.values, [](double count) { return count < kCornersPerCell; }));
  coverage.nearest_m = std::numeric_limits<double>::infinity();
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = -low;
  for (const solve::ViewFit& view : solution.views) {
    if (!view.used || view.rms_px[d] <= 0) {
      continue;
    }
    const model::Pose T_device_target = device.T_device_rig * view.T_rig_target;
    Eigen::Vector3d normal = T_device_target.q * Eigen::Vector3d::UnitZ();
    normal *= normal.z() < 0 ? -1 : 1;
    const Eigen::Vector2d tilt(std::atan2(normal.y(), normal.z()), std::atan2(normal.x(), normal.z()));
    low = low.cwiseMin(tilt);
    high = high.cwiseMax(tilt);
    coverage.nearest_m = std::min(coverage.nearest_m, view.distance_m);
    coverage.farthest_m = std::max(coverage.farthest_m, view.distance_m);
  }
  if (coverage.farthest_m > 0) {
    coverage.tilt_x_rad = high.x() - low.x();
    coverage.tilt_y_rad = high.y() - low.y();
  } else {
    coverage.nearest_m = 0;
  }
  return coverage;
}

double working_distance(const solve::Solution& solution) {
  std::vector<double> distances;
  for (const solve::ViewFit& view : solution.views) {
    if (view.used) {
      distances.push_back(view.distance_m);
    }
  }
  std::ranges::sort(distances);
  return distances.empty() ? 1 : distances[distances.size() / 2];
}

std::vector<std::string> correlated_pairs(const model::Rig& rig) {
  std::vector<std::string> pairs;
  for (Eigen::Index i = 0; i < rig.covariance.rows(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      const double scale = std::sqrt(rig.covariance(i, i) * rig.covariance(j, j));
      const double correlation = scale > 0 ? rig.covariance(i, j) / scale : 0;
      if (std::abs(correlation) > kCorrelated) {
        std::array<char, 32> value{};
        std::snprintf(value.data(), value.size(), ": %.3f", correlation);
        pairs.push_back(rig.parameters[static_cast<std::size_t>(j)] + " ~ " +
                        rig.parameters[static_cast<std::size_t>(i)] + value.data());
      }
    }
  }
  return pairs;
}

Difference difference_to(const model::Device& previous, const model::Device& now, double range_m) {
  Difference difference;
  difference.device = now.name;
  difference.range_m = range_m;
  difference.px = difference_map(now.camera, previous.camera);
  difference.mm = difference.px;
  const double focal = std::sqrt(now.camera.fx * now.camera.fy);
  for (double& value : difference.mm.values) {
    value *= 1e3 * range_m / focal;
  }
  difference.median_px = quantile(difference.px, 0.5);
  difference.p95_px = quantile(difference.px, 0.95);
  return difference;
}

}  // namespace

Result<Assessment> assess(const solve::Observations& observations, const solve::Solution& solution,
                          const AssessOptions& options) {
  const auto tell = [&](double done) {
    if (options.progress) {
      options.progress("cross-validating", done);
    }
  };
  Assessment assessment;
  tell(0);
  auto cross = cross_validate(observations, solution, options.folds);
  if (!cross) {
    return cross.error();
  }
  assessment.cross_validation = *cross;
  tell(0.7);
  const auto odd = half_of_the_views(observations, solution, 0);
  const auto even = half_of_the_views(observations, solution, 1);
  if (!odd || !even) {
    return odd ? even.error() : odd.error();
  }
  tell(0.9);

  const model::Rig& rig = solution.rig;
  const double distance = working_distance(solution);
  for (std::size_t d = 0; d < rig.devices.size(); ++d) {
    DeviceAssessment device;
    device.name = rig.devices[d].name;
    device.parameters = parameter_rows(rig, d);
    device.coverage = coverage_of(solution, d);
    const int count = 4 + coefficients(rig.devices[d].camera.lens);
    const Eigen::MatrixXd covariance = rig.covariance.block(rig.offset(d), rig.offset(d), count, count);
    for (const double range : {distance, 1.0, 2.0, 3.5, 6.0, std::numeric_limits<double>::infinity()}) {
      device.uncertainty.push_back(
          {.range_m = range, .sigma_px = uncertainty_map(rig.devices[d].camera, covariance, range, distance)});
    }
    device.odd_even_median_px = device.odd_even_p95_px = std::numeric_limits<double>::quiet_NaN();
    if (!odd->empty() && !even->empty()) {
      device.odd_even_px = difference_map((*odd)[d].camera, (*even)[d].camera);
      device.odd_even_median_px = quantile(device.odd_even_px, 0.5);
      device.odd_even_p95_px = quantile(device.odd_even_px, 0.95);
    }
    if (options.previous != nullptr) {
      if (const model::Device* before = options.previous->find(device.name);
          before != nullptr && before->camera.width == rig.devices[d].camera.width &&
          before->camera.height == rig.devices[d].camera.height) {
        assessment.differences.push_back(difference_to(*before, rig.devices[d], distance));
      }
    }
    assessment.devices.push_back(std::move(device));
  }
  assessment.correlated = correlated_pairs(rig);
  judge(solution, assessment);
  tell(1);
  return assessment;
}

}  // namespace raysteer::calib::assess
