#include "calib/decode/noise_samples.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace raysteer::calib::decode {

template <class T>
void NoiseSamples::add(ImageView<const T> p, ImageView<const T> q, bool pairs, int saturated, NoiseEstimate& estimate) {
  const int step_x = (p.width() + kNoiseColumns - 1) / kNoiseColumns;
  const int step_y = (p.height() + kNoiseRows - 1) / kNoiseRows;
  const int columns = (p.width() - 1) / step_x;
  const int rows = (p.height() + step_y - 1) / step_y;
  constexpr int kUnknown = -1;
  // Two pixels side by side, each unlit and lit; pairs use the first of the two only.
  before_.resize(4 * static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), kUnknown);
  int* before = before_.data();
  for (int y = 0; y < p.height(); y += step_y) {
    for (int k = 0; k < columns; ++k, before += 4) {
      const int x = step_x * k;
      if (std::max({p(x, y), q(x, y), p(x + 1, y), q(x + 1, y)}) >= saturated) {
        continue;
      }
      const bool lit = p(x, y) > q(x, y);
      if (!pairs && lit != (p(x + 1, y) > q(x + 1, y))) {
        continue;
      }
      int* last = before + (!pairs && lit ? 2 : 0);
      const int here = pairs ? p(x, y) + q(x, y) : p(x, y);
      const int beside = pairs ? p(x + 1, y) + q(x + 1, y) : p(x + 1, y);
      if (last[0] != kUnknown) {
        estimate.add(pairs ? 0.5 * here : here, here - last[0] - (beside - last[1]), pairs ? 8 : 4);
      }
      last[0] = here;
      last[1] = beside;
    }
  }
}

template void NoiseSamples::add(ImageView<const std::uint8_t>, ImageView<const std::uint8_t>, bool, int,
                                NoiseEstimate&);
template void NoiseSamples::add(ImageView<const std::uint16_t>, ImageView<const std::uint16_t>, bool, int,
                                NoiseEstimate&);

}  // namespace raysteer::calib::decode
