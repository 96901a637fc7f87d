#include "host/rig/known_plane.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "calib/look/board_plane.hpp"
#include "host/calibrate/gather.hpp"
#include "host/rig/pixel_floor.hpp"
#include "host/rig/thin_out.hpp"
#include "host/scan/match_look.hpp"

namespace raysteer::host::rig {
namespace {

using calib::scene::Match;
using session::Session;

Result<OneEye> see(const Session& session, int look, int eye, const GatherOptions& options) {
  auto decoded = scan::decode_look(session, eye, look);
  RAYSTEER_TRY(decoded);
  const PatternSequence& sequence = session.manifest().sequence;
  std::vector<scan::DecodedLook> alone;
  alone.push_back(*std::move(decoded));
  const auto matched = scan::match_look(alone, sequence.panel_width, sequence.panel_height);
  RAYSTEER_TRY(matched);
  OneEye seen;
  seen.eye = static_cast<std::size_t>(eye);
  for (const Match* match :
       best_of_cells(*matched, sequence.panel_width, sequence.panel_height, {options.columns, options.rows},
                     [](const Match& m) { return known_both_ways(m.cov_left); })) {
    seen.x.emplace_back(match->i * matched->spacing, match->j * matched->spacing);
    seen.q.push_back(match->q_left);
    seen.cov_q.push_back(with_floor(match->cov_left, kUnknownFloorPx));
  }
  return seen;
}

}  // namespace

Result<calib::steer::KnownPlane> find_plane(const Session& session, const calib::model::Rig& cameras,
                                            const std::string& look, const Tick& tick) {
  const auto& manifest = session.manifest();
  if (std::ranges::find(manifest.looks, look, &proto::session::Look::name) == manifest.looks.end() ||
      manifest.target_of(look) == nullptr) {
    return fail(RCode::kMissingKey, "--plane " + look + ": expected a look of the session that shows its [target]");
  }
  const auto gathered = calibrate::gather_cameras(session, tick);
  RAYSTEER_TRY(gathered);
  const auto& views = gathered->observations.views;
  const auto view = std::ranges::find(views, look, &calib::solve::View::name);
  std::vector<calib::look::Sight> sights;
  for (std::size_t eye = 0; view != views.end() && eye < cameras.devices.size(); ++eye) {
    if (!view->corners[eye].empty()) {
      const calib::model::Device& device = cameras.devices[eye];
      sights.push_back(
          {.camera = device.camera, .T_camera_rig = device.T_device_rig, .corners = view->corners[eye], .discs = {}});
    }
  }
  if (sights.empty()) {
    return fail(RCode::kTargetNotFound, "no eye sees the board in look '" + look + "'");
  }
  const auto plane = calib::look::board_plane(gathered->observations.target, sights);
  RAYSTEER_TRY(plane);
  return calib::steer::KnownPlane{plane->T_rig_plane, plane->covariance};
}

Result<OneEye> see_with_one_eye(const Session& session, int look, const GatherOptions& options) {
  auto left = see(session, look, 0, options);
  auto right = see(session, look, 1, options);
  if (!left && !right) {
    return left;
  }
  auto& better = !left || (right && right->x.size() > left->x.size()) ? right : left;
  if (better->x.size() < kFewestPoints) {
    return fail(RCode::kTooFewMatches, std::to_string(better->x.size()) + " points of one eye, at least " +
                                           std::to_string(kFewestPoints) + " are needed");
  }
  return std::move(better);
}

std::vector<calib::steer::LitPoint> on_plane(const OneEye& seen, const calib::model::Rig& cameras,
                                             const calib::steer::KnownPlane& plane, std::size_t together) {
  std::vector<calib::steer::LitPoint> points;
  for (std::size_t i = 0; i < seen.x.size(); ++i) {
    if (const auto point =
            calib::steer::seen_on_plane(cameras, plane, seen.eye, seen.x[i], seen.q[i], seen.cov_q[i], together)) {
      points.push_back(*point);
    }
  }
  return points;
}

}  // namespace raysteer::host::rig
