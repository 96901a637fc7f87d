// Lays a target out on paper: squares in the middle, a bar to measure and the target's name below.
#pragma once

#include <cstdint>
#include <string>

#include "hal/base/image.hpp"
#include "hal/base/result.hpp"
#include "hal/base/target.hpp"
#include "host/exchange/sheet.hpp"

namespace raysteer::host::cli {

struct Paper {
  std::string name;
  double width_mm = 0;  ///< upright
  double height_mm = 0;
};

/// "A4" to "A0", "letter", or "420x300" in millimetres. Errors: kUsage.
Result<Paper> paper(const std::string& name);

struct TargetSheet {
  exchange::Sheet sheet;
  double left_mm = 0;  ///< of the squares on the sheet
  double top_mm = 0;
  double bar_mm = 0;  ///< the bar's length: 200, or 100 on small paper
};

/// Upright or across, whichever fits. Errors: kTargetDoesNotFit (saying what would), and those of artwork().
Result<TargetSheet> lay_out(const TargetSpec& target, const Paper& paper);

/// Draws the sheet as pixels and finds the target in them: is what will be printed what was asked?
/// Errors: kInternal when it is not found or a corner lies more than 0.1 mm off.
Status check_sheet(const TargetSpec& target, const TargetSheet& sheet);

inline constexpr double kSheetMargin = 10;  ///< mm; office printers leave 4 to 6 mm white
inline constexpr double kSheetFoot = 16;    ///< mm below what is printed, for bar and text

/// The bar to measure and a line of text at the sheet's foot; gives the bar's length in mm.
double draw_foot(exchange::Sheet& sheet, const std::string& what);
/// Ink per pixel (0 to 1) as a camera sees the paper.
Image<std::uint8_t> softened(const Image<float>& ink);

/// "[[target]]" with the keys of a session file.
std::string session_block(const TargetSpec& target);

}  // namespace raysteer::host::cli
