#include "host/rig/gather.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "host/rig/known_plane.hpp"
#include "host/rig/pixel_floor.hpp"
#include "host/rig/thin_out.hpp"
#include "host/scan/match_look.hpp"
#include "host/scan/scan.hpp"

namespace raysteer::host::rig {
namespace {

using calib::scene::Match;
using calib::steer::LitPoint;
using calib::steer::Look;
using session::Session;

/// `cameras`: calibrated; null where they are known only as drawn, so that they cannot say how pixels scatter.
std::vector<LitPoint> thin_out(const scan::MatchedLook& matched, int panel_width, int panel_height,
                               const calib::scene::TwoViews* cameras, const GatherOptions& options) {
  const double floor_px = cameras != nullptr ? pixel_floor(*cameras, matched.matches.measured) : kUnknownFloorPx;
  std::vector<LitPoint> points;
  for (const Match* match :
       best_of_cells(matched, panel_width, panel_height, {options.columns, options.rows},
                     [](const Match& m) { return known_both_ways(m.cov_left) && known_both_ways(m.cov_right); })) {
    points.push_back({.x = Eigen::Vector2d(match->i * matched.spacing, match->j * matched.spacing),
                      .q = {match->q_left, match->q_right},
                      .cov_x = Eigen::Matrix2d::Zero(),
                      .cov_q = {with_floor(match->cov_left, floor_px), with_floor(match->cov_right, floor_px)}});
  }
  return points;
}

/// Mean of what the mirror's sensor said during the look.
std::optional<Eigen::Vector2d> feedback(const Session& session, const std::string& look) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int count = 0;
  for (const proto::session::Shot& shot : session.manifest().shots) {
    if (shot.look == look && shot.mirror_feedback && shot.mirror_feedback->size() == 2) {
      sum += Eigen::Vector2d((*shot.mirror_feedback)[0], (*shot.mirror_feedback)[1]);
      ++count;
    }
  }
  return count > 0 ? std::optional<Eigen::Vector2d>(sum / count) : std::nullopt;
}

/// Points that both eyes see. Errors: why there are none or too few.
Result<std::vector<LitPoint>> see_with_both(const Session& session, int look, const calib::scene::TwoViews* cameras,
                                            const GatherOptions& options, const Tick& tick) {
  auto decoded = scan::decode_cameras(session, look, {}, tick);
  RAYSTEER_TRY(decoded);
  const PatternSequence& sequence = session.manifest().sequence;
  auto matched = scan::match_look(*decoded, sequence.panel_width, sequence.panel_height);
  RAYSTEER_TRY(matched);
  auto points = thin_out(*matched, sequence.panel_width, sequence.panel_height, cameras, options);
  if (points.size() < kFewestPoints) {
    return fail(RCode::kTooFewMatches,
                std::to_string(points.size()) + " points, at least " + std::to_string(kFewestPoints) + " are needed");
  }
  return points;
}

}  // namespace

Status check_cameras(const Session& session, const calib::model::Rig& cameras) {
  if (session.cameras() != 2) {
    return fail(RCode::kCameraCount,
                "the session has " + std::to_string(session.cameras()) + " cameras; a steered rig takes two");
  }
  const auto devices = scan::scan_devices(session, cameras);
  if (!devices) {
    return devices.error();
  }
  if (devices->left != 0 || devices->right != 1 || cameras.devices.size() != 2) {
    return fail(RCode::kCalibrationMismatch, "expected the session's two cameras alone, in their order");
  }
  return ok();
}

Result<Gathered> gather(const Session& session, const calib::model::Rig& cameras, const GatherOptions& options,
                        const Tick& tick) {
  RAYSTEER_TRY(check_cameras(session, cameras));
  const auto views = calib::scene::two_views(cameras, 0, 1);
  RAYSTEER_TRY(views);
  Gathered gathered;
  gathered.observations.cameras = cameras;
  std::vector<int> numbers;
  for (int look = 0; look < session.looks(); ++look) {
    const auto& named = session.manifest().looks[static_cast<std::size_t>(look)];
    if (!options.looks.empty() && std::ranges::find(options.looks, named.name) == options.looks.end()) {
      continue;
    }
    if (named.name == options.plane_look) {
      continue;
    }
    if (!named.command || named.command->size() != 2) {
      return fail(RCode::kCommandMissing, "look '" + named.name + "' has no 'command_rad' of two angles");
    }
    numbers.push_back(look);
  }
  std::vector<OneEyedLook> one_eyed;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    const auto part = [&](double done) {
      return (static_cast<double>(k) + done) / static_cast<double>(numbers.size());
    };
    const auto& named = session.manifest().looks[static_cast<std::size_t>(numbers[k])];
    const Tick step = [&](double done) { return !tick || tick(part(done)); };
    auto points = see_with_both(session, numbers[k], options.cameras_drawn ? nullptr : &*views, options, step);
    if (!points && points.error().rcode == RCode::kCancelled) {
      return std::move(points).error();
    }
    Look look{.name = named.name,
              .command_rad = Eigen::Vector2d((*named.command)[0], (*named.command)[1]),
              .feedback_rad = feedback(session, named.name),
              .points = {}};
    if (points) {
      look.points = *std::move(points);
    } else if (!options.plane) {
      gathered.missed.push_back({named.name, std::move(points).error()});
      continue;
    } else {
      auto seen = see_with_one_eye(session, numbers[k], options, step);
      if (!seen && seen.error().rcode == RCode::kCancelled) {
        return std::move(seen).error();
      }
      if (!seen) {
        gathered.missed.push_back({named.name, std::move(seen).error()});
        continue;
      }
      one_eyed.push_back({gathered.observations.looks.size(), *std::move(seen)});
    }
    gathered.observations.looks.push_back(std::move(look));
  }
  if (options.plane) {
    put_on_plane(gathered, one_eyed, *options.plane);
  }
  if (gathered.observations.looks.empty()) {
    return fail(RCode::kTooFewLooks, gathered.missed.empty()
                                         ? "the session has no looks"
                                         : "none of " + std::to_string(gathered.missed.size()) +
                                               " looks could be used; look '" + gathered.missed.front().name +
                                               "': " + gathered.missed.front().error.message());
  }
  return gathered;
}

}  // namespace raysteer::host::rig
