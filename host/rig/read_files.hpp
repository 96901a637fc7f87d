// The files that calibrating a rig starts from, each by its path or by the name of one that is installed.
#pragma once

#include <string>

#include "calib/steer/drawing.hpp"
#include "hal/base/result.hpp"
#include "proto/board/board.hpp"
#include "proto/stations/stations.hpp"
#include "proto/survey/survey.hpp"

namespace raysteer::host::rig {

struct SurveyFile {
  proto::survey::Survey survey;
  std::string id;  ///< exchange::survey_id() of the file's text
};

/// Errors: kFileMissing, kFileUnreadable, and those of the reader.
Result<proto::board::Board> read_board(const std::string& name);
Result<SurveyFile> read_survey(const std::string& name);
Result<proto::stations::Stations> read_stations(const std::string& name);
/// The board's drawing; also errors of drawing_of().
Result<calib::steer::Drawing> read_drawing(const std::string& name);

}  // namespace raysteer::host::rig
