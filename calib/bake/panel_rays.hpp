// value: the lens undone once for every pixel of the panel; all stations of a rig share it.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "calib/model/camera.hpp"

namespace raysteer::calib::bake {

/// A pixel's ray in the lens's frame.
struct PanelRay {
  Eigen::Vector3d m;  ///< (X/Z, Y/Z, 1); not finite where the lens has no ray
  double magnify;     ///< area of the distorted picture over that of the undistorted one

  bool valid() const { return m.allFinite(); }
};

/// Also between and beside the panel's pixels.
PanelRay panel_ray(const model::Camera& lens, const Eigen::Vector2d& x);

class PanelRays {
 public:
  /// The same numbers with any number of threads.
  PanelRays(const model::Camera& lens, int threads);

  const model::Camera& lens() const { return lens_; }
  PanelRay operator()(int x, int y) const {
    const auto& [nx, ny, magnify] =
        rays_[static_cast<std::size_t>(y) * static_cast<std::size_t>(lens_.width) + static_cast<std::size_t>(x)];
    return {.m = {nx, ny, 1}, .magnify = magnify};
  }

 private:
  struct Stored {
    double nx, ny, magnify;
  };
  void fill_row(int y);

  model::Camera lens_;
  std::vector<Stored> rays_;
};

}  // namespace raysteer::calib::bake
