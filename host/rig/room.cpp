#include "host/rig/room.hpp"

#include <algorithm>
#include <utility>

#include "calib/datum/steady.hpp"
#include "calib/target/datum.hpp"
#include "hal/base/pattern.hpp"

namespace raysteer::host::rig {
namespace {

using calib::datum::View;
using calib::steer::RoomPoint;

Eigen::Vector3d vector(const proto::survey::Vec3& v) { return {v[0], v[1], v[2]}; }

/// Where the disc's centre is seen, of which the ellipse's middle is not the picture (calib/target/datum.hpp).
std::optional<Eigen::Vector2d> centre_seen(const Eigen::Vector2d& middle, const calib::model::Device& eye,
                                           const calib::model::Pose& T_rig_room,
                                           const proto::survey::SurveyedDatum& datum) {
  const Eigen::Vector3d p = eye.T_device_rig * (T_rig_room * vector(datum.position_m));
  const Eigen::Vector3d normal = eye.T_device_rig.q * (T_rig_room.q * vector(datum.normal));
  const auto ellipse = calib::target::ellipse_middle(eye.camera, p, normal, datum.radius_m);
  const auto centre = eye.camera.project(p);
  if (!ellipse || !centre) {
    return std::nullopt;
  }
  return middle - (*ellipse - *centre);
}

}  // namespace

Result<std::vector<View>> see_datums(const session::Session& session, int most_looks, const Tick& tick) {
  if (session.cameras() != 2) {
    return fail(RCode::kCameraCount,
                "datums are measured by two cameras, the session has " + std::to_string(session.cameras()));
  }
  const std::vector<Pattern> patterns = session.manifest().sequence.patterns();
  // By the room's light: the border of the projector's would shift a datum's middle.
  const auto black =
      std::ranges::find_if(patterns, [](const Pattern& pattern) { return pattern.block.kind == PatternKind::kBlack; });
  if (black == patterns.end()) {
    return fail(RCode::kBadSequence, "datums are looked for in the black frame; the sequence has none");
  }
  const int index = static_cast<int>(black - patterns.begin());
  const int count = std::min(most_looks, session.looks());
  std::vector<View> views;
  for (int k = 0; k < count; ++k) {
    // The first look and the last are among them: a rig that moved between any two others stands elsewhere there.
    const int look = count > 1 ? k * (session.looks() - 1) / (count - 1) : 0;
    View view{.name = session.manifest().looks[static_cast<std::size_t>(look)].name};
    for (int eye = 0; eye < 2; ++eye) {
      if (tick && !tick((k + 0.5 * eye) / count)) {
        return fail(RCode::kCancelled);
      }
      const auto frame = session.frame({eye, look, index});
      RAYSTEER_TRY(frame);
      view.eyes[static_cast<std::size_t>(eye)] = calib::target::detect_datums(*frame).seen;
    }
    views.push_back(std::move(view));
  }
  if (auto seen = calib::datum::steady(views); !seen && seen.error().rcode == RCode::kRigMoved) {
    return std::move(seen).error();
  }
  return views;
}

Result<InRoom> tie_to_room(const calib::steer::Solution& solution, const proto::survey::Survey& survey,
                           const std::vector<View>& views) {
  auto tie = calib::datum::tie_to_room(solution.cameras, survey, views);
  RAYSTEER_TRY(tie);
  const auto means = calib::datum::steady(views);
  RAYSTEER_TRY(means);
  const calib::model::Pose T_rig_room = tie->T_room_rig.inverse();
  std::vector<RoomPoint> points;
  for (const proto::survey::SurveyedDatum& datum : survey.datums) {
    const auto mean = means->find(datum.code);
    if (mean == means->end() || !mean->second[0] || !mean->second[1]) {
      continue;
    }
    RoomPoint point;
    point.p_room = vector(datum.position_m);
    point.covariance = 1e-6 * datum.sigma_mm * datum.sigma_mm * Eigen::Matrix3d::Identity();
    bool seen = true;
    for (std::size_t eye = 0; eye < 2; ++eye) {
      const auto q = centre_seen(mean->second[eye]->q, solution.cameras.devices[eye], T_rig_room, datum);
      seen = seen && q.has_value();
      point.q[eye] = q.value_or(Eigen::Vector2d::Zero());
      point.cov_q[eye] = mean->second[eye]->cov;
    }
    if (seen) {
      points.push_back(point);
    }
  }
  auto rig = calib::steer::tie_to_room(solution, points, T_rig_room);
  RAYSTEER_TRY(rig);
  return InRoom{*std::move(rig), *std::move(tie)};
}

}  // namespace raysteer::host::rig
