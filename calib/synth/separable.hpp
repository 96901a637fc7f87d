// value: frames of a camera that looks straight at a wall, for the statistics of decoders: camera column u sees
// projector column x(u), row v sees y(v), so a pattern is rendered along one line and noise does the rest.
//
// Image model of algorithms 2.1: blurred projector light, ambient light, light that came by way of the scene, shot and
// read noise, rounding.
#pragma once

#include <cstdint>
#include <vector>

#include "calib/synth/noise.hpp"
#include "hal/base/image.hpp"
#include "hal/base/pattern.hpp"

namespace raysteer::calib::synth {

struct SeparableView {
  int width = 512;
  int height = 16;
  double x0 = 0.3, dx = 0.93;  ///< x(u) = x0 + dx u + bend u^2
  double y0 = 0.3, dy = 0.71;  ///< y(v) = y0 + dy v + bend v^2
  double bend = 2e-5;
  double blur_px = 1.2;           ///< sigma of projector and camera together, projector px
  double white_dn = 200;          ///< a white pixel without ambient light
  double white_electrons = 7000;  ///< of that
  double read_sigma_dn = 0.5;
  double ambient_dn = 5;
  double interreflection = 0;  ///< share of the light that came by way of the opposite side of the scene
  int bits = 8;
  /// A panel with fewer pixels than it is fed: of every `dropped_of` columns the one numbered `dropped_column` is never
  /// shown, and the others are wider for it. 0: every column is shown.
  int dropped_of = 0;
  int dropped_column = 0;
};

class SeparableCamera {
 public:
  SeparableCamera(const SeparableView& view, const PatternSequence& sequence) : view_(view), sequence_(sequence) {}
  double x(double u) const { return view_.x0 + view_.dx * u + view_.bend * u * u; }
  double y(double v) const { return view_.y0 + view_.dy * v + view_.bend * v * v; }
  Image<std::uint16_t> frame(const Pattern& pattern, Noise& noise) const;
  Image<std::uint8_t> frame8(const Pattern& pattern, Noise& noise) const;

 private:
  std::vector<double> light(const Pattern& pattern, bool along_x) const;

  SeparableView view_;
  PatternSequence sequence_;
};

}  // namespace raysteer::calib::synth
