#include "calib/decode/phase_rows.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calib/decode/vectorise.hpp"

namespace raysteer::calib::decode {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

template <class T>
[[gnu::always_inline]] inline void add_row(const T* __restrict frame, int count, float sine_k, float cosine_k,
                                           float* __restrict sine, float* __restrict cosine, float* __restrict sum,
                                           float* __restrict squares, float sign, float* __restrict alternating,
                                           float* __restrict peak) {
  RAYSTEER_INDEPENDENT
  for (int i = 0; i < count; ++i) {
    const float value = frame[i];
    sine[i] += value * sine_k;
    cosine[i] += value * cosine_k;
    sum[i] += value;
    squares[i] += value * value;
    alternating[i] += sign * value;
    peak[i] = peak[i] < value ? value : peak[i];
  }
}

RAYSTEER_CLONES void add_row_8(const std::uint8_t* frame, int count, float sine_k, float cosine_k, float* sine,
                               float* cosine, float* sum, float* squares, float sign, float* alternating, float* peak) {
  add_row(frame, count, sine_k, cosine_k, sine, cosine, sum, squares, sign, alternating, peak);
}

RAYSTEER_CLONES void add_row_16(const std::uint16_t* frame, int count, float sine_k, float cosine_k, float* sine,
                                float* cosine, float* sum, float* squares, float sign, float* alternating,
                                float* peak) {
  add_row(frame, count, sine_k, cosine_k, sine, cosine, sum, squares, sign, alternating, peak);
}

double fraction(double value) { return value - std::floor(value); }

}  // namespace

PhaseSums::PhaseSums(const PatternBlock& block, int width, int height)
    : block_(block),
      sine_(width, height),
      cosine_(width, height),
      sum_(width, height),
      squares_(width, height),
      alternating_(width, height),
      peak_(width, height) {}

void PhaseSums::clear() {
  for (Image<float>* plane : {&sine_, &cosine_, &sum_, &squares_, &alternating_, &peak_}) {
    plane->fill(0);
  }
}

template <class T>
void PhaseSums::add_frame(int step, ImageView<const T> frame) {
  const double angle = kTurn * step / block_.steps;
  const auto sine_k = static_cast<float>(std::sin(angle));
  const auto cosine_k = static_cast<float>(std::cos(angle));
  const float sign = step % 2 == 0 ? 1.0F : -1.0F;
  for (int y = 0; y < frame.height(); ++y) {
    if constexpr (sizeof(T) == 1) {
      add_row_8(frame.row(y), frame.width(), sine_k, cosine_k, sine_.row(y), cosine_.row(y), sum_.row(y),
                squares_.row(y), sign, alternating_.row(y), peak_.row(y));
    } else {
      add_row_16(frame.row(y), frame.width(), sine_k, cosine_k, sine_.row(y), cosine_.row(y), sum_.row(y),
                 squares_.row(y), sign, alternating_.row(y), peak_.row(y));
    }
  }
}

void PhaseSums::add(int step, ImageView<const std::uint8_t> frame) { add_frame(step, frame); }
void PhaseSums::add(int step, ImageView<const std::uint16_t> frame) { add_frame(step, frame); }

PhaseSums::Pixel PhaseSums::pixel(int x, int y) const {
  const double n = block_.steps;
  const double s = sine_(x, y);
  const double c = cosine_(x, y);
  const double total = sum_(x, y);
  Pixel pixel;
  pixel.place = block_.origin_px + std::atan2(block_.sign * s, c) / kTurn * block_.period_px;
  pixel.modulation = 2 / n * std::sqrt(s * s + c * c);
  pixel.mean = total / n;
  if (block_.steps > 3) {
    // Parseval: what is in the squares and neither in the mean nor in the first harmonic.
    const double rest = squares_(x, y) - total * total / n - 2 / n * (s * s + c * c);
    pixel.residual = std::max(0.0, rest) / (n - 3);
  }
  pixel.noise =
      block_.steps >= 6 && block_.steps % 2 == 0 ? alternating_(x, y) / std::sqrt(n) : std::sqrt(pixel.residual);
  pixel.peak = peak_(x, y);
  return pixel;
}

double PhaseSums::variance(const Pixel& pixel, const NoiseModel& noise) const {
  const double scale = block_.period_px / kTurn / std::max(pixel.modulation, 1e-6);
  return scale * scale * 2 / block_.steps * noise.variance(pixel.mean);
}

double nearest_period(double place, double period, double rough) {
  return place + period * std::round((rough - place) / period);
}

Heterodyne heterodyne(std::span<const double> places, std::span<const double> periods, double panel) {
  const double period = periods[0];
  Heterodyne found;
  if (places.size() == 2) {
    const double beat = 1 / (1 / periods[0] - 1 / periods[1]);
    const double turn = places[0] / periods[0] - places[1] / periods[1];
    // The panel begins at -0.5.
    const double rough = beat * fraction(turn + 0.5 / beat) - 0.5;
    const double order = (rough - places[0]) / period;
    found.residual = std::abs(order - std::round(order));
    found.place = places[0] + period * std::round(order);
    // At the panel's ends noise may carry the beat once around.
    if (found.place >= panel - 0.5 && found.place - beat >= -0.5 - 0.25 * period) {
      found.place -= beat;
    } else if (found.place < -0.5 && found.place + beat < panel - 0.5) {
      found.place += beat;
    }
    return found;
  }
  const double first = nearest_period(places[0], period, -0.5 + period / 2);
  double least = 1e9;
  for (double place = first; place < panel - 0.5 + period / 2; place += period) {
    double cost = 0;
    for (std::size_t i = 1; i < places.size(); ++i) {
      const double order = (place - places[i]) / periods[i];
      const double miss = order - std::round(order);
      cost += miss * miss;
    }
    if (cost < least) {
      least = cost;
      found.place = place;
    }
  }
  found.residual = places.size() > 1 ? std::sqrt(least / static_cast<double>(places.size() - 1)) : 0;
  return found;
}

}  // namespace raysteer::calib::decode
