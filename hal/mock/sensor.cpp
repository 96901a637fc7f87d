#include "hal/mock/sensor.hpp"

#include <algorithm>
#include <cmath>
#include <thread>

#include "hal/base/result.hpp"
#include "hal/mock/gaussian_row.hpp"

namespace raysteer::hal::mock {
namespace {

/// What one row needs to know.
struct Amplifier {
  float read_variance;  ///< e^2
  float full_well;      ///< e
  float numbers;        ///< of one electron
  float black;
  float most;  ///< the largest number

  Amplifier(const SensorParameters& sensor, double gain_db)
      : read_variance(static_cast<float>(sensor.read_noise_e * sensor.read_noise_e)),
        full_well(static_cast<float>(sensor.full_well_e)),
        most(std::ldexp(1.F, sensor.bits) - 1) {
    black = static_cast<float>(sensor.black) * most;
    numbers = (most - black) * static_cast<float>(std::pow(10, gain_db / 20)) / full_well;
  }
};

/// `normal` in, numbers before rounding out. Plain loop, no branch: the compiler makes vectors of it.
void amplify(const float* electrons, float* normal, int count, const Amplifier& a) {
  for (int i = 0; i < count; ++i) {
    const float mean = electrons[i];
    const float noisy = mean + std::sqrt(std::max(mean, 0.F) + a.read_variance) * normal[i];
    const float number = a.black + a.numbers * std::min(noisy, a.full_well);
    normal[i] = std::min(std::max(number, 0.F), a.most);
  }
}

void respond(float* numbers, int count, const std::vector<float>& response, const Amplifier& a) {
  const float range = a.most - a.black;
  const auto cells = static_cast<float>(response.size() - 1);
  for (int i = 0; i < count; ++i) {
    if (numbers[i] > a.black) {
      const float place = (numbers[i] - a.black) / range * cells;
      const std::size_t cell = std::min(static_cast<std::size_t>(place), response.size() - 2);
      const float part = place - static_cast<float>(cell);
      const float signal = response[cell] + part * (response[cell + 1] - response[cell]);
      numbers[i] = a.black + range * std::clamp(signal, 0.F, 1.F);
    }
  }
}

template <class T>
void quantise(const float* numbers, T* out, int count) {
  for (int i = 0; i < count; ++i) {
    out[i] = static_cast<T>(static_cast<int>(numbers[i] + 0.5F));
  }
}

template <class T>
Image<T> expose_as(ImageView<const float> electrons, const SensorParameters& sensor, double gain_db, std::uint64_t key,
                   int threads) {
  Image<T> out = Image<T>::uninitialised(electrons.width(), electrons.height());
  const Amplifier amplifier(sensor, gain_db);
  const int width = electrons.width();
  const auto rows = [&](int first, int end) {
    std::vector<float> line(static_cast<std::size_t>(width));
    for (int y = first; y < end; ++y) {
      gaussian_row(key, y, line);
      amplify(electrons.row(y), line.data(), width, amplifier);
      if (!sensor.response.empty()) {
        respond(line.data(), width, sensor.response, amplifier);
      }
      quantise(line.data(), out.row(y), width);
    }
  };
  const int bands = std::max(threads, 1);
  const int height = electrons.height();
  std::vector<std::jthread> others;
  for (int i = 1; i < bands; ++i) {
    others.emplace_back(rows, height * i / bands, height * (i + 1) / bands);
  }
  rows(0, height / bands);
  return out;
}

}  // namespace

Frame expose(ImageView<const float> electrons, const SensorParameters& sensor, double gain_db, std::uint64_t key,
             int threads) {
  RAYSTEER_CHECK(sensor.bits >= 8 && sensor.bits <= 16 && sensor.full_well_e > 0 && sensor.response.size() != 1);
  if (sensor.bits == 8) {
    return expose_as<std::uint8_t>(electrons, sensor, gain_db, key, threads);
  }
  return expose_as<std::uint16_t>(electrons, sensor, gain_db, key, threads);
}

}  // namespace raysteer::hal::mock
