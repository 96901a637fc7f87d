// A plane that a board was laid on, and looks of which only one eye sees the light there.
#pragma once

#include <string>
#include <vector>

#include "calib/steer/one_eye.hpp"
#include "hal/base/result.hpp"
#include "host/rig/gather.hpp"
#include "host/session/session.hpp"

namespace raysteer::host::rig {

/// The plane of the target that look `look` shows, by every eye that sees it; one is enough. Errors: those of
/// check_cameras(), kMissingKey (no such look, or no target is shown there), why neither eye sees the board (both
/// reasons, the left eye's code), those of calibrate::find_board() and calib::look::board_plane().
Result<calib::steer::KnownPlane> find_plane(const session::Session& session, const calib::model::Rig& cameras,
                                            const std::string& look, const Tick& tick = {});

/// Panel pixels that one eye saw.
struct OneEye {
  std::size_t eye = 0;  ///< 0: left
  std::vector<Eigen::Vector2d> x, q;
  std::vector<Eigen::Matrix2d> cov_q;
};

/// Look `look` by the eye that sees more of it. Errors: why neither could be decoded (both reasons, the left eye's
/// code); kTooFewMatches; kCancelled.
Result<OneEye> see_with_one_eye(const session::Session& session, int look, const GatherOptions& options,
                                const Tick& tick = {});

/// The same points on the plane; `together`: points of all looks on it (calib/steer/one_eye.hpp).
std::vector<calib::steer::LitPoint> on_plane(const OneEye& seen, const calib::model::Rig& cameras,
                                             const calib::steer::KnownPlane& plane, std::size_t together);

/// What one eye saw of look `index` of the observations.
struct OneEyedLook {
  std::size_t index = 0;
  OneEye seen;
};

/// Gives these looks their points on the plane. A look of which fewer than kFewestPoints meet it is moved to `missed`.
/// `looks`: by ascending index.
void put_on_plane(Gathered& gathered, const std::vector<OneEyedLook>& looks, const calib::steer::KnownPlane& plane);

}  // namespace raysteer::host::rig
