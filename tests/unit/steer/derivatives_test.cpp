// What the solve knows of slopes, against differences.
#include <gtest/gtest.h>

#include "calib/model/steered_look.hpp"
#include "tests/support/ideal_rig.hpp"
#include "tests/support/seed.hpp"
#include "tests/unit/steer/boards.hpp"

namespace raysteer::calib::model {
namespace {

class Derivatives : public testing::TestWithParam<const char*> {};

TEST_P(Derivatives, of_a_pixel_are_those_of_differences) {
  Noise noise(support::seed());
  for (int trial = 0; trial < 5; ++trial) {
    const auto rig = *support::draw_ideal(support::board_named(GetParam()), noise.bits());
    const SteeredProjector& projector = rig.projector;
    const Eigen::Vector2d command = support::between(projector, noise.uniform(), noise.uniform());
    const Eigen::Vector2d latent(1e-3, -2e-3);
    const SteeredLook look(projector, command, latent);
    const Eigen::Vector3d away = *look.view().ray({noise.uniform(0, 1920), noise.uniform(0, 1200)});
    const Eigen::Vector3d p = look.view().centre() + 3.7 * away;
    PixelDerivatives by;
    const auto pixel = look.project(p, by);
    ASSERT_TRUE(pixel);
    ASSERT_LT((*pixel - *projector.at_angles(projector.angles(command) + latent).project(p)).norm(), 1e-9);
    const auto slope = [&](auto&& at, double step) -> Eigen::Vector2d { return (*at(step) - *at(-step)) / (2 * step); };
    const int count = steered_parameters(projector.kind);
    ASSERT_EQ(by.by_parameters.cols(), count);
    for (int k = 0; k < count; ++k) {
      const Eigen::Vector2d expected = slope(
          [&](double step) {
            const auto moved = perturbed(projector, step * Eigen::VectorXd::Unit(count, k));
            return SteeredLook(moved, command, latent).project(p);
          },
          k < 4 ? 1e-3 : 1e-6);
      EXPECT_LT((by.by_parameters.col(k) - expected).norm(), 1e-6 * (1 + expected.norm()))
          << GetParam() << " " << steered_parameter_names(projector.kind)[static_cast<std::size_t>(k)];
    }
    for (int k = 0; k < 2; ++k) {
      const Eigen::Vector2d expected = slope(
          [&](double step) {
            return SteeredLook(projector, command, latent + step * Eigen::Vector2d::Unit(k)).project(p);
          },
          1e-6);
      EXPECT_LT((by.by_angles.col(k) - expected).norm(), 1e-6 * expected.norm());
    }
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector2d expected =
          slope([&](double step) { return look.project(p + step * Eigen::Vector3d::Unit(k)); }, 1e-6);
      EXPECT_LT((by.by_point.col(k) - expected).norm(), 1e-6 * (1 + expected.norm()));
    }
  }
}

TEST_P(Derivatives, a_departure_is_what_perturbed_was_given) {
  Noise noise(support::seed());
  const auto rig = *support::draw_ideal(support::board_named(GetParam()), noise.bits());
  const int count = steered_parameters(rig.projector.kind);
  Eigen::VectorXd delta(count);
  for (int k = 0; k < count; ++k) {
    delta[k] = noise.uniform(-0.05, 0.05);
  }
  EXPECT_LT((departure(rig.projector, perturbed(rig.projector, delta)) - delta).norm(), 1e-12);
  EXPECT_EQ(steered_parameter_names(rig.projector.kind).size(), static_cast<std::size_t>(count));
}

INSTANTIATE_TEST_SUITE_P(Boards, Derivatives, testing::Values("mock-galvo", "mock-head"));

TEST(ByLens, is_that_of_differences_for_every_lens_model) {
  for (const LensModel lens : {LensModel::kBc4, LensModel::kBc5, LensModel::kBc8}) {
    Device device;
    device.camera = {.width = 2448, .height = 2048, .fx = 1400, .fy = 1390, .cx = 1200, .cy = 1000};
    device.camera.lens = lens;
    device.camera.k = {-0.1, 0.02, 1e-3, -2e-3, 0.01, 0.02, -0.01, 0.005};
    for (auto k = static_cast<std::size_t>(coefficients(lens)); k < 8; ++k) {
      device.camera.k[k] = 0;
    }
    const Eigen::Vector2d n(0.4, -0.3);
    const auto by = by_lens(device.camera, n);
    ASSERT_EQ(by.cols(), 4 + coefficients(lens));
    for (int k = 0; k < by.cols(); ++k) {
      const Eigen::VectorXd step = 1e-5 * Eigen::VectorXd::Unit(by.cols(), k);
      const Eigen::Vector2d slope = (*perturbed(device, step, false).camera.project(n.homogeneous()) -
                                     *perturbed(device, -step, false).camera.project(n.homogeneous())) /
                                    2e-5;
      EXPECT_LT((by.col(k) - slope).norm(), 1e-6 * (1 + slope.norm())) << k;
    }
  }
}

}  // namespace
}  // namespace raysteer::calib::model
