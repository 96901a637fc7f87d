#include "calib/look/solve_look.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/pretend_look.hpp"
#include "tests/support/seed.hpp"

namespace raysteer::calib::look {
namespace {

/// Corners of a board that lies beside the discs, and the middles of the discs' light, with noise.
void measure(support::PretendLook& look, double corner_sigma, double disc_sigma, std::mt19937_64& random) {
  std::normal_distribution<double> noise;
  const auto noisy = [&](const Eigen::Vector2d& q, double sigma) {
    return Eigen::Vector2d(q + sigma * Eigen::Vector2d(noise(random), noise(random)));
  };
  for (std::size_t eye = 0; eye < 2; ++eye) {
    Sight& sight = look.input.sights[eye];
    for (int id = 0; id < look.input.target.corners(); ++id) {
      const auto q = support::seen(look, eye, target::corner_position(look.input.target, id).head<2>());
      sight.corners.push_back({id, noisy(*q, corner_sigma), std::max(corner_sigma, 0.01)});
    }
    for (int id = 0; id < look.input.grid.discs(); ++id) {
      // The mean over the camera's area: samples on a fine grid of the panel, each with its area in the camera.
      Eigen::Vector2d sum = Eigen::Vector2d::Zero();
      double area = 0;
      const double radius = look.input.grid.radius_px;
      for (double y = -radius; y <= radius; y += 0.125 * radius) {
        for (double x = -radius; x <= radius; x += 0.125 * radius) {
          if (std::hypot(x, y) <= 1.001 * radius) {
            const auto at = [&](double dx, double dy) {
              return *support::seen(
                  look, eye, *look.truth.panel.on_plane(look.input.grid.centre(id) + Eigen::Vector2d(x + dx, y + dy)));
            };
            const Eigen::Vector2d right = at(0.5, 0) - at(-0.5, 0);
            const Eigen::Vector2d down = at(0, 0.5) - at(0, -0.5);
            const double weight = std::abs(right.x() * down.y() - right.y() * down.x());
            sum += weight * at(0, 0);
            area += weight;
          }
        }
      }
      sight.discs.push_back({id, noisy(sum / area, disc_sigma), std::max(disc_sigma, 0.01), 10});
    }
  }
}

double worst_miss(const Solution& solution, const Solution& truth) {
  double worst = 0;
  for (const Eigen::Vector2d& x : {Eigen::Vector2d(60, 40), Eigen::Vector2d(580, 40), Eigen::Vector2d(580, 360),
                                   Eigen::Vector2d(60, 360), Eigen::Vector2d(320, 200)}) {
    worst = std::max(worst, (*solution.panel.on_plane(x) - *truth.panel.on_plane(x)).norm());
  }
  return worst;
}

TEST(SolveLook, finds_the_truth_of_exact_measurements_with_and_without_a_mirror) {
  for (const bool mirrored : {false, true}) {
    std::mt19937_64 random(support::seed());
    support::PretendLook look = support::pretend_look(random, mirrored);
    measure(look, 0, 0, random);
    const auto solution = solve_look(look.input);
    ASSERT_TRUE(solution) << solution.error().message();
    EXPECT_EQ(solution->panel.mirrored, mirrored);
    // What remains is the weak prior's pull on the lens and the sampling of the discs' light.
    EXPECT_LT(worst_miss(*solution, look.truth), 2e-5);
    EXPECT_LT((solution->T_rig_plane.t - look.truth.T_rig_plane.t).norm(), 1e-5);
  }
}

TEST(SolveLook, misses_by_what_its_covariance_says) {
  std::mt19937_64 random(support::seed());
  double chi_square = 0;
  constexpr int kTrials = 8;
  for (int trial = 0; trial < kTrials; ++trial) {
    support::PretendLook look = support::pretend_look(random, trial % 2 == 0);
    measure(look, 0.05, 0.05, random);
    const auto solution = solve_look(look.input);
    ASSERT_TRUE(solution) << solution.error().message();
    // Where a panel pixel lands on the plane, by differences.
    const Eigen::Vector2d x(560, 60);
    Eigen::Matrix<double, 2, kUnknowns> J;
    for (int i = 0; i < kUnknowns; ++i) {
      const double step = i >= 12 && i < 16 ? 1e-3 : 1e-6;
      Eigen::Matrix<double, kUnknowns, 1> delta = step * Eigen::Matrix<double, kUnknowns, 1>::Unit(i);
      J.col(i) = (*perturbed(*solution, delta).panel.on_plane(x) - *perturbed(*solution, -delta).panel.on_plane(x)) /
                 (2 * step);
    }
    const Eigen::Matrix2d covariance = J * solution->covariance * J.transpose();
    const Eigen::Vector2d miss = *solution->panel.on_plane(x) - *look.truth.panel.on_plane(x);
    chi_square += miss.dot(covariance.ldlt().solve(miss));
  }
  // 16 degrees of freedom: the 0.0001 quantiles are 3.1 and 46.9.
  EXPECT_GT(chi_square, 3);
  EXPECT_LT(chi_square, 47);
}

TEST(SolveLook, leaves_out_a_disc_that_is_somewhere_else) {
  std::mt19937_64 random(support::seed());
  support::PretendLook look = support::pretend_look(random, true);
  measure(look, 0.03, 0.03, random);
  look.input.sights[0].discs[5].q += Eigen::Vector2d(3, -2);
  const auto solution = solve_look(look.input);
  ASSERT_TRUE(solution) << solution.error().message();
  EXPECT_GE(solution->left_out, 1);
  EXPECT_LT(worst_miss(*solution, look.truth), 3e-3);
}

TEST(SolveLook, refuses_a_look_without_a_board) {
  std::mt19937_64 random(support::seed());
  support::PretendLook look = support::pretend_look(random, false);
  measure(look, 0.03, 0.03, random);
  for (Sight& sight : look.input.sights) {
    sight.corners.clear();
  }
  const auto solution = solve_look(look.input);
  ASSERT_FALSE(solution);
  EXPECT_EQ(solution.error().rcode, RCode::kTooFewCorrespondences);
}

TEST(SolveLook, refuses_discs_that_lie_on_another_surface) {
  std::mt19937_64 random(support::seed());
  support::PretendLook look = support::pretend_look(random, false);
  measure(look, 0.03, 0.03, random);
  // As if the right camera had been moved: its discs and corners do not fit the left one's.
  std::uniform_real_distribution<double> anywhere(-30, 30);
  for (target::Disc& disc : look.input.sights[1].discs) {
    disc.q += Eigen::Vector2d(anywhere(random), anywhere(random));
  }
  const auto solution = solve_look(look.input);
  ASSERT_FALSE(solution);
  EXPECT_EQ(solution.error().rcode, RCode::kLookNotSolved);
}

}  // namespace
}  // namespace raysteer::calib::look
