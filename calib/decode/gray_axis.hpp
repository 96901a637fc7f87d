// bound to the caller's thread: turns rows of Gray sums into codes and sub-pixel coordinates, top to bottom.
//
// Along x both borders of a pixel's stripe lie in its own row. Along y they lie in rows above and below, so a row is
// given out `reach` rows late.
#pragma once

#include <cstdint>
#include <vector>

#include "calib/decode/border_table.hpp"
#include "calib/decode/classify.hpp"
#include "calib/decode/code_map.hpp"
#include "calib/decode/find_borders.hpp"
#include "hal/base/pattern.hpp"

namespace raysteer::calib::decode {

template <class T>
class GrayAxis {
 public:
  /// Writes into `code`, and where they are not null into `value` and `variance`, all of the camera's size.
  GrayAxis(Axis axis, const PatternBlock& block, const GrayLimits& limits, BorderTable borders, int height,
           Image<std::uint16_t>& code, Image<float>* value, Image<float>* variance);

  /// Row v = 0, 1, 2 ... Reasons are or-ed into `mask`.
  void row(const GraySums<T>& sums, const T* white, const T* black, std::uint8_t* mask);
  /// Row v - lag() has its coordinates when row v has been given.
  int lag() const { return axis_ == Axis::kY ? reach_ : 0; }
  /// After the last row.
  void finish();

 private:
  void place_x(const GraySums<T>& sums);
  void place_y(const GraySums<T>& sums);
  void give_out_y(int v);
  /// Row `index` of the gaps, from pixel `first` on.
  GapRow gap(int index, int first = 0);
  void place(int v);

  Axis axis_;
  PatternBlock block_;
  GrayLimits limits_;
  BorderTable borders_;
  int height_;
  Image<std::uint16_t>* code_;
  Image<float>* value_;
  Image<float>* variance_;

  int next_ = 0;    ///< row that comes next
  int reach_ = 0;   ///< gaps searched on either side
  int stride_ = 0;  ///< floats of one row of gaps
  int gap_rows_ = 0;
  std::vector<float> gaps_;   ///< place, number, variance of the border nearest to a, then to b
  std::vector<float> noise_;  ///< variance of p - q, this row and the one before
  std::vector<T> previous_;   ///< finest, weakest, weakest_bit of the row before
  std::vector<GapRow> before_, after_;
};

}  // namespace raysteer::calib::decode
