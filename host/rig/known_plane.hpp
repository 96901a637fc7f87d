// A plane that a board was laid on, and looks of which only one eye sees the light there.
#pragma once

#include <string>
#include <vector>

#include "calib/steer/one_eye.hpp"
#include "hal/base/result.hpp"
#include "host/rig/gather.hpp"
#include "host/session/session.hpp"

namespace raysteer::host::rig {

/// The plane of the session's target in look `look`, by every eye that sees it. Errors: kMissingKey (no such look, or
/// its [target] is not shown there), kTargetNotFound, those of gather_cameras() and calib::look::board_plane().
Result<calib::steer::KnownPlane> find_plane(const session::Session& session, const calib::model::Rig& cameras,
                                            const std::string& look, const Tick& tick = {});

/// Panel pixels that one eye saw.
struct OneEye {
  std::size_t eye = 0;  ///< 0: left
  std::vector<Eigen::Vector2d> x, q;
  std::vector<Eigen::Matrix2d> cov_q;
};

/// Look `look` by the eye that sees more of it. Errors: why neither could be decoded; kTooFewMatches; kCancelled.
Result<OneEye> see_with_one_eye(const session::Session& session, int look, const GatherOptions& options);

/// The same points on the plane; `together`: points of all looks on it (calib/steer/one_eye.hpp).
std::vector<calib::steer::LitPoint> on_plane(const OneEye& seen, const calib::model::Rig& cameras,
                                             const calib::steer::KnownPlane& plane, std::size_t together);

}  // namespace raysteer::host::rig
