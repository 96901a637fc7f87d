#include "host/exchange/exports.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <opencv2/core.hpp>
#include <sstream>
#include <string>

namespace raysteer::host::exchange {
namespace {

using calib::model::Camera;
using calib::model::Device;
using calib::model::DeviceKind;
using calib::model::LensModel;
using calib::model::Pose;
using calib::model::Rig;

// Three cameras in a row on the rig's x axis, each turned a little more, and a projector between.
Rig three_cameras() {
  Rig rig;
  for (int i = 0; i < 4; ++i) {
    Device device;
    device.name = i == 2 ? "beamer" : "cam " + std::to_string(i);
    device.kind = i == 2 ? DeviceKind::kProjector : DeviceKind::kCamera;
    device.camera = {640, 480, 800.25 + i, 801, 320.5, 241, LensModel::kBc5, {-0.2, 0.05, 1e-3, -2e-3, 0.01}};
    const Pose T_rig_device{Eigen::Quaterniond(Eigen::AngleAxisd(0.1 * i, Eigen::Vector3d::UnitY())),
                            {0.2 * i, 0.01 * i, 0}};
    device.T_device_rig = T_rig_device.inverse();
    rig.devices.push_back(device);
  }
  return rig;
}

TEST(OpenCvYaml, is_read_by_file_storage) {
  const Rig rig = three_cameras();
  const cv::FileStorage file(to_opencv_yaml(rig), cv::FileStorage::READ | cv::FileStorage::MEMORY);
  for (const Device& device : rig.devices) {
    std::string name = device.name;
    std::ranges::replace(name, ' ', '_');
    cv::Mat K, k, R, T;
    file[name + "_camera_matrix"] >> K;
    file[name + "_distortion"] >> k;
    file[name + "_R"] >> R;
    file[name + "_T"] >> T;
    EXPECT_EQ(static_cast<int>(file[name + "_width"]), 640);
    EXPECT_EQ(static_cast<int>(file[name + "_height"]), 480);
    ASSERT_EQ(K.size(), cv::Size(3, 3)) << name;
    EXPECT_EQ(K.at<double>(0, 0), device.camera.fx);
    EXPECT_EQ(K.at<double>(1, 2), device.camera.cy);
    ASSERT_EQ(k.size(), cv::Size(5, 1));
    EXPECT_EQ(k.at<double>(0, 4), device.camera.k[4]);
    ASSERT_EQ(R.size(), cv::Size(3, 3));
    ASSERT_EQ(T.size(), cv::Size(1, 3));
    // A point of the rig through R and T is the point in the device.
    const Eigen::Vector3d p(0.3, -0.2, 1.5);
    const cv::Mat q = R * (cv::Mat_<double>(3, 1) << p.x(), p.y(), p.z()) + T;
    const Eigen::Vector3d expected = device.T_device_rig * p;
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(q.at<double>(i), expected[i], 1e-12);
    }
  }
}

// The numbers of the four lines after `key` in camera `cam`.
Eigen::Matrix4d matrix_of(const std::string& text, const std::string& cam, const std::string& key) {
  std::size_t at = text.find(cam + ":");
  EXPECT_NE(at, std::string::npos);
  at = text.find(key + ":", at);
  EXPECT_NE(at, std::string::npos);
  std::istringstream lines(text.substr(text.find('\n', at) + 1));
  Eigen::Matrix4d matrix;
  for (int row = 0; row < 4; ++row) {
    std::string line;
    std::getline(lines, line);
    std::ranges::replace(line, ',', ' ');
    std::istringstream numbers(line.substr(line.find('[') + 1));
    numbers >> matrix(row, 0) >> matrix(row, 1) >> matrix(row, 2) >> matrix(row, 3);
  }
  return matrix;
}

TEST(KalibrCamchain, takes_points_of_the_camera_before_to_this_one) {
  const Rig rig = three_cameras();
  const std::string text = to_kalibr_camchain(rig);
  // cam0, cam1, cam2 are devices 0, 1 and 3: the projector is none of Kalibr's.
  EXPECT_EQ(text.find("cam3:"), std::string::npos);
  EXPECT_EQ(text.find("beamer"), std::string::npos);
  const Eigen::Matrix4d T_c1_c0 = matrix_of(text, "cam1", "T_cn_cnm1");
  const Eigen::Matrix4d T_c2_c1 = matrix_of(text, "cam2", "T_cn_cnm1");
  const Eigen::Vector3d p(0.1, 0.2, 2);  // in the rig, that is in cam0
  const Eigen::Vector4d in_1 = T_c1_c0 * p.homogeneous();
  const Eigen::Vector4d in_2 = T_c2_c1 * in_1;
  EXPECT_LT((in_1.head<3>() - rig.devices[1].T_device_rig * p).norm(), 1e-12);
  EXPECT_LT((in_2.head<3>() - rig.devices[3].T_device_rig * p).norm(), 1e-12);
  // cam1 stands to the right of cam0, so cam0's origin has negative x in cam1: the direction users get wrong.
  EXPECT_LT(T_c1_c0(0, 3), 0);
}

TEST(KalibrCamchain, says_how_far_radtan_is_from_a_richer_lens) {
  Rig rig = three_cameras();
  EXPECT_NE(to_kalibr_camchain(rig).find("radtan fitted to the lens model bc5"), std::string::npos);
  for (Device& device : rig.devices) {
    device.camera.lens = LensModel::kBc4;
    device.camera.k[4] = 0;
  }
  const std::string text = to_kalibr_camchain(rig);
  EXPECT_EQ(text.find("fitted"), std::string::npos);
  EXPECT_NE(text.find("distortion_coeffs: [-0.2, 0.05, 0.001, -0.002]"), std::string::npos) << text;
  EXPECT_NE(text.find("intrinsics: [800.25, 801.0, 320.5, 241.0]"), std::string::npos) << text;
}

}  // namespace
}  // namespace raysteer::host::exchange
