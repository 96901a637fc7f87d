// stereo-phaseshift-angel has no calibration: its rectified views are matched along their rows.
#include <gtest/gtest.h>

#include "calib/scene/row_match.hpp"
#include "host/scan/decode_look.hpp"
#include "tests/support/paths.hpp"

namespace raysteer::golden {
namespace {

TEST(ScanAngel, rows_find_their_partners_to_a_tenth_of_a_pixel) {
  if (!support::captures()) {
    GTEST_SKIP() << "no real captures: RAYSTEER_DATA_DIR names none";
  }
  const Result<host::session::Session> session = host::session::Session::open(
      support::source_root() / "tests/data/sessions/phaseshift-angel.toml", support::captures());
  ASSERT_TRUE(session) << session.error().message();
  const auto looks = host::scan::decode_cameras(*session, 0);
  ASSERT_TRUE(looks) << looks.error().message();
  const auto rows = calib::scene::match_rows((*looks)[0].codes, (*looks)[1].codes);
  ASSERT_TRUE(rows) << rows.error().message();
  // Measured 2026: 167,167 partners of 179,997 pixels; 0.041 px sigma, 0.100 px at 95 %; rows 0.092 / 0.323 px. Of the
  // pixels left out at depth edges in the left view, half are more than 1 px off the disparities around them.
  EXPECT_GT(rows->matched, 160000U);
  EXPECT_LT(rows->matched, 180000U);
  EXPECT_GT(static_cast<double>(rows->matched), 0.91 * static_cast<double>(rows->valid_left));
  EXPECT_NEAR(rows->sigma_px, 0.041, 0.01);
  EXPECT_NEAR(rows->p95_px, 0.100, 0.03);
  EXPECT_NEAR(rows->row_p95_median_px, 0.092, 0.03);
  EXPECT_LT(rows->row_p95_worst_px, 0.8);
}

}  // namespace
}  // namespace raysteer::golden
