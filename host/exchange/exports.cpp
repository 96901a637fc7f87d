#include "host/exchange/exports.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "host/exchange/number_text.hpp"

namespace raysteer::host::exchange {
namespace {

using calib::model::Camera;
using calib::model::Device;
using calib::model::DeviceKind;
using calib::model::Pose;
using calib::model::Rig;

// Keys of FileStorage are words.
std::string word(std::string_view name) {
  std::string safe;
  for (const char letter : name) {
    safe += std::isalnum(static_cast<unsigned char>(letter)) != 0 ? letter : '_';
  }
  return safe.empty() || std::isdigit(static_cast<unsigned char>(safe.front())) != 0 ? "_" + safe : safe;
}

template <class Values>
std::string row(const Values& values) {
  std::string text;
  for (const double value : values) {
    text += (text.empty() ? "" : ", ") + exact(value);
  }
  return "[" + text + "]";
}

std::string opencv_matrix(const std::string& key, const Eigen::MatrixXd& matrix) {
  std::vector<double> values;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
      values.push_back(matrix(i, j));
    }
  }
  return fmt::format("{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: {}\n", key, matrix.rows(),
                     matrix.cols(), row(values));
}

Eigen::Matrix4d matrix(const Pose& pose) {
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T.topLeftCorner<3, 3>() = pose.rotation();
  T.topRightCorner<3, 1>() = pose.t;
  return T;
}

struct RadTan {
  std::array<double, 4> k;
  double worst_px;  // against the lens model as solved, over the image
};

// k1 k2 p1 p2 that come nearest to the lens over the image: a linear fit, since the model is linear in them.
RadTan fit_radtan(const Camera& camera) {
  RadTan fit{{camera.k[0], camera.k[1], camera.k[2], camera.k[3]}, 0};
  if (camera.lens == calib::model::LensModel::kBc4) {
    return fit;
  }
  constexpr int kSteps = 24;
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  std::vector<Eigen::Vector2d> places;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      const Eigen::Vector2d q(camera.width * (i / double{kSteps}) - 0.5, camera.height * (j / double{kSteps}) - 0.5);
      const std::optional<Eigen::Vector2d> n = camera.normalize(q);
      if (!n) {
        continue;  // beyond the lens model
      }
      const double x = n->x(), y = n->y(), s = n->squaredNorm();
      Eigen::Matrix<double, 2, 4> by_k;
      by_k << x * s, x * s * s, 2 * x * y, s + 2 * x * x, y * s, y * s * s, s + 2 * y * y, 2 * x * y;
      const Eigen::Vector2d wanted((q.x() - camera.cx) / camera.fx - x, (q.y() - camera.cy) / camera.fy - y);
      normal += by_k.transpose() * by_k;
      right += by_k.transpose() * wanted;
      places.push_back(*n);
    }
  }
  const Eigen::Vector4d k = normal.ldlt().solve(right);
  Camera radtan = camera;
  radtan.k = {k[0], k[1], k[2], k[3]};
  for (const Eigen::Vector2d& n : places) {
    const Eigen::Vector2d miss = radtan.distort(n) - camera.distort(n);
    fit.worst_px = std::max(fit.worst_px, std::hypot(miss.x() * camera.fx, miss.y() * camera.fy));
  }
  std::copy(k.begin(), k.end(), fit.k.begin());
  return fit;
}

}  // namespace

std::string to_opencv_yaml(const Rig& rig) {
  std::string text = "%YAML:1.0\n---\n# Written by raysteer " RAYSTEER_VERSION
                     ". Metres; a point of the first device goes to device NAME as NAME_R p + NAME_T.\n";
  for (const Device& device : rig.devices) {
    const std::string name = word(device.name);
    const Camera& camera = device.camera;
    Eigen::Matrix3d K = Eigen::Matrix3d::Identity();
    K(0, 0) = camera.fx;
    K(1, 1) = camera.fy;
    K(0, 2) = camera.cx;
    K(1, 2) = camera.cy;
    const Eigen::MatrixXd k = Eigen::Map<const Eigen::RowVectorXd>(camera.k.data(), coefficients(camera.lens));
    text += fmt::format("{0}_width: {1}\n{0}_height: {2}\n", name, camera.width, camera.height);
    text += opencv_matrix(name + "_camera_matrix", K);
    text += opencv_matrix(name + "_distortion", k);
    text += opencv_matrix(name + "_R", device.T_device_rig.rotation());
    text += opencv_matrix(name + "_T", device.T_device_rig.t);
  }
  return text;
}

std::string to_kalibr_camchain(const Rig& rig) {
  std::vector<const Device*> cameras;
  for (const Device& device : rig.devices) {
    if (device.kind == DeviceKind::kCamera) {
      cameras.push_back(&device);
    }
  }
  std::string text =
      "# Written by raysteer " RAYSTEER_VERSION ". T_cn_cnm1 takes a point of the camera before to this one; metres.\n";
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const Camera& camera = cameras[i]->camera;
    const RadTan lens = fit_radtan(camera);
    std::string overlaps;
    for (std::size_t other = 0; other < cameras.size(); ++other) {
      if (other != i) {
        overlaps += (overlaps.empty() ? "" : ", ") + std::to_string(other);
      }
    }
    text += fmt::format("cam{}:  # {}\n", i, word(cameras[i]->name));
    if (lens.worst_px > 0) {
      text += fmt::format("  # radtan fitted to the lens model {}: off by at most {:.3f} px within the image\n",
                          calib::model::to_string(camera.lens), lens.worst_px);
    }
    if (i > 0) {
      const Eigen::Matrix4d T = matrix(cameras[i]->T_device_rig * cameras[i - 1]->T_device_rig.inverse());
      text += "  T_cn_cnm1:\n";
      for (Eigen::Index r = 0; r < 4; ++r) {
        text += "  - " + row(std::array{T(r, 0), T(r, 1), T(r, 2), T(r, 3)}) + "\n";
      }
    }
    text += fmt::format(
        "  cam_overlaps: [{}]\n"
        "  camera_model: pinhole\n"
        "  distortion_coeffs: {}\n"
        "  distortion_model: radtan\n"
        "  intrinsics: {}\n"
        "  resolution: [{}, {}]\n"
        "  rostopic: /{}/image_raw\n",
        overlaps, row(lens.k), row(std::array{camera.fx, camera.fy, camera.cx, camera.cy}), camera.width, camera.height,
        word(cameras[i]->name));
  }
  return text;
}

}  // namespace raysteer::host::exchange
