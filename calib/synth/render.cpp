#include "calib/synth/render.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <thread>
#include <type_traits>

#include "calib/synth/noise.hpp"

namespace raysteer::calib::synth {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Calls `work(row)` for each row; rows do not depend on each other, so the number of threads changes nothing.
template <class Work>
void for_rows(int rows, int threads, const Work& work) {
  const auto share = [&](int thread) {
    for (int y = thread; y < rows; y += threads) {
      work(y);
    }
  };
  std::vector<std::jthread> others;
  for (int thread = 1; thread < threads; ++thread) {
    others.emplace_back(share, thread);
  }
  share(0);
}

/// Fibonacci lattice in the unit square about 0: 89 samples whose shadows on both axes are 89 equal steps, so that even
/// an edge parallel to a pixel's side is hit to 1/178 of the pixel (Sloan and Joe, Lattice Methods, 1994).
constexpr int kSamples = 89;
std::array<Eigen::Vector2d, kSamples> lattice() {
  std::array<Eigen::Vector2d, kSamples> points;
  for (int i = 0; i < kSamples; ++i) {
    points[static_cast<std::size_t>(i)] = {(i + 0.5) / kSamples - 0.5, (55 * i % kSamples + 0.5) / kSamples - 0.5};
  }
  return points;
}

/// Mean reflectance over the parallelogram about (u, v) that `by_pixel` makes of a pixel.
double mean_reflectance(const Print& print, double u, double v, const Eigen::Matrix2d& by_pixel) {
  const Eigen::Vector2d half = 0.5 * by_pixel.cwiseAbs().rowwise().sum();
  if (print.plain(u - half.x(), u + half.x(), v - half.y(), v + half.y())) {
    return print.reflectance(u, v);
  }
  static const std::array<Eigen::Vector2d, kSamples> samples = lattice();
  double sum = 0;
  for (const Eigen::Vector2d& sample : samples) {
    const Eigen::Vector2d offset = by_pixel * sample;
    sum += print.reflectance(u + offset.x(), v + offset.y());
  }
  return sum / kSamples;
}

/// Gaussian of a sampled signal, exp(-t) I_n(t) with t = sigma^2: its variance is exactly sigma^2, also for narrow ones
/// (Lindeberg, Scale-Space for Discrete Signals, 1990). Index n is the distance from the centre.
std::vector<float> discrete_gaussian(double sigma) {
  std::vector<float> weights;
  const double t = sigma * sigma;
  const int reach = static_cast<int>(std::ceil(5 * sigma));
  double sum = 0;
  for (int n = 0; n <= reach; ++n) {
    const double weight = std::exp(-t) * std::cyl_bessel_i(static_cast<double>(n), t);
    weights.push_back(static_cast<float>(weight));
    sum += n == 0 ? weight : 2 * weight;
  }
  for (float& weight : weights) {
    weight = static_cast<float>(weight / sum);
  }
  return weights;
}

void blur_along(const float* row, int width, const std::vector<float>& weights, float* out) {
  const int reach = static_cast<int>(weights.size()) - 1;
  for (int x = 0; x < width; ++x) {
    float sum = weights[0] * row[x];
    for (int n = 1; n <= reach; ++n) {
      sum += weights[static_cast<std::size_t>(n)] * (row[std::max(x - n, 0)] + row[std::min(x + n, width - 1)]);
    }
    out[x] = sum;
  }
}

void blur_across(const Image<float>& image, int y, const std::vector<float>& weights, float* out) {
  const int reach = static_cast<int>(weights.size()) - 1;
  const float* row = image.row(y);
  for (int x = 0; x < image.width(); ++x) {
    out[x] = weights[0] * row[x];
  }
  for (int n = 1; n <= reach; ++n) {
    const float* above = image.row(std::max(y - n, 0));
    const float* below = image.row(std::min(y + n, image.height() - 1));
    const float weight = weights[static_cast<std::size_t>(n)];
    for (int x = 0; x < image.width(); ++x) {
      out[x] += weight * (above[x] + below[x]);
    }
  }
}

}  // namespace

View::View(const Scene& scene, const Sensor& sensor, const Lamp* lamp, double ambient, int threads)
    : sensor_(sensor), threads_(std::max(threads, 1)) {
  const int width = sensor.camera.width;
  const int height = sensor.camera.height;
  truth_.p = Image<Eigen::Vector3d>(width, height);
  truth_.x = Image<Eigen::Vector2d>(width, height);
  truth_.surface = Image<std::int16_t>(width, height);
  ambient_dn_ = Image<float>(width, height);
  lit_dn_ = Image<float>(width, height);
  footprint_ = Image<Footprint>(width, height);
  if (lamp != nullptr) {
    black_ = lamp->black;
    lamp_blur_ = std::max(lamp->blur_px, kMinLampBlurPx);
    panel_width_ = lamp->panel.width;
    panel_height_ = lamp->panel.height;
  }
  const Profile panel_x(std::vector<double>(static_cast<std::size_t>(panel_width_), 1.0), lamp_blur_);
  const Profile panel_y(std::vector<double>(static_cast<std::size_t>(panel_height_), 1.0), lamp_blur_);
  for_rows(height, threads_, [&](int y) { trace_row(scene, lamp, panel_x, panel_y, ambient, y); });
}

void View::trace_row(const Scene& scene, const Lamp* lamp, const Profile& panel_x, const Profile& panel_y,
                     double ambient, int y) {
  const model::Pose T_rig_camera = sensor_.T_camera_rig.inverse();
  const Eigen::Matrix3d R_rig_camera = T_rig_camera.rotation();
  const Eigen::Vector3d lamp_place = lamp != nullptr ? lamp->T_projector_rig.inverse().t : Eigen::Vector3d::Zero();
  for (int x = 0; x < sensor_.camera.width; ++x) {
    truth_.p(x, y).setConstant(kNan);
    truth_.x(x, y).setConstant(kNan);
    truth_.surface(x, y) = -1;
    const auto n = sensor_.camera.normalize({x, y});
    if (!n) {
      continue;
    }
    const Eigen::Vector3d direction = R_rig_camera * n->homogeneous();
    const auto hit = first_hit(scene, T_rig_camera.t, direction);
    if (!hit) {
      continue;
    }
    truth_.p(x, y) = hit->p;
    truth_.surface(x, y) = static_cast<std::int16_t>(hit->surface);

    // How the point moves with the pixel: the ray turns, the tangent plane holds the point.
    Eigen::Matrix2d distorted_by_n;
    sensor_.camera.distort(*n, distorted_by_n);
    const Eigen::Matrix2d n_by_pixel =
        distorted_by_n.inverse() * Eigen::Vector2d(1 / sensor_.camera.fx, 1 / sensor_.camera.fy).asDiagonal();
    const Eigen::Matrix<double, 3, 2> turn = R_rig_camera.leftCols<2>() * n_by_pixel;
    const Eigen::Matrix<double, 3, 2> p_by_pixel =
        hit->s * (turn - direction * (hit->normal.transpose() * turn) / hit->normal.dot(direction));

    double albedo = 0;
    const auto plates = static_cast<int>(scene.plates.size());
    if (hit->surface < plates) {
      const Plate& plate = scene.plates[static_cast<std::size_t>(hit->surface)];
      albedo = plate.albedo;
      if (plate.print && hit->front) {
        const Eigen::Matrix2d place_by_pixel = plate.T_rig_plate.rotation().leftCols<2>().transpose() * p_by_pixel;
        albedo = mean_reflectance(*plate.print, hit->u, hit->v, place_by_pixel);
      }
    } else {
      albedo = scene.balls[static_cast<std::size_t>(hit->surface - plates)].albedo;
    }
    ambient_dn_(x, y) = static_cast<float>(sensor_.gain * albedo * ambient);

    if (lamp == nullptr) {
      continue;
    }
    const Eigen::Vector3d to_lamp = lamp_place - hit->p;
    const double distance = to_lamp.norm();
    const double facing = hit->normal.dot(to_lamp) / distance;
    if (facing <= 0) {
      continue;
    }
    Eigen::Matrix<double, 2, 3> panel_by_p;
    const auto panel = lamp->panel.project(lamp->T_projector_rig * hit->p, panel_by_p);
    if (!panel) {
      continue;
    }
    const Eigen::Matrix<float, 2, 2> side = (panel_by_p * lamp->T_projector_rig.rotation() * p_by_pixel).cast<float>();
    Footprint footprint{panel->x(), panel->y(), side(0, 0), side(0, 1), side(1, 0), side(1, 1)};
    footprint.window_x = static_cast<float>(panel_x.mean(footprint.x, footprint.xu, footprint.xv));
    footprint.window_y = static_cast<float>(panel_y.mean(footprint.y, footprint.yu, footprint.yv));
    if (footprint.window_x * footprint.window_y <= 0 || blocked(scene, hit->p, lamp_place)) {
      continue;
    }
    footprint_(x, y) = footprint;
    lit_dn_(x, y) = static_cast<float>(sensor_.gain * albedo * lamp->power * facing / (distance * distance));
    const bool on_panel = panel->x() >= -0.5 && panel->x() <= panel_width_ - 0.5 &&  //
                          panel->y() >= -0.5 && panel->y() <= panel_height_ - 0.5;
    if (on_panel) {
      truth_.x(x, y) = *panel;
    }
  }
}

void View::light_row(const Pattern& pattern, const Profile* profile, int y, float* row) const {
  const bool along_x = pattern.block.axis == Axis::kX;
  const float* ambient = ambient_dn_.row(y);
  const float* lit = lit_dn_.row(y);
  const Footprint* footprints = footprint_.row(y);
  const auto leak = static_cast<float>(black_);
  for (int x = 0; x < ambient_dn_.width(); ++x) {
    row[x] = ambient[x];
    if (lit[x] == 0) {
      continue;
    }
    const Footprint& at = footprints[x];
    const float window = at.window_x * at.window_y;
    float on = pattern.block.kind == PatternKind::kWhite ? window : 0;
    if (profile != nullptr) {
      on = along_x ? at.window_y * static_cast<float>(profile->mean(at.x, at.xu, at.xv))
                   : at.window_x * static_cast<float>(profile->mean(at.y, at.yu, at.yv));
    }
    row[x] += lit[x] * (leak * window + (1 - leak) * on);
  }
}

Image<float> View::mean(const Pattern& pattern) const {
  const int width = sensor_.camera.width;
  const int height = sensor_.camera.height;
  std::vector<Profile> profile;  // none for white and black
  if (pattern.block.kind == PatternKind::kGray || pattern.block.kind == PatternKind::kPhase) {
    const int length = pattern.block.axis == Axis::kX ? panel_width_ : panel_height_;
    std::vector<double> pixels;
    for (int i = 0; i < length; ++i) {
      pixels.push_back(pattern.value(i, i));
    }
    profile.emplace_back(pixels, lamp_blur_);
  }
  const std::vector<float> weights = discrete_gaussian(sensor_.blur_px);
  Image<float> along = Image<float>::uninitialised(width, height);
  for_rows(height, threads_, [&](int y) {
    std::vector<float> row(static_cast<std::size_t>(width));
    light_row(pattern, profile.empty() ? nullptr : profile.data(), y, row.data());
    blur_along(row.data(), width, weights, along.row(y));
  });
  Image<float> both = Image<float>::uninitialised(width, height);
  for_rows(height, threads_, [&](int y) { blur_across(along, y, weights, both.row(y)); });
  return both;
}

template <class Pixel>
Image<Pixel> View::frame(const Pattern& pattern, const NoiseKey& key) const {
  const Image<float> light = mean(pattern);
  Image<Pixel> frame = Image<Pixel>::uninitialised(light.width(), light.height());
  const double brightest = std::min(sensor_.saturation_dn, static_cast<double>(std::numeric_limits<Pixel>::max()));
  for_rows(light.height(), threads_, [&](int y) {
    Noise noise(key.seed, key.camera, key.look, key.frame, static_cast<std::uint64_t>(y));
    const float* mean_dn = light.row(y);
    Pixel* out = frame.row(y);
    for (int x = 0; x < light.width(); ++x) {
      const double dn = mean_dn[x];
      const double variance = sensor_.read_noise_dn * sensor_.read_noise_dn + dn / sensor_.electrons_per_dn;
      const double measured = dn + std::sqrt(variance) * noise.normal();
      out[x] = static_cast<Pixel>(std::clamp(measured, 0.0, brightest) + 0.5);
    }
  });
  return frame;
}

template Image<std::uint8_t> View::frame(const Pattern& pattern, const NoiseKey& key) const;
template Image<std::uint16_t> View::frame(const Pattern& pattern, const NoiseKey& key) const;

}  // namespace raysteer::calib::synth
