#include "host/rig/scan_surface.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/scene/triangulate.hpp"
#include "calib/scene/two_views.hpp"
#include "calib/steer/predict.hpp"
#include "host/scan/match_look.hpp"

namespace raysteer::host::rig {
namespace {

using calib::scene::Cloud;
using calib::scene::Match;
using calib::scene::Matches;
using session::Session;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Does the light of a look come from where its command says?
void check_light(ScannedLook& look, const calib::steer::Solution& rig, const Eigen::Vector2d& command_rad,
                 const Cloud& cloud, const std::vector<Match>& matches, int spacing) {
  constexpr std::size_t kAsked = 200;
  std::vector<double> off_x;
  std::vector<double> off_y;
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  for (std::size_t k = 0; k < cloud.points.size(); k += 1 + cloud.points.size() / kAsked) {
    const auto predicted = calib::steer::predict(rig, command_rad, cloud.points[k].p);
    if (predicted) {
      const Match& match = matches[cloud.points[k].match];
      off_x.push_back(predicted->x.x() - match.i * spacing);
      off_y.push_back(predicted->x.y() - match.j * spacing);
      covariance += predicted->covariance;
    }
  }
  if (off_x.empty()) {
    return;
  }
  covariance /= static_cast<double>(off_x.size());
  const Eigen::Vector2d off(median(off_x), median(off_y));
  look.light_off_px = off.norm();
  look.light_off_sigma = std::sqrt(off.dot(covariance.ldlt().solve(off)));
}

Result<std::vector<int>> chosen_looks(const Session& session, const ScanSurfaceOptions& options) {
  for (const auto* names : {&options.looks, &options.without}) {
    for (const std::string& name : *names) {
      if (!session.look_number(name)) {
        return fail(RCode::kUsage, "the session has no look '" + name + "'");
      }
    }
  }
  std::vector<int> numbers;
  for (int look = 0; look < session.looks(); ++look) {
    const std::string& name = session.manifest().looks[static_cast<std::size_t>(look)].name;
    const auto among = [&](const std::vector<std::string>& names) {
      return std::ranges::find(names, name) != names.end();
    };
    if ((options.looks.empty() || among(options.looks)) && !among(options.without)) {
      numbers.push_back(look);
    }
  }
  return numbers;
}

}  // namespace

Result<ScannedSurface> scan_surface(const Session& session, const calib::steer::Solution& rig,
                                    const ScanSurfaceOptions& options, const Tick& tick) {
  RAYSTEER_TRY(check_cameras(session, rig.cameras));
  const auto views = calib::scene::two_views(rig.cameras, 0, 1);
  RAYSTEER_TRY(views);
  const auto numbers = chosen_looks(session, options);
  RAYSTEER_TRY(numbers);
  ScannedSurface surface;
  std::optional<calib::scene::Fusion> fusion;
  const PatternSequence& sequence = session.manifest().sequence;
  for (std::size_t k = 0; k < numbers->size(); ++k) {
    const int number = (*numbers)[k];
    const auto& named = session.manifest().looks[static_cast<std::size_t>(number)];
    const auto decoding = [&](double done) {
      return !tick || tick((static_cast<double>(k) + 0.9 * done) / static_cast<double>(numbers->size()));
    };
    auto decoded = scan::decode_cameras(session, number, {}, decoding);
    if (!decoded) {
      if (decoded.error().rcode == RCode::kCancelled) {
        return std::move(decoded).error();
      }
      surface.missed.push_back({named.name, std::move(decoded).error()});
      continue;
    }
    ScannedLook look{.name = named.name, .light_off_px = std::nullopt};
    for (const scan::DecodedLook& eye : *decoded) {
      const calib::decode::Diagnostics& seen = eye.codes.diagnostics;
      look.decoded_fraction += 0.5 * static_cast<double>(seen.valid) / static_cast<double>(seen.pixels);
    }
    auto matched = scan::match_look(*decoded, sequence.panel_width, sequence.panel_height);
    RAYSTEER_TRY(matched);
    const std::vector<Match>& matches = matched->matches.measured;
    const auto cloud = calib::scene::triangulate(*views, matches, calib::scene::ray_pairs(*views, matches));
    auto cell = cloud ? calib::scene::cell_for(cloud->points, matches) : cloud.error();
    if (!cell) {
      surface.missed.push_back({named.name, std::move(cell).error()});
      continue;
    }
    look.matched = matches.size();
    if (named.command && named.command->size() == 2) {
      check_light(look, rig, {(*named.command)[0], (*named.command)[1]}, *cloud, matches, matched->spacing);
    }
    if (!fusion) {
      fusion.emplace(*cell);
    }
    fusion->add(named.name, cloud->points);
    surface.looks.push_back(std::move(look));
  }
  if (!fusion) {
    return fail(RCode::kTooFewLooks, surface.missed.empty()
                                         ? "no look of the session is left to scan"
                                         : "none of " + std::to_string(surface.missed.size()) +
                                               " looks could be used; look '" + surface.missed.front().name +
                                               "': " + surface.missed.front().error.message());
  }
  auto fused = fusion->fuse();
  RAYSTEER_TRY(fused);
  surface.fused = *std::move(fused);
  return surface;
}

}  // namespace raysteer::host::rig
