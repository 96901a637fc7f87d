// Rendered boards, from pixels to parameters: is the truth where the calibration says it is?
#include <cmath>

#include "tests/contract/cli/bad_input.hpp"

namespace raysteer::bad_input {
namespace {

/// The value that a chi-square variable exceeds once in 10 000 times (Wilson and Hilferty, 1931).
double rarely_exceeded(double freedom) {
  constexpr double kNormal = 3.719;
  const double spread = 2 / (9 * freedom);
  return freedom * std::pow(1 - spread + kNormal * std::sqrt(spread), 3);
}

void expect_truth_within_covariance(const std::vector<std::string>& words) {
  const Outcome outcome = run_raysteer(words);
  ASSERT_TRUE(outcome.json.contains("truth")) << outcome.printed;
  const nlohmann::json& truth = outcome.json["truth"];
  const double freedom = truth["degrees_of_freedom"];
  EXPECT_LT(truth["chi_square"].get<double>(), rarely_exceeded(freedom)) << truth.dump(2);
  // No lower bound by chance: corners are rendered sharper than the solve's floor of 0.05 px believes.
  EXPECT_GT(truth["chi_square"].get<double>(), 0.05 * freedom) << truth.dump(2);
  EXPECT_LT(truth["focal_relative"].get<double>(), 0.005) << truth.dump(2);
  EXPECT_LT(truth["baseline_m"].get<double>(), 0.001) << truth.dump(2);
}

TEST(Truth, cameras_are_where_their_calibration_says_within_its_own_covariance) {
  expect_truth_within_covariance({"calibrate", "cameras", (cameras_session() / "session.toml").string(), "--json"});
}

TEST(Truth, camera_and_projector_are_where_their_calibration_says_within_its_own_covariance) {
  expect_truth_within_covariance({"calibrate", "projector", (projector_session() / "session.toml").string(), "--json"});
}

}  // namespace
}  // namespace raysteer::bad_input
