// The calibration file: our own documented TOML (docs/calibration-format.md), exact and checked in full.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "calib/model/rig.hpp"
#include "hal/base/result.hpp"
#include "hal/base/target.hpp"

namespace raysteer::host::exchange {

/// How the calibration came about; kept beside the rig in the file.
struct CalibrationMeta {
  std::string session;  ///< where the frames were, as the user named it
  TargetSpec target;
  std::string verdict;         ///< "good", "usable", "redo"
  double rms_px = 0;           ///< kept corners, two-dimensional
  double held_out_p95_px = 0;  ///< cross-validation; 0: not done
  int views_used = 0;
  int corners_used = 0;
  double sag_x_m = 0, sag_y_m = 0;  ///< the target's shape as solved
};

struct Calibration {
  calib::model::Rig rig;
  CalibrationMeta meta;
  std::string created_by;  ///< "raysteer 0.1.0"
  std::string id;          ///< of the rig: FNV-1a 64 of its text form, 16 hexadecimal digits
};

/// The file's text. Numbers are the shortest that read back to the same bits.
std::string to_toml(const calib::model::Rig& rig, const CalibrationMeta& meta);

/// The id a rig gets: the same numbers give the same id, wherever they were written.
std::string calibration_id(const calib::model::Rig& rig);

/// Reads and checks everything. `name` begins the messages. Errors: kTomlSyntax, kFormatVersion, kUnknownKey (naming
/// the nearest known one), kMissingKey, kBadValue, kNotFinite (naming the key), kBadCalibrationFile (matrix sizes, a
/// covariance that is not symmetric or not positive semidefinite, a rotation of no unit length, an id that does not
/// belong to the numbers: the file was edited).
Result<Calibration> from_toml(std::string_view text, std::string_view name);

/// Reads a file, or calibration.toml in a folder. Errors: kFileMissing, kFileUnreadable, and those of from_toml.
Result<Calibration> read_calibration(const std::filesystem::path& path);

/// Writes calibration.toml, calibration.opencv.yaml and camchain.yaml (cameras only) into `folder`.
/// Returns the id. Errors: kDiskFull, kWriteFailed, kNotFinite.
Result<std::string> write_calibration(const std::filesystem::path& folder, const calib::model::Rig& rig,
                                      const CalibrationMeta& meta);

}  // namespace raysteer::host::exchange
