#include "calib/solve/solve.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/solver_case.hpp"

namespace raysteer::calib::solve {
namespace {

using support::Devices;
using support::normalised_error_squared;
using support::parameter_error;
using support::solver_case;

SolveOptions bc4() {
  SolveOptions options;
  options.lens = model::LensModel::kBc4;
  return options;
}

void expect_code(const Result<Solution>& result, RCode rcode) {
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().rcode, rcode) << result.error().message();
}

TEST(Solve, recovers_each_kind_of_rig_within_its_own_sigma) {
  for (const Devices devices : {Devices::kMono, Devices::kStereo, Devices::kProjector}) {
    const auto known = solver_case(devices, 11);
    const auto solution = solve(known.observations, bc4());
    ASSERT_TRUE(solution) << solution.error().message();
    const Eigen::VectorXd error = parameter_error(*solution, known.truth);
    const Eigen::VectorXd sigma = solution->rig.covariance.diagonal().cwiseSqrt();
    for (Eigen::Index i = 0; i < error.size(); ++i) {
      EXPECT_LT(std::abs(error[i]), 5 * sigma[i]) << solution->rig.parameters[static_cast<std::size_t>(i)];
    }
    EXPECT_NEAR(solution->whitened_rms, 1, 0.05);
    EXPECT_NEAR(solution->devices[0].sigma_px, 0.1, 0.01);
    EXPECT_GT(solution->devices[0].kept_share(), 0.99);
  }
}

// The short form of bench/campaign_solve.cpp: seeds are printed when it fails.
TEST(Solve, parameter_errors_are_as_large_as_the_covariance_says) {
  double sum = 0;
  double freedom = 0;
  constexpr std::uint64_t kFirst = 1000;
  constexpr int kTrials = 12;
  for (std::uint64_t seed = kFirst; seed < kFirst + kTrials; ++seed) {
    const auto known = solver_case(Devices::kStereo, seed, 8);
    const auto solution = solve(known.observations, bc4());
    ASSERT_TRUE(solution) << "seed " << seed << ": " << solution.error().message();
    sum += normalised_error_squared(*solution, known.truth);
    freedom += static_cast<double>(solution->rig.covariance.rows());
  }
  EXPECT_GT(sum, support::chi_square_quantile(freedom, -support::kSigma9999)) << "seeds from " << kFirst;
  EXPECT_LT(sum, support::chi_square_quantile(freedom, support::kSigma9999)) << "seeds from " << kFirst;
}

TEST(Solve, the_projectors_focal_length_does_not_depend_on_the_start) {
  const auto known = solver_case(Devices::kProjector, 21, 6);
  const auto reference = solve(known.observations, bc4());
  ASSERT_TRUE(reference) << reference.error().message();
  for (const double start : {1000.0, 2500.0, 4000.0, 8000.0}) {
    SolveOptions options = bc4();
    options.projector_start_px = start;
    const auto solution = solve(known.observations, options);
    ASSERT_TRUE(solution) << start << ": " << solution.error().message();
    EXPECT_NEAR(solution->rig.devices[1].camera.fx, reference->rig.devices[1].camera.fx, 0.01) << start;
    EXPECT_NEAR(solution->rig.devices[1].camera.cy, reference->rig.devices[1].camera.cy, 0.05) << start;
  }
}

TEST(Solve, outliers_are_left_out_and_change_nothing) {
  auto known = solver_case(Devices::kMono, 31);
  for (std::size_t v = 0; v < known.observations.views.size(); ++v) {
    known.observations.views[v].corners[0][5 + v].q += Eigen::Vector2d(6, -4);
  }
  const auto solution = solve(known.observations, bc4());
  ASSERT_TRUE(solution) << solution.error().message();
  const DeviceFit& fit = solution->devices[0];
  EXPECT_NEAR(fit.corners_seen - fit.corners_kept, static_cast<int>(known.observations.views.size()), 2);
  EXPECT_NEAR(fit.sigma_px, 0.1, 0.01);
}

TEST(Solve, a_bent_boards_sag_is_found) {
  auto known = solver_case(Devices::kStereo, 41);
  // Bend the board by 0.4 mm: what the devices see moves accordingly.
  const Eigen::Vector2d sag(0.0004, -0.0002);
  const auto straight = solve(known.observations, bc4());
  ASSERT_TRUE(straight);
  for (std::size_t v = 0; v < known.observations.views.size(); ++v) {
    for (std::size_t d = 0; d < 2; ++d) {
      const model::Device& device = known.truth.devices[d];
      for (target::Corner& corner : known.observations.views[v].corners[d]) {
        const model::Pose T = device.T_device_rig * straight->views[v].T_rig_target;
        const Eigen::Vector3d flat = target::corner_position(known.observations.target, corner.id);
        corner.q += *device.camera.project(T * target_point(known.observations.target, sag, corner.id)) -
                    *device.camera.project(T * flat);
      }
    }
  }
  const auto solution = solve(known.observations, bc4());
  ASSERT_TRUE(solution) << solution.error().message();
  EXPECT_LT(std::abs(solution->sag_m.x() - sag.x()), 5 * solution->sag_sigma_m.x());
  EXPECT_LT(std::abs(solution->sag_m.y() - sag.y()), 5 * solution->sag_sigma_m.y());
  EXPECT_LT(solution->sag_sigma_m.maxCoeff(), 0.0001);
}

TEST(Solve, a_view_of_another_board_is_named_and_left_out) {
  auto known = solver_case(Devices::kStereo, 51);
  // A board with squares 10 % higher: no pose makes it fit.
  for (std::size_t d = 0; d < 2; ++d) {
    auto& corners = known.observations.views[4].corners[d];
    const Eigen::Vector2d first = corners.front().q;
    for (target::Corner& corner : corners) {
      corner.q.y() = first.y() + 1.1 * (corner.q.y() - first.y());
    }
  }
  const auto solution = solve(known.observations, bc4());
  ASSERT_TRUE(solution) << solution.error().message();
  for (std::size_t v = 0; v < solution->views.size(); ++v) {
    EXPECT_EQ(solution->views[v].used, v != 4) << solution->views[v].why_note;
  }
  EXPECT_EQ(solution->views[4].why, RCode::kForeignView);
}

TEST(Solve, a_camera_nudged_half_way_is_named_with_the_view) {
  auto known = solver_case(Devices::kStereo, 61);
  const auto nudged = [&] {
    model::Rig rig = known.truth;
    rig.devices[1].T_device_rig.q = model::rotation_by({0.004, -0.003, 0.001}) * rig.devices[1].T_device_rig.q;
    return rig;
  }();
  const auto straight = solve(known.observations, bc4());
  ASSERT_TRUE(straight);
  for (std::size_t v = 7; v < known.observations.views.size(); ++v) {
    for (target::Corner& corner : known.observations.views[v].corners[1]) {
      const Eigen::Vector3d p =
          straight->views[v].T_rig_target * target::corner_position(known.observations.target, corner.id);
      corner.q += *nudged.devices[1].camera.project(nudged.devices[1].T_device_rig * p) -
                  *known.truth.devices[1].camera.project(known.truth.devices[1].T_device_rig * p);
    }
  }
  const auto solution = solve(known.observations, bc4());
  expect_code(solution, RCode::kCameraMovedDuringCapture);
  EXPECT_NE(solution.error().note.find("'view6' and view 'view7'"), std::string::npos) << solution.error().note;
}

TEST(Solve, a_board_read_from_the_other_end_by_one_camera_is_turned_back) {
  auto known = solver_case(Devices::kStereo, 71);
  TargetSpec& target = known.observations.target;
  target.rows = 7;  // 9 x 7 looks the same from both ends; only 6 rows of it were seen
  for (const std::size_t v : {2U, 5U}) {
    for (target::Corner& corner : known.observations.views[v].corners[1]) {
      corner.id = target.corners() - 1 - corner.id;
    }
  }
  const auto solution = solve(known.observations, bc4());
  ASSERT_TRUE(solution) << solution.error().message();
  EXPECT_TRUE(solution->views[2].used && solution->views[5].used);
  EXPECT_LT(solution->rms_px, 0.2);
}

TEST(Solve, a_board_that_was_never_tilted_is_refused) {
  auto known = solver_case(Devices::kMono, 81);
  const model::Camera& camera = known.truth.devices[0].camera;
  for (std::size_t v = 0; v < known.observations.views.size(); ++v) {
    const auto s = static_cast<double>(v);
    const model::Pose pose{Eigen::Quaterniond(Eigen::AngleAxisd(0.1 * s, Eigen::Vector3d::UnitZ())),
                           {-0.15 + 0.02 * s, -0.1, 0.8 + 0.03 * s}};
    for (target::Corner& corner : known.observations.views[v].corners[0]) {
      corner.q = *camera.project(pose * target::corner_position(known.observations.target, corner.id));
    }
  }
  expect_code(solve(known.observations, bc4()), RCode::kCoplanarViews);
}

TEST(Solve, three_views_are_too_few) {
  auto known = solver_case(Devices::kMono, 91);
  known.observations.views.resize(3);
  expect_code(solve(known.observations, bc4()), RCode::kTooFewViews);
}

TEST(Solve, a_board_without_scale_is_refused) {
  auto known = solver_case(Devices::kMono, 101);
  known.observations.target.square_m = 0;
  expect_code(solve(known.observations, bc4()), RCode::kTargetScaleMissing);
}

TEST(Solve, a_corner_that_is_not_a_number_is_refused) {
  auto known = solver_case(Devices::kMono, 111);
  known.observations.views[2].corners[0][3].q.x() = std::numeric_limits<double>::quiet_NaN();
  expect_code(solve(known.observations, bc4()), RCode::kNotFinite);
}

TEST(Solve, a_mirrored_panel_is_refused) {
  auto known = solver_case(Devices::kProjector, 21, 6);
  for (View& view : known.observations.views) {
    for (target::Corner& corner : view.corners[1]) {
      corner.q.x() = 1023 - corner.q.x();
    }
    view.pixels.clear();
  }
  expect_code(solve(known.observations, bc4()), RCode::kMirroredTarget);
}

TEST(Solve, the_simple_lens_model_is_chosen_when_it_is_true) {
  const auto known = solver_case(Devices::kMono, 131);
  const auto solution = solve(known.observations);
  ASSERT_TRUE(solution) << solution.error().message();
  EXPECT_EQ(solution->rig.devices[0].camera.lens, model::LensModel::kBc4);
  EXPECT_EQ(solution->lenses.size(), 3U);
}

}  // namespace
}  // namespace raysteer::calib::solve
