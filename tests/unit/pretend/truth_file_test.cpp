#include "host/pretend/truth_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "calib/synth/noise.hpp"
#include "calib/synth/stage.hpp"

namespace raysteer::host::pretend {
namespace {

TEST(TruthFile, reads_back_to_the_same_numbers) {
  const auto pretend = calib::synth::pretend_rig(4);
  const TruthFile truth{4, pretend.rig(), calib::synth::scan_stage(pretend, 4).looks.front().scene};
  const auto back = truth_from_json(to_json(truth));
  ASSERT_TRUE(back.has_value());
  ASSERT_EQ(back->rig.devices.size(), 3U);
  EXPECT_EQ(back->seed, 4U);
  EXPECT_EQ(back->rig.devices[2].name, "projector");
  EXPECT_EQ(back->rig.devices[2].camera.cy, truth.rig.devices[2].camera.cy);
  EXPECT_EQ(back->rig.devices[1].camera.k, truth.rig.devices[1].camera.k);
  const Eigen::Vector3d p(0.03, -0.02, 0.91);
  EXPECT_NEAR(distance_to(back->scene, p), distance_to(truth.scene, p), 1e-14);
}

TEST(TruthFile, a_damaged_file_is_an_error) {
  EXPECT_EQ(truth_from_json("{").error().rcode, RCode::kBadValue);
  EXPECT_EQ(truth_from_json("{\"format\": 1}").error().rcode, RCode::kBadValue);
  EXPECT_EQ(truth_from_json("{\"format\": 2}").error().rcode, RCode::kBadValue);
}

TEST(TruthFile, surface_error_is_the_distance_to_the_nearest_surface) {
  calib::synth::Scene scene;
  calib::model::Pose wall;
  wall.t = {0, 0, 1};
  scene.plates.push_back(calib::synth::plate(wall, 1, 1, 0.5));
  scene.balls.push_back({{0, 0, 0.8}, 0.1, 0.5});
  const std::vector<Eigen::Vector3d> points{
      {0.4, 0.4, 1.003},        // 3 mm behind the wall
      {0, 0, 0.696},            // 4 mm before the ball
      {0.5 + 0.003, 0, 1.004},  // past the wall's edge
  };
  EXPECT_NEAR(surface_error({.seed = 0, .rig = {}, .scene = scene}, points).rms_m,
              std::sqrt((9e-6 + 16e-6 + 25e-6) / 3), 1e-12);
}

TEST(TruthFile, distance_to_a_triangle_is_that_to_its_nearest_corner_edge_or_inside) {
  const Triangle triangle{Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(3, 0, 1), Eigen::Vector3d(0, 3, 1)};
  EXPECT_DOUBLE_EQ(distance_to(triangle, {1, 1, 1.5}), 0.5);                 // above
  EXPECT_DOUBLE_EQ(distance_to(triangle, {1, -2, 1}), 2);                    // an edge
  EXPECT_DOUBLE_EQ(distance_to(triangle, {-2, 1, 1}), 2);                    // an edge
  EXPECT_NEAR(distance_to(triangle, {2.5, 2.5, 1}), std::sqrt(2.0), 1e-12);  // the slanted edge
  EXPECT_DOUBLE_EQ(distance_to(triangle, {-3, -4, 1}), 5);                   // a corner
  EXPECT_DOUBLE_EQ(distance_to(triangle, {6, -4, 1}), 5);                    // a corner
  EXPECT_DOUBLE_EQ(distance_to(triangle, {-3, 7, 1}), 5);                    // a corner
}

TEST(TruthFile, surfaces_of_the_pretend_rig_are_read_as_triangles) {
  const auto truth = truth_from_json(
      R"({"format":1,"seed":2,"devices":[],"meshes_complete":true,
          "meshes":[{"name":"floor","points_m":[[0,0,3],[1,0,3],[0,1,3]],"triangles":[[0,1,2]]}]})");
  ASSERT_TRUE(truth) << truth.error().message();
  ASSERT_EQ(truth->triangles.size(), 1U);
  const std::vector<Eigen::Vector3d> points{{0.2, 0.2, 3.002}, {0.3, 0.3, 2.998}};
  EXPECT_NEAR(surface_error(*truth, points).rms_m, 0.002, 1e-12);
  EXPECT_FALSE(
      truth_from_json(R"({"format":1,"seed":2,"devices":[],"meshes":[{"points_m":[],"triangles":[[0,1,2]]}]})"));
}

TEST(TruthFile, a_rig_off_by_its_own_covariance_has_a_chi_square_of_its_parameters) {
  const calib::model::Rig truth = calib::synth::pretend_rig(4).rig();
  constexpr int kTrials = 200;
  double sum = 0;
  int freedom = 0;
  calib::synth::Noise noise(9);
  for (int trial = 0; trial < kTrials; ++trial) {
    calib::model::Rig solved = truth;
    const int count = truth.offset(truth.devices.size());
    // Any covariance will do: A A^T with units that differ widely; one parameter is held fixed.
    Eigen::MatrixXd A(count, count);
    for (double& value : A.reshaped()) {
      value = 1e-4 * noise.normal();
    }
    A.row(2) *= 1e3;
    A.row(5).setZero();
    solved.covariance = A * A.transpose();
    Eigen::VectorXd z(count);
    for (double& value : z) {
      value = noise.normal();
    }
    const Eigen::VectorXd delta = A * z;
    for (std::size_t i = 0; i < truth.devices.size(); ++i) {
      solved.devices[i] = perturbed(truth.devices[i], delta.segment(truth.offset(i), truth.count(i)), i > 0);
    }
    const auto error = rig_error(solved, truth);
    ASSERT_TRUE(error.has_value());
    sum += error->chi_square;
    freedom += error->degrees_of_freedom;
    EXPECT_EQ(error->degrees_of_freedom, count - 1);
    EXPECT_NEAR(error->baseline_m,
                std::abs(solved.devices[1].T_device_rig.t.norm() - truth.devices[1].T_device_rig.t.norm()), 1e-12);
  }
  EXPECT_NEAR(sum / freedom, 1, 5 * std::sqrt(2.0 / freedom));
}

}  // namespace
}  // namespace raysteer::host::pretend
