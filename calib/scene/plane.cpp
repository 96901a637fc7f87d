#include "calib/scene/plane.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "calib/scene/epipolar.hpp"

namespace raysteer::calib::scene {
namespace {

constexpr std::size_t kFewestPoints = 100;
constexpr std::size_t kFewestInPatch = 50;
constexpr std::size_t kFewestPatches = 10;

/// Least squares through the mean: the direction of least scatter.
Plane fit(std::span<const CloudPoint> points, std::span<const std::uint32_t> members) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const std::uint32_t k : members) {
    mean += points[k].p;
  }
  mean /= static_cast<double>(members.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const std::uint32_t k : members) {
    const Eigen::Vector3d d = points[k].p - mean;
    scatter.noalias() += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scatter);  // values rise
  Plane plane;
  plane.centroid = mean;
  plane.normal = eigen.eigenvectors().col(0);
  if (plane.normal.dot(mean) > 0) {
    plane.normal = -plane.normal;
  }
  plane.axes.col(0) = eigen.eigenvectors().col(2);
  plane.axes.col(1) = plane.normal.cross(plane.axes.col(0));
  plane.axes.col(2) = plane.normal;
  plane.distance_m = plane.normal.dot(mean);
  plane.inliers = members.size();
  const double freedom = std::max(1.0, static_cast<double>(members.size()) - 3);
  const double variance = std::max(0.0, eigen.eigenvalues()[0]) / freedom;
  plane.rms_m = std::sqrt(variance);
  // A tilt about one direction moves points along the other: variance over the scatter along it.
  plane.covariance.diagonal() << variance / eigen.eigenvalues()[1], variance / eigen.eigenvalues()[2],
      variance / static_cast<double>(members.size());
  return plane;
}

std::vector<std::uint32_t> within(std::span<const CloudPoint> points, const Plane& plane, double band_m) {
  std::vector<std::uint32_t> members;
  for (std::uint32_t k = 0; k < points.size(); ++k) {
    if (std::abs(plane.signed_distance(points[k].p)) < band_m) {
      members.push_back(k);
    }
  }
  return members;
}

/// Robust RMS of one patch; predicted variance along the normal added to `predicted`.
struct Patch {
  double rms = 0, predicted = 0;
  std::size_t trimmed = 0;
};

Patch judge(std::span<const CloudPoint> points, std::vector<std::uint32_t> members) {
  const std::size_t all = members.size();
  Plane plane = fit(points, members);
  std::vector<double> distances(members.size());
  std::ranges::transform(members, distances.begin(),
                         [&](std::uint32_t k) { return plane.signed_distance(points[k].p); });
  const double gate = 4 * robust_sigma(distances);
  std::erase_if(members, [&](std::uint32_t k) { return std::abs(plane.signed_distance(points[k].p)) > gate; });
  plane = fit(points, members);
  double predicted = 0;
  for (const std::uint32_t k : members) {
    predicted += plane.normal.dot(points[k].covariance * plane.normal);
  }
  return {plane.rms_m, std::sqrt(predicted / static_cast<double>(members.size())), all - members.size()};
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace

Result<Plane> dominant_plane(std::span<const CloudPoint> points, double band_m) {
  if (points.size() < kFewestPoints) {
    return fail(RCode::kTooFewMatches, std::to_string(points.size()) + " points are too few for a plane");
  }
  // Three random points make a plane, 2000 others vote: with a tenth of the points on the plane 5000 draws miss
  // it once in 150 scans, with a fifth never.
  constexpr int kDraws = 5000;
  constexpr std::size_t kVoters = 2000;
  std::mt19937 draw(1);
  std::vector<std::uint32_t> voters(std::min(kVoters, points.size()));
  for (std::uint32_t& voter : voters) {
    voter = static_cast<std::uint32_t>(draw() % points.size());
  }
  Plane best;
  std::ptrdiff_t most = -1;
  for (int k = 0; k < kDraws; ++k) {
    const Eigen::Vector3d& a = points[voters[draw() % voters.size()]].p;
    const Eigen::Vector3d& b = points[voters[draw() % voters.size()]].p;
    const Eigen::Vector3d& c = points[voters[draw() % voters.size()]].p;
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    if (!(normal.norm() > 1e-9)) {
      continue;
    }
    Plane plane;
    plane.normal = normal.normalized();
    plane.distance_m = plane.normal.dot(a);
    const std::ptrdiff_t votes = std::ranges::count_if(
        voters, [&](std::uint32_t voter) { return std::abs(plane.signed_distance(points[voter].p)) < band_m; });
    if (votes > most) {
      most = votes;
      best = plane;
    }
  }
  for (int round = 0; round < 5; ++round) {
    const std::vector<std::uint32_t> members = within(points, best, band_m);
    if (members.size() < kFewestPoints / 2) {
      return fail(RCode::kTooFewMatches, "no plane holds more than " + std::to_string(members.size()) + " points");
    }
    best = fit(points, members);
  }
  return best;
}

Result<Flatness> flatness(std::span<const CloudPoint> points, const Plane& wall, const FlatnessOptions& options) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order;  // patch, point
  for (const std::uint32_t k : within(points, wall, options.band_m)) {
    const Eigen::Vector3d d = (points[k].p - wall.centroid) / options.patch_m;
    const auto column = static_cast<std::int64_t>(std::floor(wall.axes.col(0).dot(d)));
    const auto row = static_cast<std::int64_t>(std::floor(wall.axes.col(1).dot(d)));
    order.emplace_back(
        static_cast<std::uint64_t>(row + (1LL << 31)) << 32 | static_cast<std::uint64_t>(column + (1LL << 31)), k);
  }
  std::ranges::sort(order);
  std::vector<std::vector<std::uint32_t>> patches;
  std::vector<double> counts;
  for (std::size_t from = 0; from < order.size();) {
    std::size_t to = from;
    std::vector<std::uint32_t> members;
    for (; to < order.size() && order[to].first == order[from].first; ++to) {
      members.push_back(order[to].second);
    }
    if (members.size() >= kFewestInPatch) {
      counts.push_back(static_cast<double>(members.size()));
      patches.push_back(std::move(members));
    }
    from = to;
  }
  if (!counts.empty()) {
    const double fewest = median(counts) / 2;
    std::erase_if(patches, [&](const auto& members) { return static_cast<double>(members.size()) < fewest; });
  }
  if (patches.size() < kFewestPatches) {
    return fail(RCode::kTooFewMatches, std::to_string(patches.size()) + " patches of the wall hold " +
                                           std::to_string(kFewestInPatch) + " points; flatness needs " +
                                           std::to_string(kFewestPatches));
  }
  std::vector<double> rms, predicted;
  std::size_t trimmed = 0, used = 0;
  for (std::vector<std::uint32_t>& members : patches) {
    used += members.size();
    const Patch patch = judge(points, std::move(members));
    rms.push_back(patch.rms);
    predicted.push_back(patch.predicted);
    trimmed += patch.trimmed;
  }
  return Flatness{median(rms), median(predicted), static_cast<double>(trimmed) / static_cast<double>(used),
                  patches.size()};
}

}  // namespace raysteer::calib::scene
