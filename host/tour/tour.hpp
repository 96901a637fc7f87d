// The first straight rectangle: cameras calibrated, one look solved, one picture baked, all on the pretend rig.
//
// As the published method does it: discs are shown beside a board on the floor; the cameras tell the plane from the
// board; the projector is posed against the plane by the discs; the rectangle's homography, with the projector's lens
// in it, becomes the picture that is sent. The truth is asked for afterwards, for the error alone.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <string>

#include "hal/base/result.hpp"
#include "host/sim/pretend_options.hpp"
#include "host/sim/program.hpp"

namespace raysteer::host::tour {

struct TourOptions {
  sim::PretendOptions pretend;
  std::array<double, 2> mirror_rad{};  ///< the look
  std::string plan = "cameras";        ///< how the board is held for the cameras
  std::filesystem::path folder;        ///< what is recorded goes here; must exist
};

/// Lengths in millimetres, on the floor.
struct TourResult {
  std::array<double, 4> corners_mm{};  ///< top left, top right, bottom right, bottom left: missed by
  double corner_mean_mm = 0;
  double corner_max_mm = 0;
  double before_mean_mm = 0;  ///< sent unwarped
  double before_max_mm = 0;
  std::array<double, 4> sides_mm{};  ///< lengths: top, right, bottom, left
  double predicted_mean_mm = 0;      ///< what corner_mean_mm was to be expected by the covariance alone
  double chi_square = 0;             ///< of the corners' eight errors by their covariance; about 8
  double leave_one_out_mm = 0;       ///< RMS of discs that the solution had not seen
  double camera_rms_px = 0;
  double corner_rms_px = 0;  ///< board on the floor
  double disc_rms_px = 0;
  int discs = 0;
  int left_out = 0;
  bool mirrored = false;
  std::array<double, 2> middle_m{};  ///< of the rectangle, from the board's corner 0: level to the camera, and down
  std::filesystem::path picture;     ///< before and after, PNG
};

/// Errors: those of the pretend rig, of calibrating, detecting and solving; kBadValue: the rectangle lies off the
/// panel.
Result<TourResult> tour(const TourOptions& options, const sim::Listener& listener);

}  // namespace raysteer::host::tour
