#include "calib/steer/depth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace raysteer::calib::steer {
namespace {

constexpr std::size_t kPooled = 1500;  // pairs of all looks together
constexpr std::size_t kOfLook = 150;
constexpr double kLeastAngle = std::numbers::pi / 540;
constexpr std::size_t kNamed = 6;  // looks in a note

/// A pixel without its lens, and its covariance there. Distortion's own slope is left out: a few per cent of sigma.
struct Bare {
  Eigen::Vector2d n;
  Eigen::Matrix2d covariance;
};

std::optional<Bare> bare(const model::Camera& camera, const Eigen::Vector2d& q, const Eigen::Matrix2d& covariance,
                         double noise) {
  const auto n = camera.normalize(q);
  if (!n) {
    return std::nullopt;
  }
  const Eigen::DiagonalMatrix<double, 2> by_pixel(noise / camera.fx, noise / camera.fy);
  return Bare{*n, by_pixel * covariance * by_pixel};
}

/// Every n-th, so that no more than `most` are left.
std::vector<ViewPair> thinned(const std::vector<ViewPair>& pairs, std::size_t most) {
  const std::size_t step = pairs.size() / most + 1;
  std::vector<ViewPair> few;
  for (std::size_t i = 0; i < pairs.size(); i += step) {
    few.push_back(pairs[i]);
  }
  return few;
}

std::string text(double value) {
  std::array<char, 32> out{};
  std::snprintf(out.data(), out.size(), "%.2g", value);
  return out.data();
}

/// "'look-1', 'look-2' and 7 more"
std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < std::min(kNamed, names.size()); ++i) {
    text += (text.empty() ? "'" : ", '") + names[i] + "'";
  }
  return names.size() > kNamed ? text + " and " + std::to_string(names.size() - kNamed) + " more" : text;
}

}  // namespace

Depth depth_of(std::span<const Look> looks, const model::Rig& cameras, double noise) {
  const model::Device& left = cameras.devices[0];
  const model::Device& right = cameras.devices[1];
  const Eigen::Matrix3d F = fundamental(right.T_device_rig.rotation(), right.T_device_rig.t);
  Depth depth;
  std::vector<ViewPair> all;
  std::vector<double> angles;
  for (const Look& look : looks) {
    std::vector<ViewPair> pairs;
    for (const LitPoint& point : look.points) {
      const auto a = bare(left.camera, point.q[0], point.cov_q[0], noise);
      const auto b = bare(right.camera, point.q[1], point.cov_q[1], noise);
      if (a && b) {
        pairs.push_back({a->n, b->n, a->covariance, b->covariance});
        const Eigen::Vector3d along = right.T_device_rig.q.conjugate() * b->n.homogeneous();
        angles.push_back(std::asin(std::min(1.0, along.normalized().cross(a->n.homogeneous().normalized()).norm())));
      }
    }
    if (plane_or_depth(thinned(pairs, kOfLook), F).flat()) {
      depth.flat_looks.push_back(look.name);
    }
    all.insert(all.end(), pairs.begin(), pairs.end());
  }
  depth.all = plane_or_depth(thinned(all, kPooled), F, Lenses::kOpen);
  if (!angles.empty()) {
    const auto middle = angles.begin() + static_cast<std::ptrdiff_t>(angles.size() / 2);
    std::ranges::nth_element(angles, middle);
    depth.angle_rad = *middle;
  }
  return depth;
}

Status check_depth(const Depth& depth) {
  if (depth.angle_rad < kLeastAngle) {
    return fail(RCode::kTooLittleParallax,
                "the eyes' rays meet at " + text(depth.angle_rad * 180 / std::numbers::pi) +
                    " degrees; expected a third of a degree at least, better 3 degrees and more: mount them farther "
                    "apart, or give --cameras a calibration");
  }
  if (depth.all.flat()) {
    return fail(RCode::kSceneTooFlat, "one plane explains all " + std::to_string(depth.all.points) +
                                          " points of all looks (GRIC " + text(depth.all.plane) + " against " +
                                          text(depth.all.depth) +
                                          "); expected surfaces at different distances: put boxes of different heights "
                                          "into the looks, or give --cameras a calibration");
  }
  return ok();
}

Status check_depth(const Depth& depth, const Solution& solution) {
  RAYSTEER_TRY(check_depth(depth));
  double worst = 0;
  for (std::size_t i = 0; i < solution.cameras.devices.size(); ++i) {
    const int at = solution.cameras.offset(i);
    worst = std::max(worst, std::sqrt(solution.covariance(at, at)) / solution.cameras.devices[i].camera.fx);
  }
  if (worst <= kMostFocalSigma) {
    return ok();
  }
  return fail(
      RCode::kSceneTooFlat,
      "a camera's focal length is known to " + text(100 * worst) + " % only (one sigma); expected " +
          text(100 * kMostFocalSigma) + " %" +
          (depth.flat_looks.empty() ? std::string() : ". One plane is all of looks " + listed(depth.flat_looks)) +
          ": add looks onto boxes of different heights, or give --cameras a calibration");
}

}  // namespace raysteer::calib::steer
