#include "sim/scene/scene.hpp"

#include <gtest/gtest.h>

#include <chrono>

#include "sim/optics/light_path.hpp"
#include "sim/scene/read_scene.hpp"
#include "tests/support/paths.hpp"
#include "tests/unit/optics/boards.hpp"

namespace raysteer::sim::scene {
namespace {

Moment at(double seconds, int target_pose = kTargetAway) {
  return {.time = RigTime(std::chrono::duration_cast<RigTime::duration>(std::chrono::duration<double>(seconds))),
          .target_pose = target_pose};
}

Scene scene_named(const std::string& name) {
  auto scene = load_scene(support::source_root() / "scenes" / (name + ".toml"));
  if (!scene) {
    throw std::runtime_error(scene.error().message());
  }
  return std::move(*scene);
}

constexpr std::array kScenes{"floor", "factory", "step", "door", "assembly"};

TEST(Scenes, all_are_read_and_have_a_floor_and_a_target) {
  for (const char* name : kScenes) {
    const Scene scene = scene_named(name);
    EXPECT_EQ(scene.name, name);
    EXPECT_GE(scene.surfaces.size(), 2U);
    ASSERT_EQ(scene.targets.size(), 1U);
    EXPECT_EQ(scene.targets[0].spec.corners(), 104);
    EXPECT_TRUE(scene.target_pose("target pose 16"));
    const FlatScene flat = flatten(scene, at(0, 1));
    EXPECT_EQ(flat.triangles.size(), flat.surface.size());
    EXPECT_EQ(flat.vertices.size(), flat.uv.size());
  }
  EXPECT_EQ(scene_named("factory").ambient.lux, 1000);
  EXPECT_EQ(scene_named("floor").ambient.lux, 300);
}

// Every pose must be usable with every board: wholly in both pictures, in front, seen on its printed side.
TEST(Scenes, both_cameras_of_every_board_see_each_held_target_whole) {
  const Scene scene = scene_named("floor");
  const Surface& target = scene.surfaces[scene.targets[0].surface];
  for (const std::string& board : optics::kBoards) {
    const optics::TrueRig rig = optics::rig_named(board);
    for (int pose = 0; pose <= 16; ++pose) {
      const auto T_room_target = target.pose(at(0, pose));
      ASSERT_TRUE(T_room_target);
      const Eigen::Isometry3d T_rig_target = scene.T_room_rig.inverse() * *T_room_target;
      for (const optics::TrueCamera& camera : rig.cameras) {
        EXPECT_GT(T_rig_target.linear().col(2).dot((T_rig_target.translation() - camera.centre()).normalized()), 0.6);
        const double border = camera.width * 0.03;
        for (const Eigen::Vector3d& vertex : target.mesh.vertices) {
          const auto q = camera.project(T_rig_target * vertex);
          ASSERT_TRUE(q);
          EXPECT_TRUE(q->x() > border && q->y() > border && q->x() < camera.width - 1 - border &&
                      q->y() < camera.height - 1 - border)
              << board << " pose " << pose;
        }
      }
    }
  }
}

TEST(Scenes, the_target_on_the_floor_lies_beside_the_first_look_s_light) {
  const Scene scene = scene_named("floor");
  const Surface& target = scene.surfaces[scene.targets[0].surface];
  const Eigen::Isometry3d T_rig_target = scene.T_room_rig.inverse() * *target.pose(at(0, kTargetOnFloor));
  for (const std::string& board : optics::kBoards) {
    const optics::TrueRig rig = optics::rig_named(board);
    const optics::LightPath path(rig, {});
    for (const Eigen::Vector3d& vertex : target.mesh.vertices) {
      const auto x = path.pixel(T_rig_target * vertex);
      ASSERT_TRUE(x);
      EXPECT_FALSE(x->x() > 0 && x->x() < rig.projector.width && x->y() > 0 && x->y() < rig.projector.height) << board;
      // Near: within one picture's width beside it.
      EXPECT_TRUE(x->x() > -rig.projector.width && x->x() < 2 * rig.projector.width) << board;
    }
  }
}

TEST(Scene, targets_are_where_they_were_asked_to_be) {
  const Scene scene = scene_named("floor");
  const Surface& target = scene.surfaces[scene.targets[0].surface];
  EXPECT_FALSE(target.pose(at(0)));
  EXPECT_EQ(*scene.target_pose("", 5), 5);
  EXPECT_EQ(*scene.target_pose("target away", 5), kTargetAway);
  EXPECT_EQ(*scene.target_pose("target on floor"), kTargetOnFloor);
  EXPECT_EQ(*scene.target_pose("target pose 3"), 3);
  // Face up: its z goes into the floor.
  EXPECT_LT((target.pose(at(0, kTargetOnFloor))->linear().col(2) + Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  // The poses speak of the middle of the corners, in the rig's frame: the first is (0.16, -0.25, 1.28).
  const Eigen::Isometry3d T_rig_target = scene.T_room_rig.inverse() * *target.pose(at(0, 1));
  EXPECT_LT((T_rig_target * Eigen::Vector3d(0.33, 0.1925, 0) - Eigen::Vector3d(0.16, -0.25, 1.28)).norm(), 1e-12);
  for (const char* wrong : {"target pose 17", "target pose 0", "target pose", "target pose 3 ", "wave the board"}) {
    const auto pose = scene.target_pose(wrong);
    ASSERT_FALSE(pose) << wrong;
    EXPECT_EQ(pose.error().rcode, RCode::kBadPrepare);
    EXPECT_NE(pose.error().note.find("'target pose 1' to 'target pose 16'"), std::string::npos) << pose.error().note;
  }
}

TEST(Scene, parts_appear_one_after_the_other) {
  const Scene scene = scene_named("assembly");
  const auto parts = [&](double seconds) { return flatten(scene, at(seconds)).triangles.size(); };
  EXPECT_LT(parts(9.9), parts(10.0));
  EXPECT_LT(parts(10.1), parts(20.1));
  EXPECT_LT(parts(20.1), parts(30.1));
  EXPECT_EQ(still_key(scene, at(1)), still_key(scene, at(9)));
  EXPECT_NE(still_key(scene, at(9)), still_key(scene, at(11)));
  EXPECT_NE(still_key(scene, at(9)), still_key(scene, at(9, 2)));
}

TEST(Scene, the_passer_by_walks_straight_from_point_to_point_and_again) {
  const Scene scene = scene_named("factory");
  const auto walker = std::ranges::find_if(scene.surfaces, &Surface::moves);
  ASSERT_NE(walker, scene.surfaces.end());
  const auto place = [&](double seconds) -> Eigen::Vector3d { return walker->pose(at(seconds))->translation(); };
  EXPECT_LT((place(5) - Eigen::Vector3d(-4, -1.5, 0)).norm(), 1e-9);
  EXPECT_LT((place(15) - Eigen::Vector3d(0.25, -0.25, 0)).norm(), 1e-9);
  EXPECT_LT((place(35) - place(15)).norm(), 1e-9);
  // It changes the moving part only.
  EXPECT_EQ(still_key(scene, at(12)), still_key(scene, at(15)));
  const auto count = [&](Which which) { return flatten(scene, at(15), which).triangles.size(); };
  EXPECT_EQ(count(Which::kStill) + count(Which::kMoving), count(Which::kAll));
  EXPECT_GT(count(Which::kMoving), 0U);
}

}  // namespace
}  // namespace raysteer::sim::scene
