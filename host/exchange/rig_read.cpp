#include <algorithm>
#include <array>
#include <cmath>
#include <system_error>
#include <utility>

#include "calib/model/steered_parameters.hpp"
#include "host/exchange/device_read.hpp"
#include "host/exchange/rig_file.hpp"
#include "host/exchange/write_file.hpp"

namespace raysteer::host::exchange {
namespace {

using calib::model::MirrorKind;
using calib::model::SteeredProjector;
using calib::steer::Solution;
using proto::document::Faults;
using proto::document::TomlTable;

constexpr std::int64_t kFormatVersion = 1;
constexpr double kHuge = 1e12;

Eigen::Vector3d vector(TomlTable& table, std::string_view key) {
  const std::vector<double> v = numbers(table, key, 3);
  return {v[0], v[1], v[2]};
}

Eigen::Vector2d pair(TomlTable& table, std::string_view key) {
  const std::vector<double> v = numbers(table, key, 2);
  return {v[0], v[1]};
}

Eigen::Vector3d direction(TomlTable& table, std::string_view key) {
  const Eigen::Vector3d v = vector(table, key);
  if (std::abs(v.norm() - 1) > 1e-6) {
    table.fault(RCode::kBadCalibrationFile, key, "is not a direction: its length is not 1");
  }
  return v;
}

void read_mirror(TomlTable& table, SteeredProjector& projector) {
  projector.kind = table.choice("kind", {"galvo-pair", "head"}) == 0 ? MirrorKind::kGalvoPair : MirrorKind::kHead;
  const bool head = projector.kind == MirrorKind::kHead;
  projector.least_rad = pair(table, "least_rad");
  projector.most_rad = pair(table, "most_rad");
  if (!(projector.least_rad.array() < projector.most_rad.array()).all()) {
    table.fault(RCode::kBadCalibrationFile, "least_rad", "must be below most_rad on both axes");
  }
  if (head) {
    projector.outer_axis = direction(table, "outer_axis");
    projector.outer_point = vector(table, "outer_point_m");
  }
  std::vector<TomlTable> planes = table.tables("plane");
  const std::size_t count = head ? 1 : 2;
  if (planes.size() != count) {
    table.fault(RCode::kBadCalibrationFile, "plane",
                "expected " + std::to_string(count) + ", got " + std::to_string(planes.size()));
  }
  for (std::size_t k = 0; k < std::min(count, planes.size()); ++k) {
    projector.parts[k] = {.axis = direction(planes[k], "axis"),
                          .point = vector(planes[k], "point_m"),
                          .normal = direction(planes[k], "normal"),
                          .offset_m = planes[k].number("offset_m", {-kHuge, kHuge}),
                          .size_m = pair(planes[k], "size_m"),
                          .ellipse = planes[k].choice("outline", {"ellipse", "rectangle"}) == 0};
    if (projector.parts[k].size_m.minCoeff() < 0) {
      planes[k].fault(RCode::kBadCalibrationFile, "size_m", "must not be negative");
    }
    planes[k].finish();
  }
  std::vector<TomlTable> curves = table.tables("curve");
  if (curves.size() != 2) {
    table.fault(RCode::kBadCalibrationFile, "curve", "expected 2, got " + std::to_string(curves.size()));
  }
  for (std::size_t k = 0; k < std::min<std::size_t>(2, curves.size()); ++k) {
    projector.curves[k] = {.half_range = curves[k].number("half_range_rad", {1e-9, kHuge}),
                           .gain = curves[k].number("gain", {-kHuge, kHuge}),
                           .quadratic = curves[k].number("quadratic", {-kHuge, kHuge}),
                           .cubic = curves[k].number("cubic", {-kHuge, kHuge}),
                           .cross_talk = curves[k].number("cross_talk", {-kHuge, kHuge})};
    curves[k].finish();
  }
  table.finish();
}

RoomTie read_room(TomlTable& table) {
  RoomTie room{.T_rig_room = read_pose(table, false), .covariance = {}};
  room.datums = static_cast<int>(table.integer("datums", {0, 1'000'000}));
  room.scale = table.number("scale", {1e-9, kHuge});
  table.finish();
  return room;
}

RigMeta read_origin(TomlTable& table) {
  RigMeta meta;
  meta.session = table.text("session", "");
  meta.board = table.text("board", "");
  meta.verdict = table.text("verdict", "");
  meta.survey = table.text("survey", "");
  meta.survey_id = table.text("survey_id", "");
  meta.whitened_rms = table.number("whitened_rms", {0, kHuge}, 0);
  meta.looks = static_cast<int>(table.integer("looks", {0, 1'000'000}, 0));
  meta.held_out_median_px = table.number("held_out_median_px", {0, kHuge}, 0);
  meta.held_out_p95_px = table.number("held_out_p95_px", {0, kHuge}, 0);
  meta.held_out_median_mm = table.number("held_out_median_mm", {0, kHuge}, 0);
  meta.held_out_p95_mm = table.number("held_out_p95_mm", {0, kHuge}, 0);
  table.finish();
  return meta;
}

void read_devices(TomlTable& table, Solution& solution) {
  std::vector<TomlTable> devices = table.tables("device");
  if (devices.size() != 3) {
    table.fault(RCode::kBadCalibrationFile, "device",
                "expected two cameras and the projector, got " + std::to_string(devices.size()) + " devices");
    return;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const calib::model::Device device = read_device(devices[k], k == 0);
    const bool projector = device.kind == calib::model::DeviceKind::kProjector;
    if (projector != (k == 2)) {
      devices[k].fault(RCode::kBadCalibrationFile, "kind", "expected two cameras, then the projector");
    }
    if (projector) {
      solution.projector.lens = device.camera;
      solution.projector.T_projector_rig = device.T_device_rig;
    } else {
      solution.cameras.devices.push_back(device);
    }
  }
}

}  // namespace

Result<RigCalibration> rig_from_toml(std::string_view text, std::string_view name) {
  const Result<toml::table> parsed = parse_numbers(text, name);
  RAYSTEER_TRY(parsed);
  RAYSTEER_TRY(check_format(*parsed, "raysteer-rig", kFormatVersion, name));
  Faults faults;
  TomlTable table({&*parsed}, "", faults);
  RigCalibration rig;
  Solution& solution = rig.solution;
  table.text("format");
  table.integer("format_version", {kFormatVersion, kFormatVersion});
  rig.created_by = table.text("created_by", "");
  rig.id = table.text("id", "");
  solution.repeatability_rad = table.number("repeatability_rad", {0, 1});
  if (std::optional<TomlTable> origin = table.table("origin")) {
    rig.meta = read_origin(*origin);
  }
  read_devices(table, solution);
  if (std::optional<TomlTable> mirror = table.table("mirror")) {
    read_mirror(*mirror, solution.projector);
  } else {
    table.fault(RCode::kMissingKey, "mirror", "");
  }
  if (std::optional<TomlTable> room = table.table("room")) {
    rig.room = read_room(*room);
  }
  RAYSTEER_TRY(faults.status());
  const std::size_t last = solution.cameras.devices.size() - 1;
  const int cameras = solution.cameras.offset(last) + solution.cameras.count(last);
  const int kept = cameras + calib::model::steered_parameters(solution.projector.kind);
  std::vector<std::string> names;
  Eigen::MatrixXd covariance;
  if (std::optional<TomlTable> stated = table.table("covariance")) {
    read_covariance(*stated, static_cast<std::size_t>(kept + (rig.room ? 6 : 0)), names, covariance);
  } else {
    table.fault(RCode::kMissingKey, "covariance", "");
  }
  table.finish();
  RAYSTEER_TRY(faults.status());
  solution.parameters = {names.begin(), names.begin() + kept};
  solution.covariance = covariance.topLeftCorner(kept, kept);
  solution.cameras.parameters = {names.begin(), names.begin() + cameras};
  solution.cameras.covariance = covariance.topLeftCorner(cameras, cameras);
  if (rig.room) {
    rig.room->covariance = covariance;
  }
  const std::string id = rig_id(solution, rig.room);
  if (!rig.id.empty() && rig.id != id) {
    return fail(RCode::kBadCalibrationFile, std::string(name) + ": its numbers give the id " + id + ", but it says " +
                                                rig.id + ": it was changed after it was written");
  }
  rig.id = id;
  return rig;
}

std::optional<calib::steer::InRoom> RigCalibration::in_room() const {
  if (!room) {
    return std::nullopt;
  }
  return calib::steer::InRoom{.solution = solution, .T_rig_room = room->T_rig_room, .covariance = room->covariance};
}

Result<RigCalibration> read_rig(const std::filesystem::path& path) {
  std::error_code ignored;
  const std::filesystem::path file = std::filesystem::is_directory(path, ignored) ? path / "rig.toml" : path;
  const Result<std::string> text = read_file(file);
  RAYSTEER_TRY(text);
  return rig_from_toml(*text, file.string());
}

}  // namespace raysteer::host::exchange
