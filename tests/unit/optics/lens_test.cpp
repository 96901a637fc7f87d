#include "sim/optics/lens.hpp"

#include <gtest/gtest.h>

#include <random>

#include "calib/model/camera.hpp"
#include "tests/support/seed.hpp"

namespace raysteer::sim::optics {
namespace {

LensNumbers drawn(std::mt19937_64& random) {
  const auto normal = [&](double sigma) { return std::normal_distribution<double>(0, sigma)(random); };
  return {.focal_px = {1400 + normal(40), 1400 + normal(40)},
          .centre_px = {1224 + normal(20), 1024 + normal(20)},
          .distortion = {-0.03 + normal(0.02), normal(0.005), normal(5e-4), normal(5e-4), normal(1e-3)}};
}

// By hand: u = (0.5, -0.25), s = 0.3125; radial = 1 - 0.1*0.3125 + 0.02*0.09765625 + 0.004*0.030517578125
// = 0.97082519531250. x = 0.5*radial + 2*0.001*0.5*(-0.25) + 0.002*(0.3125 + 0.5) = 0.48678759765625;
// y = -0.25*radial + 0.001*(0.3125 + 0.125) + 2*0.002*0.5*(-0.25) = -0.242768798828125.
TEST(Lens, projects_a_point_as_worked_by_hand) {
  const Lens lens({.focal_px = {1000, 2000}, .centre_px = {10, 20}, .distortion = {-0.1, 0.02, 0.001, 0.002, 0.004}});
  const auto pixel = lens.project({1, -0.5, 2});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 496.78759765625, 1e-9);
  EXPECT_NEAR(pixel->y(), -465.53759765625, 1e-9);
}

TEST(Lens, ray_is_the_exact_inverse_of_project) {
  std::mt19937_64 random(support::seed());
  std::uniform_real_distribution<double> x(-0.5, 2447.5);
  std::uniform_real_distribution<double> y(-0.5, 2047.5);
  for (int i = 0; i < 200; ++i) {
    const Lens lens(drawn(random));
    if (!lens.covers(2448, 2048)) {
      continue;
    }
    const Eigen::Vector2d pixel(x(random), y(random));
    const Eigen::Vector3d ray = lens.ray(pixel);
    ASSERT_NEAR(ray.norm(), 1, 1e-12);
    const auto back = lens.project(3.5 * ray);
    ASSERT_TRUE(back);
    EXPECT_LT((*back - pixel).norm(), 1e-9);
  }
}

TEST(Lens, agrees_with_the_lens_that_calibrations_use) {
  std::mt19937_64 random(support::seed());
  std::uniform_real_distribution<double> side(-0.6, 0.6);
  for (int i = 0; i < 200; ++i) {
    const LensNumbers numbers = drawn(random);
    const auto [k1, k2, p1, p2, k3] = numbers.distortion;
    const calib::model::Camera model{.width = 2448,
                                     .height = 2048,
                                     .fx = numbers.focal_px.x(),
                                     .fy = numbers.focal_px.y(),
                                     .cx = numbers.centre_px.x(),
                                     .cy = numbers.centre_px.y(),
                                     .lens = calib::model::LensModel::kBc5,
                                     .k = {k1, k2, p1, p2, k3}};
    const Eigen::Vector3d p(side(random) * 3, side(random) * 3, 3);
    const auto here = Lens(numbers).project(p);
    const auto there = model.project(p);
    ASSERT_TRUE(here && there);
    EXPECT_LT((*here - *there).norm(), 1e-9);
  }
}

TEST(Lens, gives_no_pixel_behind_it_nor_beyond_the_fold) {
  // r (1 - r^2 / 3) stops growing at r = 1, where it is 2/3.
  const Lens lens({.focal_px = {100, 100}, .centre_px = {0, 0}, .distortion = {-1.0 / 3, 0, 0, 0, 0}});
  EXPECT_FALSE(lens.project({0, 0, -1}));
  EXPECT_FALSE(lens.project({0, 0, 0}));
  EXPECT_TRUE(lens.project({0.999, 0, 1}));
  EXPECT_FALSE(lens.project({1.001, 0, 1}));
  EXPECT_TRUE(lens.ray({66.6, 0}).allFinite());
  EXPECT_FALSE(lens.ray({66.7, 0}).allFinite());
}

TEST(Lens, says_whether_a_picture_has_a_ray_everywhere) {
  const Lens lens({.focal_px = {100, 100}, .centre_px = {44.5, 44.5}, .distortion = {-1.0 / 3, 0, 0, 0, 0}});
  EXPECT_TRUE(lens.covers(90, 90));
  EXPECT_FALSE(lens.covers(101, 101));
}

}  // namespace
}  // namespace raysteer::sim::optics
