#include "calib/steer/room.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/floor_task.hpp"
#include "tests/support/seed.hpp"

namespace raysteer::calib::steer {
namespace {

std::vector<RoomPoint> datums(const support::SteerTrial& trial, Noise& noise) {
  std::vector<RoomPoint> points;
  for (int k = 0; k < 12; ++k) {
    RoomPoint point{.p_room = {k % 4 - 1.2, 1.5 * (k / 4) - 1.5, support::kFloorDepth},  // NOLINT
                    .covariance = Eigen::Matrix3d::Zero(),
                    .q = {},
                    .cov_q = {}};
    for (std::size_t eye = 0; eye < 2; ++eye) {
      point.q[eye] = *trial.rig().truth.rig.cameras[eye].project(point.p_room) + support::ideal::normals(noise, 0.1);
      point.cov_q[eye] = 0.01 * Eigen::Matrix2d::Identity();
    }
    points.push_back(point);
  }
  return points;
}

class Room : public testing::Test {
 protected:
  Room() : board_(support::planned_board("mock-galvo", 9, 20e-6, 7)), trial_(board_, support::seed(), {.points = 25}) {}
  /// Root mean square of the cameras' absolute errors over the floor: true places through pose and camera.
  static double misses_px(const support::SteerTrial& trial, const InRoom& rig) {
    double sum = 0;
    int count = 0;
    for (double x = -1.8; x < 2; x += 0.6) {
      for (double y = -1.5; y < 1.6; y += 0.6) {
        const Eigen::Vector3d p(x, y, support::kFloorDepth);
        for (std::size_t eye = 0; eye < 2; ++eye) {
          const model::Device& device = rig.solution.cameras.devices[eye];
          const auto q = device.camera.project(device.T_device_rig * (rig.T_rig_room * p));
          sum += (*q - *trial.rig().truth.rig.cameras[eye].project(p)).squaredNorm();
          ++count;
        }
      }
    }
    return std::sqrt(sum / count);
  }
  support::PlannedBoard board_;
  support::SteerTrial trial_;
};

TEST_F(Room, datums_correct_what_the_cameras_are_off_by) {
  ASSERT_TRUE(trial_.solution()) << trial_.solution().error().message();
  double rigid = 0;
  double joint = 0;
  for (std::uint64_t k = 0; k < 5; ++k) {
    const support::SteerTrial trial(board_, support::seed() + k, {.points = 25});
    ASSERT_TRUE(trial.solution());
    Noise noise(support::seed(), k);
    const auto points = datums(trial, noise);
    const auto tied = tie_to_room(*trial.solution(), points, {});
    // Cameras that count as exact leave the pose alone to be found.
    Solution exact = *trial.solution();
    exact.cameras.covariance.setZero();
    const auto alone = tie_to_room(exact, points, {});
    ASSERT_TRUE(tied && alone);
    EXPECT_LT(tied->whitened_rms, 1.7);
    rigid += std::pow(misses_px(trial, *alone), 2) / 5;
    joint += std::pow(misses_px(trial, *tied), 2) / 5;
  }
  std::printf("cameras miss places in the room by %.3f px with a rigid fit, by %.3f px adjusted with it\n",
              std::sqrt(rigid), std::sqrt(joint));
  EXPECT_LT(joint, rigid / 2);
}

TEST_F(Room, covariances_shrink_and_stay_symmetric) {
  ASSERT_TRUE(trial_.solution());
  Noise noise(support::seed());
  const auto tied = tie_to_room(*trial_.solution(), datums(trial_, noise), {});
  ASSERT_TRUE(tied);
  const Eigen::MatrixXd& before = trial_.solution()->covariance;
  const Eigen::MatrixXd& after = tied->covariance;
  ASSERT_EQ(after.rows(), before.rows() + 6);
  EXPECT_TRUE((after.diagonal().head(before.rows()).array() <= before.diagonal().array() * (1 + 1e-9)).all());
  EXPECT_GT(after.diagonal().minCoeff(), 0);
  EXPECT_LT((after - after.transpose()).cwiseAbs().maxCoeff(), 1e-9 * after.cwiseAbs().maxCoeff());
}

TEST_F(Room, bad_datums_are_refused) {
  ASSERT_TRUE(trial_.solution());
  Noise noise(support::seed());
  auto points = datums(trial_, noise);
  const auto code = [&](const std::vector<RoomPoint>& some, const model::Pose& start) {
    const auto tied = tie_to_room(*trial_.solution(), some, start);
    return tied ? RCode::kNone : tied.error().rcode;
  };
  EXPECT_EQ(code({points.begin(), points.begin() + 3}, {}), RCode::kDatumsMissing);
  EXPECT_EQ(code(points, {.t = {0, 0, -10}}), RCode::kRigNotSolved);
  points[2].q[1].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code(points, {}), RCode::kNotFinite);
}

}  // namespace
}  // namespace raysteer::calib::steer
