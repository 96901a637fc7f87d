#include "host/cli/datum_sheet.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "calib/target/datum.hpp"
#include "hal/base/datum_code.hpp"
#include "host/exchange/number_text.hpp"

namespace raysteer::host::cli {
namespace {

// In radii (docs/survey-format.md).
constexpr double kSide = 7;
constexpr double kRingInner = 2;
constexpr double kRingOuter = 3;
constexpr double kName = 7;     // mm below each datum for its name
constexpr double kBetween = 4;  // mm between datums: scissors
constexpr int kParts = 720;     // of a circle; its corners lie on it, and no side leaves it by more than 1e-5 r

struct Cells {
  int columns = 0;
  int rows = 0;
};

/// How many cells of a datum's size a sheet holds.
Cells cells(double radius_mm, double width_mm, double height_mm) {
  const double side = kSide * radius_mm;
  return {static_cast<int>((width_mm - 2 * kSheetMargin + kBetween + 1e-9) / (side + kBetween)),
          static_cast<int>((height_mm - 2 * kSheetMargin - kSheetFoot + kBetween + 1e-9) / (side + kName + kBetween))};
}

std::array<double, 2> on_circle(const std::array<double, 2>& middle, double radius, double part) {
  // y is down on the sheet: from +x towards +y as one looks at the print is against the clock.
  const double turn = 2 * std::numbers::pi * part;
  return {middle[0] + radius * std::cos(turn), middle[1] - radius * std::sin(turn)};
}

/// A sector of a ring, or with no inner radius a whole disc.
exchange::Sheet::Outline ring_part(const std::array<double, 2>& middle, double inner, double outer, double from,
                                   double to) {
  exchange::Sheet::Outline outline{.corners = {}, .white = true};
  const int steps = static_cast<int>(std::lround(kParts * (to - from)));
  for (int k = 0; k <= steps; ++k) {
    outline.corners.push_back(on_circle(middle, outer, from + (to - from) * k / steps));
  }
  for (int k = steps; inner > 0 && k >= 0; --k) {
    outline.corners.push_back(on_circle(middle, inner, from + (to - from) * k / steps));
  }
  return outline;
}

void draw_datum(exchange::Sheet& sheet, unsigned code, double radius_mm, const std::array<double, 2>& middle) {
  const double half = kSide / 2 * radius_mm;
  sheet.black.push_back({middle[0] - half, middle[1] - half, 2 * half, 2 * half});
  sheet.outlines.push_back(ring_part(middle, 0, radius_mm, 0, 1));
  const auto white = [code](int sector) { return (code >> (sector % kDatumBits) & 1U) != 0; };
  // Neighbouring white sectors are one shape, so that no seam shows between them. No code has all sectors white.
  for (int first = 0; first < kDatumBits; ++first) {
    if (!white(first) || white(first + kDatumBits - 1)) {
      continue;
    }
    int end = first + 1;
    while (white(end)) {
      ++end;
    }
    sheet.outlines.push_back(ring_part(middle, kRingInner * radius_mm, kRingOuter * radius_mm,
                                       first / double{kDatumBits}, end / double{kDatumBits}));
  }
  sheet.texts.push_back(
      {middle[0] - half, middle[1] + half + 4.5, 3, fmt::format("datum {}, r {:g} mm", code, radius_mm)});
}

/// Is a point inside an outline? Even and odd crossings of the way to its right.
bool inside(const exchange::Sheet::Outline& outline, double x, double y) {
  bool in = false;
  const auto& corners = outline.corners;
  for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
    if ((corners[i][1] > y) != (corners[j][1] > y) &&
        x < corners[i][0] + (corners[j][0] - corners[i][0]) * (y - corners[i][1]) / (corners[j][1] - corners[i][1])) {
      in = !in;
    }
  }
  return in;
}

}  // namespace

Result<DatumSheet> lay_out_datums(std::span<const unsigned> codes, double radius_mm, const Paper& paper) {
  for (const unsigned code : codes) {
    RAYSTEER_TRY(check_datum_code(code));
  }
  DatumSheet out;
  exchange::Sheet& sheet = out.sheet;
  sheet.width_mm = paper.width_mm;
  sheet.height_mm = paper.height_mm;
  Cells most = cells(radius_mm, sheet.width_mm, sheet.height_mm);
  const Cells across = cells(radius_mm, sheet.height_mm, sheet.width_mm);
  if (across.columns * across.rows > most.columns * most.rows) {
    most = across;
    std::swap(sheet.width_mm, sheet.height_mm);
  }
  const int count = static_cast<int>(codes.size());
  if (most.columns < 1 || most.rows < 1 || count > most.columns * most.rows) {
    double largest = 0;  // whole millimetres
    for (double radius = 1; radius < radius_mm; ++radius) {
      const Cells upright = cells(radius, paper.width_mm, paper.height_mm);
      const Cells turned = cells(radius, paper.height_mm, paper.width_mm);
      largest = std::max(upright.columns * upright.rows, turned.columns * turned.rows) >= count ? radius : largest;
    }
    return fail(
        RCode::kTargetDoesNotFit,
        fmt::format("{} holds {} datum(s) of radius {:g} mm, not {}; {}fewer codes a sheet or larger paper would fit",
                    paper.name, std::max(0, most.columns) * std::max(0, most.rows), radius_mm, count,
                    largest > 0 ? fmt::format("--radius-mm {:g}, ", largest) : ""));
  }
  const double side = kSide * radius_mm;
  const int columns = std::min(most.columns, count);
  const double left = (sheet.width_mm - columns * (side + kBetween) + kBetween) / 2;
  for (int k = 0; k < count; ++k) {
    const std::array<double, 2> middle{left + (k % columns) * (side + kBetween) + side / 2,
                                       kSheetMargin + (k / columns) * (side + kName + kBetween) + side / 2};
    draw_datum(sheet, codes[static_cast<std::size_t>(k)], radius_mm, middle);
    out.middles_mm.push_back(middle);
  }
  sheet.title = fmt::format("{} datum(s) of radius {:g} mm", count, radius_mm);
  out.bar_mm = draw_foot(sheet, sheet.title);
  return out;
}

Status check_datums(std::span<const unsigned> codes, double radius_mm, const DatumSheet& laid) {
  // 10 px of radius are found with ease; the odd factor keeps edges off the pixel grid, as in a camera.
  const double per_mm = 1.0372 * std::clamp(10 / radius_mm, 0.02, 20.0);
  constexpr int kFine = 2;  // samples a pixel, both ways
  const double half = kSide / 2 * radius_mm;
  for (std::size_t k = 0; k < codes.size(); ++k) {
    // Each datum by itself, with the paper around it.
    const double x0 = laid.middles_mm[k][0] - half - kBetween / 2;
    const double y0 = laid.middles_mm[k][1] - half - kBetween / 2;
    const int size = static_cast<int>(std::ceil((2 * half + kBetween) * per_mm));
    Image<float> ink(size, size);
    std::vector<const exchange::Sheet::Outline*> outlines;  // of this datum: others are too far away to show
    for (const exchange::Sheet::Outline& outline : laid.sheet.outlines) {
      const auto& [x, y] = outline.corners.front();
      if (std::abs(x - laid.middles_mm[k][0]) < half && std::abs(y - laid.middles_mm[k][1]) < half) {
        outlines.push_back(&outline);
      }
    }
    for (int y = 0; y < size * kFine; ++y) {
      for (int x = 0; x < size * kFine; ++x) {
        const double at_x = x0 + (x + 0.5) / (kFine * per_mm);
        const double at_y = y0 + (y + 0.5) / (kFine * per_mm);
        bool black = std::ranges::any_of(laid.sheet.black, [&](const exchange::Sheet::Rectangle& r) {
          return at_x >= r.x && at_x < r.x + r.width && at_y >= r.y && at_y < r.y + r.height;
        });
        for (const exchange::Sheet::Outline* outline : outlines) {
          black = black && !inside(*outline, at_x, at_y);
        }
        ink(x / kFine, y / kFine) += black ? 1.0F / (kFine * kFine) : 0.0F;
      }
    }
    const Image<std::uint8_t> frame = softened(ink);
    const auto found = calib::target::detect_datums(frame.view());
    if (found.seen.size() != 1 || found.seen[0].code != smallest_rotation(codes[k])) {
      return fail(RCode::kInternal, fmt::format("the sheet does not show datum {}", codes[k]));
    }
    const double off = std::hypot((found.seen[0].q.x() + 0.5) / per_mm + x0 - laid.middles_mm[k][0],
                                  (found.seen[0].q.y() + 0.5) / per_mm + y0 - laid.middles_mm[k][1]);
    if (off > 0.1 || std::abs(found.seen[0].radius_px() / per_mm / radius_mm - 1) > 0.03) {
      return fail(RCode::kInternal, fmt::format("datum {} of the sheet is {:.2f} mm from where it belongs, or of "
                                                "another size",
                                                codes[k], off));
    }
  }
  return ok();
}

std::string survey_block(std::span<const unsigned> codes, double radius_m) {
  std::string text;
  for (const unsigned code : codes) {
    text += fmt::format(
        "{}[[datum]]\nname = \"datum {}\"\ncode = {}\nradius_m = {}\nposition_m = [?, ?, ?]\nsigma_mm = ?\n",
        text.empty() ? "" : "\n", code, code, exchange::exact(radius_m));
  }
  return text;
}

}  // namespace raysteer::host::cli
