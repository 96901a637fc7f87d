// value: Gray sums of some lines across the stripes, from which the borders' places are learnt: each border is crossed
// by most of them.
#pragma once

#include <vector>

#include "calib/decode/border_table.hpp"
#include "calib/decode/gray_sums.hpp"
#include "hal/base/image.hpp"
#include "hal/base/pattern.hpp"

namespace raysteer::calib::decode {

template <class T>
class LineSamples {
 public:
  LineSamples() = default;
  /// Stripes that code `axis`, in frames of width x height pixels.
  LineSamples(Axis axis, int width, int height);

  /// One bit: pattern and inverse.
  void add(const BitRole& role, ImageView<const T> p, ImageView<const T> q);
  /// After the last bit. `limits` are those of a row of the frame.
  BorderTable learn(GrayLimits limits) const;

 private:
  int place(int line) const;

  Axis axis_ = Axis::kX;
  int length_ = 0;   ///< of a line
  int breadth_ = 0;  ///< of the frame across the lines
  int count_ = 0;
  GrayStore<T> sums_;
  std::vector<T> p_, q_;  ///< some columns, turned into rows
};

}  // namespace raysteer::calib::decode
