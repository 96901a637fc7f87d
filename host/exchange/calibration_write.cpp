#include <fmt/core.h>

#include <array>
#include <cstdint>

#include "host/exchange/calibration_file.hpp"
#include "host/exchange/device_text.hpp"
#include "host/exchange/exports.hpp"
#include "host/exchange/number_text.hpp"
#include "host/exchange/write_file.hpp"
#include "proto/document/toml_text.hpp"

namespace raysteer::host::exchange {
namespace {

using calib::model::Device;
using calib::model::Rig;
namespace document = proto::document;

// Devices and covariance: what the id stands for.
std::string rig_text(const Rig& rig) {
  std::string text;
  for (const Device& device : rig.devices) {
    text += device_text(device);
  }
  if (rig.covariance.size() > 0) {
    text += covariance_text(rig.parameters, rig.covariance);
  }
  return text;
}

std::string target_text(const TargetSpec& target) {
  const bool charuco = target.kind == TargetKind::kCharuco;
  std::string text =
      fmt::format("\n[target]\nkind = \"{}\"\ncolumns = {}\nrows = {}\nsquare_m = {}\n",
                  charuco ? "charuco" : "chessboard", target.columns, target.rows, exact(target.square_m));
  if (charuco) {
    text +=
        fmt::format("marker_m = {}\ndictionary = {}\n", exact(target.marker_m), document::quoted(target.dictionary));
    if (target.layout != CharucoLayout::kAuto) {
      text += fmt::format("layout = \"{}\"\n", target.layout == CharucoLayout::kLegacy ? "legacy" : "current");
    }
  }
  return text;
}

Status check_finite(const Rig& rig, const CalibrationMeta& meta) {
  for (const Device& device : rig.devices) {
    if (const Status checked = calib::model::check(device.camera); !checked) {
      return with_context(checked.error(), device.name);
    }
    if (!device.T_device_rig.t.allFinite() || !device.T_device_rig.q.coeffs().allFinite()) {
      return fail(RCode::kNotFinite, "the pose of " + device.name);
    }
  }
  if (!rig.covariance.allFinite()) {
    return fail(RCode::kNotFinite, "the covariance");
  }
  const Eigen::Vector4d numbers(meta.rms_px, meta.held_out_p95_px, meta.sag_x_m, meta.sag_y_m);
  if (!numbers.allFinite()) {
    return fail(RCode::kNotFinite, "the statistics");
  }
  return ok();
}

}  // namespace

std::string calibration_id(const Rig& rig) { return text_id(rig_text(rig)); }

std::string to_toml(const Rig& rig, const CalibrationMeta& meta) {
  std::string text = fmt::format(
      "# A calibration made by Raysteer; docs/calibration-format.md says what every key means.\n"
      "format = \"raysteer-calibration\"\n"
      "format_version = 1\n"
      "created_by = \"raysteer {}\"\n"
      "id = \"{}\"\n"
      "\n[origin]\n"
      "session = {}\n"
      "verdict = {}\n"
      "rms_px = {}\n",
      RAYSTEER_VERSION, calibration_id(rig), document::quoted(meta.session), document::quoted(meta.verdict),
      exact(meta.rms_px));
  if (meta.held_out_p95_px > 0) {
    text += fmt::format("held_out_p95_px = {}\n", exact(meta.held_out_p95_px));
  }
  text += fmt::format("views_used = {}\ncorners_used = {}\ntarget_sag_m = {}\n", meta.views_used, meta.corners_used,
                      number_array(std::array{meta.sag_x_m, meta.sag_y_m}));
  return text + target_text(meta.target) + rig_text(rig);
}

Result<std::string> write_calibration(const std::filesystem::path& folder, const Rig& rig,
                                      const CalibrationMeta& meta) {
  RAYSTEER_TRY(check_finite(rig, meta));
  RAYSTEER_TRY(write_file(folder / "calibration.toml", to_toml(rig, meta)));
  RAYSTEER_TRY(write_file(folder / "calibration.opencv.yaml", to_opencv_yaml(rig)));
  RAYSTEER_TRY(write_file(folder / "camchain.yaml", to_kalibr_camchain(rig)));
  return calibration_id(rig);
}

}  // namespace raysteer::host::exchange
