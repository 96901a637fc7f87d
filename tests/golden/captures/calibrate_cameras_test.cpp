// The real stereo set: what plain OpenCV reaches there is 0.160 / 0.169 / 0.166 px.
#include <gtest/gtest.h>

#include "calib/assess/assess.hpp"
#include "calib/solve/solve.hpp"
#include "host/calibrate/gather.hpp"
#include "tests/support/paths.hpp"

namespace raysteer {
namespace {

TEST(CalibrateCameras, reaches_the_recorded_figures_on_the_stereo_bag) {
  const auto captures = support::captures();
  if (!captures) {
    GTEST_SKIP() << "no real captures: set RAYSTEER_DATA_DIR";
  }
  const auto session = host::session::Session::open(
      support::source_root() / "tests/data/sessions/stereo-bag-calibration.toml", *captures);
  ASSERT_TRUE(session) << session.error().message();
  const auto gathered = host::calibrate::gather_cameras(*session);
  ASSERT_TRUE(gathered) << gathered.error().message();
  EXPECT_EQ(gathered->observations.target.layout, CharucoLayout::kLegacy);
  EXPECT_TRUE(gathered->missed.empty());

  const auto solution = calib::solve::solve(gathered->observations);
  ASSERT_TRUE(solution) << solution.error().message();
  for (const calib::solve::DeviceFit& device : solution->devices) {
    EXPECT_GT(device.rms_px, 0.12) << device.name;
    EXPECT_LT(device.rms_px, 0.16) << device.name;  // asked: 0.17
    EXPECT_GT(device.kept_share(), 0.98) << device.name;
    EXPECT_GT(device.corners_seen, 4500) << device.name;
  }
  EXPECT_GT(solution->rms_px, 0.12);
  EXPECT_LT(solution->rms_px, 0.16);
  EXPECT_NEAR(solution->rig.devices[1].T_device_rig.t.norm(), 0.0399, 0.0001);
  EXPECT_NEAR(solution->rig.devices[0].camera.fx, 3728, 15);
  for (const calib::solve::ViewFit& view : solution->views) {
    EXPECT_TRUE(view.used) << view.name << ": " << view.why_note;
  }

  const auto assessment = calib::assess::assess(gathered->observations, *solution);
  ASSERT_TRUE(assessment) << assessment.error().message();
  EXPECT_GT(assessment->cross_validation.p95_px, 0.20);
  EXPECT_LT(assessment->cross_validation.p95_px, 0.30);  // asked: 0.33
  for (const calib::assess::DeviceAssessment& device : assessment->devices) {
    EXPECT_GT(device.odd_even_p95_px, 0.1) << device.name;
    EXPECT_LT(device.odd_even_p95_px, 2.0) << device.name;
  }
  EXPECT_EQ(assessment->verdict, calib::assess::Verdict::kUsable);
}

}  // namespace
}  // namespace raysteer
