#include "calib/target/artwork.hpp"

#include <opencv2/aruco.hpp>
#include <optional>
#include <string>

#include "calib/target/charuco.hpp"

namespace raysteer::calib::target {
namespace {

constexpr int kMostSquares = 200;  // along one side; beyond, a typing error

void draw_squares(const TargetSpec& target, int columns, int rows, int black_parity, Artwork& art) {
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      if ((row + column) % 2 == black_parity) {
        art.black.push_back({column * target.square_m, row * target.square_m, target.square_m, target.square_m});
      }
    }
  }
}

// A marker's black cells, runs along a row in one piece.
void draw_marker(const TargetSpec& target, const cv::Mat& cells, cv::Point square, Artwork& art) {
  const double cell = target.marker_m / cells.cols;
  const double margin = (target.square_m - target.marker_m) / 2;
  for (int row = 0; row < cells.rows; ++row) {
    for (int column = 0; column < cells.cols; ++column) {
      int end = column;
      while (end < cells.cols && cells.at<std::uint8_t>(row, end) == 0) {
        ++end;
      }
      if (end > column) {
        art.black.push_back({square.x * target.square_m + margin + column * cell,
                             square.y * target.square_m + margin + row * cell, (end - column) * cell, cell});
        column = end;
      }
    }
  }
}

}  // namespace

Result<Artwork> artwork(const TargetSpec& target) {
  const bool charuco = target.kind == TargetKind::kCharuco;
  if (target.corner_columns() < 2 || target.corner_rows() < 2 || target.columns > kMostSquares ||
      target.rows > kMostSquares) {
    return fail(RCode::kBadValue, "columns and rows must give 2 to " + std::to_string(kMostSquares) +
                                      " corners each way, got " + std::to_string(target.corner_columns()) + " x " +
                                      std::to_string(target.corner_rows()));
  }
  if (!(target.square_m > 0)) {
    return fail(RCode::kTargetScaleMissing, "a target is printed to scale: its squares need a size");
  }
  Artwork art;
  const int columns = target.corner_columns() + 1;
  const int rows = target.corner_rows() + 1;
  art.width_m = columns * target.square_m;
  art.height_m = rows * target.square_m;
  if (!charuco) {
    draw_squares(target, columns, rows, 0, art);
    return art;
  }
  RAYSTEER_TRY(check_charuco(target));
  const CharucoLayout layout = target.layout == CharucoLayout::kAuto ? CharucoLayout::kCurrent : target.layout;
  const cv::Ptr<cv::aruco::Dictionary> dictionary = dictionary_of(target);
  const cv::Point first = marker_square(target, layout, 0);
  draw_squares(target, columns, rows, 1 - (first.x + first.y) % 2, art);
  const int markers = columns * rows - static_cast<int>(art.black.size());
  if (markers > dictionary->bytesList.rows) {
    return fail(RCode::kBadValue, "the target needs " + std::to_string(markers) + " markers, " + target.dictionary +
                                      " has " + std::to_string(dictionary->bytesList.rows));
  }
  for (int id = 0; id < markers; ++id) {
    cv::Mat cells;
    dictionary->drawMarker(id, dictionary->markerSize + 2, cells, 1);  // one pixel a cell, border of one
    draw_marker(target, cells, marker_square(target, layout, id), art);
  }
  return art;
}

}  // namespace raysteer::calib::target
