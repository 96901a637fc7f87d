// What is written as surface.ply is read back, and nothing else is.
#include "host/exchange/surface_file.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "tests/support/seed.hpp"

namespace raysteer::host::exchange {
namespace {

SurfaceFile square() {
  return {.rig_id = "0f1e2d",
          .points = {{0, 0, 3.5}, {0.5, 0, 3.5}, {0, 0.5, 3.25}, {0.5, 0.5, 3.25}},
          .sigma_m = {0.001F, 0.002F, 0.0005F, 0.001F},
          .triangles = {{0, 2, 1}, {1, 2, 3}}};
}

TEST(SurfaceFile, comes_back_as_it_was_written) {
  const auto read = surface_from_ply(to_ply(square()), "surface.ply");
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(read->rig_id, "0f1e2d");
  EXPECT_EQ(read->points, square().points);  // all are floats
  EXPECT_EQ(read->sigma_m, square().sigma_m);
  EXPECT_EQ(read->triangles, square().triangles);
}

TEST(SurfaceFile, is_refused_when_cut_short_or_not_one) {
  const std::string whole = to_ply(square());
  for (std::size_t length = 0; length < whole.size(); ++length) {
    ASSERT_FALSE(surface_from_ply(whole.substr(0, length), "cut")) << length;
  }
  EXPECT_EQ(surface_from_ply(whole + "x", "longer").error().rcode, RCode::kMeshSyntax);
  EXPECT_EQ(surface_from_ply("solid stl", "stl").error().rcode, RCode::kMeshSyntax);
  SurfaceFile empty = square();
  empty.triangles.clear();
  EXPECT_EQ(surface_from_ply(to_ply(empty), "points").error().rcode, RCode::kMeshEmpty);
  std::string bytes = to_ply(square());
  bytes[bytes.size() - 1] = 9;  // the last corner's highest byte
  EXPECT_EQ(surface_from_ply(bytes, "index").error().rcode, RCode::kMeshIndex);
  SurfaceFile nowhere = square();
  nowhere.points[1].z() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(surface_from_ply(to_ply(nowhere), "nowhere").error().rcode, RCode::kMeshNotFinite);
}

TEST(SurfaceFile, survives_any_damaged_bytes) {
  std::mt19937_64 random(support::seed());
  const std::string whole = to_ply(square());
  for (int round = 0; round < 2000; ++round) {
    std::string damaged = whole;
    for (int k = 0; k < 3; ++k) {
      damaged[random() % damaged.size()] = static_cast<char>(random());
    }
    if (const auto read = surface_from_ply(damaged, "damaged")) {
      for (const auto& triangle : read->triangles) {
        for (const std::uint32_t corner : triangle) {
          ASSERT_LT(corner, read->points.size());
        }
      }
    }
  }
  EXPECT_EQ(read_surface("/no/such/surface.ply").error().rcode, RCode::kFileMissing);
}

}  // namespace
}  // namespace raysteer::host::exchange
