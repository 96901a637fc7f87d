// Looks over a floor with a box, whose points are known but for noise, against the surface made of them.
#include "calib/scene/fuse.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "tests/support/seed.hpp"

namespace raysteer::calib::scene {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kFloorM = 3.5;
constexpr double kTilt = 0.05;   // of the floor
constexpr double kHalfM = 0.08;  // of the box's top
constexpr double kStep = 0.0008;
constexpr double kSigmaM = 0.0015;

/// Depth of the surface in a direction of the left eye: a tilted floor and a box of 0.3 m on it, `box_x` to the right.
double depth(const Vector2d& n, double box_x = 0) {
  const double box_z = kFloorM - 0.3;
  const Vector2d top = box_z * n - Vector2d(box_x, 0);
  if (top.cwiseAbs().maxCoeff() < kHalfM) {
    return box_z;
  }
  return kFloorM / (1 + kTilt * n.x());
}

struct Look {
  std::vector<CloudPoint> points;
  std::vector<Match> matches;
};

/// 100 x 80 panel pixels about `middle`, in turned and uneven rows as a mirror throws them.
Look look_at(const Vector2d& middle, std::mt19937_64& random, double box_x = 0, double off_m = 0) {
  std::normal_distribution<double> noise(0, kSigmaM);
  Look look;
  for (std::uint16_t j = 0; j < 80; ++j) {
    for (std::uint16_t i = 0; i < 100; ++i) {
      const Vector2d at(i - 50 + 0.3 * std::sin(0.1 * j), j - 40 + 0.1 * i);
      const Vector2d n = middle + kStep * at;
      const double z = depth(n, box_x);
      CloudPoint point;
      point.p = (z + off_m + noise(random)) * Vector3d(n.homogeneous());
      point.covariance = kSigmaM * kSigmaM * Vector3d(n.homogeneous()) * Vector3d(n.homogeneous()).transpose();
      point.match = static_cast<std::uint32_t>(look.matches.size());
      look.points.push_back(point);
      look.matches.push_back({.i = i, .j = j});
    }
  }
  return look;
}

FusedSurface fused(const std::vector<Look>& looks) {
  Fusion fusion(*cell_for(looks[0].points, looks[0].matches));
  for (std::size_t k = 0; k < looks.size(); ++k) {
    fusion.add("look-" + std::to_string(k + 1), looks[k].points);
  }
  auto surface = fusion.fuse();
  EXPECT_TRUE(surface) << surface.error().message();
  return surface ? *std::move(surface) : FusedSurface();
}

TEST(Fusion, makes_one_surface_larger_than_a_look_and_says_how_well_looks_agree) {
  std::mt19937_64 random(support::seed());
  const std::vector<Look> looks{look_at({-0.03, 0}, random), look_at({0.03, 0}, random), look_at({0, 0.03}, random)};
  const FusedSurface surface = fused(looks);
  double sum = 0;
  double worst = 0;
  double predicted = 0;
  std::size_t counted = 0;
  for (std::size_t k = 0; k < surface.points.size(); ++k) {
    const Vector2d n = surface.points[k].hnormalized();
    // At the box's rim a place may belong to either.
    const Vector2d rim = (kFloorM - 0.3) * n;
    if (std::abs(rim.cwiseAbs().maxCoeff() - kHalfM) < 2 * surface.cell * kFloorM) {
      continue;
    }
    const double off = surface.points[k].z() - depth(n);
    sum += off * off;
    worst = std::max(worst, std::abs(off));
    predicted += std::pow(surface.sigma_m[k] / n.homogeneous().norm(), 2);
    ++counted;
  }
  ASSERT_GT(counted, 2000U);
  const double rms = std::sqrt(sum / static_cast<double>(counted));
  const double stated = std::sqrt(predicted / static_cast<double>(counted));
  std::printf("%zu places: %.3f mm RMS, %.3f stated, %.2f at most; overlap %.3f / %.3f mm at %zu\n", counted, 1e3 * rms,
              1e3 * stated, 1e3 * worst, surface.median_mm, surface.p95_mm, surface.shared);
  EXPECT_LT(rms, 0.7 * kSigmaM) << "several points make a place";
  // Stated a little high: scatter beyond the points' own noise is believed, scatter below it is not.
  EXPECT_NEAR(rms / stated, 0.94, 0.2);
  EXPECT_LT(worst, 8 * kSigmaM);
  ASSERT_EQ(surface.overlaps.size(), 3U);
  for (const Overlap& overlap : surface.overlaps) {
    EXPECT_NEAR(overlap.whitened, 0.94, 0.25);
    EXPECT_LT(overlap.apart, 0.03);
    EXPECT_LT(std::abs(overlap.bias_mm), 0.2);
  }
  EXPECT_LT(surface.median_mm, 1.2);
  EXPECT_GT(surface.p95_mm, surface.median_mm);
  EXPECT_GT(surface.triangles.size(), surface.points.size());
}

TEST(Fusion, leaves_depth_edges_open) {
  std::mt19937_64 random(support::seed());
  const FusedSurface surface = fused({look_at({0, 0}, random)});
  EXPECT_TRUE(std::isnan(surface.median_mm)) << "one look overlaps nothing";
  for (const auto& triangle : surface.triangles) {
    double least = 10;
    double most = 0;
    for (const std::uint32_t k : triangle) {
      least = std::min(least, surface.points[k].z());
      most = std::max(most, surface.points[k].z());
    }
    ASSERT_LT(most - least, 0.2) << "spans from the box to the floor";
    const Vector3d& a = surface.points[triangle[0]];
    ASSERT_LT((surface.points[triangle[1]] - a).cross(surface.points[triangle[2]] - a).dot(a), 0) << "faces the eye";
  }
}

TEST(Fusion, names_the_look_between_which_and_the_others_something_moved) {
  std::mt19937_64 random(support::seed());
  for (const double off_m : {0.0, 0.02}) {
    const Look first = look_at({-0.01, 0}, random);
    const Look second = look_at({0.01, 0}, random);
    const Look moved = look_at({0, 0.01}, random, off_m > 0 ? 0 : 0.08, off_m);
    Fusion fusion(*cell_for(first.points, first.matches));
    fusion.add("first", first.points);
    fusion.add("second", second.points);
    fusion.add("third", moved.points);
    const auto surface = fusion.fuse();
    ASSERT_FALSE(surface);
    EXPECT_EQ(surface.error().rcode, RCode::kSurfacesApart);
    EXPECT_NE(surface.error().note.find("look 'third' disagrees with 2 others"), std::string::npos)
        << surface.error().note;
  }
}

TEST(Fusion, says_when_there_is_nothing_to_fuse) {
  Fusion nothing(0.001);
  EXPECT_EQ(nothing.fuse().error().rcode, RCode::kTooFewMatches);
  nothing.add("empty", {});
  EXPECT_EQ(nothing.fuse().error().rcode, RCode::kTooFewMatches);
  EXPECT_EQ(cell_for({}, {}).error().rcode, RCode::kTooFewMatches);
}

}  // namespace
}  // namespace raysteer::calib::scene
