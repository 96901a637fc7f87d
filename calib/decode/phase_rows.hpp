// value: what is kept of one block of phase steps per camera pixel, and the coordinate that comes of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "calib/decode/noise.hpp"
#include "hal/base/image.hpp"
#include "hal/base/pattern.hpp"

namespace raysteer::calib::decode {

/// Sums over the steps of one block (algorithms 2.2), of squares for the residual, and with alternating sign for the
/// noise.
class PhaseSums {
 public:
  PhaseSums(const PatternBlock& block, int width, int height);
  void clear();
  void add(int step, ImageView<const std::uint8_t> frame);
  void add(int step, ImageView<const std::uint16_t> frame);
  const PatternBlock& block() const { return block_; }
  /// Mean over the steps: 50 % grey at each pixel.
  float mean(int x, int y) const { return sum_(x, y) / static_cast<float>(block_.steps); }

  struct Pixel {
    double place = 0;       ///< projector px, modulo the period
    double modulation = 0;  ///< B, DN
    double mean = 0;        ///< A, DN
    double residual = 0;    ///< sum of squared departures from the sinusoid / (steps - 3), DN^2; 0 for 3 steps
    double peak = 0;        ///< brightest step, DN
    /// A difference with the variance of one frame's pixel: what an even number of 6 steps or more says at their
    /// highest frequency, where a projector's gamma has put next to nothing; else the root of the residual.
    double noise = 0;
  };
  Pixel pixel(int x, int y) const;
  /// Variance of `place`, px^2.
  double variance(const Pixel& pixel, const NoiseModel& noise) const;

 private:
  template <class T>
  void add_frame(int step, ImageView<const T> frame);

  PatternBlock block_;
  Image<float> sine_, cosine_, sum_, squares_, alternating_, peak_;
};

/// The coordinate from several periods without a Gray code.
struct Heterodyne {
  double place = 0;
  double residual = 0;  ///< distance of the order from an integer, periods
};
/// `places` modulo `periods`, finest first; `panel` px long. Two periods: their beat gives the order. More: the order
/// for which all phases agree best.
Heterodyne heterodyne(std::span<const double> places, std::span<const double> periods, double panel);

/// `place` moved by whole periods to be nearest `rough`.
double nearest_period(double place, double period, double rough);

}  // namespace raysteer::calib::decode
