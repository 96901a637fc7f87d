#include "calib/scene/epipolar.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace raysteer::calib::scene {
namespace {

constexpr std::size_t kFewestMatches = 100;
/// A cell counts with this many matches: its median then has an error of 0.2 sigma at most.
constexpr int kFewestInCell = 30;
/// Beyond this a match is wrong, not noisy, and must not tilt its cell's plane.
constexpr double kGrossPx = 1.5;

double median_in_place(std::vector<double>& values) {
  if (values.empty()) {
    return 0;
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Residuals about a robust plane over a cell, scaled for the 3 parameters it took.
void append_plane_residuals(std::span<const Match> matches, std::span<const double> d,
                            std::span<const std::uint32_t> members, double median, std::vector<double>& residuals) {
  const Eigen::Vector2d origin = matches[members.front()].q_left;
  Eigen::Vector3d plane(median, 0, 0);
  // Cauchy weights of scale 0.5 px: three rounds are enough from the median.
  for (int round = 0; round < 3; ++round) {
    Eigen::Matrix3d normal = 1e-9 * Eigen::Matrix3d::Identity();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const std::uint32_t k : members) {
      if (!(std::abs(d[k] - median) < kGrossPx)) {
        continue;
      }
      const Eigen::Vector2d q = matches[k].q_left - origin;
      const Eigen::Vector3d row(1, q.x(), q.y());
      const double miss = (d[k] - plane.dot(row)) / 0.5;
      const double weight = 1 / (1 + miss * miss);
      normal.noalias() += weight * row * row.transpose();
      right += weight * d[k] * row;
    }
    plane = normal.ldlt().solve(right);
  }
  const double n = static_cast<double>(members.size());
  const double scale = std::sqrt(n / (n - 3));
  for (const std::uint32_t k : members) {
    const Eigen::Vector2d q = matches[k].q_left - origin;
    residuals.push_back(scale * (d[k] - plane.dot(Eigen::Vector3d(1, q.x(), q.y()))));
  }
}

}  // namespace

double robust_sigma(std::span<const double> values) {
  std::vector<double> finite;
  finite.reserve(values.size());
  std::ranges::copy_if(values, std::back_inserter(finite), [](double value) { return std::isfinite(value); });
  const double median = median_in_place(finite);
  for (double& value : finite) {
    value = std::abs(value - median);
  }
  return 1.4826 * median_in_place(finite);
}

std::vector<double> epipolar_disagreement(const TwoViews& views, std::span<const RayPair> rays) {
  const Eigen::Matrix3d R = views.T_right_left.rotation();
  const Eigen::Vector3d t = views.T_right_left.t.normalized();
  const Eigen::Matrix3d essential =
      (Eigen::Matrix3d() << 0, -t.z(), t.y(), t.z(), 0, -t.x(), -t.y(), t.x(), 0).finished() * R;
  const double focal = (views.left.fx + views.left.fy + views.right.fx + views.right.fy) / 4;
  std::vector<double> disagreement;
  disagreement.reserve(rays.size());
  for (const RayPair& ray : rays) {
    const Eigen::Vector3d line_right = essential * ray.left.homogeneous();
    const Eigen::Vector3d line_left = essential.transpose() * ray.right.homogeneous();
    const double gradient = std::sqrt(line_right.head<2>().squaredNorm() + line_left.head<2>().squaredNorm());
    disagreement.push_back(std::numbers::sqrt2 * focal * line_right.dot(ray.right.homogeneous()) / gradient);
  }
  return disagreement;
}

Result<EpipolarAnalysis> analyse_epipolar(std::span<const Match> matches, std::span<const double> disagreement,
                                          int cell_px) {
  RAYSTEER_CHECK(matches.size() == disagreement.size() && cell_px > 0);
  // Matches by cell: sorted by (row, column) of the cell, so that each is one run.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> order;  // cell, match
  order.reserve(matches.size());
  for (std::uint32_t k = 0; k < matches.size(); ++k) {
    const Eigen::Vector2d& q = matches[k].q_left;
    if (std::isfinite(disagreement[k])) {
      const auto column = static_cast<std::uint32_t>(std::max(0.0, q.x()) / cell_px);
      const auto row = static_cast<std::uint32_t>(std::max(0.0, q.y()) / cell_px);
      order.emplace_back(row << 16 | column, k);
    }
  }
  if (order.size() < kFewestMatches) {
    return fail(RCode::kTooFewMatches,
                std::to_string(order.size()) + " matches, at least " + std::to_string(kFewestMatches) + " are needed");
  }
  std::ranges::sort(order);

  EpipolarAnalysis analysis;
  analysis.sigma_px = robust_sigma(disagreement);
  analysis.within_1_5_px =
      static_cast<std::size_t>(std::ranges::count_if(disagreement, [](double d) { return std::abs(d) < kGrossPx; }));
  std::vector<double> residuals, values;
  residuals.reserve(order.size());
  std::vector<std::uint32_t> members;
  double squares = 0;
  for (std::size_t from = 0; from < order.size();) {
    const std::uint32_t cell = order[from].first;
    members.clear();
    values.clear();
    for (; from < order.size() && order[from].first == cell; ++from) {
      members.push_back(order[from].second);
      values.push_back(disagreement[order[from].second]);
    }
    if (std::ssize(members) < kFewestInCell) {
      continue;
    }
    const double median = median_in_place(values);
    append_plane_residuals(matches, disagreement, members, median, residuals);
    analysis.cells.push_back(
        {static_cast<int>(cell & 0xffff), static_cast<int>(cell >> 16), static_cast<int>(members.size()), median});
    squares += median * median;
  }
  analysis.within_cell_px = robust_sigma(residuals);
  if (!analysis.cells.empty()) {
    analysis.systematic_px = std::sqrt(squares / static_cast<double>(analysis.cells.size()));
  }
  return analysis;
}

}  // namespace raysteer::calib::scene
