// value: by how much do two pictures of the same tiles differ in place? Private to the sequence check.
#pragma once

#include <cstdint>
#include <vector>

namespace raysteer::calib::decode {

/// Grey levels of square tiles, one after the other, each row by row.
struct Tiles {
  int side = 0;
  std::vector<float> levels;
};

struct Shift {
  bool known = false;  ///< false: too little texture to tell
  double x = 0;        ///< px that `moved` lies to the right of the reference
  double y = 0;        ///< ... below
  double changed = 0;  ///< share of the samples that differ much even so: something else moved or changed
  double length() const;
};

/// One reference against many pictures. Gauss-Newton on smoothed tiles (Lucas and Kanade 1981), with weights that let
/// changed places count little.
class ShiftMeter {
 public:
  /// `usable`: 0 where a sample is not to be trusted (saturated).
  ShiftMeter(const Tiles& reference, const std::vector<std::uint8_t>& usable);
  Shift measure(const Tiles& moved) const;

 private:
  Tiles smooth_;
  std::vector<float> gradient_x_;
  std::vector<float> gradient_y_;
  std::vector<std::uint8_t> usable_;
  float typical_ = 0;  // median level
};

}  // namespace raysteer::calib::decode
