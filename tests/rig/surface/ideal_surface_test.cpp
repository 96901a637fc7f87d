// Pictures on a scanned surface, against the truth: rigs solved from noisy ideal looks scan a box on a floor, aim, and
// the true rig's light is followed to where it truly falls.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calib/assess/on_relief.hpp"
#include "calib/bake/lit_content.hpp"
#include "calib/scene/fuse.hpp"
#include "calib/scene/two_views.hpp"
#include "host/rig/stations.hpp"
#include "tests/support/floor_task.hpp"
#include "tests/support/seed.hpp"

namespace raysteer::support {
namespace {

using calib::scene::CloudPoint;
using calib::scene::Match;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kScanNoisePx = 0.1;  // algorithms 2.3: the default set

/// 0.3 m high. The room's frame is the true rig's: z down.
const std::array kBoxes{ideal::Box{{-0.35, -0.3, kFloorDepth - 0.3}, {0.15, 0.2, kFloorDepth}}};

std::optional<Vector3d> lit(const sim::optics::LightPath& path, const Vector2d& x) {
  const auto out = path.leave(x);
  return out && out->passage.through ? ideal::meet(out->origin, out->direction, kBoxes) : std::nullopt;
}

struct Cloud {
  std::vector<CloudPoint> points;
  std::vector<Match> matches;
};

sim::optics::LightPath path_of(const IdealRig& rig, const Vector2d& angles) {
  return {rig.truth.rig, {Radians(angles.x()), Radians(angles.y())}};
}

/// A look as the solved cameras measure it: every `step`th pixel of the panel.
Cloud scanned(const IdealRig& rig, const calib::scene::TwoViews& views, const Vector2d& command, int step,
              Noise& noise) {
  Cloud cloud;
  const auto path = path_of(rig, rig.projector.angles(command));
  const auto& panel = rig.projector.lens;
  for (int j = 0; j < panel.height / step; ++j) {
    for (int i = 0; i < panel.width / step; ++i) {
      const auto p = lit(path, Vector2d(i * step, j * step));
      Match match{.i = static_cast<std::uint16_t>(i), .j = static_cast<std::uint16_t>(j)};
      bool seen = p.has_value();
      for (std::size_t eye = 0; eye < 2 && seen; ++eye) {
        const auto& camera = rig.truth.rig.cameras[eye];
        const auto q = camera.project(*p);
        const auto again = ideal::meet(camera.centre(), *p - camera.centre(), kBoxes);
        seen = q && again && (*again - *p).norm() < 1e-6 && q->minCoeff() > 0 && q->x() < camera.width - 1 &&
               q->y() < camera.height - 1;
        if (seen) {
          (eye == 0 ? match.q_left : match.q_right) = *q + ideal::normals(noise, kScanNoisePx);
          (eye == 0 ? match.cov_left : match.cov_right) = kScanNoisePx * kScanNoisePx * Eigen::Matrix2d::Identity();
        }
      }
      if (!seen) {
        continue;
      }
      const std::array one{match};
      if (auto point = calib::scene::triangulate_one(views, match, calib::scene::ray_pairs(views, one)[0])) {
        point->match = static_cast<std::uint32_t>(cloud.matches.size());
        cloud.points.push_back(*point);
        cloud.matches.push_back(match);
      }
    }
  }
  return cloud;
}

std::optional<host::rig::Scene> scan(const IdealRig& rig, const calib::steer::InRoom& room, Noise& noise,
                                     int step = 12) {
  const auto views = calib::scene::two_views(room.solution.cameras, 0, 1);
  std::optional<calib::scene::Fusion> fusion;
  for (const Vector2d& about : {Vector2d(-0.35, -0.1), Vector2d(0.1, -0.1), Vector2d(-0.1, 0.2)}) {
    const Vector2d command =
        aimed(room.solution.projector, room.T_rig_room * Vector3d(about.x(), about.y(), kFloorDepth - 0.1));
    const Cloud cloud = scanned(rig, *views, command, step, noise);
    if (!fusion) {
      fusion.emplace(*calib::scene::cell_for(cloud.points, cloud.matches));
    }
    fusion->add("look", cloud.points);
  }
  auto fused = fusion->fuse();
  EXPECT_TRUE(fused) << fused.error().message();
  if (!fused) {
    return std::nullopt;
  }
  EXPECT_LT(fused->median_mm, 2);
  auto surface = calib::bake::RayCaster::make({.points = fused->points, .triangles = fused->triangles});
  return surface ? std::optional(host::rig::Scene{.surface = *std::move(surface), .sigma_m = fused->sigma_m})
                 : std::nullopt;
}

/// Over the box's edge, half on its top and half on the floor; the same for somebody who stands aside; and one that an
/// eye sees upright on the bare floor.
proto::stations::Stations wanted() {
  using proto::stations::Surface;
  proto::stations::Station draped;
  draped.name = "draped";
  draped.position_m = {0.15, -0.05, kFloorDepth - 0.1};
  draped.rotation_deg = {180, 0, 0};
  draped.size_m = {0.5, 0.3};
  draped.surface = Surface::kScan;
  draped.tolerance_mm = 5;
  auto seen = draped;
  seen.name = "seen";
  seen.position_m = {-0.1, -0.05, kFloorDepth - 0.3};
  seen.size_m = {0.2, 0.15};
  seen.eye_m = proto::stations::Vec3{0.9, 1.2, kFloorDepth - 1.7};
  auto plane = seen;
  plane.name = "plane";
  plane.surface = Surface::kPlane;
  plane.position_m = {0.5, 0.2, kFloorDepth};
  return {.name = "three", .stations = {draped, seen, plane}, .keep_out = {}};
}

struct Off {
  std::vector<double> corner_mm;
  std::vector<double> picture_mm;
  int within = 0;
};

/// Follows the true light of the corners' pixels, and of many pixels between them.
void follow(const IdealRig& rig, const calib::steer::InRoom& room, const host::rig::Scene& scene,
            const host::rig::AimedStation& one, Noise& noise, Off& off) {
  const Vector2d angles =
      rig.projector.angles(*one.station.command_rad) + ideal::normals(noise, IdealOptions{}.repeatability_rad);
  const auto path = path_of(rig, angles);
  for (std::size_t k = 0; k < 4; ++k) {
    const auto p = lit(path, one.panel[k]);
    ASSERT_TRUE(p) << one.station.name;
    const Vector3d miss = *p - one.corners_room[k];
    const double across_mm = 1e3 * (miss - one.sights_room[k] * one.sights_room[k].dot(miss)).norm();
    off.corner_mm.push_back(across_mm);
    off.within += across_mm <= one.bound_95_mm[k] ? 1 : 0;
  }
  // What the picture shows at a pixel against what belongs where its light truly falls.
  const calib::bake::StationView view(room.solution.projector, *one.station.command_rad, one.content, &scene.surface,
                                      {}, {});
  std::vector<std::optional<calib::bake::Placed>> placed;
  Vector2d least = one.panel[0], most = one.panel[0];
  for (const Vector2d& x : one.panel) {
    least = least.cwiseMin(x);
    most = most.cwiseMax(x);
  }
  const double sheet_m = one.station.size_m.x() / one.station.content_px.x();
  const double at_sheet = (one.content.content_rig * one.station.T_rig_plane.t.homogeneous()).z();
  for (int k = 0; k < 300; ++k) {
    const double share_x = noise.uniform(0, 1);
    const double share_y = noise.uniform(0, 1);
    const Vector2d x = least + Vector2d(share_x, share_y).cwiseProduct(most - least);
    const std::array ray{calib::bake::panel_ray(room.solution.projector.lens, x)};
    view.lit(ray, placed);
    const auto p = lit(path, x);
    if (placed[0] && p) {
      const Vector3d belongs = one.content.content_rig * (room.T_rig_room * *p).homogeneous();
      off.picture_mm.push_back(1e3 * sheet_m * belongs.z() / at_sheet *
                               (belongs.hnormalized() - placed[0]->content()).norm());
    }
  }
}

class IdealSurface : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Boards, IdealSurface, testing::Values("mock-galvo", "mock-head"),
                         [](const auto& name) { return name.param == std::string("mock-head") ? "head" : "galvo"; });

TEST_P(IdealSurface, pictures_lie_on_what_was_scanned_within_what_was_stated) {
  const PlannedBoard board = planned_board(GetParam(), 16);
  const std::uint64_t first = seed();
  std::map<std::string, Off> off;
  constexpr int kRigs = 3;
  for (std::uint64_t k = 0; k < kRigs; ++k) {
    IdealOptions options;
    options.points = 45;
    const SteerTrial trial(board, first + k, options);
    ASSERT_TRUE(trial.solution()) << trial.solution().error().message();
    Noise noise(first + k, 0x5ca);
    const auto room = tied_to_room(trial, {}, noise);
    ASSERT_TRUE(room);
    const auto scene = scan(trial.rig(), *room, noise);
    ASSERT_TRUE(scene);
    const auto stations = host::rig::aim_stations(*room, wanted(), &*scene);
    ASSERT_TRUE(stations) << stations.error().message();
    for (const host::rig::AimedStation& one : *stations) {
      follow(trial.rig(), *room, *scene, one, noise, off[one.station.name]);
    }
  }
  int within = 0;
  int corners = 0;
  for (const auto& [name, one] : off) {
    std::printf(
        "%s %s: corners %.2f / %.2f mm median / worst, %d of %zu within the stated 95 %%; picture %.2f / %.2f mm "
        "median / 95 %%\n",
        GetParam(), name.c_str(), quantile(one.corner_mm, 0.5), quantile(one.corner_mm, 1), one.within,
        one.corner_mm.size(), quantile(one.picture_mm, 0.5), quantile(one.picture_mm, 0.95));
    // The box's height shows to an eye that looks from aside; how well it is known the next test asks of many rigs.
    const bool by_height = name == "seen";
    EXPECT_LT(quantile(one.corner_mm, 0.5), by_height ? 2.5 : 0.7);
    EXPECT_LT(quantile(one.corner_mm, 1), by_height ? 4 : 2.5);
    EXPECT_LT(quantile(one.picture_mm, 0.5), by_height ? 2.5 : 1);
    EXPECT_GT(one.picture_mm.size(), 100U * kRigs);
    within += by_height ? 0 : one.within;
    corners += by_height ? 0 : static_cast<int>(one.corner_mm.size());
  }
  // A picture's corners miss alike: nine pictures say little of a share, but a bound that is far too small shows.
  EXPECT_GT(within, corners * 6 / 10);
}

// Two eyes know heights by their datums alone: with twelve seen to 0.1 px each, to 0.85 mm (one standard deviation, the
// same over the whole room), so that three rigs say nothing. Of 100, whose corners miss alike, fewer than 89 % are
// inside once in 10^4 runs where 97 % are (a mesh's sigma is that of its triangles' worst corner: on the safe side).
TEST_P(IdealSurface, a_picture_for_an_eye_is_as_sure_as_stated) {
  const auto board = drawn_rig(GetParam()).board;
  const std::uint64_t first = seed();
  constexpr std::uint64_t kRigs = 100;
  auto only = wanted();
  only.stations = {only.stations[1]};
  Off off;
  std::vector<double> bound_mm;
  for (std::uint64_t mine = first; mine < first + kRigs; ++mine) {
    const auto rig = draw_ideal(board, mine);
    ASSERT_TRUE(rig) << rig.error().message();
    Noise noise(mine, 0xe7e);
    const auto room = tied_to_room(*rig, solution_of(*rig, mine), {}, noise);
    ASSERT_TRUE(room);
    const auto scene = scan(*rig, *room, noise, 24);
    ASSERT_TRUE(scene);
    const auto stations = host::rig::aim_stations(*room, only, &*scene);
    ASSERT_TRUE(stations) << stations.error().message();
    follow(*rig, *room, *scene, stations->front(), noise, off);
    bound_mm.insert(bound_mm.end(), stations->front().bound_95_mm.begin(), stations->front().bound_95_mm.end());
  }
  const double inside = off.within / static_cast<double>(off.corner_mm.size());
  std::printf("%s: corners %.2f / %.2f / %.2f mm median / 95 %% / worst, %.1f %% within the stated 95 %%: %.2f mm\n",
              GetParam(), quantile(off.corner_mm, 0.5), quantile(off.corner_mm, 0.95), quantile(off.corner_mm, 1),
              100 * inside, quantile(bound_mm, 0.5));
  EXPECT_GT(inside, 0.89);
  EXPECT_LT(quantile(off.corner_mm, 0.5), 0.95);
  EXPECT_LT(quantile(off.corner_mm, 0.95), 2.1);
  EXPECT_LT(quantile(bound_mm, 0.5), 1.75);
}

TEST(PlaceBound, is_the_corners_bound_where_a_known_plane_is_looked_at_along_its_normal) {
  const PlannedBoard board = planned_board("mock-head", 16);
  IdealOptions options;
  options.points = 45;
  const SteerTrial trial(board, seed(), options);
  ASSERT_TRUE(trial.solution());
  Noise noise(seed(), 2);
  const auto room = tied_to_room(trial, {}, noise);
  ASSERT_TRUE(room);
  const Vector3d normal = Vector3d(0.2, -0.1, -1).normalized();
  const Vector3d p(0.6, 0.4, kFloorDepth);
  const Vector2d command = aimed(room->solution.projector, room->T_rig_room * p);
  const std::array corner{p};
  const auto bounds = calib::assess::corner_bounds(*room, command, corner, normal);
  calib::assess::MeantPlace place{.p_room = p, .normal_room = normal, .sight_room = -normal, .scan_sigma_m = {}};
  const auto bound = calib::assess::place_bound(*room, command, place);
  ASSERT_TRUE(bounds && bound);
  EXPECT_NEAR(bound->error_95_mm, (*bounds)[0].error_95_mm, 1e-6);
  // A scan adds its own noise; seen along the light itself, sliding along it does not show.
  place.scan_sigma_m = 0.01;
  const auto noisy = calib::assess::place_bound(*room, command, place);
  EXPECT_GT(noisy->error_95_mm, bound->error_95_mm);
  place.sight_room = (room->T_rig_room.inverse() * room->solution.projector.at(command).centre() - p).normalized();
  place.scan_sigma_m = 0;
  const auto along = calib::assess::place_bound(*room, command, place);
  place.scan_sigma_m = 0.01;
  EXPECT_NEAR(calib::assess::place_bound(*room, command, place)->error_95_mm, along->error_95_mm, 1e-6);
}

TEST(SurfaceStations, are_refused_where_the_scan_does_not_reach) {
  const PlannedBoard board = planned_board("mock-galvo", 16);
  IdealOptions options;
  options.points = 45;
  const SteerTrial trial(board, seed(), options);
  ASSERT_TRUE(trial.solution());
  Noise noise(seed(), 1);
  const auto room = tied_to_room(trial, {}, noise);
  ASSERT_TRUE(room);
  const auto scene = scan(trial.rig(), *room, noise);
  ASSERT_TRUE(scene);
  auto stations = wanted();
  const auto without = host::rig::aim_stations(*room, stations);
  ASSERT_FALSE(without);
  EXPECT_EQ(without.error().rcode, RCode::kSurfaceMissing);
  stations.stations[0].position_m = {2.2, 1, kFloorDepth};
  const auto beside = host::rig::aim_stations(*room, stations, &*scene);
  ASSERT_FALSE(beside);
  EXPECT_EQ(beside.error().rcode, RCode::kSurfaceMissing);
  EXPECT_NE(beside.error().message().find("draped"), std::string::npos) << beside.error().message();
  stations = wanted();
  stations.stations[2].eye_m = stations.stations[2].position_m;
  EXPECT_EQ(host::rig::aim_stations(*room, stations, &*scene).error().rcode, RCode::kBadValue);
  // An eye at the floor's level never sees the picture's far edge fall onto it.
  stations.stations[2].eye_m = proto::stations::Vec3{1.5, 0.2, kFloorDepth - 0.02};
  EXPECT_EQ(host::rig::aim_stations(*room, stations, &*scene).error().rcode, RCode::kStationOutOfReach);
}

}  // namespace
}  // namespace raysteer::support
