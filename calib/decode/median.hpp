// pure: the middle one of some values.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace raysteer::calib::decode {

/// NaN of none. Reorders `values`.
inline float median(std::vector<float>& values) {
  if (values.empty()) {
    return std::numeric_limits<float>::quiet_NaN();
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace raysteer::calib::decode
