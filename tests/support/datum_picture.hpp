// Draws coded ring datums as a camera sees them: area-sampled, blurred, unevenly lit, noisy. Written apart from the
// detector: surfaces are asked, not outlines.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "calib/model/camera.hpp"
#include "calib/model/pose.hpp"
#include "hal/base/image.hpp"

namespace raysteer::support {

struct DrawnDatum {
  calib::model::Pose T_camera_datum;  ///< z out of the datum's face
  double radius_m = 0.03;
  unsigned code = 0;
};

struct DatumLight {
  double ground_dn = 70;                               ///< grey around the datums
  double black_dn = 15;                                ///< of the datums
  double white_dn = 170;                               ///< of the datums
  Eigen::Vector2d fall_off = Eigen::Vector2d::Zero();  ///< share of light more per pixel from the picture's middle
  Eigen::Vector2d glare_dn = Eigen::Vector2d::Zero();  ///< light added per pixel from the picture's middle
  double blur_px = 0.6;
  double noise_dn = 1.5;
};

namespace datum_picture_detail {

// Light of a datum at a place on its plate; below 0 beside it.
inline double print_at(const DrawnDatum& datum, const Eigen::Vector2d& p, const DatumLight& light) {
  const double half = 3.5 * datum.radius_m;
  if (std::abs(p.x()) > half || std::abs(p.y()) > half) {
    return -1;
  }
  const double radii = p.norm() / datum.radius_m;
  double turn = std::atan2(p.y(), p.x()) / (2 * std::numbers::pi);
  turn = turn < 0 ? turn + 1 : turn;
  const unsigned sector = std::min(11U, static_cast<unsigned>(turn * 12));
  const bool white = radii < 1 || (radii >= 2 && radii < 3 && ((datum.code >> sector) & 1U) != 0);
  return white ? light.white_dn : light.black_dn;
}

// The same along a ray of the camera; below 0 where it misses the plate or sees its back.
inline double seen_along(const DrawnDatum& datum, const Eigen::Vector3d& ray, const DatumLight& light) {
  const Eigen::Matrix3d rotation = datum.T_camera_datum.rotation();
  const double facing = rotation.col(2).dot(ray);
  const double distance = rotation.col(2).dot(datum.T_camera_datum.t) / facing;
  if (!(facing < 0) || !(distance > 0)) {
    return -1;
  }
  const Eigen::Vector3d p = rotation.transpose() * (distance * ray - datum.T_camera_datum.t);
  return print_at(datum, p.head<2>(), light);
}

inline Image<float> blurred(const Image<float>& in, double sigma) {
  const int reach = static_cast<int>(std::ceil(4 * sigma));
  std::vector<double> kernel;
  double sum = 0;
  for (int i = -reach; i <= reach; ++i) {
    kernel.push_back(sigma > 0 ? std::exp(-0.5 * i * i / (sigma * sigma)) : 1);
    sum += kernel.back();
  }
  const auto pass = [&](const Image<float>& from, int dx, int dy) {
    Image<float> to(from.width(), from.height());
    for (int y = 0; y < to.height(); ++y) {
      for (int x = 0; x < to.width(); ++x) {
        double value = 0;
        for (int i = -reach; i <= reach; ++i) {
          value += kernel[static_cast<std::size_t>(i + reach)] / sum *
                   from(std::clamp(x + i * dx, 0, to.width() - 1), std::clamp(y + i * dy, 0, to.height() - 1));
        }
        to(x, y) = static_cast<float>(value);
      }
    }
    return to;
  };
  return pass(pass(in, 1, 0), 0, 1);
}

}  // namespace datum_picture_detail

/// Pixel: std::uint8_t, or std::uint16_t with `scale` times as many grey levels.
template <class Pixel = std::uint8_t>
Image<Pixel> draw_datums(const calib::model::Camera& camera, const std::vector<DrawnDatum>& datums,
                         const DatumLight& light, std::mt19937_64& random, double scale = 1) {
  constexpr int kSide = 4;  // samples of a pixel, each way
  const int columns = camera.width + 1;
  // Rays through the pixels' corners; within a pixel they are as good as linear.
  std::vector<Eigen::Vector2d> corners;
  for (int y = 0; y <= camera.height; ++y) {
    for (int x = 0; x <= camera.width; ++x) {
      corners.push_back(camera.normalize({x - 0.5, y - 0.5}).value_or(Eigen::Vector2d::Zero()));
    }
  }
  Image<float> exact(camera.width, camera.height);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector2d* at = &corners[static_cast<std::size_t>(y * columns + x)];
      const Eigen::Vector2d right = at[1] - at[0];
      const Eigen::Vector2d down = at[columns] - at[0];
      double sum = 0;
      for (int j = 0; j < kSide; ++j) {
        for (int i = 0; i < kSide; ++i) {
          const Eigen::Vector3d ray = (at[0] + (i + 0.5) / kSide * right + (j + 0.5) / kSide * down).homogeneous();
          double value = -1;
          for (const DrawnDatum& datum : datums) {
            value = value < 0 ? datum_picture_detail::seen_along(datum, ray, light) : value;
          }
          sum += value < 0 ? light.ground_dn : value;
        }
      }
      exact(x, y) = static_cast<float>(sum / (kSide * kSide));
    }
  }
  const Image<float> soft = datum_picture_detail::blurred(exact, light.blur_px);
  std::normal_distribution<double> noise(0, light.noise_dn);
  Image<Pixel> picture(camera.width, camera.height);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector2d place(x - 0.5 * camera.width, y - 0.5 * camera.height);
      const double grey = soft(x, y) * (1 + light.fall_off.dot(place)) + light.glare_dn.dot(place) + noise(random);
      picture(x, y) =
          static_cast<Pixel>(std::clamp(std::round(scale * grey), 0.0, 1.0 * std::numeric_limits<Pixel>::max()));
    }
  }
  return picture;
}

}  // namespace raysteer::support
