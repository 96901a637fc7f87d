#include "sim/scene/mesh.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstring>
#include <limits>
#include <string>

#include "sim/scene/read_scene.hpp"

namespace raysteer::sim::scene {
namespace {

double area(const Mesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    sum += (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).norm() / 2;
  }
  return sum;
}

TEST(Generators, have_the_area_of_what_they_are) {
  EXPECT_NEAR(area(rectangle(-1, -0.5, 2, 0.5)), 3, 1e-12);
  EXPECT_NEAR(area(box({1, 2, 3})), 1 * 2 + 2 * (1 * 3 + 2 * 3), 1e-12);
  // Two steps of 0.3 x 0.7 x 0.15, each a box without its bottom: tops, fronts and backs, sides.
  EXPECT_NEAR(area(stairs(2, 0.3, 0.7, 0.15)), 2 * 0.3 * 0.7 + 2 * 0.7 * (0.15 + 0.3) + 2 * 0.3 * (0.15 + 0.3), 1e-12);
  EXPECT_GT(area(person(1.8)), 1.5);
}

TEST(Generators, door_follows_its_height_to_a_quarter_of_a_millimetre) {
  const double length = 1.1;
  const double width = 0.7;
  const double crown = 0.09;
  const Mesh mesh = door(length, width, crown, 0.005);
  double worst = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d middle = (mesh.vertices[a] + mesh.vertices[b] + mesh.vertices[c]) / 3;
    // Not on the crease, where no smooth triangle follows.
    if (std::abs(middle.y() - 0.15 * width) > 0.005) {
      worst = std::max(worst, std::abs(middle.z() - door_height(length, width, crown, middle.x(), middle.y())));
    }
  }
  EXPECT_LT(worst, 0.25e-3);
  EXPECT_EQ(mesh.uv[7].x(), mesh.vertices[7].x());
}

constexpr const char* kObj = R"(# two faces that share an edge
v 0 0 0
v 1 0 0
v 1 1 0.5
v 0 1 0.5
vt 0 0
vt 2 0
vt 2 3
usemtl whatever
f 1/1 2/2 3/3
f -4 -2 -1
)";

TEST(ReadObj, takes_vertices_faces_and_texture_points) {
  const auto mesh = read_obj(kObj, "two.obj");
  ASSERT_TRUE(mesh) << mesh.error().message();
  EXPECT_EQ(mesh->triangles.size(), 2U);
  EXPECT_EQ(mesh->vertices.size(), 6U);  // three with texture points, three without
  EXPECT_EQ(mesh->uv[mesh->triangles[0][2]], Eigen::Vector2d(2, 3));
  EXPECT_EQ(mesh->vertices[mesh->triangles[1][2]], Eigen::Vector3d(0, 1, 0.5));
}

TEST(ReadObj, makes_a_fan_of_a_face_with_more_corners) {
  const auto mesh = read_obj("v 0 0 0\nv 1 0 0\r\nv 1 1 0\nv 0 1 0\nf 1//9 2//9 3//9 4//9", "quad.obj");
  ASSERT_TRUE(mesh) << mesh.error().message();
  EXPECT_NEAR(area(*mesh), 1, 1e-12);
  EXPECT_TRUE(mesh->uv.empty());
}

struct BadMesh {
  const char* text;
  RCode rcode;
  const char* said;
};

TEST(ReadObj, tells_each_fault_apart) {
  const BadMesh faults[] = {
      {"", RCode::kMeshEmpty, "bad.obj has no faces"},
      {"v 0 0 0\nv 1 0 0\nv 0 1 0\n", RCode::kMeshEmpty, "bad.obj has no faces"},
      {"v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", RCode::kMeshNotFinite, "vertex 1"},
      {"v 0 0 0\nv 1 inf 0\nv 0 1 0\nf 1 2 3\n", RCode::kMeshNotFinite, "vertex 2"},
      {"v 0 0 0\nv 1 0 0\nf 1 2 3\n", RCode::kMeshIndex, "bad.obj:3: '3' of 2 vertices"},
      {"v 0 0 0\nv 1 0 0\nv 1 1 0\nf 0 1 2\n", RCode::kMeshIndex, "'0'"},
      {"v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1/1 2 3\n", RCode::kMeshIndex, "0 texture points"},
      {"v 0 0\n", RCode::kMeshSyntax, "bad.obj:1: expected 'v' and three numbers"},
      {"v 0 0 0x\n", RCode::kMeshSyntax, "three numbers"},
      {"v 0 0 0\nv 1 0 0\nf 1 2\n", RCode::kMeshSyntax, "bad.obj:3: expected 'f'"},
      {"v 0 0 0\nf a b c\n", RCode::kMeshSyntax, "got 'a'"},
  };
  for (const BadMesh& fault : faults) {
    const auto mesh = read_obj(fault.text, "bad.obj");
    ASSERT_FALSE(mesh) << fault.text;
    EXPECT_EQ(mesh.error().rcode, fault.rcode) << fault.text << mesh.error().message();
    EXPECT_NE(mesh.error().note.find(fault.said), std::string::npos) << mesh.error().message();
  }
}

constexpr const char* kPlyHeader =
    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n";

template <class Raw>
void append(std::string& bytes, Raw value) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.append(raw, sizeof value);
}

std::string binary_ply(float z, int last_corner) {
  std::string bytes = std::string("ply\nformat binary_little_endian 1.0\ncomment ours\n") + kPlyHeader;
  for (const float x : {0.0F, 2.0F, 0.0F}) {
    append(bytes, x);
    append(bytes, x == 0 && bytes.size() % 2 == 0 ? 0.0F : 1.0F);
    append(bytes, z);
    append(bytes, std::uint8_t{200});
  }
  append(bytes, std::uint8_t{3});
  append(bytes, 0);
  append(bytes, 1);
  append(bytes, last_corner);
  return bytes;
}

TEST(ReadPly, ascii_and_binary_are_both_read) {
  const auto ascii =
      read_ply(std::string("ply\nformat ascii 1.0\n") + kPlyHeader + "0 0 1 9\n2 0 1 9\n0 1 1 9\n3 0 1 2\n", "a.ply");
  ASSERT_TRUE(ascii) << ascii.error().message();
  EXPECT_NEAR(area(*ascii), 1, 1e-12);
  const auto binary = read_ply(binary_ply(1, 2), "b.ply");
  ASSERT_TRUE(binary) << binary.error().message();
  EXPECT_EQ(binary->triangles, ascii->triangles);
  EXPECT_EQ(binary->vertices[1].x(), 2);
  EXPECT_EQ(binary->vertices[1].z(), 1);
}

TEST(ReadPly, tells_each_fault_apart) {
  const std::string whole = binary_ply(1, 2);
  EXPECT_EQ(read_ply("obj\n", "x.ply").error().rcode, RCode::kMeshSyntax);
  EXPECT_EQ(read_ply("ply\nformat binary_big_endian 1.0\nend_header\n", "x.ply").error().rcode, RCode::kMeshSyntax);
  EXPECT_EQ(read_ply("ply\nformat ascii 1.0\nelement vertex 99999999\nend_header\n", "x.ply").error().rcode,
            RCode::kMeshSyntax);
  EXPECT_EQ(read_ply("ply\nformat ascii 1.0\nend_header\n", "x.ply").error().rcode, RCode::kMeshEmpty);
  EXPECT_EQ(read_ply(binary_ply(std::numeric_limits<float>::quiet_NaN(), 2), "x.ply").error().rcode,
            RCode::kMeshNotFinite);
  EXPECT_EQ(read_ply(binary_ply(1, 3), "x.ply").error().rcode, RCode::kMeshIndex);
  EXPECT_EQ(read_ply(binary_ply(1, -1), "x.ply").error().rcode, RCode::kMeshIndex);
  // Cut short anywhere, it is never taken for good.
  for (std::size_t length = 0; length < whole.size(); ++length) {
    EXPECT_FALSE(read_ply(whole.substr(0, length), "x.ply")) << length;
  }
}

}  // namespace
}  // namespace raysteer::sim::scene
