#include "calib/decode/sequence_words.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace raysteer::calib::decode {

std::string percent(double share) {
  const int tenths = static_cast<int>(std::lround(1000 * share));
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " %";
}

std::string fixed(double value) {
  const long hundredths = std::lround(100 * value);
  const std::string digits = std::to_string(hundredths % 100);
  return std::to_string(hundredths / 100) + "." + (digits.size() < 2 ? "0" : "") + digits;
}

std::string list_of(const std::vector<int>& frames) {
  constexpr std::size_t kMostNamed = 8;
  std::string text = frames.size() == 1 ? "frame " : "frames ";
  for (std::size_t i = 0; i < std::min(frames.size(), kMostNamed); ++i) {
    text += (i > 0 ? ", " : "") + std::to_string(frames[i]);
  }
  return frames.size() > kMostNamed ? text + " and " + std::to_string(frames.size() - kMostNamed) + " more" : text;
}

}  // namespace raysteer::calib::decode
