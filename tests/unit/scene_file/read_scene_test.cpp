#include "sim/scene/read_scene.hpp"

#include <gtest/gtest.h>
#include <png.h>
#include <unistd.h>

#include <fstream>
#include <string>

namespace raysteer::sim::scene {
namespace {

namespace fs = std::filesystem;

const std::string kHead = "format = 1\nname = 'room'\n";
const std::string kFloor = "[[plane]]\nsize_m = [4, 4]\n";

class ReadScene : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              ("scene_" + std::to_string(getpid()) + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) { std::ofstream(folder_ / name) << text; }
  Result<Scene> read(const std::string& text) { return read_scene(text, folder_ / "scene.toml"); }

  void refused(const std::string& text, RCode rcode, const std::string& said) {
    const auto scene = read(text);
    ASSERT_FALSE(scene) << text;
    EXPECT_EQ(scene.error().rcode, rcode) << text << "\n" << scene.error().message();
    EXPECT_NE(scene.error().note.find(said), std::string::npos) << scene.error().message();
  }

  fs::path folder_;
};

TEST_F(ReadScene, places_a_surface_in_the_room) {
  const auto scene = read(kHead +
                          "[[plane]]\nname = 'wall'\nsize_m = [2, 1]\nposition_m = [1, 2, 3]\n"
                          "rotation_deg = [90, 0, 0]\nalbedo = 0.3\ngloss = 0.1\ngloss_mrad = 20\n");
  ASSERT_TRUE(scene) << scene.error().message();
  const Surface& wall = scene->surfaces.at(0);
  EXPECT_EQ(wall.name, "wall");
  EXPECT_EQ(wall.material.albedo, 0.3);
  EXPECT_EQ(wall.material.gloss_rad, 0.02);
  // Turned by 90 degrees about x, its y goes up.
  EXPECT_LT((wall.T_room_surface * Eigen::Vector3d(1, 0.5, 0) - Eigen::Vector3d(2, 2, 3.5)).norm(), 1e-12);
}

TEST_F(ReadScene, hangs_the_rig_looking_down) {
  const auto straight = read(kHead + "[rig]\nposition_m = [1, 2, 3]\n" + kFloor);
  ASSERT_TRUE(straight) << straight.error().message();
  // 3 m along the rig's z is the floor, its x is the room's, its y the room's -y.
  EXPECT_LT((straight->T_room_rig * Eigen::Vector3d(0.5, 0.25, 3) - Eigen::Vector3d(1.5, 1.75, 0)).norm(), 1e-12);
  const auto turned = read(kHead + "[rig]\nposition_m = [0, 0, 3]\nrotation_deg = [0, 0, 90]\n" + kFloor);
  ASSERT_TRUE(turned);
  // Turned about its own z by 90 degrees, its x lies where its y was.
  EXPECT_LT((turned->T_room_rig.linear().col(0) - Eigen::Vector3d(0, -1, 0)).norm(), 1e-12);
}

TEST_F(ReadScene, takes_from_an_included_scene_what_is_not_in_its_own) {
  write("base.toml", "format = 1\nname = 'base'\n[ambient]\nlux = 200\n[rig]\nposition_m = [0, 0, 2]\n");
  const auto scene = read(kHead + "include = 'base.toml'\n[ambient]\nlux = 500\n" + kFloor);
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_EQ(scene->ambient.lux, 500);
  EXPECT_EQ(scene->T_room_rig.translation().z(), 2);
  refused(kHead + "include = 'other.toml'\n" + kFloor, RCode::kFileMissing, "other.toml");
  refused(kHead + "include = '../base.toml'\n" + kFloor, RCode::kPathOutside, "beside the scene");
}

TEST_F(ReadScene, says_what_is_wrong_and_where) {
  refused(kHead + kFloor + "albdo = 0.5\n", RCode::kUnknownKey, "albedo");
  refused(kHead + kFloor + "[ambient]\nlux = 3\nflicker_khz = 1\n", RCode::kUnknownKey, "flicker_hz");
  refused(kHead + "[[plane]]\nsize_mm = [4000, 4000]\n", RCode::kUnknownKey, "size_m");
  refused(kHead + "[[plane]]\nsize_m = [4000, -1]\n", RCode::kBadValue, "two lengths above 0, in metres");
  refused(kHead + "[[plane]]\n", RCode::kMissingKey, "size_m");
  refused(kHead + kFloor + "position_m = [0, 0, 3500]\n", RCode::kBadValue, "metres");
  refused(kHead + kFloor + "rotation_deg = [0, 0]\n", RCode::kBadValue, "three numbers");
  refused(kHead + kFloor + "albedo = 50\n", RCode::kBadValue, "a share of the light");
  refused(kHead + kFloor + "albedo = 0.8\ngloss = 0.3\n", RCode::kBadValue, "would make light");
  refused(kHead + kFloor + "appears_s = 5\nvanishes_s = 4\n", RCode::kBadValue, "later");
  refused(kHead + kFloor + "path = [[1, 0, 0, 0], [1, 1, 0, 0]]\n", RCode::kBadValue, "rising seconds");
  refused(kHead + "[[box]]\nsize_m = [1, 1]\n", RCode::kBadValue, "three");
  refused(kHead + "[[door]]\nlength_m = 100\nwidth_m = 100\ncrown_m = 1\ncell_m = 0.01\n", RCode::kBadValue, "million");
  refused(kHead + "[[datum]]\ncode = 4096\n", RCode::kBadValue, "code");
  refused(kHead +
              "[[target]]\nkind = 'charuco'\ncolumns = 5\nrows = 4\nsquare_m = 0.05\nmarker_m = 0.04\n"
              "dictionary = '4X4_50'\n",
          RCode::kBadValue, "chessboard");
  refused(kHead + "[[target]]\nkind = 'chessboard'\ncolumns = 5\nrows = 4\n", RCode::kMissingKey, "square_m");
  refused(kHead + "[[target]]\nkind = 'chessboard'\ncolumns = 5\nrows = 4\nsquare_m = 0.05\nposes = [[0, 0, 2]]\n",
          RCode::kBadValue, "rows of six");
  refused(kHead, RCode::kMissingKey, "plane");
  refused("format = 2\nname = 'x'\n" + kFloor, RCode::kFormatVersion, "");
  refused(kHead + "[[plane", RCode::kTomlSyntax, "scene.toml");
}

TEST_F(ReadScene, a_mesh_is_scaled_and_its_faults_are_told_apart) {
  write("ramp.obj", "v 0 0 0\nv 20000 0 0\nv 0 1000 500\nf 1 2 3\n");  // millimetres
  write("bare.obj", "v 0 0 0\n");
  write("nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  write("ramp.stl", "solid\n");
  const auto scene = read(kHead + "[[mesh]]\nfile = 'ramp.obj'\nscale = 0.001\nposition_m = [0, 0, 1]\n");
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_NEAR(flatten(*scene, {}).vertices[2].z(), 1.5, 1e-12);
  refused(kHead + "[[mesh]]\nfile = 'rmap.obj'\n", RCode::kMeshMissing, "rmap.obj");
  refused(kHead + "[[mesh]]\nfile = 'ramp.obj'\n", RCode::kMeshNotFinite, "'scale'");
  refused(kHead + "[[mesh]]\nfile = 'bare.obj'\n", RCode::kMeshEmpty, "bare.obj");
  refused(kHead + "[[mesh]]\nfile = 'nan.obj'\n", RCode::kMeshNotFinite, "nan.obj");
  refused(kHead + "[[mesh]]\nfile = 'ramp.stl'\n", RCode::kBadValue, ".obj or .ply");
  refused(kHead + "[[mesh]]\nfile = '/etc/passwd'\n", RCode::kPathOutside, "beside the scene");
  refused(kHead + "[[mesh]]\n", RCode::kMissingKey, "file");
}

TEST_F(ReadScene, a_picture_lies_on_a_plane) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = 2;
  png.height = 1;
  png.format = PNG_FORMAT_GRAY;
  const unsigned char pixels[] = {51, 204};
  ASSERT_NE(png_image_write_to_file(&png, (folder_ / "print.png").c_str(), 0, pixels, 0, nullptr), 0);
  const std::string texture = "texture = { file = 'print.png', pixel_m = 0.5 }\n";
  const auto scene = read(kHead + kFloor + texture);
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_NEAR(scene->surfaces[0].material.texture->albedo({0.75, 0}), 0.8, 1e-6);
  refused(kHead + kFloor + "texture = { file = 'none.png', pixel_m = 0.5 }\n", RCode::kTextureMissing, "none.png");
  refused(kHead + kFloor + "texture = { file = 'print.png' }\n", RCode::kMissingKey, "pixel_m");
  refused(kHead + "[[box]]\nsize_m = [1, 1, 1]\n" + texture, RCode::kBadValue, "how a picture lies");
  write("text.png", "not a picture");
  refused(kHead + kFloor + "texture = { file = 'text.png', pixel_m = 0.5 }\n", RCode::kTextureFormat, "text.png");
  // Cut short.
  std::ifstream whole(folder_ / "print.png", std::ios::binary);
  std::string all((std::istreambuf_iterator<char>(whole)), {});
  write("cut.png", all.substr(0, all.size() / 2));
  refused(kHead + kFloor + "texture = { file = 'cut.png', pixel_m = 0.5 }\n", RCode::kTextureFormat, "cut.png");
}

TEST_F(ReadScene, a_file_that_is_not_there_is_said_so) {
  EXPECT_EQ(load_scene(folder_ / "nothing.toml").error().rcode, RCode::kFileMissing);
  EXPECT_EQ(load_scene(folder_).error().rcode, RCode::kFileMissing);
}

}  // namespace
}  // namespace raysteer::sim::scene
