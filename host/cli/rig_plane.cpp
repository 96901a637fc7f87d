#include "host/cli/rig_plane.hpp"

#include <fmt/core.h>

#include "calib/steer/one_eye.hpp"
#include "host/rig/known_plane.hpp"

namespace raysteer::host::cli {

void RigPlane::declare(Options& options) {
  options.option("--plane", "LOOK", &look_,
                 "look in which the session's board lies on a plane: looks that one eye sees count then too, if all "
                 "their light falls on it");
}

Status RigPlane::find(Context& context, const session::Session& session, const calib::model::Rig& cameras,
                      rig::GatherOptions& options) const {
  if (look_.empty()) {
    return ok();
  }
  if (options.cameras_drawn) {
    return fail(RCode::kUsage, "--plane takes calibrated cameras: a board's pose cannot be told from drawn ones");
  }
  const auto plane = rig::find_plane(session, cameras, look_, context.stage("finding the plane"));
  RAYSTEER_TRY(plane);
  options.plane = *plane;
  options.plane_look = look_;
  return ok();
}

void RigPlane::report(Context& context, const rig::Gathered& gathered) const {
  context.json()["one_eyed_looks"] = gathered.one_eyed.size();
  for (const std::string& name : gathered.one_eyed) {
    context.note(fmt::format("look '{}': seen by one eye, placed on the plane of look '{}'", name, look_));
  }
}

Status RigPlane::check(const rig::Gathered& gathered, const calib::steer::Solution& solution,
                       const calib::steer::Drawing& drawing) const {
  const double drawn_rad = drawing.tolerance.repeatability_rad;
  if (gathered.one_eyed.empty() || solution.repeatability_rad <= calib::steer::kMostScatter * drawn_rad) {
    return ok();
  }
  return fail(RCode::kRigNotSolved,
              fmt::format("the mirror would repeat to {:.0f} urad, drawn are {:.0f}: does all light of the looks that "
                          "one eye saw fall on the plane of look '{}'?",
                          1e6 * solution.repeatability_rad, 1e6 * drawn_rad, look_));
}

}  // namespace raysteer::host::cli
