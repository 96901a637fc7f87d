// value: which cameras a rig is calibrated with: calibrated ones, or as the board file draws them and a known length.
#pragma once

#include <optional>
#include <string>

#include "calib/model/rig.hpp"
#include "calib/steer/without_board.hpp"
#include "hal/base/result.hpp"
#include "host/cli/context.hpp"
#include "host/cli/options.hpp"
#include "host/rig/known_length.hpp"
#include "host/session/session.hpp"
#include "proto/board/board.hpp"

namespace raysteer::host::cli {

class RigCameras {
 public:
  /// --cameras, --baseline, --length.
  void declare(Options& options);

  /// Nobody gave the cameras' calibration.
  bool drawn() const;

  /// Makes sense of --baseline and --length; before any file is opened. Errors: kUsage.
  Status read_length();

  /// The calibration, or what `board` draws. `board_name`: for messages. Errors: those of read_calibration(); of
  /// check_cameras() where the board draws other cameras than the session has.
  Result<calib::model::Rig> read(const proto::board::Board& board, const std::string& board_name,
                                 const session::Session& session) const;

  /// The length of read_length() with its ends found in the session; no value without one. Errors: those of
  /// rig::find_length().
  Result<std::optional<calib::steer::KnownLength>> find_length(Context& context, const session::Session& session) const;

  /// What the cameras came out as, where they were not given. `truth`: null where it is not known.
  void report(Context& context, const calib::steer::Solution& solution, const calib::model::Rig* truth) const;

 private:
  std::string cameras_;
  std::optional<std::string> baseline_;
  std::optional<std::string> length_;
  std::optional<rig::MeasuredLength> measured_;
};

}  // namespace raysteer::host::cli
