// Lays coded datums out on paper, each on its black square with its code below.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "hal/base/result.hpp"
#include "host/cli/target_sheet.hpp"
#include "host/exchange/sheet.hpp"

namespace raysteer::host::cli {

struct DatumSheet {
  exchange::Sheet sheet;
  std::vector<std::array<double, 2>> middles_mm;  ///< of the discs on the sheet, in the order of the codes
  double bar_mm = 0;
};

/// Datums (hal/base/datum_code.hpp) in rows, upright or across, whichever fits. Errors: kBadValue (a code that is not
/// offered), kTargetDoesNotFit (saying what would).
Result<DatumSheet> lay_out_datums(std::span<const unsigned> codes, double radius_mm, const Paper& paper);

/// Draws the sheet as pixels and finds the datums in them: is what will be printed what was asked?
/// Errors: kInternal when one is not found, another is, or one lies more than 0.1 mm off.
Status check_datums(std::span<const unsigned> codes, double radius_mm, const DatumSheet& sheet);

/// "[[datum]]" of each with the keys of a survey file; its place is for who surveys it.
std::string survey_block(std::span<const unsigned> codes, double radius_m);

}  // namespace raysteer::host::cli
