#include "host/cli/target_sheet.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "calib/target/artwork.hpp"
#include "calib/target/detect.hpp"
#include "hal/base/nearest.hpp"
#include "host/exchange/number_text.hpp"
#include "host/report/calibration_result.hpp"

namespace raysteer::host::cli {
namespace {

// Upright sheets, ISO 216 and ANSI.
const std::array kPapers{Paper{"A4", 210, 297}, Paper{"A3", 297, 420},  Paper{"A2", 420, 594},
                         Paper{"A1", 594, 841}, Paper{"A0", 841, 1189}, Paper{"letter", 215.9, 279.4}};

// White around the squares: half a square, so that the outermost corners stand clear, at least the printer's margin.
double white(const TargetSpec& target) { return std::max(kSheetMargin, 500 * target.square_m); }

struct Need {
  double width, height;
};
Need need(const TargetSpec& target, double square_mm) {
  const double around = 2 * std::max(kSheetMargin, square_mm / 2);
  return {(target.corner_columns() + 1) * square_mm + around,
          (target.corner_rows() + 1) * square_mm + around + kSheetFoot};
}

bool fits(const Need& need, double width, double height) {
  return need.width <= width + 1e-9 && need.height <= height + 1e-9;
}

Error does_not_fit(const TargetSpec& target, const Paper& paper, const Need& needed) {
  double largest = 0;  // whole half millimetres
  for (double square = 0.5; square < 1000 * target.square_m; square += 0.5) {
    const Need smaller = need(target, square);
    if (fits(smaller, paper.width_mm, paper.height_mm) || fits(smaller, paper.height_mm, paper.width_mm)) {
      largest = square;
    }
  }
  std::string larger;
  for (const Paper& other : kPapers) {
    if (other.name.starts_with('A') &&
        (fits(needed, other.width_mm, other.height_mm) || fits(needed, other.height_mm, other.width_mm))) {
      larger = " or --paper " + other.name;
      break;
    }
  }
  return fail(RCode::kTargetDoesNotFit,
              fmt::format("it needs {:.0f} x {:.0f} mm, {} has {:g} x {:g} mm; {}{} would fit", needed.width,
                          needed.height, paper.name, paper.width_mm, paper.height_mm,
                          largest > 0 ? fmt::format("--square-mm {:g}", largest) : "fewer squares", larger));
}

// A bar from mark to mark: its length is between the outer edges, where a rule is laid.
void draw_bar(exchange::Sheet& sheet, double x, double y, double length) {
  sheet.black.push_back({x, y, length, 0.6});
  sheet.black.push_back({x, y - 2.4, 0.3, 2.4});
  sheet.black.push_back({x + length - 0.3, y - 2.4, 0.3, 2.4});
  for (double at = 10; at < length; at += 10) {
    const double tall = std::fmod(at, 50) == 0 ? 1.8 : 1.0;
    sheet.black.push_back({x + at - 0.1, y - tall, 0.2, tall});
  }
}

}  // namespace

// Blurred by (1 2 1)/4 both ways: a lens does, and sub-pixel refinement counts on it.
Image<std::uint8_t> softened(const Image<float>& ink) {
  Image<std::uint8_t> grey(ink.width(), ink.height());
  grey.fill(255);
  for (int y = 1; y + 1 < ink.height(); ++y) {
    for (int x = 1; x + 1 < ink.width(); ++x) {
      float sum = 0;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const auto weight = static_cast<float>((2 - std::abs(dx)) * (2 - std::abs(dy)));
          sum += weight * std::min(1.0F, ink(x + dx, y + dy));
        }
      }
      grey(x, y) = static_cast<std::uint8_t>(std::lround(255 * (1 - sum / 16)));
    }
  }
  return grey;
}

double draw_foot(exchange::Sheet& sheet, const std::string& what) {
  const double bar_mm = sheet.width_mm >= 200 + 2 * kSheetMargin   ? 200
                        : sheet.width_mm >= 100 + 2 * kSheetMargin ? 100
                                                                   : 30;
  const double foot = sheet.height_mm - kSheetMargin;
  draw_bar(sheet, kSheetMargin, foot - 5, bar_mm);
  sheet.texts.push_back(
      {kSheetMargin, foot, 3,
       fmt::format("Raysteer: {}. Print at 100 %. The bar is {:.0f} mm from end to end: measure it.", what, bar_mm)});
  return bar_mm;
}

Result<Paper> paper(const std::string& name) {
  std::vector<std::string_view> known;
  for (const Paper& row : kPapers) {
    if (row.name == name) {
      return row;
    }
    known.push_back(row.name);
  }
  double width = 0, height = 0;
  char rest = 0;
  if (std::sscanf(name.c_str(), "%lfx%lf%c", &width, &height, &rest) == 2 && width >= 50 && height >= 50 &&
      width <= 5000 && height <= 5000) {
    return Paper{name + " mm", std::min(width, height), std::max(width, height)};
  }
  return fail(RCode::kUsage, "--paper takes A4, A3, A2, A1, A0, letter or WIDTHxHEIGHT in mm (50 to 5000), not '" +
                                 name + "'" + did_you_mean(name, known));
}

Result<TargetSheet> lay_out(const TargetSpec& target, const Paper& paper) {
  const Result<calib::target::Artwork> art = calib::target::artwork(target);
  RAYSTEER_TRY(art);
  const Need needed = need(target, 1000 * target.square_m);
  TargetSheet out;
  exchange::Sheet& sheet = out.sheet;
  sheet.width_mm = paper.width_mm;
  sheet.height_mm = paper.height_mm;
  if (!fits(needed, sheet.width_mm, sheet.height_mm)) {
    std::swap(sheet.width_mm, sheet.height_mm);
    if (!fits(needed, sheet.width_mm, sheet.height_mm)) {
      return does_not_fit(target, paper, needed);
    }
  }
  const double width = 1000 * art->width_m;
  const double height = 1000 * art->height_m;
  out.left_mm = (sheet.width_mm - width) / 2;
  out.top_mm = std::max(white(target), (sheet.height_mm - kSheetFoot - height) / 2);
  for (const calib::target::BlackRectangle& r : art->black) {
    sheet.black.push_back({out.left_mm + 1000 * r.x, out.top_mm + 1000 * r.y, 1000 * r.width, 1000 * r.height});
  }
  sheet.title = report::describe(target);
  out.bar_mm = draw_foot(sheet, sheet.title + (target.kind == TargetKind::kCharuco
                                                   ? fmt::format(", markers {:g} mm", 1000 * target.marker_m)
                                                   : std::string()));
  return out;
}

Status check_sheet(const TargetSpec& target, const TargetSheet& laid) {
  // A smallest cell of at least four pixels is found by every detector; more would only take time.
  const double cell_mm = 1000 * (target.kind == TargetKind::kCharuco ? target.marker_m / 9 : target.square_m / 5);
  // The odd factor keeps edges off the pixel grid, as in a camera: a rough place that is exactly right already looks
  // to the detector like one that could not be refined.
  const double per_mm = 1.0372 * std::clamp(4 / cell_mm, 1.0, 20.0);
  const int width = static_cast<int>(std::lround(laid.sheet.width_mm * per_mm));
  const int height = static_cast<int>(std::lround(laid.sheet.height_mm * per_mm));
  Image<float> ink(width, height);
  // Each rectangle covers each pixel by its share in x times its share in y.
  for (const exchange::Sheet::Rectangle& r : laid.sheet.black) {
    const double left = r.x * per_mm, right = (r.x + r.width) * per_mm;
    const double top = r.y * per_mm, bottom = (r.y + r.height) * per_mm;
    for (int y = static_cast<int>(top); y < std::min<double>(height, bottom); ++y) {
      const double share_y = std::min(bottom, y + 1.0) - std::max(top, double{y * 1.0});
      for (int x = static_cast<int>(left); x < std::min<double>(width, right); ++x) {
        const double share_x = std::min(right, x + 1.0) - std::max(left, x * 1.0);
        ink(x, y) += static_cast<float>(share_x * share_y);
      }
    }
  }
  const Image<std::uint8_t> frame = softened(ink);
  const Result<calib::target::Detection> found = calib::target::detect(target, frame.view());
  if (!found) {
    return fail(RCode::kInternal, "the sheet does not show the target: " + found.error().message());
  }
  if (static_cast<int>(found->corners.size()) != target.corners()) {
    return fail(RCode::kInternal,
                fmt::format("the sheet shows {} of {} corners", found->corners.size(), target.corners()));
  }
  for (const calib::target::Corner& corner : found->corners) {
    const Eigen::Vector3d p = 1000 * calib::target::corner_position(target, corner.id);
    // Corner 0 is one square in from the top left; pixel centres are at integers.
    const double square = 1000 * target.square_m;
    const double x = (laid.left_mm + square + p.x()) * per_mm - 0.5;
    const double y = (laid.top_mm + square + p.y()) * per_mm - 0.5;
    if (std::hypot(corner.q.x() - x, corner.q.y() - y) > 0.1 * per_mm) {
      return fail(RCode::kInternal, fmt::format("corner {} of the sheet is {:.2f} mm from where it belongs", corner.id,
                                                std::hypot(corner.q.x() - x, corner.q.y() - y) / per_mm));
    }
  }
  return ok();
}

std::string session_block(const TargetSpec& target) {
  const bool charuco = target.kind == TargetKind::kCharuco;
  std::string text =
      fmt::format("[[target]]\nkind = \"{}\"\ncolumns = {}\nrows = {}\nsquare_m = {}\n",
                  charuco ? "charuco" : "chessboard", target.columns, target.rows, exchange::exact(target.square_m));
  if (charuco) {
    text += fmt::format("marker_m = {}\ndictionary = \"{}\"\nlayout = \"{}\"\n", exchange::exact(target.marker_m),
                        target.dictionary, target.layout == CharucoLayout::kLegacy ? "legacy" : "current");
  }
  return text;
}

}  // namespace raysteer::host::cli
