#include "calib/bake/aim.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "calib/bake/mirror_window.hpp"

namespace raysteer::calib::bake {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// What is to be lit: four places, and the plane that they lie in or about.
struct Shown {
  std::string name;
  std::array<Vector3d, 4> corners;
  Vector3d middle;
  Vector3d normal;
  std::optional<Vector2d> command_rad;
};

std::optional<Vector2d> miss_px(const model::SteeredProjector& projector, const Vector3d& p, const Vector2d& x,
                                const Vector2d& command) {
  const auto at = projector.at(command).project(p);
  return at && at->allFinite() ? std::optional<Vector2d>(*at - x) : std::nullopt;
}

/// Does the panel light a point of the rig's frame?
bool lit(const model::VirtualProjector& view, const MirrorWindow& window, const Vector3d& p) {
  const Vector3d q = view.rotation * p + view.translation;
  const auto x = view.lens.project(q);
  if (!x || x->x() < -0.5 || x->y() < -0.5 || x->x() > view.lens.width - 0.5 || x->y() > view.lens.height - 0.5) {
    return false;
  }
  const Vector3d m = q / q.z();
  return window.passes(m) && window.inverse_exit(m) * q.z() > 1;
}

/// How far beyond the light a point lies, on the way to `inner`.
double beyond_m(const model::VirtualProjector& view, const MirrorWindow& window, const Vector3d& p,
                const Vector3d& inner) {
  double outside = 0;
  double inside = 1;
  for (int halving = 0; halving < 30; ++halving) {
    const double middle = 0.5 * (outside + inside);
    (lit(view, window, p + middle * (inner - p)) ? inside : outside) = middle;
  }
  return inside * (inner - p).norm();
}

/// Where the panel's middle lands on the plane; the places' own middle when it does not.
Vector3d middle_of_light(const model::VirtualProjector& view, const Shown& shown) {
  const auto ray = view.ray(0.5 * Vector2d(view.lens.width - 1, view.lens.height - 1));
  const double length = ray ? shown.normal.dot(shown.middle - view.centre()) / shown.normal.dot(*ray) : -1;
  return length > 0 && std::isfinite(length) ? Vector3d(view.centre() + length * *ray) : shown.middle;
}

Vector2d middle_of(const std::array<Vector2d, 4>& points) {
  Vector2d least = points[0];
  Vector2d most = points[0];
  for (const Vector2d& point : points) {
    least = least.cwiseMin(point);
    most = most.cwiseMax(point);
  }
  return 0.5 * (least + most);
}

/// Puts the middle of the corners' picture in the panel's middle.
std::optional<Vector2d> central_command(const model::SteeredProjector& projector, const Shown& shown) {
  const Vector3d& middle = shown.middle;
  const auto& points = shown.corners;
  Vector2d x = panel_middle(projector);
  auto command = command_for(projector, middle, x);
  for (int round = 0; round < 5 && command; ++round) {
    const model::VirtualProjector view = projector.at(*command);
    std::array<Vector2d, 4> seen;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const auto at = view.project(points[i]);
      if (!at) {
        return command;
      }
      seen[i] = *at;
    }
    const Vector2d off = panel_middle(projector) - middle_of(seen);
    if (off.norm() < 1e-3 || off.norm() > projector.lens.width) {
      return command;
    }
    x += off;
    const auto next = command_near(projector, middle, x, *command);
    if (!next) {
      return command;
    }
    command = next;
  }
  return command;
}

/// A command within the range whose light comes as near to the middle as the range allows; roughly.
std::optional<Vector2d> nearest_command(const model::SteeredProjector& projector, const Shown& shown) {
  constexpr int kParts = 24;
  const auto n = projector.lens.normalize(panel_middle(projector));
  double least = std::numeric_limits<double>::infinity();
  std::optional<Vector2d> best;
  for (int i = 0; i <= kParts && n; ++i) {
    for (int j = 0; j <= kParts; ++j) {
      const Vector2d share(i / double{kParts}, j / double{kParts});
      const Vector2d command = projector.least_rad + share.cwiseProduct(projector.most_rad - projector.least_rad);
      const Vector3d lands = middle_of_light(projector.at(command), shown);
      const double off = (lands - shown.middle).norm();
      if (off > 0 && off < least && MirrorWindow(projector, command).passes(n->homogeneous())) {
        least = off;
        best = command;
      }
    }
  }
  return best;
}

std::string in_mrad(const Vector2d& command) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "(%.1f, %.1f) mrad", 1e3 * command.x(), 1e3 * command.y());
  return text.data();
}

}  // namespace

std::optional<Vector2d> command_near(const model::SteeredProjector& projector, const Vector3d& p, const Vector2d& x,
                                     const Vector2d& start_rad) {
  constexpr double kStep = 1e-6;  // rad, of the derivatives
  Vector2d command = start_rad;
  auto miss = miss_px(projector, p, x, command);
  for (int iteration = 0; iteration < 30 && miss; ++iteration) {
    if (miss->norm() < 1e-9) {
      return command;
    }
    Eigen::Matrix2d J;
    for (int axis = 0; axis < 2; ++axis) {
      const Vector2d step = kStep * Vector2d::Unit(axis);
      const auto ahead = miss_px(projector, p, x, command + step);
      const auto behind = miss_px(projector, p, x, command - step);
      if (!ahead || !behind) {
        return std::nullopt;
      }
      J.col(axis) = (*ahead - *behind) / (2 * kStep);
    }
    if (!(std::abs(J.determinant()) > 1e-6 * J.squaredNorm())) {
      return std::nullopt;
    }
    const Vector2d full = -(J.inverse() * *miss);
    // Halving: far away a full step can leave the half space before the lens.
    double part = std::min(1.0, 0.3 / full.norm());
    auto next = miss_px(projector, p, x, command + part * full);
    while (part > 1e-4 && !(next && next->norm() < miss->norm())) {
      part /= 2;
      next = miss_px(projector, p, x, command + part * full);
    }
    if (!(next && next->norm() < miss->norm())) {
      // Rounding ends the way down: near enough is found.
      return miss->norm() < 1e-7 ? std::optional(command) : std::nullopt;
    }
    command += part * full;
    miss = next;
  }
  return miss && miss->norm() < 1e-7 ? std::optional(command) : std::nullopt;
}

std::optional<Vector2d> command_for(const model::SteeredProjector& projector, const Vector3d& p, const Vector2d& x) {
  constexpr int kParts = 8;
  double least = std::numeric_limits<double>::infinity();
  Vector2d best = Vector2d::Zero();
  for (int i = 0; i <= kParts; ++i) {
    for (int j = 0; j <= kParts; ++j) {
      const Vector2d share(i / double{kParts}, j / double{kParts});
      const Vector2d command = projector.least_rad + share.cwiseProduct(projector.most_rad - projector.least_rad);
      const auto miss = miss_px(projector, p, x, command);
      if (miss && miss->norm() < least) {
        least = miss->norm();
        best = command;
      }
    }
  }
  return std::isfinite(least) ? command_near(projector, p, x, best) : std::nullopt;
}

namespace {

Result<Vector2d> command_of(const model::SteeredProjector& projector, const Shown& shown) {
  const std::string where = "station '" + shown.name + "': ";
  const auto exact = shown.command_rad ? shown.command_rad : central_command(projector, shown);
  const auto wanted = exact ? exact : nearest_command(projector, shown);
  if (!wanted) {
    return fail(RCode::kStationOutOfReach, where + "it lies behind the light at every command");
  }
  if (shown.command_rad && !projector.in_range(*wanted)) {
    return fail(RCode::kStationOutOfReach, where + "its command " + in_mrad(*wanted) + " is out of the range " +
                                               in_mrad(projector.least_rad) + " to " + in_mrad(projector.most_rad));
  }
  const Vector2d command = wanted->cwiseMax(projector.least_rad).cwiseMin(projector.most_rad);
  const model::VirtualProjector view = projector.at(command);
  const MirrorWindow window(projector, command);
  const auto& points = shown.corners;
  const Vector3d inner = middle_of_light(view, shown);
  std::size_t worst = 0;
  double farthest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double beyond = lit(view, window, points[i]) ? 0 : beyond_m(view, window, points[i], inner);
    if (beyond > farthest) {
      farthest = beyond;
      worst = i;
    }
  }
  if (farthest > 0) {
    std::array<char, 96> far{};
    std::snprintf(far.data(), far.size(), "its %s corner lies %.0f mm beyond the light", kCornerNames[worst],
                  1e3 * farthest);
    std::string note = where + far.data() + " at command " + in_mrad(command);
    if (!exact || !projector.in_range(*wanted)) {
      note += ", where the mirror's range ends";
    }
    return fail(RCode::kStationOutOfReach, std::move(note), static_cast<std::int64_t>(std::lround(1e3 * farthest)));
  }
  return command;
}

}  // namespace

Result<Vector2d> station_command(const model::SteeredProjector& projector, const Station& station) {
  return command_of(projector, {.name = station.name,
                                .corners = corners(station),
                                .middle = station.T_rig_plane.t,
                                .normal = station.T_rig_plane.q * Vector3d::UnitZ(),
                                .command_rad = station.command_rad});
}

Result<Vector2d> command_showing(const model::SteeredProjector& projector, const std::string& name,
                                 const std::array<Vector3d, 4>& corners) {
  const Vector3d normal = (corners[2] - corners[0]).cross(corners[3] - corners[1]).normalized();
  return command_of(projector, {.name = name,
                                .corners = corners,
                                .middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]),
                                .normal = normal,
                                .command_rad = std::nullopt});
}

}  // namespace raysteer::calib::bake
