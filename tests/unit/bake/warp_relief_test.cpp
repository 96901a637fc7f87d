// Warp maps over a box on a floor, against rays that are tried on every triangle in doubles.
#include <gtest/gtest.h>

#include <cstdio>
#include <limits>

#include "calib/bake/aim.hpp"
#include "calib/bake/warp.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/steered_rig.hpp"
#include "tests/unit/bake/baked.hpp"

namespace raysteer::calib::bake {
namespace {

using Eigen::Vector3d;

/// A floor of 6 m x 6 m at z = 0 and a box standing on it (z up is negative), in the floor's frame.
TriangleMesh floor_with_box(const model::Pose& T_rig_floor, const Vector3d& corner, const Vector3d& size) {
  TriangleMesh mesh;
  const auto quad = [&](const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
    const auto first = static_cast<std::uint32_t>(mesh.points.size());
    for (const Vector3d& p : {a, b, c, d}) {
      mesh.points.push_back(T_rig_floor * p);
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  };
  quad({-3, -3, 0}, {3, -3, 0}, {3, 3, 0}, {-3, 3, 0});
  const auto at = [&](double x, double y, double z) -> Vector3d {
    return corner + Vector3d(x, y, z).cwiseProduct(size);
  };
  quad(at(0, 0, -1), at(1, 0, -1), at(1, 1, -1), at(0, 1, -1));
  quad(at(0, 0, 0), at(1, 0, 0), at(1, 0, -1), at(0, 0, -1));
  quad(at(0, 1, 0), at(1, 1, 0), at(1, 1, -1), at(0, 1, -1));
  quad(at(0, 0, 0), at(0, 1, 0), at(0, 1, -1), at(0, 0, -1));
  quad(at(1, 0, 0), at(1, 1, 0), at(1, 1, -1), at(1, 0, -1));
  return mesh;
}

struct Hit {
  double length = std::numeric_limits<double>::infinity();
  double incidence = 0;  ///< cosine
  double edge = 1;       ///< how near to a triangle's edge the ray came, in barycentric coordinates
};

Hit brute_force(const TriangleMesh& mesh, const Vector3d& origin, const Vector3d& along) {
  Hit nearest;
  double edge = 1;
  for (const auto& t : mesh.triangles) {
    const Vector3d a = mesh.points[t[0]];
    Eigen::Matrix3d basis;
    basis << mesh.points[t[1]] - a, mesh.points[t[2]] - a, -along;
    if (std::abs(basis.determinant()) < 1e-12) {
      continue;
    }
    const Vector3d uvs = basis.inverse() * (origin - a);
    const double least = std::min({uvs.x(), uvs.y(), 1 - uvs.x() - uvs.y()});
    edge = uvs.z() > 0 ? std::min(edge, std::abs(least)) : edge;
    if (least >= 0 && uvs.z() > 0 && uvs.z() < nearest.length) {
      const Vector3d normal = (mesh.points[t[1]] - a).cross(mesh.points[t[2]] - a).normalized();
      nearest = {.length = uvs.z(), .incidence = std::abs(normal.dot(along))};
    }
  }
  nearest.edge = edge;
  return nearest;
}

struct Relief {
  support::SteeredRig rig;
  model::Pose T_rig_floor;
  TriangleMesh mesh;
  Station station;
  Eigen::Vector2d command;

  Relief(const std::string& board, std::mt19937_64& random)
      : rig(support::steered_rig(board, random)), T_rig_floor(support::floor_pose(random)) {
    mesh = floor_with_box(T_rig_floor, {-0.1, 0.05, 0}, {0.3, 0.25, 0.4});
    station = support::station_at("relief", T_rig_floor, 0.05, 0.1, 0.3, {0.9, 0.7});
    station.content_px = {900, 700};
    command = valid(station_command(rig.projector, station));
  }
};

/// Compares every third pixel or so of a map with the true ray: what is shown, and where.
void compare(const Relief& relief, const Content& content, const proto::lut::WarpMap& map, bool shadow_only) {
  const sim::optics::LightPath path = relief.rig.path(relief.command);
  Lookup lookup(map);
  int shown = 0;
  int skipped = 0;
  int dark = 0;
  double worst = 0;
  for (int y = 0; y < map.parts().panel_height; ++y) {
    for (int x = y % 3; x < map.parts().panel_width; x += 3) {
      const auto out = path.leave(Eigen::Vector2d(x, y));
      const Hit hit = brute_force(relief.mesh, out->origin, out->direction);
      if (hit.edge < 1e-4) {
        ++skipped;  // single precision may take the other triangle
        continue;
      }
      Vector3d p = out->origin + hit.length * out->direction;
      bool lit = out->passage.through && std::isfinite(hit.length) && hit.incidence >= std::cos(75 * M_PI / 180);
      if (shadow_only) {
        const double to_plane = (content.plane->distance_m - content.plane->normal.dot(out->origin)) /
                                content.plane->normal.dot(out->direction);
        lit = out->passage.through && hit.length > to_plane - 0.003;
        p = out->origin + to_plane * out->direction;
      }
      const Vector3d homogeneous = content.content_rig * p.homogeneous();
      const Eigen::Vector2d uv = homogeneous.hnormalized();
      const bool inside = homogeneous.z() > 0 && uv.minCoeff() > -1 && uv.x() < content.content_px.x() &&
                          uv.y() < content.content_px.y();
      const LookedUp is = lookup(x, y);
      ASSERT_EQ(is.gain > 0, inside && lit) << x << ", " << y << " at " << uv.transpose();
      dark += inside && !lit ? 1 : 0;
      if (inside && lit) {
        ++shown;
        worst = std::max(worst, (uv - Eigen::Vector2d(is.u, is.v)).norm());
      }
    }
  }
  std::printf("%s, cells of %d px, %zu dense pixels: worst of %d pixels %.4f px, stated %.4f; %d dark, %d on edges\n",
              content.name.c_str(), map.parts().cell_px, map.parts().dense.size(), shown, worst, map.parts().worst_px,
              dark, skipped);
  EXPECT_LE(worst, map.parts().bound_px);
  EXPECT_GT(shown, 5000);
  EXPECT_LT(skipped, shown / 50);
  if (shadow_only) {
    EXPECT_GT(dark, 500);
  } else {
    EXPECT_FALSE(map.parts().dense.empty()) << "a depth edge crosses";
  }
}

TEST(WarpOfRelief, drapes_content_over_a_box_within_the_bound_up_to_its_edges) {
  std::mt19937_64 random(support::seed());
  for (const std::string board : {"mock-small", "mock-small-head"}) {
    const Relief relief(board, random);
    const PanelRays rays(relief.rig.projector.lens, 2);
    const RayCaster scene = valid(RayCaster::make(relief.mesh));
    const Content content = draped_content(relief.station);
    const StationView view(relief.rig.projector, relief.command, content, &scene, {}, {});
    compare(relief, content, valid(bake_warp(view, rays, relief.command, {.boost = 1})), false);
  }
}

TEST(WarpOfRelief, looks_undistorted_from_the_place_it_was_made_for) {
  std::mt19937_64 random(support::seed());
  for (const std::string board : {"mock-small", "mock-small-head"}) {
    const Relief relief(board, random);
    const PanelRays rays(relief.rig.projector.lens, 2);
    const RayCaster scene = valid(RayCaster::make(relief.mesh));
    // Somebody who stands 2 m aside and looks at the box.
    const Vector3d eye(1.8, 0.4, 1.8);
    const Vector3d ahead = (relief.station.T_rig_plane.t - eye).normalized();
    Eigen::Matrix3d R;
    const Vector3d right = ahead.cross(Vector3d::UnitX()).normalized();
    R << right.transpose(), ahead.cross(right).transpose(), ahead.transpose();
    const Content content = seen_content("seen", {.q = Eigen::Quaterniond(R), .t = -(R * eye)}, 1500, {499.5, 399.5},
                                         {1000, 800}, std::nullopt);
    const StationView view(relief.rig.projector, relief.command, content, &scene, {}, {});
    compare(relief, content, valid(bake_warp(view, rays, relief.command, {.boost = 1})), false);
  }
}

TEST(WarpOfRelief, shows_nothing_where_a_box_throws_its_shadow_on_the_plane) {
  std::mt19937_64 random(support::seed());
  for (const std::string board : {"mock-small", "mock-small-head"}) {
    const Relief relief(board, random);
    const PanelRays rays(relief.rig.projector.lens, 2);
    const RayCaster scene = valid(RayCaster::make(relief.mesh));
    const Content content = metric_content(relief.station);
    const StationView view(relief.rig.projector, relief.command, content, &scene, {}, {});
    compare(relief, content, valid(bake_warp(view, rays, relief.command, {})), true);
  }
}

TEST(HeightField, has_two_triangles_between_four_heights_and_none_at_a_hole) {
  Image<double> heights(4, 3);
  heights(1, 1) = 0.5;
  heights(3, 2) = std::numeric_limits<double>::quiet_NaN();
  const TriangleMesh mesh = height_field({}, 0.1, heights.view());
  EXPECT_EQ(mesh.points.size(), 12U);
  EXPECT_EQ(mesh.triangles.size(), 11U);
  EXPECT_LT((mesh.points[5] - Vector3d(0.1, 0.1, 0.5)).norm(), 1e-15);
}

TEST(RayCaster, refuses_surfaces_that_are_none) {
  EXPECT_EQ(RayCaster::make({}).error().rcode, RCode::kMeshEmpty);
  EXPECT_EQ(RayCaster::make({.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, .triangles = {{0, 1, 2}}}).error().rcode,
            RCode::kMeshEmpty);
  EXPECT_EQ(RayCaster::make({.points = {{0, 0, 0}}, .triangles = {{0, 1, 2}}}).error().rcode, RCode::kMeshIndex);
  EXPECT_EQ(RayCaster::make({.points = {{0, 0, std::nan("")}}, .triangles = {{0, 0, 0}}}).error().rcode,
            RCode::kMeshNotFinite);
}

}  // namespace
}  // namespace raysteer::calib::bake
