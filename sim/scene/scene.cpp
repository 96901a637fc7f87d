#include "sim/scene/scene.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>

namespace raysteer::sim::scene {
namespace {

double seconds(RigTime time) { return std::chrono::duration<double>(time.time_since_epoch()).count(); }

Eigen::Vector3d place_on(const std::vector<Waypoint>& path, bool repeats, double time_s) {
  const double first = path.front().time_s;
  const double last = path.back().time_s;
  if (repeats && last > first && time_s > first) {
    time_s = first + std::fmod(time_s - first, last - first);
  }
  const auto next = std::ranges::upper_bound(path, time_s, {}, &Waypoint::time_s);
  if (next == path.begin()) {
    return path.front().position;
  }
  if (next == path.end()) {
    return path.back().position;
  }
  const Waypoint& from = *(next - 1);
  const double share = (time_s - from.time_s) / (next->time_s - from.time_s);
  return from.position + share * (next->position - from.position);
}

}  // namespace

std::optional<Eigen::Isometry3d> Surface::pose(const Moment& moment) const {
  const double now = seconds(moment.time);
  if (now < appears_s || now >= vanishes_s) {
    return {};
  }
  if (is_target && moment.target_pose > 0) {
    const auto index = static_cast<std::size_t>(moment.target_pose) - 1;
    return index < T_room_poses.size() ? std::optional(T_room_poses[index]) : std::nullopt;
  }
  if (is_target && (moment.target_pose < 0 || !rests)) {
    return {};
  }
  Eigen::Isometry3d T = T_room_surface;
  if (moves()) {
    T.translation() += place_on(path, path_repeats, now);
  }
  return T;
}

Result<int> Scene::target_pose(std::string_view prepare, int now) const {
  if (prepare.empty()) {
    return now;
  }
  if (prepare == "target away") {
    return kTargetAway;
  }
  const bool rests = std::ranges::any_of(surfaces, &Surface::rests);
  if (prepare == "target on floor" && rests) {
    return kTargetOnFloor;
  }
  std::size_t poses = 0;
  for (const Surface& surface : surfaces) {
    poses = std::max(poses, surface.T_room_poses.size());
  }
  constexpr std::string_view kPose = "target pose ";
  if (prepare.starts_with(kPose)) {
    const std::string_view number = prepare.substr(kPose.size());
    int pose = 0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), pose);
    if (error == std::errc{} && end == number.data() + number.size() && pose > 0 &&
        static_cast<std::size_t>(pose) <= poses) {
      return pose;
    }
  }
  std::string known = "'target away'";
  known += rests ? ", 'target on floor'" : "";
  known += poses > 0 ? ", 'target pose 1' to 'target pose " + std::to_string(poses) + "'" : "";
  return fail(RCode::kBadPrepare, "scene '" + name + "' knows " + known + "; got '" + std::string(prepare) + "'");
}

FlatScene flatten(const Scene& scene, const Moment& moment, Which which) {
  FlatScene flat;
  for (std::size_t i = 0; i < scene.surfaces.size(); ++i) {
    const Surface& surface = scene.surfaces[i];
    const auto T_room_surface = surface.pose(moment);
    if (!T_room_surface || (which == Which::kStill && surface.moves()) ||
        (which == Which::kMoving && !surface.moves())) {
      continue;
    }
    const auto first = static_cast<std::uint32_t>(flat.vertices.size());
    for (const Eigen::Vector3d& vertex : surface.mesh.vertices) {
      flat.vertices.push_back(*T_room_surface * vertex);
    }
    flat.uv.insert(flat.uv.end(), surface.mesh.uv.begin(), surface.mesh.uv.end());
    flat.uv.resize(flat.vertices.size(), Eigen::Vector2d::Zero());
    for (const Triangle& triangle : surface.mesh.triangles) {
      flat.triangles.push_back({first + triangle[0], first + triangle[1], first + triangle[2]});
      flat.surface.push_back(static_cast<std::uint32_t>(i));
    }
  }
  return flat;
}

std::uint64_t still_key(const Scene& scene, const Moment& moment) {
  // FNV-1a over what can change without moving: who is there, and which pose targets are in.
  std::uint64_t key = 0xcbf29ce484222325U;
  const auto add = [&](std::uint64_t value) { key = (key ^ value) * 0x100000001b3U; };
  for (const Surface& surface : scene.surfaces) {
    if (!surface.moves()) {
      add(surface.pose(moment).has_value() ? 1 : 2);
      add(surface.is_target ? static_cast<std::uint64_t>(moment.target_pose) : 0);
    }
  }
  return key;
}

}  // namespace raysteer::sim::scene
