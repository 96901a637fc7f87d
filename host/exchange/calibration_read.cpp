#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "host/exchange/calibration_file.hpp"
#include "host/exchange/device_read.hpp"
#include "host/exchange/write_file.hpp"
#include "proto/document/toml_table.hpp"

namespace raysteer::host::exchange {
namespace {

using calib::model::Rig;
using proto::document::Faults;
using proto::document::TomlTable;

constexpr std::int64_t kFormatVersion = 1;
constexpr double kHuge = 1e12;  // beyond any number of a rig, and far from overflow

CalibrationMeta read_origin(TomlTable& table) {
  CalibrationMeta meta;
  meta.session = table.text("session", "");
  meta.verdict = table.text("verdict", "");
  meta.rms_px = table.number("rms_px", {0, kHuge}, 0);
  meta.held_out_p95_px = table.number("held_out_p95_px", {0, kHuge}, 0);
  meta.views_used = static_cast<int>(table.integer("views_used", {0, 1'000'000}, 0));
  meta.corners_used = static_cast<int>(table.integer("corners_used", {0, 1'000'000'000}, 0));
  if (table.has("target_sag_m")) {
    const std::vector<double> sag = numbers(table, "target_sag_m", 2);
    meta.sag_x_m = sag[0];
    meta.sag_y_m = sag[1];
  }
  table.finish();
  return meta;
}

TargetSpec read_target(TomlTable& table) {
  TargetSpec target;
  const bool charuco = table.choice("kind", {"chessboard", "charuco"}) == 1;
  target.kind = charuco ? TargetKind::kCharuco : TargetKind::kChessboard;
  target.columns = static_cast<int>(table.integer("columns", {0, 1000}));
  target.rows = static_cast<int>(table.integer("rows", {0, 1000}));
  target.square_m = table.number("square_m", {0, 100});
  if (charuco) {
    target.marker_m = table.number("marker_m", {0, 100}, 0);
    target.dictionary = table.text("dictionary", "");
    constexpr std::array kLayouts{CharucoLayout::kAuto, CharucoLayout::kLegacy, CharucoLayout::kCurrent};
    target.layout = kLayouts[static_cast<std::size_t>(table.choice("layout", {"auto", "legacy", "current"}, 0))];
  }
  table.finish();
  return target;
}

}  // namespace

Result<Calibration> from_toml(std::string_view text, std::string_view name) {
  const Result<toml::table> parsed = parse_numbers(text, name);
  RAYSTEER_TRY(parsed);
  const toml::table& root = *parsed;
  RAYSTEER_TRY(check_format(root, "raysteer-calibration", kFormatVersion, name));
  Faults faults;
  TomlTable table({&root}, "", faults);
  Calibration calibration;
  table.text("format");
  table.integer("format_version", {kFormatVersion, kFormatVersion});
  calibration.created_by = table.text("created_by", "");
  calibration.id = table.text("id", "");
  if (std::optional<TomlTable> origin = table.table("origin")) {
    calibration.meta = read_origin(*origin);
  }
  if (std::optional<TomlTable> target = table.table("target")) {
    calibration.meta.target = read_target(*target);
  }
  Rig& rig = calibration.rig;
  std::set<std::string> names;
  for (TomlTable& device : table.tables("device")) {
    rig.devices.push_back(read_device(device, rig.devices.empty()));
    if (!names.insert(rig.devices.back().name).second) {
      device.fault(RCode::kBadCalibrationFile, "name", "is there twice");
    }
  }
  if (rig.devices.empty()) {
    table.fault(RCode::kMissingKey, "device", "");
  } else if (std::optional<TomlTable> covariance = table.table("covariance")) {
    const std::size_t last = rig.devices.size() - 1;
    read_covariance(*covariance, static_cast<std::size_t>(rig.offset(last) + rig.count(last)), rig.parameters,
                    rig.covariance);
  }
  table.finish();
  RAYSTEER_TRY(faults.status());
  const std::string id = calibration_id(rig);
  if (!calibration.id.empty() && calibration.id != id) {
    return fail(RCode::kBadCalibrationFile, std::string(name) + ": its numbers give the id " + id + ", but it says " +
                                                calibration.id + ": it was changed after it was written");
  }
  calibration.id = id;
  return calibration;
}

Result<Calibration> read_calibration(const std::filesystem::path& path) {
  std::error_code ignored;
  const std::filesystem::path file = std::filesystem::is_directory(path, ignored) ? path / "calibration.toml" : path;
  const Result<std::string> text = read_file(file);
  RAYSTEER_TRY(text);
  return from_toml(*text, file.string());
}

}  // namespace raysteer::host::exchange
