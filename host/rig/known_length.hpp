// A length that somebody measured, for cameras that nobody calibrated: how long a metre is.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "calib/steer/without_board.hpp"
#include "hal/base/result.hpp"
#include "host/rig/gather.hpp"
#include "host/session/session.hpp"

namespace raysteer::host::rig {

/// As told on the command line.
struct MeasuredLength {
  double metres = 0;
  std::optional<std::array<unsigned, 2>> datums{};  ///< their codes; no value: from lens to lens
};

/// "3-7=2.514": between the datums coded 3 and 7, decimal and without blanks. Errors: kUsage.
Result<MeasuredLength> read_length(std::string_view text);

/// "0.512": from lens to lens. Errors: kUsage.
Result<MeasuredLength> read_baseline(std::string_view text);

/// The length with its ends as both eyes see them in the black frames of at most `most_looks` looks; it counts as good
/// to half a millimetre. Errors: kDatumsMissing (which datum), those of see_datums().
Result<calib::steer::KnownLength> find_length(const session::Session& session, const MeasuredLength& length,
                                              int most_looks, const Tick& tick = {});

}  // namespace raysteer::host::rig
