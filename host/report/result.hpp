// value: what a calibration or a scan found, as result.json holds it and report.html draws it.
//
// docs/json/result.schema.json describes the file. Plain numbers only; NaN (null in the file) means "not known".
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <variant>
#include <vector>

#include "hal/base/result.hpp"
#include "host/report/parts.hpp"
#include "host/report/rig_result.hpp"

namespace raysteer::host::report {

struct DeviceResult {
  std::string name;
  std::string kind;  ///< "camera", "projector"
  int width = 0;     ///< px
  int height = 0;
  std::string lens;  ///< "bc5"
  double focal_px = kUnknown;
  double rms_px = kUnknown;  ///< kept corners, two-dimensional
  int corners_seen = 0;
  int corners_kept = 0;
  std::vector<ParameterRow> parameters;
  std::vector<ResidualVector> residuals;
  Grid coverage;        ///< kept corners per cell
  Grid uncertainty_px;  ///< sigma of the projection at `uncertainty_range_m` (infinite: directions)
  double uncertainty_range_m = kUnknown;
  Grid odd_even_px;  ///< difference of calibrations from odd and from even views
  double odd_even_median_px = kUnknown;
  double odd_even_p95_px = kUnknown;
};

struct ViewRow {
  std::string name;
  bool used = true;
  std::string code;            ///< "R0306" when not used
  std::string why;             ///< when not used
  std::vector<double> rms_px;  ///< per device, in the order of `devices`; NaN: not seen
  double tilt_rad = kUnknown;
  double distance_m = kUnknown;
};

struct LensRow {
  std::string device;
  std::string lens;
  double held_out_px = kUnknown;
  bool monotonic = true;
  bool chosen = false;
};

/// Against the calibration that was in --out before.
struct DifferenceResult {
  std::string device;
  Grid px;
  Grid mm;  ///< the same at `range_m`
  double range_m = kUnknown;
  double median_px = kUnknown;
  double p95_px = kUnknown;
};

struct CalibrationResult {
  Judgement judgement;
  std::string session;
  std::string target;          ///< "chessboard, 9 x 6 corners of 30 mm"
  std::string calibration_id;  ///< of calibration.toml
  double rms_px = kUnknown;    ///< all devices, each kept corner of equal weight, two-dimensional
  double baseline_m = kUnknown;
  int folds = 0;  ///< cross-validation; 0: none
  int held_out_corners = 0;
  double held_out_rms_px = kUnknown;
  double held_out_median_px = kUnknown;
  double held_out_p95_px = kUnknown;
  double leave_one_out_px = kUnknown;  ///< with a projector
  double pixel_rms_px = kUnknown;      ///< with a projector: single decoded pixels
  std::vector<double> sag_m;           ///< of the target along columns and rows; empty: not solved
  std::vector<double> sag_sigma_m;
  std::vector<DeviceResult> devices;
  std::vector<ViewRow> views;
  std::vector<LensRow> lenses;
  std::vector<std::string> correlated;
  std::vector<DifferenceResult> differences;
};

struct ScanResult {
  Judgement judgement;
  std::string session;
  std::string calibration;     ///< path
  std::string calibration_id;  ///< of calibration.toml
  std::int64_t points = 0;
  std::int64_t matched_projector_pixels = 0;
  std::int64_t interpolated_projector_pixels = 0;  ///< not among the matched
  double decoded_fraction = kUnknown;
  double epipolar_sigma_px = kUnknown;  ///< 1.4826 MAD, ungated
  double epipolar_within_cell_px = kUnknown;
  double epipolar_systematic_px = kUnknown;
  Grid epipolar_cells_px;        ///< medians over the left image, signed
  Histogram epipolar_histogram;  ///< signed disagreement, px
  double patch_rms_m = kUnknown;
  double patch_predicted_rms_m = kUnknown;
  std::int64_t patches = 0;
  double pose_moved_rad = kUnknown;
  double pose_moved_sigma_rad = kUnknown;
  bool pose_moved = false;
  bool pose_refitted = false;
  double held_out_before_px = kUnknown;  ///< 1.4826 MAD on matches held out of the refit
  double held_out_after_px = kUnknown;
  Histogram depth_histogram;  ///< m
  std::string picture;        ///< file name in the folder: "cloud.png" (picture.hpp makes it); empty: none
  std::vector<Fact> facts;    ///< further lines for the table
};

using AnyResult = std::variant<CalibrationResult, ScanResult, RigResult>;

/// What --json prints: the keys scripts rely on, without maps and residuals. Keys that are not known are left out.
/// Calibration: verdict, summary, reasons, advice, rms_px, cameras[] {name, rms_px, ...}, stereo {rms_px, baseline_m}
/// when there are two cameras, projector {focal_px, ...} and leave_one_out_px when there is one,
/// cross_validation {rms_px, median_px, p95_px}. Scan: points, matched_projector_pixels, epipolar {sigma_px,
/// within_cell_px, systematic_px}, flatness {patch_rms_m}, decoded_fraction, pose_moved_rad. A steered rig: what its
/// commands print comes from them; here are the judgement, reach, stations and the difference to the calibration
/// before.
nlohmann::ordered_json summary_json(const AnyResult& result);

/// A rig's difference to an earlier calibration, as the summary has it.
nlohmann::ordered_json difference_json(const RigDifferenceResult& difference);

/// The whole file: the summary's keys and `detail`.
nlohmann::ordered_json result_json(const AnyResult& result);

/// Writes `folder`/result.json and `folder`/report.html. A scan's picture must be there already. `more`: an object
/// whose keys stand beside the summary's and win. Errors: kDiskFull, kWriteFailed.
Status write_result(const std::filesystem::path& folder, const AnyResult& result);
Status write_result(const std::filesystem::path& folder, const AnyResult& result, const nlohmann::ordered_json& more);

/// Reads `folder`/result.json. Errors: kNothingToReport, kBadValue, kFormatVersion.
Result<AnyResult> read_result(const std::filesystem::path& folder);

}  // namespace raysteer::host::report
