// value: the plane that stands in for a second eye, as --plane names it.
#pragma once

#include <string>

#include "calib/model/rig.hpp"
#include "calib/steer/drawing.hpp"
#include "calib/steer/solve.hpp"
#include "hal/base/result.hpp"
#include "host/cli/context.hpp"
#include "host/cli/options.hpp"
#include "host/rig/gather.hpp"
#include "host/session/session.hpp"

namespace raysteer::host::cli {

class RigPlane {
 public:
  /// --plane.
  void declare(Options& options);

  /// Finds the plane, where one is named. Errors: kUsage (cameras only drawn); those of rig::find_plane().
  Status find(Context& context, const session::Session& session, const calib::model::Rig& cameras,
              rig::GatherOptions& options) const;

  /// Which looks it placed.
  void report(Context& context, const rig::Gathered& gathered) const;

  /// Light that falls elsewhere than on the plane shows as a mirror that scatters. Errors: kRigNotSolved.
  Status check(const rig::Gathered& gathered, const calib::steer::Solution& solution,
               const calib::steer::Drawing& drawing) const;

 private:
  std::string look_;
};

}  // namespace raysteer::host::cli
