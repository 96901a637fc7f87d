// A session and a calibration become a cloud: decode, match, check the pair, triangulate, judge.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calib/decode/decoder.hpp"
#include "calib/model/rig.hpp"
#include "calib/scene/epipolar.hpp"
#include "calib/scene/match.hpp"
#include "calib/scene/plane.hpp"
#include "calib/scene/refit_pose.hpp"
#include "calib/scene/triangulate.hpp"
#include "hal/base/image.hpp"
#include "hal/base/result.hpp"
#include "host/scan/decode_look.hpp"
#include "host/session/session.hpp"

namespace raysteer::host::scan {

/// Starts a named stage and gives what its progress is told to.
using StartStage = std::function<Tick(std::string name)>;

struct ScanOptions {
  bool refit_pose = false;
  calib::decode::Options decode;
};

struct DepthRange {
  double p1_m = 0, median_m = 0, p99_m = 0;
};

/// Two devices of a rig that a session is scanned with: two cameras, or its one camera and the projector.
struct ScanDevices {
  std::size_t left = 0, right = 0;
  bool with_projector = false;
};

struct Scan {
  ScanDevices devices;
  std::vector<double> decoded_fraction;  ///< per camera of the session: pixels with a coordinate / all pixels
  calib::scene::Matches matches;
  std::vector<double> disagreement;  ///< of each match, px, with the pose that the cloud was made with
  /// With the pose as calibrated; with --refit-pose with the refitted pose, on the matches held out of the refit.
  calib::scene::EpipolarAnalysis epipolar;
  std::optional<calib::scene::PoseRefit> refit;  ///< always tried; nothing where too few matches
  bool refitted = false;                         ///< and used
  double depth_ratio = 1;                        ///< median depth with the refitted pose / as calibrated
  calib::scene::Cloud cloud;
  DepthRange depth;
  std::optional<calib::scene::Plane> plane;
  std::optional<calib::scene::Flatness> flatness;
  Image<std::uint8_t> white;  ///< of the left camera; may be empty

  bool moved() const { return refit && refit->moved; }
};

/// Which devices of `rig` the session's cameras are. Errors: kCameraCount (one camera and no projector, three
/// cameras), kCalibrationMismatch (a name is not in the calibration, a size differs; says which).
Result<ScanDevices> scan_devices(const session::Session& session, const calib::model::Rig& rig);

/// Errors: those of scan_devices(), decode_cameras(); kTooFewMatches; kPoseMoved (the pair moved so far that nothing
/// fits, and options.refit_pose would help); kCancelled.
Result<Scan> scan(const session::Session& session, int look, const calib::model::Rig& rig, const ScanOptions& options,
                  const StartStage& start_stage);

}  // namespace raysteer::host::scan
