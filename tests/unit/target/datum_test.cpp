#include "calib/target/datum.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <numbers>
#include <random>

#include "tests/support/datum_picture.hpp"
#include "tests/support/seed.hpp"

namespace raysteer::calib::target {
namespace {

using support::DatumLight;
using support::DrawnDatum;

model::Camera camera_of(int side) {
  return {.width = side, .height = side, .fx = 1400, .fy = 1400, .cx = 0.5 * side, .cy = 0.5 * side, .k = {}};
}

/// A datum of `diameter_px` near the picture's middle, tilted about any axis in the picture and turned at random.
DrawnDatum random_datum(std::mt19937_64& random, unsigned code, double diameter_px, double tilt_deg) {
  std::uniform_real_distribution<double> any(-1, 1);
  DrawnDatum datum{.T_camera_datum = {}, .radius_m = 0.03, .code = code};
  const double z = 1400 * 2 * datum.radius_m / diameter_px;
  const double around = std::numbers::pi * any(random);
  const Eigen::Vector3d axis(std::cos(around), std::sin(around), 0);
  datum.T_camera_datum.q = model::rotation_by(axis * (tilt_deg * std::numbers::pi / 180)) *
                           model::rotation_by({std::numbers::pi, 0, 0}) *
                           model::rotation_by({0, 0, std::numbers::pi * any(random)});
  datum.T_camera_datum.t = Eigen::Vector3d(any(random) * z / 1400, any(random) * z / 1400, z);
  return datum;
}

struct Score {
  int drawn = 0;
  int found = 0;
  int wrong = 0;
  Eigen::Vector2d bias = Eigen::Vector2d::Zero();
  double rms_px = 0;      ///< per coordinate
  double chi_square = 0;  ///< of the error against the stated covariance, per coordinate
};

Score score(std::mt19937_64& random, int count, double diameter_px, double tilt_deg, const DatumLight& light) {
  Score score{.drawn = count};
  const model::Camera camera = camera_of(static_cast<int>(7 * diameter_px / 2) + 30);
  for (int i = 0; i < count; ++i) {
    const unsigned code = datum_codes()[static_cast<std::size_t>(i) % datum_codes().size()];
    const DrawnDatum drawn = random_datum(random, code, diameter_px, tilt_deg);
    const auto picture = support::draw_datums(camera, {drawn}, light, random);
    const DatumsInFrame got = detect_datums(picture.view());
    score.wrong += static_cast<int>(got.doubled.size());
    for (const SeenDatum& seen : got.seen) {
      if (seen.code != code) {
        ++score.wrong;
        continue;
      }
      ++score.found;
      const Eigen::Vector3d normal = drawn.T_camera_datum.q * Eigen::Vector3d::UnitZ();
      const Eigen::Vector2d error = seen.q - *ellipse_middle(camera, drawn.T_camera_datum.t, normal, drawn.radius_m);
      score.bias += error;
      score.rms_px += error.squaredNorm() / 2;
      score.chi_square += error.dot(seen.cov.inverse() * error) / 2;
    }
  }
  score.bias /= std::max(1, score.found);
  score.rms_px = std::sqrt(score.rms_px / std::max(1, score.found));
  score.chi_square /= std::max(1, score.found);
  return score;
}

TEST(DatumCode, offered_ones_differ_in_three_sectors_from_each_other_and_from_themselves_turned) {
  const auto turned = [](unsigned code, unsigned by) { return ((code >> by) | (code << (12 - by))) & 0xfffU; };
  for (const unsigned a : datum_codes()) {
    EXPECT_EQ(smallest_rotation(a), a);
    for (const unsigned b : datum_codes()) {
      for (unsigned by = 0; by < 12; ++by) {
        if (a != b || by != 0) {
          EXPECT_GE(std::popcount(a ^ turned(b, by)), 3) << a << ' ' << b << ' ' << by;
        }
      }
      EXPECT_EQ(smallest_rotation(turned(a, 5)), a);
    }
  }
}

TEST(DatumCode, others_are_refused_with_the_list) {
  EXPECT_TRUE(check_datum_code(datum_codes()[0]));
  EXPECT_TRUE(check_datum_code((datum_codes()[3] << 1U) & 0xfffU));
  for (const unsigned bad : {0U, 0xfffU, 0x555U, datum_codes()[2] ^ 1U, 0x1017U}) {
    const Status status = check_datum_code(bad);
    ASSERT_FALSE(status) << bad;
    EXPECT_EQ(status.error().rcode, RCode::kBadValue);
    EXPECT_NE(status.error().note.find("take one of 23 79"), std::string::npos);
  }
}

TEST(Datum, is_found_to_a_fiftieth_of_a_pixel_as_the_reference_cameras_see_it) {
  std::mt19937_64 random(support::seed());
  const Score got = score(random, 16, 24, 10, {.noise_dn = 2});
  EXPECT_EQ(got.found, 16);
  EXPECT_EQ(got.wrong, 0);
  EXPECT_LT(got.rms_px, 0.02);
  EXPECT_LT(got.bias.norm(), 0.02);
  EXPECT_GT(got.chi_square, 0.2);  // stated covariance: neither boastful nor shy
  EXPECT_LT(got.chi_square, 2);
}

TEST(Datum, of_eight_pixels_is_found_tilted) {
  std::mt19937_64 random(support::seed());
  const Score got = score(random, 32, 8, 30, {.blur_px = 0.5, .noise_dn = 2});
  EXPECT_GE(got.found, 28);
  EXPECT_EQ(got.wrong, 0);
  EXPECT_LT(got.rms_px, 0.04);
  EXPECT_LT(got.bias.norm(), 0.03);
}

TEST(Datum, tilted_by_sixty_degrees_and_blurred_is_found) {
  std::mt19937_64 random(support::seed());
  const Score got = score(random, 16, 20, 60, {.blur_px = 1, .noise_dn = 2});
  EXPECT_GE(got.found, 15);
  EXPECT_EQ(got.wrong, 0);
  EXPECT_LT(got.rms_px, 0.04);
  EXPECT_LT(got.bias.norm(), 0.03);
}

TEST(Datum, under_glare_that_doubles_its_grey_from_side_to_side_is_not_biased) {
  std::mt19937_64 random(support::seed());
  const Score got = score(random, 12, 24, 10, {.fall_off = {0.003, 0.002}, .glare_dn = {0.6, -0.6}, .noise_dn = 2});
  EXPECT_EQ(got.found, 12);
  EXPECT_LT(got.rms_px, 0.05);
  EXPECT_LT(got.bias.norm(), 0.05);
}

TEST(Datum, is_found_at_any_size_in_sixteen_bits) {
  std::mt19937_64 random(support::seed());
  for (const double diameter : {12.0, 35.0, 70.0}) {
    const model::Camera camera = camera_of(static_cast<int>(4 * diameter));
    const DrawnDatum drawn = random_datum(random, datum_codes()[5], diameter, 20);
    const auto picture = support::draw_datums<std::uint16_t>(camera, {drawn}, {}, random, 16);
    const DatumsInFrame got = detect_datums(picture.view());
    ASSERT_EQ(got.seen.size(), 1U) << diameter;
    EXPECT_EQ(got.seen[0].code, datum_codes()[5]);
    EXPECT_GT(got.seen[0].margin, 0.6);
    EXPECT_NEAR(got.seen[0].radius_px(), diameter / 2, 0.06 * diameter);
  }
}

TEST(Datum, that_hangs_twice_is_reported_and_not_used) {
  std::mt19937_64 random(support::seed());
  DrawnDatum left = random_datum(random, datum_codes()[1], 16, 5);
  DrawnDatum right = left;
  left.T_camera_datum.t.x() -= 0.15;
  right.T_camera_datum.t.x() += 0.15;
  const auto picture = support::draw_datums(camera_of(180), {left, right}, {}, random);
  const DatumsInFrame got = detect_datums(picture.view());
  EXPECT_TRUE(got.seen.empty());
  EXPECT_EQ(got.doubled, std::vector<unsigned>{datum_codes()[1]});
}

TEST(Datum, with_one_sector_painted_over_or_half_hidden_is_refused) {
  std::mt19937_64 random(support::seed());
  for (unsigned bit = 0; bit < 12; ++bit) {
    const DrawnDatum drawn = random_datum(random, datum_codes()[2] ^ (1U << bit), 24, 10);
    const auto picture = support::draw_datums(camera_of(120), {drawn}, {}, random);
    EXPECT_TRUE(detect_datums(picture.view()).seen.empty()) << bit;
  }
  auto hidden = support::draw_datums(camera_of(120), {random_datum(random, datum_codes()[2], 24, 10)}, {}, random);
  for (int y = 0; y < 120; ++y) {
    std::fill(hidden.row(y) + 60, hidden.row(y) + 120, std::uint8_t{70});
  }
  EXPECT_TRUE(detect_datums(hidden.view()).seen.empty());
}

TEST(Datum, is_not_seen_in_noise_a_chessboard_discs_screws_or_nothing) {
  std::mt19937_64 random(support::seed());
  Image<std::uint8_t> noise(320, 240), board(320, 240), discs(320, 240), screws(320, 240);
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      noise(x, y) = static_cast<std::uint8_t>(random());
      board(x, y) = (x / 16 + y / 16) % 2 == 0 ? 20 : 200;
      const double r = std::hypot(x % 40 - 20, y % 40 - 20);
      discs(x, y) = r < 8 ? 200 : 20;
      // Bright, dark groove, bright washer with no sectors.
      screws(x, y) = r < 5 || (r > 10 && r < 15) ? 200 : 20;
    }
  }
  for (const auto* picture : {&noise, &board, &discs, &screws}) {
    const DatumsInFrame got = detect_datums(picture->view());
    EXPECT_TRUE(got.seen.empty());
    EXPECT_TRUE(got.doubled.empty());
  }
  EXPECT_TRUE(detect_datums(Frame{}).seen.empty());
  EXPECT_TRUE(detect_datums(Image<std::uint8_t>(3, 1).view()).seen.empty());
}

// The closed form for a pinhole: the outline of a disc about c with axes a, b is a conic in homogeneous coordinates.
TEST(EllipseMiddle, is_that_of_the_conic) {
  const model::Camera camera = camera_of(2000);
  const Eigen::Vector3d centre(0.3, -0.2, 0.8);
  const Eigen::Vector3d normal = Eigen::Vector3d(0.5, 0.4, -0.7).normalized();
  const double radius = 0.03;
  const Eigen::Vector3d along = normal.unitOrthogonal();
  Eigen::Matrix3d plane;
  plane << radius * along, radius * normal.cross(along), centre;
  Eigen::Matrix3d intrinsic;
  intrinsic << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  const Eigen::Matrix3d back = (intrinsic * plane).inverse();
  const Eigen::Matrix3d conic = back.transpose() * Eigen::Vector3d(1, 1, -1).asDiagonal() * back;
  const Eigen::Vector2d middle = -conic.topLeftCorner<2, 2>().inverse() * conic.topRightCorner<2, 1>();
  const auto got = ellipse_middle(camera, centre, normal, radius);
  ASSERT_TRUE(got);
  EXPECT_GT((middle - *camera.project(centre)).norm(), 0.5);
  EXPECT_LT((*got - middle).norm(), 0.01);
  EXPECT_FALSE(ellipse_middle(camera, {0, 0, -1}, normal, radius));
}

}  // namespace
}  // namespace raysteer::calib::target
