#include "calib/target/chessboard.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "calib/target/refine.hpp"

namespace raysteer::calib::target {
namespace {

constexpr double kMinContrast = 20;   // grey levels; below, cornerSubPix follows noise
constexpr int kQuickSide = 1000;      // px; boards are found in frames of at most twice this
constexpr double kCornerSigma = 0.1;  // px, before a fit says better

// Corners of one board, row by row.
struct Grid {
  int columns = 0;
  int rows = 0;
  std::vector<cv::Point2f> places;
  cv::Point2f at(int column, int row) const { return places[static_cast<std::size_t>(row * columns + column)]; }
};

// In a frame made smaller first: the search takes seconds on five million pixels of noise, and refine_corners() places
// the corners on the frame itself anyway.
bool find_quickly(const TargetSpec& target, const cv::Mat& frame, Grid& grid) {
  grid.columns = target.columns;
  grid.rows = target.rows;
  const auto find = [&](const cv::Mat& pixels) {
    return cv::findChessboardCorners(pixels, cv::Size(target.columns, target.rows), grid.places,
                                     cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE);
  };
  const int factor = std::max(frame.cols, frame.rows) / kQuickSide;
  if (factor > 1) {
    cv::Mat small;
    cv::resize(frame, small, cv::Size(frame.cols / factor, frame.rows / factor), 0, 0, cv::INTER_AREA);
    const auto scale_x = static_cast<float>(frame.cols) / static_cast<float>(small.cols);
    const auto scale_y = static_cast<float>(frame.rows) / static_cast<float>(small.rows);
    if (find(small)) {
      for (cv::Point2f& q : grid.places) {
        // Pixel centres are whole numbers in both.
        q = {(q.x + 0.5F) * scale_x - 0.5F, (q.y + 0.5F) * scale_y - 0.5F};
      }
      return true;
    }
  }
  return find(frame);
}

// Seconds a frame, so only where the quick search fails.
bool find_thoroughly(const TargetSpec& target, const cv::Mat& frame, Grid& grid) {
  return cv::findChessboardCornersSB(frame, cv::Size(target.columns, target.rows), grid.places,
                                     cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_ACCURACY);
}

// The largest board in the frame, to say what was seen instead.
bool find_any(const cv::Mat& frame, Grid& grid) {
  cv::Mat meta;
  if (!cv::findChessboardCornersSB(frame, cv::Size(3, 3), grid.places, cv::CALIB_CB_LARGER, meta)) {
    return false;
  }
  grid.columns = meta.cols;
  grid.rows = meta.rows;
  return static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows) == grid.places.size();
}

double smallest_spacing(const Grid& grid) {
  double smallest = std::numeric_limits<double>::infinity();
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      if (column + 1 < grid.columns) {
        smallest = std::min(smallest, cv::norm(grid.at(column + 1, row) - grid.at(column, row)));
      }
      if (row + 1 < grid.rows) {
        smallest = std::min(smallest, cv::norm(grid.at(column, row + 1) - grid.at(column, row)));
      }
    }
  }
  return smallest;
}

// Is there one more line of saddle points beyond this side? Then the board is larger than was said, and which part of
// it was taken is chance. `inner` and `outer` step through the corners of the side's last two lines.
template <class Place>
bool continues(const cv::Mat& frame, int count, Place&& place) {
  std::vector<cv::Point2f> beyond;
  double spacing = std::numeric_limits<double>::infinity();
  for (int i = 0; i < count; ++i) {
    const cv::Point2f outer = place(i, 0);
    const cv::Point2f inner = place(i, 1);
    const cv::Point2f third = place(i, 2);
    // Squares shrink with distance by nearly the same ratio from one to the next.
    const auto ratio = static_cast<float>(cv::norm(outer - inner) / std::max(1e-3, cv::norm(inner - third)));
    beyond.push_back(outer + (outer - inner) * ratio);
    spacing = std::min(spacing, cv::norm(outer - inner));
  }
  const int window = std::clamp(static_cast<int>(0.25 * spacing), 3, 15);
  for (const cv::Point2f& p : beyond) {
    const auto reach = static_cast<float>(2 * window);
    if (p.x < reach || p.y < reach || p.x > static_cast<float>(frame.cols) - reach ||
        p.y > static_cast<float>(frame.rows) - reach) {
      return false;
    }
  }
  int saddles = 0;
  for (int i = 0; i < count; ++i) {
    // Four squares around it: opposite ones alike, neighbours unlike. On the board's border two of them are paper.
    const cv::Point2f p = beyond[static_cast<std::size_t>(i)];
    const cv::Point2f out = (p - place(i, 0)) * 0.35F;
    const int next = i + 1 < count ? i + 1 : i - 1;
    const cv::Point2f side = (place(next, 0) - place(i, 0)) * 0.35F;
    const double a = grey_at(frame, p + out + side);
    const double b = grey_at(frame, p + out - side);
    const double c = grey_at(frame, p - out - side);
    const double d = grey_at(frame, p - out + side);
    const double contrast = std::abs(c - d);
    if (contrast > kMinContrast && std::abs(a - c) < 0.4 * contrast && std::abs(b - d) < 0.4 * contrast) {
      ++saddles;
    }
  }
  return saddles * 10 >= count * 7;
}

bool is_part_of_a_larger_board(const cv::Mat& frame, const Grid& grid) {
  const int last_column = grid.columns - 1;
  const int last_row = grid.rows - 1;
  return continues(frame, grid.rows, [&](int i, int back) { return grid.at(last_column - back, i); }) ||
         continues(frame, grid.rows, [&](int i, int back) { return grid.at(back, i); }) ||
         continues(frame, grid.columns, [&](int i, int back) { return grid.at(i, last_row - back); }) ||
         continues(frame, grid.columns, [&](int i, int back) { return grid.at(i, back); });
}

// Is the square outside the corner (column, row), away from the grid, darker than its neighbour along the row?
bool dark_outside(const cv::Mat& frame, const Grid& grid, int column, int row) {
  const int inward_x = column == 0 ? 1 : -1;
  const int inward_y = row == 0 ? 1 : -1;
  const cv::Point2f p = grid.at(column, row);
  const cv::Point2f x = (grid.at(column + inward_x, row) - p) * 0.4F;
  const cv::Point2f y = (grid.at(column, row + inward_y) - p) * 0.4F;
  const double opposite = grey_at(frame, p - x - y) + grey_at(frame, p + x + y);
  const double beside = grey_at(frame, p + x - y) + grey_at(frame, p - x + y);
  return opposite < beside;
}

void turn_half(Grid& grid) { std::ranges::reverse(grid.places); }

void mirror(Grid& grid) {
  for (int row = 0; row < grid.rows; ++row) {
    const auto first = grid.places.begin() + static_cast<std::ptrdiff_t>(row) * grid.columns;
    std::reverse(first, first + grid.columns);
  }
}

// The same order whatever the detector did: x to the right of y (right-handed with z away from the viewer), and the
// origin at the end whose outer square is dark; where both ends look alike, at the end nearer the image's top left.
void normalise_order(const cv::Mat& frame, Grid& grid) {
  const int last_column = grid.columns - 1;
  const int last_row = grid.rows - 1;
  const cv::Point2f x = grid.at(last_column, 0) - grid.at(0, 0);
  const cv::Point2f y = grid.at(0, last_row) - grid.at(0, 0);
  if (x.x * y.y - x.y * y.x < 0) {
    mirror(grid);
  }
  const bool first_dark = dark_outside(frame, grid, 0, 0);
  const bool last_dark = dark_outside(frame, grid, last_column, last_row);
  const cv::Point2f first = grid.at(0, 0);
  const cv::Point2f last = grid.at(last_column, last_row);
  const bool turn = first_dark != last_dark ? last_dark : last.x + last.y < first.x + first.y;
  if (turn) {
    turn_half(grid);
  }
}

struct Found {
  Detection detection;
  bool dark_origin = false;
};

Result<Found> detect_one(const TargetSpec& target, const cv::Mat& frame) {
  const std::string expected =
      "expected " + std::to_string(target.columns) + "x" + std::to_string(target.rows) + " inner corners";
  Grid grid;
  if (!find_quickly(target, frame, grid)) {
    Grid other;
    const bool any = find_any(frame, other);
    const auto [fewer, more] = std::minmax(other.columns, other.rows);
    const std::string seen = ", saw at least " + std::to_string(more) + "x" + std::to_string(fewer);
    const auto [expect_fewer, expect_more] = std::minmax(target.columns, target.rows);
    if (any && (more > expect_more || fewer > expect_fewer)) {
      return fail(RCode::kWrongTarget, expected + seen);
    }
    if (!find_thoroughly(target, frame, grid)) {
      if (any) {
        return fail(RCode::kWrongTarget, expected + seen);
      }
      return fail(RCode::kTargetNotFound, expected + " in a frame of " + std::to_string(frame.cols) + "x" +
                                              std::to_string(frame.rows) + "; no chessboard was seen");
    }
  }
  if (is_part_of_a_larger_board(frame, grid)) {
    return fail(RCode::kWrongTarget, expected + "; the pattern goes on beyond them");
  }
  normalise_order(frame, grid);
  const double spacing = smallest_spacing(grid);
  const int window = static_cast<int>(std::clamp(0.4 * spacing, 3.0, 15.0));
  const std::vector<bool> good = refine_corners(frame, grid.places, window, kMinContrast);

  Found found{.detection = {}, .dark_origin = dark_outside(frame, grid, 0, 0)};
  Detection& detection = found.detection;
  std::vector<double> blurs;
  for (int id = 0; id < target.corners(); ++id) {
    const auto i = static_cast<std::size_t>(id);
    if (!good[i]) {
      continue;
    }
    detection.corners.push_back({id, {grid.places[i].x, grid.places[i].y}, kCornerSigma});
    if ((id + 1) % target.columns != 0) {
      const double blur = edge_blur(frame, grid.places[i], grid.places[i + 1], static_cast<float>(0.3 * spacing));
      if (blur > 0) {
        blurs.push_back(blur);
      }
    }
  }
  detection.sharpness_px = median(blurs);
  if (detection.corners.size() * 10 < grid.places.size() * 8) {
    return fail(RCode::kTargetNotFound, "only " + std::to_string(detection.corners.size()) + " of " +
                                            std::to_string(target.corners()) + " corners have enough contrast");
  }
  return found;
}

// A board with odd numbers of inner corners both ways has outer squares of one colour at the ends of one diagonal and
// of the other at the other: a mirror image exchanges them. Which colour is right is the printer's choice, so the views
// are compared with each other. A board with an even number looks the same in a mirror.
void refuse_mirrored(const TargetSpec& target, std::span<const Result<Found>> sightings,
                     std::vector<Result<Detection>>& detections) {
  if (target.columns % 2 == 0 || target.rows % 2 == 0) {
    return;
  }
  const auto dark = std::ranges::count_if(sightings, [](const auto& s) { return s && s->dark_origin; });
  const auto light = std::ranges::count_if(sightings, [](const auto& s) { return s && !s->dark_origin; });
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    if (sightings[i] && dark != light && sightings[i]->dark_origin != (dark > light)) {
      detections[i] = fail(RCode::kMirroredTarget, "its black and white squares are exchanged against the other views");
    }
  }
}

}  // namespace

std::vector<Result<Detection>> detect_chessboard(const TargetSpec& target, std::span<const cv::Mat> frames) {
  std::vector<Result<Found>> sightings;
  std::vector<Result<Detection>> detections;
  for (const cv::Mat& frame : frames) {
    sightings.push_back(detect_one(target, frame));
    const auto& sighting = sightings.back();
    detections.push_back(sighting ? Result<Detection>(sighting->detection) : Result<Detection>(sighting.error()));
  }
  refuse_mirrored(target, sightings, detections);
  return detections;
}

}  // namespace raysteer::calib::target
