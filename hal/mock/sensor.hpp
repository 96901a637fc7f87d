// pure: electrons become digital numbers: shot and read noise, full well, gain, response, quantisation.
#pragma once

#include <cstdint>
#include <vector>

#include "hal/base/frame.hpp"
#include "hal/base/image.hpp"

namespace raysteer::hal::mock {

struct SensorParameters {
  int bits = 8;               ///< 8 to 16
  double full_well_e = 10e3;  ///< reads the largest number at 0 dB
  double read_noise_e = 6;    ///< one standard deviation
  double black = 2.0 / 255;   ///< offset of no light, as part of the largest number
  /// Of signal, black taken off, both 0 to 1, at equal steps; empty: linear.
  std::vector<float> response;
};

/// Noise belongs to (key, row, column): same key, same bytes, whatever the number of threads.
/// Each pixel: electrons + normal(0, electrons + read_noise^2), at most full well, gain, response, rounded, clipped.
Frame expose(ImageView<const float> electrons, const SensorParameters& sensor, double gain_db, std::uint64_t key,
             int threads);

}  // namespace raysteer::hal::mock
