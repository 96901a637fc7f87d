// What `calibrate cameras` and `calibrate projector` do alike once the frames are read. Inside host/cli.
#pragma once

#include <string>
#include <string_view>

#include "calib/solve/solve.hpp"
#include "host/calibrate/gather.hpp"
#include "host/cli/command.hpp"

namespace raysteer::host::cli {

struct CalibrateInput {
  std::string session;   ///< as the user named it
  std::string previous;  ///< --previous FILE; empty: what --out held before, if anything
  calib::solve::SolveOptions options;
};

/// Solves, judges, writes --out, fills the JSON object and the text. Errors: those of solve and assess, of the previous
/// calibration when it was named, and of writing.
Result<ExitCode> calibrate(Context& context, const calibrate::Gathered& gathered, CalibrateInput input);

/// "bc4" and the like for --lens; empty: chosen by held-out error. Errors: kUsage.
Status set_lens(std::string_view text, calib::solve::SolveOptions& options);

}  // namespace raysteer::host::cli
