#include "calib/bake/steering.hpp"

#include <cmath>
#include <deque>
#include <limits>
#include <vector>

#include "calib/bake/aim.hpp"
#include "calib/bake/mirror_window.hpp"

namespace raysteer::calib::bake {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using proto::lut::PlanePoint;
using proto::lut::SteeringTable;
using proto::lut::SteeringTableParts;

/// Nodes are solved a little beyond the range, so that cells at its end have all their corners.
constexpr double kBeyondRange = 0.1;
constexpr double kSpare = 1.25;  ///< bound over the worst place tried

struct Area {
  Vector2d least = Vector2d::Constant(std::numeric_limits<double>::infinity());
  Vector2d most = -least;
};

/// The command at whose angles the mirror stands when it should stand at `angles`. Curves are nearly straight with
/// slope 1, so each round leaves a fiftieth.
Vector2d command_of(const model::SteeredProjector& projector, const Vector2d& angles, Vector2d command) {
  for (int round = 0; round < 10; ++round) {
    command += angles - projector.angles(command);
  }
  return command;
}

/// As what command the drifted mirror stands when it is told this one.
Vector2d stands_as(const model::SteeredProjector& projector, const MirrorDrift& drift, const Vector2d& told) {
  const Vector2d angles = projector.angles(told);
  return command_of(projector, angles + drift.gain.cwiseProduct(angles) + drift.offset_rad, told);
}

/// What the drifted mirror must be told to stand as at this command.
Vector2d told_for(const model::SteeredProjector& projector, const MirrorDrift& drift, const Vector2d& command) {
  const Vector2d angles = (projector.angles(command) - drift.offset_rad).cwiseQuotient(Vector2d::Ones() + drift.gain);
  return command_of(projector, angles, command);
}

/// Around all places that a grid of commands reaches.
Area reach(const model::SteeredProjector& projector, const SteeringRequest& request, const Vector2d& aim) {
  constexpr int kParts = 24;
  Area area;
  for (int i = 0; i <= kParts; ++i) {
    for (int j = 0; j <= kParts; ++j) {
      const Vector2d share(i / double{kParts}, j / double{kParts});
      const Vector2d told = projector.least_rad + share.cwiseProduct(projector.most_rad - projector.least_rad);
      const auto place = landing(projector, request.T_rig_plane, aim, stands_as(projector, request.drift, told));
      if (place && place->norm() <= request.farthest_m) {
        area.least = area.least.cwiseMin(*place);
        area.most = area.most.cwiseMax(*place);
      }
    }
  }
  return area;
}

class Nodes {
 public:
  Nodes(const model::SteeredProjector& projector, const SteeringRequest& request, const Vector2d& aim,
        const SteeringTableParts& parts)
      : projector_(projector), request_(request), aim_(aim), parts_(parts) {
    commands_.resize(parts.nodes.size());
    tried_.resize(parts.nodes.size());
  }

  /// From one node to its neighbours, each started from the command beside it.
  void solve() {
    const Vector2d middle = 0.5 * (projector_.least_rad + projector_.most_rad);
    const auto place = landing(projector_, request_.T_rig_plane, aim_, middle);
    int column = parts_.columns / 2;
    int row = parts_.rows / 2;
    if (place) {
      column = std::clamp(static_cast<int>((place->x() - parts_.origin.x) / parts_.spacing_m), 0, parts_.columns - 1);
      row = std::clamp(static_cast<int>((place->y() - parts_.origin.y) / parts_.spacing_m), 0, parts_.rows - 1);
    }
    const auto first = command_for(projector_, at(column, row), aim_);
    if (!first) {
      return;
    }
    accept(column, row, *first);
    while (!open_.empty()) {
      const auto [from_column, from_row] = open_.front();
      open_.pop_front();
      const Vector2d start = *commands_[index(from_column, from_row)];
      for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
        const int c = from_column + dx;
        const int r = from_row + dy;
        if (c < 0 || r < 0 || c >= parts_.columns || r >= parts_.rows || tried_[index(c, r)] != 0) {
          continue;
        }
        tried_[index(c, r)] = 1;
        if (const auto command = command_near(projector_, at(c, r), aim_, start)) {
          accept(c, r, *command);
        }
      }
    }
  }

  const std::optional<Vector2d>& command(int column, int row) const { return commands_[index(column, row)]; }

 private:
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(parts_.columns) + static_cast<std::size_t>(column);
  }
  Vector3d at(int column, int row) const {
    return request_.T_rig_plane *
           Vector3d(parts_.origin.x + column * parts_.spacing_m, parts_.origin.y + row * parts_.spacing_m, 0);
  }
  void accept(int column, int row, const Vector2d& command) {
    tried_[index(column, row)] = 1;
    const Vector2d beyond = kBeyondRange * (projector_.most_rad - projector_.least_rad);
    if ((command.array() >= (projector_.least_rad - beyond).array()).all() &&
        (command.array() <= (projector_.most_rad + beyond).array()).all()) {
      commands_[index(column, row)] = command;
      open_.emplace_back(column, row);
    }
  }

  const model::SteeredProjector& projector_;
  const SteeringRequest& request_;
  Vector2d aim_;
  const SteeringTableParts& parts_;
  std::vector<std::optional<Vector2d>> commands_;
  std::vector<std::uint8_t> tried_;
  std::deque<std::pair<int, int>> open_;
};

std::int32_t nanoradians(double rad) { return static_cast<std::int32_t>(std::lround(1e9 * rad)); }

/// Commands at all nodes; a cell is reached when the aimed ray leaves the rig at its four corners.
void fill(const model::SteeredProjector& projector, const SteeringRequest& request, const Vector2d& aim,
          const Vector3d& m, SteeringTableParts& parts) {
  Nodes nodes(projector, request, aim, parts);
  nodes.solve();
  std::vector<std::uint8_t> leaves(parts.nodes.size());
  for (int row = 0; row < parts.rows; ++row) {
    for (int column = 0; column < parts.columns; ++column) {
      if (const auto& command = nodes.command(column, row)) {
        const auto i = static_cast<std::size_t>(row * parts.columns + column);
        const Vector2d told = told_for(projector, request.drift, *command);
        parts.nodes[i] = {nanoradians(told.x()), nanoradians(told.y())};
        leaves[i] = MirrorWindow(projector, *command).passes(m) ? 1 : 0;
      }
    }
  }
  for (int row = 0; row + 1 < parts.rows; ++row) {
    for (int column = 0; column + 1 < parts.columns; ++column) {
      const auto i = static_cast<std::size_t>(row * parts.columns + column);
      const auto below = i + static_cast<std::size_t>(parts.columns);
      parts.reached[static_cast<std::size_t>(row * (parts.columns - 1) + column)] =
          leaves[i] & leaves[i + 1] & leaves[below] & leaves[below + 1];
    }
  }
}

/// The worst of the middles of cells and sides; negative when no place has a command.
double worst_m(const model::SteeredProjector& projector, const SteeringRequest& request, const Vector2d& aim,
               const SteeringTable& table) {
  const SteeringTableParts& parts = table.parts();
  double worst = -1;
  for (int row = 0; row <= 2 * (parts.rows - 1); ++row) {
    for (int column = 0; column <= 2 * (parts.columns - 1); ++column) {
      if (row % 2 == 0 && column % 2 == 0) {
        continue;
      }
      const PlanePoint place{parts.origin.x + 0.5 * column * parts.spacing_m,
                             parts.origin.y + 0.5 * row * parts.spacing_m};
      if (const auto command = table.command(place)) {
        const Vector2d told(command->axis1_rad, command->axis2_rad);
        const auto lands = landing(projector, request.T_rig_plane, aim, stands_as(projector, request.drift, told));
        worst = std::max(worst, lands ? (*lands - Vector2d(place.x, place.y)).norm() : 1e6);
      }
    }
  }
  return worst;
}

}  // namespace

std::optional<Vector2d> landing(const model::SteeredProjector& projector, const model::Pose& T_rig_plane,
                                const Vector2d& x, const Vector2d& command_rad) {
  const model::VirtualProjector view = projector.at(command_rad);
  const auto ray = view.ray(x);
  if (!ray) {
    return std::nullopt;
  }
  const Vector3d from = T_rig_plane.inverse() * view.centre();
  const Vector3d along = T_rig_plane.q.conjugate() * *ray;
  const double length = -from.z() / along.z();
  if (!(length > 0) || !std::isfinite(length)) {
    return std::nullopt;
  }
  return (from + length * along).head<2>();
}

Result<SteeringTable> bake_steering(const model::SteeredProjector& projector, const SteeringRequest& request) {
  if (!(request.bound_m > 0) || !(request.farthest_m > 0)) {
    return fail(RCode::kBadValue, "bound and farthest place of a steering table must be positive");
  }
  if (!request.drift.offset_rad.allFinite() || !(request.drift.gain.cwiseAbs().maxCoeff() < 0.5)) {
    return fail(RCode::kBadValue, "a mirror's drift must be finite, its gain less than a half");
  }
  const Vector2d aim = request.aim_px.value_or(panel_middle(projector));
  const auto n = projector.lens.normalize(aim);
  const Area area = reach(projector, request, aim);
  if (!n || !area.least.allFinite() || !((area.most - area.least).minCoeff() > 1e-3)) {
    return fail(RCode::kStationOutOfReach, "the steering table's plane gets no light at any command");
  }
  SteeringTableParts parts;
  parts.frame = request.frame;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      parts.T_frame_plane[static_cast<std::size_t>(4 * row + column)] = request.T_frame_plane.rotation()(row, column);
    }
    parts.T_frame_plane[static_cast<std::size_t>(4 * row + 3)] = request.T_frame_plane.t[row];
  }
  parts.aim_px = {aim.x(), aim.y()};
  parts.bound_m = request.bound_m;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    parts.least_nrad[axis] = nanoradians(projector.least_rad[static_cast<int>(axis)]);
    parts.most_nrad[axis] = nanoradians(projector.most_rad[static_cast<int>(axis)]);
  }
  double spacing = (area.most - area.least).maxCoeff() / 48;
  for (int round = 0; round < 12; ++round) {
    parts.spacing_m = spacing;
    // A cell more all around, so that the range's end lies within cells.
    parts.origin = {area.least.x() - spacing, area.least.y() - spacing};
    const Vector2d cells = (area.most - area.least) / spacing;
    if ((cells.x() + 4) * (cells.y() + 4) > SteeringTable::kMostNodes) {
      break;
    }
    parts.columns = static_cast<int>(std::ceil(cells.x())) + 3;
    parts.rows = static_cast<int>(std::ceil(cells.y())) + 3;
    const auto count = static_cast<std::size_t>(parts.columns) * static_cast<std::size_t>(parts.rows);
    parts.nodes.assign(count, {0, 0});
    parts.reached.assign(static_cast<std::size_t>(parts.columns - 1) * static_cast<std::size_t>(parts.rows - 1), 0);
    fill(projector, request, aim, n->homogeneous(), parts);
    auto table = SteeringTable::make(parts);
    RAYSTEER_TRY(table);
    const double worst = worst_m(projector, request, aim, *table);
    if (worst < 0) {
      return fail(RCode::kStationOutOfReach, "the steering table's plane gets no light at any command");
    }
    if (kSpare * worst <= request.bound_m) {
      parts.worst_m = worst;
      return SteeringTable::make(std::move(parts));
    }
    spacing *= std::clamp(std::sqrt(0.9 * request.bound_m / (kSpare * worst)), 1e-3, 0.9);
  }
  return fail(RCode::kTableBound, "a steering table within " + std::to_string(1e3 * request.bound_m) +
                                      " mm would need more than " + std::to_string(SteeringTable::kMostNodes) +
                                      " nodes; ask for a larger bound or a nearer farthest place");
}

}  // namespace raysteer::calib::bake
