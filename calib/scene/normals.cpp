#include "calib/scene/normals.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace raysteer::calib::scene {
namespace {

constexpr int kReach = 2;

}  // namespace

std::vector<Eigen::Vector3f> normals(std::span<const CloudPoint> points, std::span<const Match> matches) {
  int columns = 0, rows = 0;
  for (const CloudPoint& point : points) {
    columns = std::max(columns, matches[point.match].i + 1);
    rows = std::max(rows, matches[point.match].j + 1);
  }
  // Number of the point at each projector pixel, plus 1; a border spares the tests for it.
  Image<std::uint32_t> at(columns + 2 * kReach, rows + 2 * kReach);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Match& match = matches[points[k].match];
    at(match.i + kReach, match.j + kReach) = static_cast<std::uint32_t>(k + 1);
  }
  std::vector<Eigen::Vector3f> found(points.size(), Eigen::Vector3f::Zero());
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Eigen::Vector3d& p = points[k].p;
    const Match& match = matches[points[k].match];
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    int n = 0;
    for (int dj = 0; dj <= 2 * kReach; ++dj) {
      for (int di = 0; di <= 2 * kReach; ++di) {
        const std::uint32_t other = at(match.i + di, match.j + dj);
        if (other == 0 || std::abs(points[other - 1].p.z() - p.z()) > 0.02 * p.z()) {
          continue;
        }
        const Eigen::Vector3d d = points[other - 1].p - p;
        sum += d;
        squares.noalias() += d * d.transpose();
        ++n;
      }
    }
    if (n < 6) {
      continue;
    }
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
    eigen.computeDirect(squares - sum * sum.transpose() / n);
    const Eigen::Vector3d normal = eigen.eigenvectors().col(0);
    found[k] = (normal.dot(p) > 0 ? -normal : normal).cast<float>();
  }
  return found;
}

}  // namespace raysteer::calib::scene
