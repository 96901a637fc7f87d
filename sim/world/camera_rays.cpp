#include "sim/world/camera_rays.hpp"

#include <algorithm>

namespace raysteer::sim::world {

using Eigen::Vector2d;
using Eigen::Vector3d;

void CameraRays::row(int y, Row& out) const {
  const int width = camera_.width;
  const int step = std::clamp((width - 1) / 3, 1, 16);
  const int nodes = std::max((width - 1 + step - 1) / step + 1, 4);
  std::vector<Vector3d> ray, down;
  for (int i = 0; i < nodes; ++i) {
    const Vector2d q(i * step, y);
    ray.push_back(camera_.ray(q));
    down.push_back(camera_.ray(q + Vector2d(0, 0.5)) - camera_.ray(q - Vector2d(0, 0.5)));
  }
  out.ray.resize(static_cast<std::size_t>(width));
  out.down.resize(static_cast<std::size_t>(width));
  for (int x = 0; x < width; ++x) {
    const auto at = static_cast<std::size_t>(x);
    const auto first = static_cast<std::size_t>(std::clamp(x / step - 1, 0, nodes - 4));
    // Lagrange's cubic through nodes 0, 1, 2, 3 at t
    const double t = static_cast<double>(x) / step - static_cast<double>(first);
    const double a = t, b = t - 1, c = t - 2, d = t - 3;
    out.ray[at] = -b * c * d / 6 * ray[first] + a * c * d / 2 * ray[first + 1] - a * b * d / 2 * ray[first + 2] +
                  a * b * c / 6 * ray[first + 3];
    const auto below = std::min(static_cast<std::size_t>(x / step), down.size() - 2);
    const double share = static_cast<double>(x) / step - static_cast<double>(below);
    out.down[at] = (1 - share) * down[below] + share * down[below + 1];
    // Near the fold of a wide lens some nodes have no ray, though the pixel may.
    if (!out.ray[at].allFinite() || !out.down[at].allFinite()) {
      const Vector2d q(x, y);
      out.ray[at] = camera_.ray(q);
      out.down[at] = camera_.ray(q + Vector2d(0, 0.5)) - camera_.ray(q - Vector2d(0, 0.5));
    }
  }
}

}  // namespace raysteer::sim::world
