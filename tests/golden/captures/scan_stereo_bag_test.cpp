// The scan of stereo-graycode-bag, against the plain method measured in the same run. Both use the same cameras, solved
// by plain OpenCV (tests/data/calibrations).
#include <gtest/gtest.h>

#include <optional>

#include "calib/scene/epipolar.hpp"
#include "calib/scene/plane.hpp"
#include "calib/scene/triangulate.hpp"
#include "host/exchange/calibration_file.hpp"
#include "host/scan/scan.hpp"
#include "tests/golden/captures/plain_method.hpp"
#include "tests/support/paths.hpp"

namespace raysteer::golden {
namespace {

using calib::scene::Match;
using host::session::Session;

#define SKIP_WITHOUT_CAPTURES()                                       \
  if (!support::captures()) {                                         \
    GTEST_SKIP() << "no real captures: RAYSTEER_DATA_DIR names none"; \
  }

Session bag() {
  Result<Session> session =
      Session::open(support::source_root() / "tests/data/sessions/stereo-bag-scan.toml", support::captures());
  EXPECT_TRUE(session) << session.error().message();
  return *std::move(session);
}

calib::model::Rig plain_rig() {
  Result<host::exchange::Calibration> calibration =
      host::exchange::read_calibration(support::source_root() / "tests/data/calibrations/stereo-bag-opencv.toml");
  EXPECT_TRUE(calibration) << calibration.error().message();
  return std::move(calibration->rig);
}

/// Scans once for all tests: it takes seconds.
const host::scan::Scan& scanned(bool refit_pose) {
  static std::optional<host::scan::Scan> scans[2];
  std::optional<host::scan::Scan>& kept = scans[refit_pose ? 1 : 0];
  if (!kept) {
    Result<host::scan::Scan> found =
        host::scan::scan(bag(), 0, plain_rig(), {.refit_pose = refit_pose, .decode = {}}, {});
    EXPECT_TRUE(found) << found.error().message();
    kept = *std::move(found);
  }
  return *kept;
}

struct PlainScan {
  calib::scene::Matches matches;
  calib::scene::EpipolarAnalysis epipolar;
  calib::scene::Flatness flatness;
};

const PlainScan& plain_scan() {
  static const PlainScan plain = [] {
    PlainScan scan;
    const Session session = bag();
    scan.matches = calib::scene::match(plain_sightings(session, 0), plain_sightings(session, 1));
    const calib::scene::TwoViews views = *calib::scene::two_views(plain_rig(), 0, 1);
    const auto rays = calib::scene::ray_pairs(views, scan.matches.measured);
    scan.epipolar =
        *calib::scene::analyse_epipolar(scan.matches.measured, calib::scene::epipolar_disagreement(views, rays));
    const auto cloud = *calib::scene::triangulate(views, scan.matches.measured, rays);
    calib::scene::FlatnessOptions flat;
    scan.flatness =
        *calib::scene::flatness(cloud.points, *calib::scene::dominant_plane(cloud.points, flat.band_m), flat);
    return scan;
  }();
  return plain;
}

TEST(ScanStereoBag, the_plain_method_reaches_what_the_data_says) {
  SKIP_WITHOUT_CAPTURES();
  const PlainScan& plain = plain_scan();
  EXPECT_NEAR(static_cast<double>(plain.matches.measured.size()), 500392, 100);
  EXPECT_NEAR(static_cast<double>(plain.epipolar.within_1_5_px), 490412, 500);
  EXPECT_NEAR(plain.epipolar.sigma_px, 0.516, 0.005);
  EXPECT_NEAR(plain.epipolar.within_cell_px, 0.285, 0.01);
  EXPECT_NEAR(plain.epipolar.systematic_px, 0.352, 0.02);
  EXPECT_NEAR(plain.flatness.patch_rms_m, 1.69e-3, 0.05e-3);
}

TEST(ScanStereoBag, matches_at_least_as_many_projector_pixels) {
  SKIP_WITHOUT_CAPTURES();
  const host::scan::Scan& scan = scanned(false);
  EXPECT_GT(scan.matches.measured.size(), 560000U);
  EXPECT_LT(scan.matches.measured.size(), 700000U);
  EXPECT_GT(scan.epipolar.within_1_5_px, 560000U);
  EXPECT_GT(scan.cloud.points.size(), 550000U);
  EXPECT_LT(scan.matches.interpolated, scan.matches.measured.size() / 5);
}

TEST(ScanStereoBag, noise_within_a_cell_is_a_third_of_the_plain_method) {
  SKIP_WITHOUT_CAPTURES();
  const host::scan::Scan& scan = scanned(false);
  EXPECT_GT(scan.epipolar.within_cell_px, 0.03);
  EXPECT_LT(scan.epipolar.within_cell_px, 0.10);
}

TEST(ScanStereoBag, says_that_the_pair_moved) {
  SKIP_WITHOUT_CAPTURES();
  const host::scan::Scan& scan = scanned(false);
  ASSERT_TRUE(scan.refit);
  EXPECT_TRUE(scan.moved());
  EXPECT_NEAR(scan.refit->moved_rad, 6.9e-3, 0.3e-3);
  EXPECT_NEAR(scan.epipolar.systematic_px, 0.34, 0.03);
  EXPECT_NEAR(scan.epipolar.sigma_px, 0.47, 0.06);
}

TEST(ScanStereoBag, the_refitted_pose_fits_matches_it_never_saw) {
  SKIP_WITHOUT_CAPTURES();
  const host::scan::Scan& scan = scanned(true);
  ASSERT_TRUE(scan.refit);
  EXPECT_NEAR(scan.refit->held_out_before_px, 0.47, 0.06);
  EXPECT_GT(scan.refit->held_out_after_px, 0.03);
  EXPECT_LT(scan.refit->held_out_after_px, 0.12);
  EXPECT_DOUBLE_EQ(scan.epipolar.sigma_px, scan.refit->held_out_after_px);
  // What the refit cannot know: it changes depths by a fifth, so lengths wait for a new calibration.
  EXPECT_NEAR(scan.depth_ratio, 1.22, 0.03);
}

TEST(ScanStereoBag, the_wall_is_flatter_in_patches_than_by_the_plain_method) {
  SKIP_WITHOUT_CAPTURES();
  const host::scan::Scan& scan = scanned(false);
  ASSERT_TRUE(scan.flatness);
  const double ratio = scan.flatness->patch_rms_m / plain_scan().flatness.patch_rms_m;
  EXPECT_GT(ratio, 0.1);
  EXPECT_LT(ratio, 0.45);
  EXPECT_GT(scan.flatness->patches, 400U);
  EXPECT_LT(scan.flatness->trimmed, 0.06);
}

TEST(ScanStereoBag, depths_are_those_of_the_data) {
  SKIP_WITHOUT_CAPTURES();
  const host::scan::Scan& scan = scanned(false);
  EXPECT_NEAR(scan.depth.p1_m, 0.90, 0.03);
  EXPECT_NEAR(scan.depth.p99_m, 1.048, 0.01);
}

}  // namespace
}  // namespace raysteer::golden
