// Warp maps of planes against the optics of the pretend world, which were written apart.
#include <gtest/gtest.h>

#include <cstdio>
#include <set>

#include "calib/bake/aim.hpp"
#include "calib/bake/warp.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/steered_rig.hpp"
#include "tests/unit/bake/baked.hpp"

namespace raysteer::calib::bake {
namespace {

/// Where the true ray of a pixel meets the station's plane, metres from its middle; nothing when the ray is cut.
std::optional<Eigen::Vector2d> truly_at(const sim::optics::LightPath& path, const Station& station,
                                        const Eigen::Vector2d& x) {
  const auto out = path.leave(x);
  if (!out || !out->passage.through) {
    return std::nullopt;
  }
  const model::Pose T_plane_rig = station.T_rig_plane.inverse();
  const Eigen::Vector3d from = T_plane_rig * out->origin;
  const Eigen::Vector3d along = T_plane_rig.q * out->direction;
  return (from - from.z() / along.z() * along).head<2>();
}

Eigen::Vector2d content_of(const Station& station, const Eigen::Vector2d& p) {
  return (p + 0.5 * station.size_m).cwiseQuotient(station.size_m).cwiseProduct(station.content_px.cast<double>()) -
         Eigen::Vector2d(0.5, 0.5);
}

/// Or less than a content pixel beside it.
bool inside(const Station& station, const Eigen::Vector2d& content) {
  return content.minCoeff() > -1 && content.x() < station.content_px.x() && content.y() < station.content_px.y();
}

proto::lut::WarpMap baked(const support::SteeredRig& rig, const Station& station, const PanelRays& rays,
                          const WarpOptions& options = {}) {
  const Eigen::Vector2d command =
      station.command_rad ? *station.command_rad : valid(station_command(rig.projector, station));
  const StationView view(rig.projector, command, metric_content(station), nullptr, {}, options.light);
  return valid(bake_warp(view, rays, command, options));
}

TEST(WarpOfPlane, stays_within_its_bound_at_a_hundred_thousand_pixels_for_galvo_and_head) {
  std::mt19937_64 random(support::seed());
  for (const std::string board : {"mock-galvo", "mock-head"}) {
    const support::SteeredRig rig = support::steered_rig(board, random);
    const PanelRays rays(rig.projector.lens, 2);
    std::uniform_real_distribution<double> part(-1, 1);
    // The whole panel, on a plane that stands steeply in the light.
    Station station = support::station_at("steep", support::floor_pose(random, 0.6), 0, 0, part(random), {6, 5});
    station.content_px = {1920, 1600};
    station.command_rad = 0.3 * Eigen::Vector2d(part(random), part(random)).cwiseProduct(rig.projector.most_rad);
    const proto::lut::WarpMap map = baked(rig, station, rays, {.light = {.most_incidence_rad = 1.57}});
    EXPECT_EQ(map.parts().cell_px, 64);
    EXPECT_TRUE(map.parts().dense.empty());
    const sim::optics::LightPath path = rig.path(*station.command_rad);
    Lookup lookup(map);
    double worst = 0;
    for (int i = 0; i < 100'000; ++i) {
      const int x = static_cast<int>(960 + 959.99 * part(random));
      const int y = static_cast<int>(600 + 599.99 * part(random));
      const LookedUp is = lookup(x, y);
      const auto p = truly_at(path, station, Eigen::Vector2d(x, y));
      const bool shown = p && inside(station, content_of(station, *p));
      ASSERT_EQ(is.gain > 0, shown) << board << " " << x << ", " << y;
      if (shown) {
        worst = std::max(worst, (content_of(station, *p) - Eigen::Vector2d(is.u, is.v)).norm());
      }
    }
    std::printf("%s: worst of 1e5 pixels %.4f px, stated %.4f, bound %.2f; flipped %d\n", board.c_str(), worst,
                map.parts().worst_px, map.parts().bound_px, rig.projector.at(*station.command_rad).mirrored());
    EXPECT_LE(worst, map.parts().worst_px + 1e-6);
    EXPECT_LE(map.parts().worst_px, map.parts().bound_px);
    EXPECT_GT(worst, 0.3 * map.parts().worst_px);
  }
}

TEST(WarpOfPlane, shows_the_rectangle_and_nothing_else) {
  std::mt19937_64 random(support::seed());
  for (const std::string board : {"mock-small", "mock-small-head"}) {
    const support::SteeredRig rig = support::steered_rig(board, random);
    const PanelRays rays(rig.projector.lens, 2);
    const Station station = support::station_at("bench", support::floor_pose(random), 0.4, -0.3, 0.5);
    const Eigen::Vector2d command = valid(station_command(rig.projector, station));
    const sim::optics::LightPath path = rig.path(command);
    const proto::lut::WarpMap map = baked(rig, station, rays);
    Lookup lookup(map);
    int shown = 0;
    for (int y = 0; y < map.parts().panel_height; ++y) {
      for (int x = 0; x < map.parts().panel_width; ++x) {
        const Eigen::Vector2d content = content_of(station, *truly_at(path, station, Eigen::Vector2d(x, y)));
        ASSERT_EQ(lookup(x, y).gain > 0, inside(station, content)) << board << " " << x << ", " << y;
        shown += inside(station, content) ? 1 : 0;
      }
    }
    // 0.5 m x 0.3125 m at 3.6 mm a pixel.
    EXPECT_NEAR(shown, 12000, 2500);
  }
}

TEST(WarpOfPlane, is_cut_by_the_mirrors_outlines_as_the_light_is) {
  std::mt19937_64 random(support::seed());
  for (const std::string board : {"mock-small", "mock-small-head"}) {
    support::SteeredRig rig = support::steered_rig(board, random);
    for (std::size_t k = 0; k < 2; ++k) {  // smaller mirrors than drawn: they cut at any seed
      rig.projector.parts[k].size_m *= 0.8;
      rig.truth.mirror.parts[k].half_size_m *= 0.8;
    }
    const PanelRays rays(rig.projector.lens, 2);
    int cut = 0;
    for (const auto& [i, j] : {std::pair(-1, -1), std::pair(-1, 1), std::pair(1, -1), std::pair(1, 1)}) {
      Station station =
          support::station_at("end", {.q = Eigen::Quaterniond::Identity(), .t = {0, 0, 3.5}}, 0, 0, 0, {90, 90});
      station.command_rad = Eigen::Vector2d(i, j).cwiseProduct(rig.projector.most_rad);
      const sim::optics::LightPath path = rig.path(*station.command_rad);
      const proto::lut::WarpMap map = baked(rig, station, rays, {.light = {.most_incidence_rad = 1.57}});
      Lookup lookup(map);
      for (int y = 0; y < map.parts().panel_height; ++y) {
        for (int x = y % 3; x < map.parts().panel_width; x += 3) {
          const auto out = path.leave(Eigen::Vector2d(x, y));
          ASSERT_EQ(lookup(x, y).gain > 0, out->passage.through) << board << " " << x << ", " << y;
          cut += out->passage.through ? 0 : 1;
        }
      }
    }
    EXPECT_GT(cut, 1000) << board;
  }
}

TEST(WarpOfPlane, leaves_zones_dark) {
  std::mt19937_64 random(support::seed());
  const support::SteeredRig rig = support::steered_rig("mock-small", random);
  const PanelRays rays(rig.projector.lens, 1);
  const model::Pose T_rig_floor = support::floor_pose(random);
  const Station station = support::station_at("bench", T_rig_floor, 0, 0, 0.2, {1, 0.8});
  const std::vector<proto::lut::KeepOut> zones{{.name = "seat", .corners = {{0, -0.1}, {0.3, 0}, {0.1, 0.2}}}};
  const Eigen::Vector2d command = valid(station_command(rig.projector, station));
  const StationView view(rig.projector, command, metric_content(station), nullptr,
                         {.T_plane_rig = T_rig_floor.inverse(), .zones = zones}, {});
  const proto::lut::WarpMap map = valid(bake_warp(view, rays, command, {}));
  const sim::optics::LightPath path = rig.path(command);
  Lookup lookup(map);
  int dark = 0;
  for (int y = 0; y < map.parts().panel_height; ++y) {
    for (int x = 0; x < map.parts().panel_width; ++x) {
      const auto p = truly_at(path, station, Eigen::Vector2d(x, y));
      const Eigen::Vector2d content = content_of(station, *p);
      const Eigen::Vector3d on_floor =
          T_rig_floor.inverse() * (station.T_rig_plane * Eigen::Vector3d(p->x(), p->y(), 0));
      const bool in_zone = zones[0].contains({on_floor.x(), on_floor.y()});
      ASSERT_EQ(lookup(x, y).gain > 0, inside(station, content) && !in_zone);
      dark += inside(station, content) && in_zone ? 1 : 0;
    }
  }
  EXPECT_GT(dark, 1000);
}

/// Lux of a small place: light of the pixels around over the area they light, all by differences.
double lux(const sim::optics::LightPath& path, const Station& station, const Eigen::Vector2d& x, double off_axis) {
  const Eigen::Vector2d right =
      *truly_at(path, station, x + Eigen::Vector2d(0.5, 0)) - *truly_at(path, station, x - Eigen::Vector2d(0.5, 0));
  const Eigen::Vector2d down =
      *truly_at(path, station, x + Eigen::Vector2d(0, 0.5)) - *truly_at(path, station, x - Eigen::Vector2d(0, 0.5));
  return std::pow(off_axis, 4) / std::abs(right.x() * down.y() - right.y() * down.x());
}

TEST(WarpOfPlane, dims_bright_places_until_all_are_equally_bright_or_the_boost_is_spent) {
  std::mt19937_64 random(support::seed());
  const support::SteeredRig rig = support::steered_rig("mock-small-head", random);
  const PanelRays rays(rig.projector.lens, 2);
  Station station = support::station_at("steep", support::floor_pose(random, 0.6), 0, 0, 0, {6, 5});
  station.command_rad = Eigen::Vector2d::Zero();
  const sim::optics::LightPath path = rig.path(*station.command_rad);
  std::uniform_real_distribution<double> part(-1, 1);
  for (const double boost : {1.0, 1.2, 10.0}) {
    const proto::lut::WarpMap map = baked(rig, station, rays, {.boost = boost});
    Lookup lookup(map);
    double least = 1e9, most = 0, least_gain = 1, most_gain = 0;
    for (int i = 0; i < 3000; ++i) {
      const int x = static_cast<int>(240 + 235 * part(random));
      const int y = static_cast<int>(150 + 145 * part(random));
      const LookedUp is = lookup(x, y);
      if (is.gain == 0) {
        continue;
      }
      const Eigen::Vector3d ray = rig.truth.projector.lens.ray(Eigen::Vector2d(x, y));
      const double shown = is.gain * lux(path, station, Eigen::Vector2d(x, y), ray.z());
      least = std::min(least, shown);
      most = std::max(most, shown);
      least_gain = std::min(least_gain, is.gain);
      most_gain = std::max(most_gain, is.gain);
    }
    std::printf("boost %.1f: light %.3f, gain %.3f to %.3f\n", boost, most / least, least_gain, most_gain);
    EXPECT_GE(least_gain, 1 / boost - 0.006);
    EXPECT_GT(most_gain, 0.9);
    if (boost == 10) {
      EXPECT_LT(most / least, 1.03);
      EXPECT_LT(least_gain, 0.8);
    } else {
      EXPECT_GT(most / least, 1.1);
    }
  }
}

TEST(WarpOfPlane, in_smaller_cells_keeps_a_smaller_bound_until_fixed_point_cannot) {
  std::mt19937_64 random(support::seed());
  const support::SteeredRig rig = support::steered_rig("mock-small", random);
  const PanelRays rays(rig.projector.lens, 1);
  Station station = support::station_at("bench", support::floor_pose(random, 0.3), 0, 0, 0, {1.2, 0.8});
  station.content_px = {1920, 1200};
  EXPECT_LE(baked(rig, station, rays, {.bound_px = 0.01}).parts().worst_px, 0.01);
  const Eigen::Vector2d command = valid(station_command(rig.projector, station));
  const StationView view(rig.projector, command, metric_content(station), nullptr, {}, {});
  const auto map = bake_warp(view, rays, command, {.bound_px = 0.001});
  ASSERT_FALSE(map);
  EXPECT_EQ(map.error().rcode, RCode::kTableBound);
}

}  // namespace
}  // namespace raysteer::calib::bake
