#include "host/rig/known_plane.hpp"

#include <cstddef>
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

/// Two eyes fail for two reasons. The first one's code stands for both.
Error both(Error left, const Error& right) {
  left.note += "; " + right.message();
  return left;
}

Status enough(std::size_t points) {
  return points >= kFewestPoints
             ? ok()
             : fail(RCode::kTooFewMatches, std::to_string(points) + " points of one eye, at least " +
                                               std::to_string(kFewestPoints) + " are needed");
}

Result<OneEye> see(const Session& session, int look, int eye, const GatherOptions& options, const Tick& tick) {
  auto decoded = scan::decode_look(session, eye, look, {}, tick);
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
  RAYSTEER_TRY(check_cameras(session, cameras));
  const auto number = session.look_number(look);
  if (!number) {
    return fail(RCode::kMissingKey, "--plane " + look + ": expected a look of the session that shows its [target]");
  }
  const auto board = calibrate::find_board(session, *number, tick);
  RAYSTEER_TRY(board);
  std::vector<calib::look::Sight> sights;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    if (const auto& found = board->cameras[eye]) {
      const calib::model::Device& device = cameras.devices[eye];
      sights.push_back(
          {.camera = device.camera, .T_camera_rig = device.T_device_rig, .corners = found->corners, .discs = {}});
    }
  }
  if (sights.empty()) {
    return both(board->cameras[0].error(), board->cameras[1].error());
  }
  const auto plane = calib::look::board_plane(board->target, sights);
  RAYSTEER_TRY(plane);
  return calib::steer::KnownPlane{plane->T_rig_plane, plane->covariance};
}

Result<OneEye> see_with_one_eye(const Session& session, int look, const GatherOptions& options, const Tick& tick) {
  auto left = see(session, look, 0, options, [&](double done) { return !tick || tick(0.5 * done); });
  if (!left && left.error().rcode == RCode::kCancelled) {
    return left;
  }
  auto right = see(session, look, 1, options, [&](double done) { return !tick || tick(0.5 + 0.5 * done); });
  if (!right && right.error().rcode == RCode::kCancelled) {
    return right;
  }
  if (!left && !right) {
    return both(left.error(), right.error());
  }
  auto& better = !left || (right && right->x.size() > left->x.size()) ? right : left;
  RAYSTEER_TRY(enough(better->x.size()));
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

void put_on_plane(Gathered& gathered, const std::vector<OneEyedLook>& looks, const calib::steer::KnownPlane& plane) {
  std::size_t together = 0;
  for (const OneEyedLook& look : looks) {
    together += look.seen.x.size();
  }
  auto& all = gathered.observations.looks;
  for (const OneEyedLook& look : looks) {
    all[look.index].points = on_plane(look.seen, gathered.observations.cameras, plane, together);
  }
  // From the last on: the places of those before stay what they were.
  for (auto look = looks.rbegin(); look != looks.rend(); ++look) {
    const auto whole = all.begin() + static_cast<std::ptrdiff_t>(look->index);
    if (const Status hit = enough(whole->points.size())) {
      gathered.one_eyed.insert(gathered.one_eyed.begin(), whole->name);
    } else {
      gathered.missed.push_back({whole->name, with_context(hit.error(), "where its light meets the plane")});
      all.erase(whole);
    }
  }
}

}  // namespace raysteer::host::rig
