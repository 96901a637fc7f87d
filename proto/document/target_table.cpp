#include "proto/document/target_table.hpp"

#include <array>
#include <string_view>
#include <vector>

namespace raysteer::proto::document {
namespace {

const std::vector<std::string_view> kDictionaries = {
    "4X4_50",   "4X4_100",  "4X4_250",        "4X4_1000",      "5X5_50",        "5X5_100",        "5X5_250",
    "5X5_1000", "6X6_50",   "6X6_100",        "6X6_250",       "6X6_1000",      "7X7_50",         "7X7_100",
    "7X7_250",  "7X7_1000", "ARUCO_ORIGINAL", "APRILTAG_16h5", "APRILTAG_25h9", "APRILTAG_36h10", "APRILTAG_36h11",
};

}  // namespace

TargetSpec read_target_spec(TomlTable& table) {
  constexpr Range<double> kSquare{1e-4, 1};
  constexpr std::string_view kMetres = "lengths are in metres (25 mm is 0.025)";
  TargetSpec spec;
  spec.kind = table.choice("kind", {"chessboard", "charuco"}) == 0 ? TargetKind::kChessboard : TargetKind::kCharuco;
  spec.columns = static_cast<int>(table.integer("columns", {2, 1000}));
  spec.rows = static_cast<int>(table.integer("rows", {2, 1000}));
  if (table.has("square_m")) {
    spec.square_m = table.number("square_m", kSquare, {}, kMetres);
  } else {
    table.number("square_m", kSquare, 0.0);  // without it there is no scale, which calibrate refuses
  }
  if (spec.kind == TargetKind::kCharuco) {
    if (table.has("marker_m") || spec.square_m > 0) {
      spec.marker_m = table.number("marker_m", kSquare, {}, kMetres);
    } else {
      table.number("marker_m", kSquare, 0.0);
    }
    if (spec.square_m > 0 && spec.marker_m >= spec.square_m) {
      table.fault(RCode::kBadValue, "marker_m", "must be smaller than 'square_m'");
    }
    spec.dictionary = kDictionaries.at(static_cast<std::size_t>(table.choice("dictionary", kDictionaries)));
    constexpr std::array kLayouts{CharucoLayout::kAuto, CharucoLayout::kLegacy, CharucoLayout::kCurrent};
    spec.layout = kLayouts.at(static_cast<std::size_t>(table.choice("layout", {"auto", "legacy", "current"}, 0)));
  }
  return spec;
}

}  // namespace raysteer::proto::document
