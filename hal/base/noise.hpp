// value: reproducible random numbers: the same seed gives the same numbers everywhere and for ever.
//
// std::normal_distribution may differ between libraries; this does not.
#pragma once

#include <cstdint>

namespace raysteer {

/// SplitMix64 (Steele, Lea, Flood 2014): a counter behind a hash, so that any state is a good start.
class Noise {
 public:
  explicit Noise(std::uint64_t seed) : state_(seed) {}
  /// A stream of its own for each combination, for example (seed, camera, frame, row).
  template <class... More>
  explicit Noise(std::uint64_t seed, std::uint64_t next, More... more)
      : Noise(Noise(seed ^ (next + 1) * 0xd1342543de82ef95U).bits(), static_cast<std::uint64_t>(more)...) {}

  std::uint64_t bits() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15U);
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31U);
  }
  /// In [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11U) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Mean 0, variance 1: quantile by table, tails by formula.
  double normal();

 private:
  std::uint64_t state_;
};

}  // namespace raysteer
