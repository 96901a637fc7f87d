#include "calib/target/charuco.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <opencv2/aruco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "calib/target/refine.hpp"

namespace raysteer::calib::target {
namespace {

constexpr double kMinContrast = 20;     // grey levels; below, cornerSubPix follows noise
constexpr double kCornerSigma = 0.1;    // px, before a fit says better
constexpr int kFewestCorners = 20;      // algorithms 1.1, gate per view
constexpr double kLayoutInliers = 0.8;  // of markers; the other layout keeps at most every second row

struct Markers {
  std::vector<int> ids;
  std::vector<std::vector<cv::Point2f>> corners;  // clockwise from the marker's top left
};

// "5X5_1000" to OpenCV's number of it: sizes 4..7, counts 50, 100, 250, 1000.
std::optional<int> dictionary_number(const std::string& name) {
  constexpr std::array kCounts{"50", "100", "250", "1000"};
  for (int size = 4; size <= 7; ++size) {
    for (int i = 0; i < 4; ++i) {
      const std::string digit = std::to_string(size);
      std::string candidate = digit;
      candidate += "X";
      candidate += digit;
      candidate += "_";
      candidate += kCounts[static_cast<std::size_t>(i)];
      if (name == candidate || name == "DICT_" + candidate) {
        return cv::aruco::DICT_4X4_50 + 4 * (size - 4) + i;
      }
    }
  }
  return std::nullopt;
}

Markers find_markers(const cv::Mat& frame, const cv::Ptr<cv::aruco::Dictionary>& dictionary) {
  auto parameters = cv::aruco::DetectorParameters::create();
  parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_NONE;  // we refine chessboard corners, not markers
  parameters->minMarkerPerimeterRate = 0.01;                           // boards with hundreds of markers
  Markers markers;
  cv::aruco::detectMarkers(frame, dictionary, markers.corners, markers.ids, parameters);
  return markers;
}

// The marker's corners on the board, in squares, clockwise from its top left.
std::array<cv::Point2f, 4> marker_outline(const TargetSpec& target, cv::Point square) {
  const auto margin = static_cast<float>((1 - target.marker_m / target.square_m) / 2);
  const auto x = static_cast<float>(square.x);
  const auto y = static_cast<float>(square.y);
  return {{{x + margin, y + margin},
           {x + 1 - margin, y + margin},
           {x + 1 - margin, y + 1 - margin},
           {x + margin, y + 1 - margin}}};
}

struct Fit {
  CharucoLayout layout = CharucoLayout::kAuto;
  double inliers = 0;  // share of the markers that agree with one homography
  std::vector<std::size_t> markers;
};

// How well do the markers lie on the board in this layout? The tolerance of a quarter of a square swallows what the
// lens bends and is far below the whole square that a wrong layout misses by.
Fit fit_layout(const TargetSpec& target, CharucoLayout layout, const Markers& markers) {
  Fit fit{.layout = layout, .inliers = 0, .markers = {}};
  std::vector<cv::Point2f> on_board;
  std::vector<cv::Point2f> on_image;
  std::vector<std::size_t> which;
  double side = 0;
  for (std::size_t i = 0; i < markers.ids.size(); ++i) {
    const cv::Point square = marker_square(target, layout, markers.ids[i]);
    if (square.x < 0) {
      continue;
    }
    const auto outline = marker_outline(target, square);
    on_board.insert(on_board.end(), outline.begin(), outline.end());
    on_image.insert(on_image.end(), markers.corners[i].begin(), markers.corners[i].end());
    which.push_back(i);
    side += cv::norm(markers.corners[i][0] - markers.corners[i][1]);
  }
  if (which.size() < 4) {
    return fit;
  }
  side *= target.square_m / target.marker_m / static_cast<double>(which.size());
  std::vector<std::uint8_t> agrees;
  const cv::Mat H = cv::findHomography(on_board, on_image, cv::RANSAC, std::max(2.0, side / 4), agrees);
  if (H.empty()) {
    return fit;
  }
  for (std::size_t m = 0; m < which.size(); ++m) {
    if (agrees[4 * m] != 0 && agrees[4 * m + 1] != 0 && agrees[4 * m + 2] != 0 && agrees[4 * m + 3] != 0) {
      fit.markers.push_back(which[m]);
    }
  }
  fit.inliers = static_cast<double>(fit.markers.size()) / static_cast<double>(markers.ids.size());
  return fit;
}

// Where the corner of the board at (x, y) squares is in the image, from the markers around it alone: near by, a
// homography holds whatever the lens does.
std::optional<cv::Point2f> rough_place(const TargetSpec& target, const Fit& fit, const Markers& markers,
                                       cv::Point2f at) {
  std::vector<std::pair<double, std::size_t>> near;
  for (const std::size_t m : fit.markers) {
    const cv::Point square = marker_square(target, fit.layout, markers.ids[m]);
    const double distance =
        std::hypot(static_cast<float>(square.x) + 0.5F - at.x, static_cast<float>(square.y) + 0.5F - at.y);
    if (distance < 2.2) {
      near.emplace_back(distance, m);
    }
  }
  // A corner inside the board touches two markers; with neither of them it may lie outside the picture.
  std::ranges::sort(near);
  if (near.size() < 3 || near[0].first > 0.8) {
    return std::nullopt;
  }
  near.resize(std::min<std::size_t>(near.size(), 6));
  std::vector<cv::Point2f> on_board;
  std::vector<cv::Point2f> on_image;
  for (const auto& [distance, m] : near) {
    const auto outline = marker_outline(target, marker_square(target, fit.layout, markers.ids[m]));
    on_board.insert(on_board.end(), outline.begin(), outline.end());
    on_image.insert(on_image.end(), markers.corners[m].begin(), markers.corners[m].end());
  }
  const cv::Mat H = cv::findHomography(on_board, on_image);
  if (H.empty()) {
    return std::nullopt;
  }
  std::vector<cv::Point2f> place;
  cv::perspectiveTransform(std::vector<cv::Point2f>{at}, place, H);
  return place[0];
}

// Half-window in px: the refinement must not reach into the markers (0.4 of the spacing does: 0.55 px RMS instead of
// 0.16 on a real set).
int half_window(const TargetSpec& target, const Fit& fit, const Markers& markers) {
  std::vector<double> sides;
  for (const std::size_t m : fit.markers) {
    for (std::size_t i = 0; i < 4; ++i) {
      sides.push_back(cv::norm(markers.corners[m][i] - markers.corners[m][(i + 1) % 4]));
    }
  }
  const double margin_px = median(sides) * (target.square_m / target.marker_m - 1) / 2;
  return std::max(3, static_cast<int>(std::lround(margin_px)));
}

Error nothing_found(const TargetSpec& target, const cv::Mat& frame, const cv::Ptr<cv::aruco::Dictionary>& dictionary,
                    std::size_t found) {
  cv::Mat flipped;
  cv::flip(frame, flipped, 1);
  const Markers mirrored = find_markers(flipped, dictionary);
  if (mirrored.ids.size() >= 8 && mirrored.ids.size() > 2 * found) {
    return fail(RCode::kMirroredTarget, std::to_string(mirrored.ids.size()) + " markers of " + target.dictionary +
                                            " appear only when the image is flipped");
  }
  return fail(RCode::kTargetNotFound, "expected markers of " + target.dictionary + ", saw " + std::to_string(found) +
                                          " in a frame of " + std::to_string(frame.cols) + "x" +
                                          std::to_string(frame.rows));
}

}  // namespace

cv::Point marker_square(const TargetSpec& target, CharucoLayout layout, int id) {
  // Current layout: the top-left square is black and bare. Legacy with an even number of rows: it carries a marker.
  const bool first_carries = layout == CharucoLayout::kLegacy && target.rows % 2 == 0;
  const int even = (target.columns + (first_carries ? 1 : 0)) / 2;  // markers in rows 0, 2, ...
  const int odd = target.columns - even;                            // and in rows 1, 3, ...
  if (id < 0) {
    return {-1, -1};
  }
  const int pair = id / (even + odd);
  const int rest = id % (even + odd);
  const bool upper = rest < even;
  const int row = 2 * pair + (upper ? 0 : 1);
  const int place = upper ? rest : rest - even;
  const int column = 2 * place + (upper == first_carries ? 0 : 1);
  return row < target.rows ? cv::Point(column, row) : cv::Point(-1, -1);
}

namespace {

Result<Detection> place_corners(const TargetSpec& target, const cv::Mat& frame, const Markers& markers,
                                const Fit& best) {
  if (best.inliers < kLayoutInliers) {
    return fail(RCode::kWrongTarget, "expected " + std::to_string(target.columns) + "x" + std::to_string(target.rows) +
                                         " squares; of " + std::to_string(markers.ids.size()) +
                                         " markers seen (highest id " +
                                         std::to_string(*std::ranges::max_element(markers.ids)) + ") only " +
                                         std::to_string(best.markers.size()) + " lie where such a board has them");
  }
  std::vector<cv::Point2f> places;
  std::vector<int> ids;
  for (int row = 0; row < target.corner_rows(); ++row) {
    for (int column = 0; column < target.corner_columns(); ++column) {
      const cv::Point2f at(static_cast<float>(column + 1), static_cast<float>(row + 1));
      if (const auto place = rough_place(target, best, markers, at)) {
        places.push_back(*place);
        ids.push_back(row * target.corner_columns() + column);
      }
    }
  }
  const int window = half_window(target, best, markers);
  const std::vector<bool> good = refine_corners(frame, places, window, kMinContrast);

  Detection detection;
  detection.layout = best.layout;
  std::vector<double> blurs;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!good[i]) {
      continue;
    }
    detection.corners.push_back({ids[i], {places[i].x, places[i].y}, kCornerSigma});
    if (i + 1 < places.size() && good[i + 1] && ids[i + 1] == ids[i] + 1 && ids[i + 1] % target.corner_columns() != 0) {
      if (const double blur = edge_blur(frame, places[i], places[i + 1], static_cast<float>(window)); blur > 0) {
        blurs.push_back(blur);
      }
    }
  }
  detection.sharpness_px = median(blurs);
  if (static_cast<int>(detection.corners.size()) < std::min(kFewestCorners, target.corners())) {
    return fail(RCode::kTargetNotFound, "only " + std::to_string(detection.corners.size()) + " of " +
                                            std::to_string(target.corners()) + " corners could be placed");
  }
  return detection;
}

}  // namespace

Status check_charuco(const TargetSpec& target) {
  if (!dictionary_number(target.dictionary)) {
    return fail(RCode::kBadValue, "dictionary '" + target.dictionary + "' is not known; use one like 5X5_1000");
  }
  // Only the ratio matters here, but both come from the same rule.
  if (!(target.marker_m > 0) || !(target.square_m > target.marker_m)) {
    return fail(RCode::kBadValue, "a ChArUco board needs 0 < marker_m < square_m");
  }
  return ok();
}

cv::Ptr<cv::aruco::Dictionary> dictionary_of(const TargetSpec& target) {
  return cv::aruco::getPredefinedDictionary(*dictionary_number(target.dictionary));
}

std::vector<Result<Detection>> detect_charuco(const TargetSpec& target, std::span<const cv::Mat> frames) {
  if (const Status status = check_charuco(target); !status) {
    return std::vector<Result<Detection>>(frames.size(), Result<Detection>(status.error()));
  }
  const auto dictionary = dictionary_of(target);
  std::vector<CharucoLayout> layouts{target.layout};
  if (target.layout == CharucoLayout::kAuto) {
    layouts = {CharucoLayout::kCurrent};
    if (target.rows % 2 == 0) {
      layouts.push_back(CharucoLayout::kLegacy);
    }
  }
  // With an odd number of columns the layouts differ by a shift of one square but for one marker in every two rows: a
  // single view may fit both. The views decide together.
  std::vector<Markers> markers;
  std::vector<std::vector<Fit>> fits(layouts.size());
  std::vector<double> votes(layouts.size(), 0);
  for (const cv::Mat& frame : frames) {
    markers.push_back(find_markers(frame, dictionary));
    for (std::size_t l = 0; l < layouts.size(); ++l) {
      fits[l].push_back(fit_layout(target, layouts[l], markers.back()));
      votes[l] += static_cast<double>(fits[l].back().markers.size());
    }
  }
  const auto chosen = static_cast<std::size_t>(std::ranges::max_element(votes) - votes.begin());
  std::vector<Result<Detection>> detections;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (markers[i].ids.size() < 4) {
      detections.emplace_back(nothing_found(target, frames[i], dictionary, markers[i].ids.size()));
    } else {
      detections.push_back(place_corners(target, frames[i], markers[i], fits[chosen][i]));
    }
  }
  return detections;
}

}  // namespace raysteer::calib::target
