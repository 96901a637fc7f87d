// The calibration of a steered rig as a file, rig.toml: our own documented TOML (docs/rig-format.md), exact and
// checked.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "calib/model/pose.hpp"
#include "calib/steer/room.hpp"
#include "calib/steer/solve.hpp"
#include "hal/base/result.hpp"

namespace raysteer::host::exchange {

/// Where the rig is in the room, by its datums.
struct RoomTie {
  calib::model::Pose T_rig_room;
  /// Of cameras, projector and, last, the left increment of T_rig_room (rotation 3, radians; translation 3, metres).
  Eigen::MatrixXd covariance;
  int datums = 0;
  double scale = 1;  ///< lengths between datums as the rig measures them over those of the survey
};

/// What is kept of a rig that was just tied to its room: the covariance's rows of single looks are dropped.
RoomTie room_tie(const calib::steer::InRoom& rig, int datums, double scale);

/// How the calibration came about; for people, nothing is computed from it.
struct RigMeta {
  std::string session;
  std::string board;
  std::string verdict;  ///< "good", "usable", "redo"
  double whitened_rms = 0;
  double held_out_median_px = 0, held_out_p95_px = 0;  ///< 0: no look was held out
  double held_out_median_mm = 0, held_out_p95_mm = 0;
  int looks = 0;
  std::string survey{};     ///< its name; empty where none was used
  std::string survey_id{};  ///< survey_id() of the file's text
};

struct RigCalibration {
  /// With the room, or nothing when it is not tied to one.
  std::optional<calib::steer::InRoom> in_room() const;

  /// What predict() needs: projector, cameras, repeatability, and the covariance of cameras and projector; no looks.
  calib::steer::Solution solution;
  std::optional<RoomTie> room;
  RigMeta meta;
  std::string created_by;
  std::string id;
};

/// The file's text; the covariance's rows of single looks are left out.
std::string to_toml(const calib::steer::Solution& solution, const std::optional<RoomTie>& room, const RigMeta& meta);
/// 16 hexadecimal digits that stand for a survey file's text, to tell whether it was edited since.
std::string survey_id(std::string_view text);
/// The id a rig gets: the same numbers give the same id.
std::string rig_id(const calib::steer::Solution& solution, const std::optional<RoomTie>& room);

/// Errors: kTomlSyntax, kFormatVersion, kUnknownKey, kMissingKey, kBadValue, kNotFinite, kBadCalibrationFile, each
/// naming its place.
Result<RigCalibration> rig_from_toml(std::string_view text, std::string_view name);

/// Reads a file, or rig.toml in a folder. Errors: kFileMissing, kFileUnreadable, and those of rig_from_toml.
Result<RigCalibration> read_rig(const std::filesystem::path& path);

}  // namespace raysteer::host::exchange
