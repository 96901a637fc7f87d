// Rendered frames become the cloud they were rendered from; what does not belong together is refused.
#include "host/scan/scan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "tests/unit/scan/rendered_session.hpp"

namespace raysteer::host::scan {
namespace {

/// Share of the points within 5 sigma (of the depth) of the surface that the left ray through them meets.
double share_on_surface(const Scan& scan, const calib::model::Rig& rig) {
  const calib::synth::Scene scene = small_scene();
  const Eigen::Vector3d origin = rig.devices[0].T_device_rig.inverse().t;
  std::size_t good = 0;
  for (const calib::scene::CloudPoint& point : scan.cloud.points) {
    const auto hit = calib::synth::first_hit(scene, origin, point.p - origin);
    const double sigma = std::sqrt(point.covariance(2, 2));
    good += hit && std::abs(hit->p.z() - point.p.z()) < 5 * sigma + 1e-4 ? 1 : 0;
  }
  return static_cast<double>(good) / static_cast<double>(scan.cloud.points.size());
}

TEST(Scan, two_cameras_give_the_surface_they_saw) {
  const calib::model::Rig rig = small_rig();
  const RenderedSession rendered(rig, {{0, "left"}, {1, "right"}});
  const auto found = scan(rendered.open(), 0, rig, {}, {});
  ASSERT_TRUE(found) << found.error().message();
  EXPECT_FALSE(found->devices.with_projector);
  EXPECT_GT(found->cloud.points.size(), 5000U);
  EXPECT_LT(found->cloud.points.size(), 128U * 96U);
  EXPECT_GT(share_on_surface(*found, rig), 0.97);
  EXPECT_LT(found->epipolar.within_cell_px, 0.2);
  EXPECT_FALSE(found->moved());
  EXPECT_EQ(found->white.width(), 240);
}

TEST(Scan, one_camera_and_the_projector_do_too) {
  const calib::model::Rig rig = small_rig();
  const RenderedSession rendered(rig, {{0, "left"}});
  const auto found = scan(rendered.open(), 0, rig, {}, {});
  ASSERT_TRUE(found) << found.error().message();
  EXPECT_TRUE(found->devices.with_projector);
  EXPECT_GT(found->cloud.points.size(), 5000U);
  EXPECT_GT(share_on_surface(*found, rig), 0.97);
}

calib::model::Rig turned(calib::model::Rig rig, double angle) {
  rig.devices[1].T_device_rig.q = Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d(1, 0, 1).normalized())) *
                                  rig.devices[1].T_device_rig.q;
  return rig;
}

TEST(Scan, a_pair_that_moved_is_named_and_refitted) {
  const calib::model::Rig calibrated = small_rig();
  const RenderedSession rendered(turned(calibrated, 0.003), {{0, "left"}, {1, "right"}});
  const auto before = scan(rendered.open(), 0, calibrated, {}, {});
  ASSERT_TRUE(before) << before.error().message();
  EXPECT_TRUE(before->moved());
  const auto after = scan(rendered.open(), 0, calibrated, {.refit_pose = true, .decode = {}}, {});
  ASSERT_TRUE(after) << after.error().message();
  EXPECT_TRUE(after->refitted);
  // 0.05 mrad are 0.015 px here: places of Gray borders are that well known, their noise is smaller.
  EXPECT_NEAR(after->refit->moved_rad, 0.003, 0.0001);
  EXPECT_LT(after->epipolar.sigma_px, 0.5 * before->epipolar.sigma_px);
}

TEST(Scan, a_pair_that_moved_so_far_that_nothing_fits_is_told_to_refit) {
  const calib::model::Rig calibrated = small_rig();
  const RenderedSession rendered(turned(calibrated, 0.02), {{0, "left"}, {1, "right"}});
  const auto before = scan(rendered.open(), 0, calibrated, {}, {});
  ASSERT_FALSE(before);
  EXPECT_EQ(before.error().rcode, RCode::kPoseMoved) << before.error().message();
  EXPECT_TRUE(scan(rendered.open(), 0, calibrated, {.refit_pose = true, .decode = {}}, {}));
}

TEST(Scan, exchanged_cameras_are_refused) {
  const calib::model::Rig rig = small_rig();
  const RenderedSession rendered(rig, {{1, "left"}, {0, "right"}});
  const auto found = scan(rendered.open(), 0, rig, {}, {});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().rcode, RCode::kTooFewMatches);
}

TEST(Scan, a_calibration_of_other_cameras_is_refused) {
  calib::model::Rig rig = small_rig();
  const RenderedSession rendered(rig, {{0, "left"}, {1, "right"}});
  const session::Session session = rendered.open();
  rig.devices[1].camera.width = 320;
  auto devices = scan_devices(session, rig);
  ASSERT_FALSE(devices);
  EXPECT_EQ(devices.error().rcode, RCode::kCalibrationMismatch);
  EXPECT_NE(devices.error().note.find("240 x 180"), std::string::npos) << devices.error().note;
  rig = small_rig();
  rig.devices[1].name = "rear";
  devices = scan_devices(session, rig);
  ASSERT_FALSE(devices);
  EXPECT_EQ(devices.error().rcode, RCode::kCalibrationMismatch);
  EXPECT_NE(devices.error().note.find("'rear'"), std::string::npos) << devices.error().note;
}

TEST(Scan, one_camera_needs_a_projector) {
  calib::model::Rig rig = small_rig();
  const RenderedSession rendered(rig, {{0, "left"}});
  const session::Session session = rendered.open();
  rig.devices[2].camera.width = 64;
  auto devices = scan_devices(session, rig);
  ASSERT_FALSE(devices);
  EXPECT_EQ(devices.error().rcode, RCode::kCalibrationMismatch);
  rig.devices.pop_back();
  devices = scan_devices(session, rig);
  ASSERT_FALSE(devices);
  EXPECT_EQ(devices.error().rcode, RCode::kCameraCount);
}

TEST(Scan, stops_when_asked_to) {
  const calib::model::Rig rig = small_rig();
  const RenderedSession rendered(rig, {{0, "left"}, {1, "right"}});
  const auto found =
      scan(rendered.open(), 0, rig, {}, [](const std::string&) -> Tick { return [](double) { return false; }; });
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().rcode, RCode::kCancelled);
}

}  // namespace
}  // namespace raysteer::host::scan
