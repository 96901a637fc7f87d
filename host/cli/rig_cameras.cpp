#include "host/cli/rig_cameras.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "host/exchange/calibration_file.hpp"
#include "host/rig/drawing.hpp"
#include "host/rig/gather.hpp"
#include "host/rig/room.hpp"

namespace raysteer::host::cli {
namespace {

/// Instead of a calibration of the cameras.
constexpr std::string_view kDrawn = "drawn";

}  // namespace

void RigCameras::declare(Options& options) {
  options
      .option("--cameras", "FILE", &cameras_,
              "calibration of the cameras, or its folder; 'drawn': none, cameras are solved too")
      .required();
  options.option("--baseline", "METRES", &baseline_, "with '--cameras drawn': measured from lens to lens");
  options.option("--length", "A-B=METRES", &length_,
                 "with '--cameras drawn': measured between the datums coded A and B");
}

bool RigCameras::drawn() const { return cameras_ == kDrawn; }

Status RigCameras::read_length() {
  if (!baseline_ && !length_) {
    return ok();
  }
  if (!drawn() || (baseline_ && length_)) {
    return fail(RCode::kUsage,
                "expected one of --baseline and --length, and only with '--cameras drawn': calibrated "
                "cameras know how long a metre is");
  }
  const auto measured = length_ ? rig::read_length(*length_) : rig::read_baseline(*baseline_);
  RAYSTEER_TRY(measured);
  measured_ = *measured;
  return ok();
}

Result<calib::model::Rig> RigCameras::read(const proto::board::Board& board, const std::string& board_name,
                                           const session::Session& session) const {
  if (!drawn()) {
    auto file = exchange::read_calibration(cameras_);
    RAYSTEER_TRY(file);
    return std::move(file->rig);
  }
  auto cameras = rig::cameras_of(board);
  if (const Status fits = rig::check_cameras(session, cameras); !fits) {
    return with_context(fits.error(), "expected board file '" + board_name + "' to draw the session's cameras");
  }
  return cameras;
}

Result<std::optional<calib::steer::KnownLength>> RigCameras::find_length(Context& context,
                                                                         const session::Session& session) const {
  if (!measured_) {
    return std::optional<calib::steer::KnownLength>();
  }
  auto known = rig::find_length(session, *measured_, rig::kDatumLooks, context.stage("finding the known length"));
  RAYSTEER_TRY(known);
  return std::optional(*std::move(known));
}

void RigCameras::report(Context& context, const calib::steer::Solution& solution,
                        const calib::model::Rig* truth) const {
  Json& json = context.json();
  json["cameras"]["drawn"] = drawn();
  if (!drawn()) {
    return;
  }
  double sigma = 0;
  double error = 0;
  for (std::size_t i = 0; i < solution.cameras.devices.size(); ++i) {
    const double f = solution.cameras.devices[i].camera.fx;
    const int at = solution.cameras.offset(i);
    sigma = std::max(sigma, std::sqrt(solution.covariance(at, at)) / f);
    error = truth != nullptr ? std::max(error, std::abs(f / truth->devices[i].camera.fx - 1)) : 0;
  }
  const double baseline = solution.cameras.devices[1].T_device_rig.t.norm();
  json["cameras"]["focal_sigma"] = sigma;
  json["cameras"]["baseline_m"] = baseline;
  json["cameras"]["scale_by"] = length_ ? "length" : baseline_ ? "baseline" : "drawing";
  context.print(
      fmt::format("cameras          solved from the drawing: focal length +- {:.3f} %, {:.1f} mm apart; metres by {}\n",
                  100 * sigma, 1e3 * baseline,
                  length_     ? "the known length"
                  : baseline_ ? "the measured baseline"
                              : "the drawn baseline: give --length or --baseline for true ones"));
  if (truth != nullptr) {
    json["truth"]["focal_error"] = error;
    context.print(fmt::format("focal lengths against the truth: {:.3f} %\n", 100 * error));
  }
}

}  // namespace raysteer::host::cli
