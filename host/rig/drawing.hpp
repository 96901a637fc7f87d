// pure: a board file as the start and prior of a solve.
#pragma once

#include "calib/model/rig.hpp"
#include "calib/steer/drawing.hpp"
#include "hal/base/result.hpp"
#include "proto/board/board.hpp"

namespace raysteer::host::rig {

/// Errors: kBadValue: no direction where one is needed, or not the planes that the mirror's kind has.
Result<calib::steer::Drawing> drawing_of(const proto::board::Board& board);

/// The drawn cameras, without covariance.
calib::model::Rig cameras_of(const proto::board::Board& board);

}  // namespace raysteer::host::rig
