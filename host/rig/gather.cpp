#include "host/rig/gather.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "host/scan/match_look.hpp"
#include "host/scan/scan.hpp"

namespace raysteer::host::rig {
namespace {

using calib::scene::Match;
using calib::steer::LitPoint;
using calib::steer::Look;
using session::Session;

/// Fewer points than this say little of a look's two angles.
constexpr std::size_t kFewestPoints = 20;

double badness(const Match& match) { return match.cov_left.trace() + match.cov_right.trace(); }

/// No place is trusted beyond this, px: what lens model and decoding leave behind is the same for neighbours, and many
/// points together would pass it off for a camera that moved.
constexpr double kFloorPx = 0.02;

Eigen::Matrix2d with_floor(const Eigen::Matrix2d& cov) {
  return cov + kFloorPx * kFloorPx * Eigen::Matrix2d::Identity();
}

/// At the rim of the light a place may be known across the stripes of one axis only.
bool known_both_ways(const Eigen::Matrix2d& cov) {
  return cov.allFinite() && cov.trace() > 0 && cov.determinant() > 1e-4 * cov.trace() * cov.trace();
}

/// The best match of each cell of a grid over the panel.
std::vector<LitPoint> thin_out(const scan::MatchedLook& matched, int panel_width, int panel_height,
                               const GatherOptions& options) {
  std::vector<const Match*> best(static_cast<std::size_t>(options.columns) * static_cast<std::size_t>(options.rows));
  for (const Match& match : matched.matches.measured) {
    if (!known_both_ways(match.cov_left) || !known_both_ways(match.cov_right)) {
      continue;
    }
    const int column = std::min(match.i * matched.spacing * options.columns / panel_width, options.columns - 1);
    const int row = std::min(match.j * matched.spacing * options.rows / panel_height, options.rows - 1);
    const Match*& kept = best[static_cast<std::size_t>(row) * static_cast<std::size_t>(options.columns) +
                              static_cast<std::size_t>(column)];
    if (kept == nullptr || badness(match) < badness(*kept)) {
      kept = &match;
    }
  }
  std::vector<LitPoint> points;
  for (const Match* match : best) {
    if (match != nullptr) {
      points.push_back({.x = Eigen::Vector2d(match->i * matched.spacing, match->j * matched.spacing),
                        .q = {match->q_left, match->q_right},
                        .cov_x = Eigen::Matrix2d::Zero(),
                        .cov_q = {with_floor(match->cov_left), with_floor(match->cov_right)}});
    }
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
    return fail(RCode::kCalibrationMismatch,
                "expected a calibration of the session's two cameras alone, in their order; make one with "
                "'raysteer calibrate cameras'");
  }
  return ok();
}

Result<Gathered> gather(const Session& session, const calib::model::Rig& cameras, const GatherOptions& options,
                        const Tick& tick) {
  RAYSTEER_TRY(check_cameras(session, cameras));
  Gathered gathered;
  gathered.observations.cameras = cameras;
  std::vector<int> numbers;
  for (int look = 0; look < session.looks(); ++look) {
    const auto& named = session.manifest().looks[static_cast<std::size_t>(look)];
    if (!options.looks.empty() && std::ranges::find(options.looks, named.name) == options.looks.end()) {
      continue;
    }
    if (!named.command || named.command->size() != 2) {
      return fail(RCode::kCommandMissing, "look '" + named.name + "' has no 'command_rad' of two angles");
    }
    numbers.push_back(look);
  }
  const PatternSequence& sequence = session.manifest().sequence;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    const auto part = [&](double done) {
      return (static_cast<double>(k) + done) / static_cast<double>(numbers.size());
    };
    const auto& named = session.manifest().looks[static_cast<std::size_t>(numbers[k])];
    auto decoded =
        scan::decode_cameras(session, numbers[k], {}, [&](double done) { return !tick || tick(part(done)); });
    if (!decoded) {
      if (decoded.error().rcode == RCode::kCancelled) {
        return std::move(decoded).error();
      }
      gathered.missed.push_back({named.name, std::move(decoded).error()});
      continue;
    }
    auto matched = scan::match_look(*decoded, sequence.panel_width, sequence.panel_height);
    if (!matched) {
      return std::move(matched).error();
    }
    Look look{.name = named.name,
              .command_rad = Eigen::Vector2d((*named.command)[0], (*named.command)[1]),
              .feedback_rad = feedback(session, named.name),
              .points = thin_out(*matched, sequence.panel_width, sequence.panel_height, options)};
    if (look.points.size() < kFewestPoints) {
      gathered.missed.push_back(
          {named.name, fail(RCode::kTooFewMatches, std::to_string(look.points.size()) + " points, at least " +
                                                       std::to_string(kFewestPoints) + " are needed")});
      continue;
    }
    gathered.observations.looks.push_back(std::move(look));
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
