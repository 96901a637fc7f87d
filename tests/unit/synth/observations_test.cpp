#include "calib/synth/observations.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace raysteer::calib::synth {
namespace {

model::Rig procam() {
  model::Rig rig;
  rig.devices.resize(2);
  rig.devices[0] = {"camera",
                    model::DeviceKind::kCamera,
                    {.width = 1280, .height = 1024, .fx = 1500, .fy = 1500, .cx = 640, .cy = 512},
                    {}};
  rig.devices[1] = {"projector",
                    model::DeviceKind::kProjector,
                    {.width = 1024, .height = 768, .fx = 1100, .fy = 1100, .cx = 512, .cy = 800},
                    {}};
  rig.devices[1].T_device_rig.t = {-0.2, -0.3, 0};
  return rig;
}
const TargetSpec kTarget{.kind = TargetKind::kChessboard, .columns = 9, .rows = 6, .square_m = 0.04, .dictionary = {}};

TEST(Observations, targets_are_seen_whole_from_different_distances_and_tilts) {
  const model::Rig rig = procam();
  const auto poses = target_poses(rig, kTarget, {.views = 20, .distance_m = 1.2, .on_panel = true}, 3);
  ASSERT_EQ(poses.size(), 20U);
  double near = 10;
  double far = 0;
  double most_tilted = 1;
  for (const model::Pose& pose : poses) {
    for (const model::Device& device : rig.devices) {
      for (int id = 0; id < kTarget.corners(); ++id) {
        const auto q = device.camera.project(device.T_device_rig * (pose * target::corner_position(kTarget, id)));
        ASSERT_TRUE(q.has_value());
        EXPECT_GE(q->minCoeff(), 8);
        EXPECT_LE(q->x(), device.camera.width - 9);
        EXPECT_LE(q->y(), device.camera.height - 9);
      }
    }
    near = std::min(near, pose.t.norm());
    far = std::max(far, pose.t.norm());
    most_tilted = std::min(most_tilted, pose.rotation()(2, 2));
  }
  EXPECT_GT(far / near, 1.3);
  EXPECT_LT(most_tilted, std::cos(0.4));
}

TEST(Observations, errors_have_the_sigma_that_is_stated) {
  const model::Rig rig = procam();
  Noise noise(5);
  double corner = 0;
  double corners = 0;
  double panel = 0;
  double panels = 0;
  for (const model::Pose& pose : target_poses(rig, kTarget, {.views = 20, .distance_m = 1.2, .on_panel = true}, 3)) {
    const TargetView view = observe(rig, kTarget, pose, {.corner_px = 0.2, .panel_px = 0.3}, noise);
    EXPECT_EQ(view.corners[0].size(), 54U);
    EXPECT_TRUE(view.corners[1].empty());
    for (const target::Corner& seen : view.corners[0]) {
      const auto q = rig.devices[0].camera.project(pose * target::corner_position(kTarget, seen.id));
      corner += (seen.q - *q).squaredNorm();
      corners += 2;
    }
    EXPECT_GT(view.pixels.size(), 100U);
    for (const PanelPixel& pixel : view.pixels) {
      // The pixel's ray meets the target's plane; the panel pixel lights that point.
      const Eigen::Vector3d ray = rig.devices[0].camera.normalize(pixel.q)->homogeneous();
      const Eigen::Vector3d normal = pose.rotation().col(2);
      const Eigen::Vector3d p = ray * (normal.dot(pose.t) / normal.dot(ray));
      panel += (pixel.x - *rig.devices[1].camera.project(rig.devices[1].T_device_rig * p)).squaredNorm();
      panels += 2;
    }
  }
  EXPECT_NEAR(corner / corners / (0.2 * 0.2), 1, 5 * std::sqrt(2 / corners));
  EXPECT_NEAR(panel / panels / (0.3 * 0.3), 1, 5 * std::sqrt(2 / panels));
}

}  // namespace
}  // namespace raysteer::calib::synth
