// value: what a camera sees of a scene lit by a projector: exact projector coordinates, area-sampled light, known
// noise.
//
// For each camera pixel the ray through its centre meets the scene; the point is lit unless something stands between it
// and the projector. The pixel's square footprint, taken affine, is integrated over the panel's pattern (exactly, with
// the projector's blur) and over the print (89 samples). Light falls off with cos / distance^2 and adds to ambient
// light; the camera's blur mixes pixels as they come out, so that depth and shadow edges mix too; then come shot
// noise, read noise, saturation and rounding. Not modelled: interreflection, gloss, vignetting, depth of field, and the
// part of a pixel that a silhouette cuts off.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <vector>

#include "calib/synth/profile.hpp"
#include "calib/synth/scene.hpp"
#include "hal/base/image.hpp"
#include "hal/base/pattern.hpp"

namespace raysteer::calib::synth {

/// A camera as a light meter. Grey levels (DN) are linear in light.
struct Sensor {
  model::Camera camera;
  model::Pose T_camera_rig;
  double gain = 200;             ///< DN per unit of light; a white wall 1 m before a Lamp of power 1 reflects 1 unit
  double saturation_dn = 255;    ///< brightest value a frame can have: 255, 1023, 4095, 65535
  double electrons_per_dn = 40;  ///< shot noise: variance = DN / electrons_per_dn
  double read_noise_dn = 0.6;    ///< standard deviation, rounding not included
  double blur_px = 0.5;          ///< sigma of the lens's blur, camera px
};

/// A projector as a lamp behind a panel.
struct Lamp {
  model::Camera panel;
  model::Pose T_projector_rig;
  double power = 1;      ///< light on a surface that faces it 1 m away
  double black = 0.002;  ///< leaks through a pixel that is off
  double blur_px = 0.6;  ///< sigma of the projector's blur, panel px; at least kMinLampBlurPx
};
/// Below this the pattern's table (16 nodes a pixel) would no longer follow its edges.
inline constexpr double kMinLampBlurPx = 0.2;

/// Names one frame's noise: the same numbers give the same bytes, whatever the number of threads.
struct NoiseKey {
  std::uint64_t seed = 0;
  std::uint32_t camera = 0;
  std::uint32_t look = 0;
  std::uint32_t frame = 0;
};

/// What is true of each camera pixel's centre. Sizes are the camera's.
struct Truth {
  Image<Eigen::Vector3d> p;     ///< surface point, rig frame; NaN where the ray meets nothing
  Image<Eigen::Vector2d> x;     ///< its panel pixel; NaN where the projector does not light it
  Image<std::int16_t> surface;  ///< Hit::surface, -1 for nothing
};

/// One camera's view of one scene under one lamp: traced once, then cheap for every pattern.
class View {
 public:
  /// Traces the scene. `lamp` may be null: then ambient light is all there is.
  /// `ambient` is the light that reaches every surface from all sides, in units of Lamp::power at 1 m.
  View(const Scene& scene, const Sensor& sensor, const Lamp* lamp, double ambient, int threads = 2);

  const Truth& truth() const { return truth_; }
  const Sensor& sensor() const { return sensor_; }

  /// Mean grey levels before noise and saturation.
  Image<float> mean(const Pattern& pattern) const;
  /// A frame: Pixel is std::uint8_t or std::uint16_t.
  template <class Pixel>
  Image<Pixel> frame(const Pattern& pattern, const NoiseKey& key) const;

 private:
  /// Where a camera pixel's square lands on the panel.
  struct Footprint {
    double x = 0, y = 0;                   ///< its centre, panel px
    float xu = 0, xv = 0, yu = 0, yv = 0;  ///< what one camera pixel right (u) and down (v) moves it
    float window_x = 0, window_y = 0;      ///< shares inside the panel's width and height
  };
  void trace_row(const Scene& scene, const Lamp* lamp, const Profile& panel_x, const Profile& panel_y, double ambient,
                 int y);
  void light_row(const Pattern& pattern, const Profile* profile, int y, float* row) const;

  Sensor sensor_;
  double black_ = 0;
  double lamp_blur_ = kMinLampBlurPx;
  int panel_width_ = 0;
  int panel_height_ = 0;
  int threads_ = 1;
  Truth truth_;
  Image<float> ambient_dn_;  ///< grey level without the projector
  Image<float> lit_dn_;      ///< what a panel that is all on adds
  Image<Footprint> footprint_;
};

}  // namespace raysteer::calib::synth
