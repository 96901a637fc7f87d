#include "calib/synth/print.hpp"

#include <cmath>
#include <utility>

namespace raysteer::calib::synth {

Print::Print(const TargetSpec& target, MarkerCells markers, double black, double white)
    : target_(target),
      markers_(std::move(markers)),
      black_(black),
      white_(white),
      columns_(target.corner_columns() + 1),
      rows_(target.corner_rows() + 1),
      parity_(target.kind == TargetKind::kCharuco && target.layout == CharucoLayout::kLegacy && rows_ % 2 == 0 ? 1
                                                                                                               : 0) {}

int Print::marker_of(int column, int row) const {
  if (target_.kind != TargetKind::kCharuco || !white_square(column, row)) {
    return -1;
  }
  const int in_full_rows = row / 2 * columns_ + (row % 2) * ((columns_ + parity_) / 2);
  const int marker = in_full_rows + column / 2;
  return marker < markers_.markers() ? marker : -1;
}

double Print::reflectance(double u, double v) const {
  const double square = target_.square_m;
  const int column = static_cast<int>(std::floor(u / square)) + 1;
  const int row = static_cast<int>(std::floor(v / square)) + 1;
  if (column < 0 || row < 0 || column >= columns_ || row >= rows_) {
    return white_;
  }
  if (!white_square(column, row)) {
    return black_;
  }
  const int marker = marker_of(column, row);
  if (marker < 0) {
    return white_;
  }
  const double cell = target_.marker_m / markers_.side;
  const int i = static_cast<int>(std::floor((u - (column - 1) * square - marker_edge()) / cell));
  const int j = static_cast<int>(std::floor((v - (row - 1) * square - marker_edge()) / cell));
  if (i < 0 || j < 0 || i >= markers_.side || j >= markers_.side) {
    return white_;
  }
  const int place = (marker * markers_.side + j) * markers_.side + i;
  return markers_.cells[static_cast<std::size_t>(place)] != 0 ? white_ : black_;
}

bool Print::plain(double u0, double u1, double v0, double v1) const {
  const double square = target_.square_m;
  const double left = std::floor(u0 / square);
  const double top = std::floor(v0 / square);
  if (left != std::floor(u1 / square) || top != std::floor(v1 / square)) {
    const bool outside = u1 < -square || v1 < -square || u0 > (columns_ - 1) * square || v0 > (rows_ - 1) * square;
    return outside;
  }
  const int column = static_cast<int>(left) + 1;
  const int row = static_cast<int>(top) + 1;
  if (column < 0 || row < 0 || column >= columns_ || row >= rows_ || marker_of(column, row) < 0) {
    return true;
  }
  const double near = marker_edge();
  const double far = square - near;
  const double x0 = u0 - left * square;
  const double y0 = v0 - top * square;
  const double x1 = u1 - left * square;
  const double y1 = v1 - top * square;
  if (x1 < near || y1 < near || x0 > far || y0 > far) {
    return true;
  }
  const double cell = target_.marker_m / markers_.side;
  return x0 >= near && y0 >= near && x1 <= far && y1 <= far &&
         std::floor((x0 - near) / cell) == std::floor((x1 - near) / cell) &&
         std::floor((y0 - near) / cell) == std::floor((y1 - near) / cell);
}

}  // namespace raysteer::calib::synth
