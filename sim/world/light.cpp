#include "sim/world/light.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace raysteer::sim::world {

using Eigen::Vector2d;
using Eigen::Vector3d;
using std::numbers::pi;

double pixel_solid_angle(const optics::Lens& lens, const Vector2d& pixel) {
  constexpr double kHalf = 0.5;
  const Vector3d across = lens.ray(pixel + Vector2d(kHalf, 0)) - lens.ray(pixel - Vector2d(kHalf, 0));
  const Vector3d down = lens.ray(pixel + Vector2d(0, kHalf)) - lens.ray(pixel - Vector2d(0, kHalf));
  return across.cross(down).norm();
}

double electrons_per_luminance(const optics::TrueCamera& camera, const Vector2d& q) {
  const double focal_m = camera.lens.numbers().focal_px.mean() * camera.pixel_m;
  const double pupil_m = focal_m / camera.f_number;
  return pi / 4 * pupil_m * pupil_m * camera.lens.ray(q).z() * pixel_solid_angle(camera.lens, q) * kLensTransmission *
         kPhotonsPerLumenSecond * camera.quantum_efficiency;
}

double panel_intensity(const optics::TrueProjector& projector, const Vector2d& x) {
  const double pixels = static_cast<double>(projector.width) * projector.height;
  return projector.lumens / pixels * std::pow(projector.lens.ray(x).z(), projector.fall_off) /
         pixel_solid_angle(projector.lens, x);
}

double projector_blur_px(const optics::TrueProjector& projector, double depth_m) {
  const double disc = projector.lens.numbers().focal_px.mean() * projector.pupil_m *
                      std::abs(1 / depth_m - (projector.focus_m > 0 ? 1 / projector.focus_m : 0));
  return std::hypot(kProjectorLensBlurPx, disc / 4);
}

double flicker_integral(double depth, double hz, RigTime begin, std::chrono::nanoseconds duration) {
  const double length = std::chrono::duration<double>(duration).count();
  if (depth == 0 || hz == 0) {
    return length;
  }
  // Whole periods are taken off first: the cosine of a large angle has few digits left.
  const double periods = std::chrono::duration<double>(begin.time_since_epoch()).count() * hz;
  const double from = 2 * pi * (periods - std::floor(periods));
  return length + depth * (std::cos(from) - std::cos(from + 2 * pi * hz * length)) / (2 * pi * hz);
}

double gloss_lobe(double gloss, double gloss_rad, const Vector3d& normal, const Vector3d& to_light,
                  const Vector3d& to_camera) {
  if (gloss <= 0) {
    return 0;
  }
  const double exponent = 4 / (gloss_rad * gloss_rad);
  const double cosine = std::max(0.0, normal.dot((to_light + to_camera).normalized()));
  return gloss * (exponent + 8) / (8 * pi) * std::pow(cosine, exponent);
}

}  // namespace raysteer::sim::world
