#include "host/scan/scan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>
#include <utility>

#include "calib/scene/two_views.hpp"
#include "host/scan/match_look.hpp"

namespace raysteer::host::scan {
namespace {

using calib::model::Camera;
using calib::model::Device;
using calib::model::DeviceKind;
using calib::scene::CloudPoint;
using calib::scene::Match;
using calib::scene::RayPair;
using session::Session;

/// Points this close to the wall's plane count as the wall: walls bend by several millimetres (flatness is judged in
/// patches for that reason).
constexpr double kWallBandM = 0.015;

/// A refit that leaves less than this explains why a pair's matches do not fit, px.
constexpr double kRefitHelpsPx = 1;

std::string size_text(int width, int height) { return std::to_string(width) + " x " + std::to_string(height); }

Result<std::size_t> find_camera(const Session& session, int camera, const calib::model::Rig& rig) {
  const std::string& name = session.manifest().cameras[static_cast<std::size_t>(camera)].name;
  std::string known;
  for (std::size_t k = 0; k < rig.devices.size(); ++k) {
    const Device& device = rig.devices[k];
    if (device.kind != DeviceKind::kCamera) {
      continue;
    }
    if (device.name == name) {
      if (device.camera.width != session.width(camera) || device.camera.height != session.height(camera)) {
        return fail(RCode::kCalibrationMismatch,
                    "camera '" + name + "' has frames of " + size_text(session.width(camera), session.height(camera)) +
                        ", its calibration is for " + size_text(device.camera.width, device.camera.height));
      }
      return k;
    }
    known += (known.empty() ? "'" : ", '") + device.name + "'";
  }
  return fail(RCode::kCalibrationMismatch,
              "the session has a camera '" + name + "', the calibration " + (known.empty() ? "none" : known));
}

DepthRange depth_range(const std::vector<CloudPoint>& points) {
  std::vector<double> z(points.size());
  std::ranges::transform(points, z.begin(), [](const CloudPoint& point) { return point.p.z(); });
  const auto at = [&z](double share) {
    const auto place = z.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(z.size() - 1));
    std::ranges::nth_element(z, place);
    return *place;
  };
  return {at(0.01), at(0.5), at(0.99)};
}

/// Median depth of a few thousand matches with the refitted pose over that with the calibrated one.
double depth_ratio(const calib::scene::TwoViews& views, const calib::model::Pose& refitted,
                   std::span<const Match> matches, std::span<const RayPair> rays) {
  std::vector<Match> sample;
  std::vector<RayPair> sample_rays;
  for (std::size_t k = 0; k < matches.size(); k += 1 + matches.size() / 5000) {
    sample.push_back(matches[k]);
    sample_rays.push_back(rays[k]);
  }
  const auto median = [&](const calib::scene::TwoViews& with) {
    std::vector<double> depths;
    for (std::size_t k = 0; k < sample.size(); ++k) {
      if (const auto p = calib::scene::triangulate_one(with, sample[k], sample_rays[k])) {
        depths.push_back(p->p.z());
      }
    }
    if (depths.empty()) {
      return std::numeric_limits<double>::quiet_NaN();
    }
    const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
    std::ranges::nth_element(depths, middle);
    return *middle;
  };
  calib::scene::TwoViews moved = views;
  moved.T_right_left = refitted;
  return median(moved) / median(views);
}

/// The disagreement of the matches that were not fitted.
Result<calib::scene::EpipolarAnalysis> analyse_held_out(std::span<const Match> matches, std::span<const double> d) {
  std::vector<Match> held_out;
  std::vector<double> disagreement;
  for (std::size_t k = 0; k < matches.size(); ++k) {
    if (calib::scene::is_held_out(matches[k])) {
      held_out.push_back(matches[k]);
      disagreement.push_back(d[k]);
    }
  }
  return calib::scene::analyse_epipolar(held_out, disagreement);
}

/// Everything after the matches.
Status reconstruct(Scan& scan, const calib::model::Rig& rig, bool refit_pose, const Tick& tick) {
  Result<calib::scene::TwoViews> views = calib::scene::two_views(rig, scan.devices.left, scan.devices.right);
  if (!views) {
    return std::move(views).error();
  }
  const std::vector<Match>& matches = scan.matches.measured;
  const std::vector<RayPair> rays = calib::scene::ray_pairs(*views, matches);
  Result<calib::scene::PoseRefit> refit =
      calib::scene::refit_pose(rig, scan.devices.left, scan.devices.right, matches, rays);
  if (!refit && refit_pose) {
    return std::move(refit).error();
  }
  if (refit) {
    scan.depth_ratio = depth_ratio(*views, refit->T_right_left, matches, rays);
    scan.refit = *std::move(refit);
  }
  if (tick && !tick(0.4)) {
    return fail(RCode::kCancelled);
  }
  scan.refitted = refit_pose;
  if (scan.refitted) {
    views->T_right_left = scan.refit->T_right_left;
  }
  scan.disagreement = calib::scene::epipolar_disagreement(*views, rays);
  Result<calib::scene::EpipolarAnalysis> epipolar = scan.refitted
                                                        ? analyse_held_out(matches, scan.disagreement)
                                                        : calib::scene::analyse_epipolar(matches, scan.disagreement);
  if (!epipolar) {
    return std::move(epipolar).error();
  }
  scan.epipolar = *std::move(epipolar);

  Result<calib::scene::Cloud> cloud = calib::scene::triangulate(*views, matches, rays);
  if (!cloud) {
    // Not a few wrong matches but the whole pair, and a refit would put it right: say so.
    const bool refit_helps = !scan.refitted && scan.moved() && scan.refit->held_out_after_px < kRefitHelpsPx &&
                             std::isfinite(scan.depth_ratio);
    return refit_helps ? fail(RCode::kPoseMoved,
                              "by " + std::to_string(1e3 * scan.refit->moved_rad) + " mrad; " + cloud.error().note)
                       : std::move(cloud).error();
  }
  scan.cloud = *std::move(cloud);
  scan.depth = depth_range(scan.cloud.points);
  // A scene without a wall has no flatness; that is no fault.
  if (Result<calib::scene::Plane> plane = calib::scene::dominant_plane(scan.cloud.points, kWallBandM)) {
    scan.plane = *plane;
    calib::scene::FlatnessOptions flat;
    flat.band_m = kWallBandM;
    if (const Result<calib::scene::Flatness> found = calib::scene::flatness(scan.cloud.points, *plane, flat)) {
      scan.flatness = *found;
    }
  }
  return ok();
}

}  // namespace

Result<ScanDevices> scan_devices(const Session& session, const calib::model::Rig& rig) {
  ScanDevices devices;
  const Result<std::size_t> left = find_camera(session, 0, rig);
  if (!left) {
    return left.error();
  }
  devices.left = *left;
  if (session.cameras() == 2) {
    const Result<std::size_t> right = find_camera(session, 1, rig);
    if (!right) {
      return right.error();
    }
    devices.right = *right;
    return devices;
  }
  if (session.cameras() != 1) {
    return fail(RCode::kCameraCount,
                std::to_string(session.cameras()) + " cameras; scanning takes two, or one and a calibrated projector");
  }
  const auto projector = std::ranges::find(rig.devices, DeviceKind::kProjector, &Device::kind);
  if (projector == rig.devices.end()) {
    return fail(RCode::kCameraCount, "one camera, and the calibration has no projector to measure against");
  }
  const PatternSequence& sequence = session.manifest().sequence;
  if (projector->camera.width != sequence.panel_width || projector->camera.height != sequence.panel_height) {
    return fail(RCode::kCalibrationMismatch,
                "the session's projector has " + size_text(sequence.panel_width, sequence.panel_height) +
                    " pixels, its calibration is for " + size_text(projector->camera.width, projector->camera.height));
  }
  devices.right = static_cast<std::size_t>(projector - rig.devices.begin());
  devices.with_projector = true;
  return devices;
}

Result<Scan> scan(const Session& session, int look, const calib::model::Rig& rig, const ScanOptions& options,
                  const StartStage& start_stage) {
  const auto stage = [&](const char* name) { return start_stage ? start_stage(name) : Tick(); };
  Scan scan;
  const Result<ScanDevices> devices = scan_devices(session, rig);
  if (!devices) {
    return devices.error();
  }
  scan.devices = *devices;
  Result<std::vector<DecodedLook>> looks = decode_cameras(session, look, options.decode, stage("decoding"));
  if (!looks) {
    return std::move(looks).error();
  }
  for (const DecodedLook& decoded : *looks) {
    const calib::decode::Diagnostics& diagnostics = decoded.codes.diagnostics;
    scan.decoded_fraction.push_back(static_cast<double>(diagnostics.valid) / static_cast<double>(diagnostics.pixels));
  }
  scan.white = std::move(looks->front().white);

  const PatternSequence& sequence = session.manifest().sequence;
  Tick tick = stage("matching");
  Result<MatchedLook> matches = match_look(*looks, sequence.panel_width, sequence.panel_height);
  if (!matches) {
    return std::move(matches).error();
  }
  looks->clear();
  scan.matches = std::move(matches->matches);
  if (tick && !tick(1)) {
    return fail(RCode::kCancelled);
  }
  tick = stage("triangulating");
  RAYSTEER_TRY(reconstruct(scan, rig, options.refit_pose, tick));
  return scan;
}

}  // namespace raysteer::host::scan
