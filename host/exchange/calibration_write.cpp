#include <fmt/core.h>

#include <array>
#include <cstdint>

#include "host/exchange/calibration_file.hpp"
#include "host/exchange/exports.hpp"
#include "host/exchange/number_text.hpp"
#include "host/exchange/write_file.hpp"

namespace raysteer::host::exchange {
namespace {

using calib::model::Device;
using calib::model::Rig;

template <class Values>
std::string array(const Values& values) {
  std::string text;
  for (const double value : values) {
    text += (text.empty() ? "" : ", ") + exact(value);
  }
  return "[" + text + "]";
}

// A basic TOML string.
std::string toml_text(std::string_view text) {
  std::string out = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') {
      out += '\\';
      out += letter;
    } else if (static_cast<unsigned char>(letter) < 0x20 || letter == 0x7f) {
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(letter));
    } else {
      out += letter;
    }
  }
  return out + "\"";
}

std::string device_text(const Device& device) {
  const calib::model::Camera& camera = device.camera;
  const Eigen::Quaterniond& q = device.T_device_rig.q;
  const Eigen::Vector3d& t = device.T_device_rig.t;
  const auto used = static_cast<std::ptrdiff_t>(coefficients(camera.lens));
  const std::vector<double> distortion(camera.k.begin(), camera.k.begin() + used);
  return fmt::format(
      "\n[[device]]\n"
      "name = {}\n"
      "kind = \"{}\"\n"
      "width = {}\n"
      "height = {}\n"
      "focal_px = {}\n"
      "center_px = {}\n"
      "lens = \"{}\"\n"
      "distortion = {}\n"
      "rotation_wxyz = {}\n"
      "translation_m = {}\n",
      toml_text(device.name), device.kind == calib::model::DeviceKind::kProjector ? "projector" : "camera",
      camera.width, camera.height, array(std::array{camera.fx, camera.fy}), array(std::array{camera.cx, camera.cy}),
      calib::model::to_string(camera.lens), array(distortion), array(std::array{q.w(), q.x(), q.y(), q.z()}),
      array(std::array{t.x(), t.y(), t.z()}));
}

// Devices and covariance: what the id stands for.
std::string rig_text(const Rig& rig) {
  std::string text;
  for (const Device& device : rig.devices) {
    text += device_text(device);
  }
  if (rig.covariance.size() > 0) {
    text += "\n[covariance]\nparameters = [";
    for (std::size_t i = 0; i < rig.parameters.size(); ++i) {
      text += (i == 0 ? "" : ", ") + toml_text(rig.parameters[i]);
    }
    text += "]\nmatrix = [\n";
    for (Eigen::Index i = 0; i < rig.covariance.rows(); ++i) {
      const Eigen::VectorXd row = rig.covariance.row(i);
      text += "  " + array(row) + ",\n";
    }
    text += "]\n";
  }
  return text;
}

std::string target_text(const TargetSpec& target) {
  const bool charuco = target.kind == TargetKind::kCharuco;
  std::string text =
      fmt::format("\n[target]\nkind = \"{}\"\ncolumns = {}\nrows = {}\nsquare_m = {}\n",
                  charuco ? "charuco" : "chessboard", target.columns, target.rows, exact(target.square_m));
  if (charuco) {
    text += fmt::format("marker_m = {}\ndictionary = {}\n", exact(target.marker_m), toml_text(target.dictionary));
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

std::string calibration_id(const Rig& rig) {
  // FNV-1a, 64 bits (Fowler, Noll, Vo): finds mistakes and mix-ups; it is no protection against forgery.
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char letter : rig_text(rig)) {
    hash = (hash ^ static_cast<unsigned char>(letter)) * 1099511628211ULL;
  }
  return fmt::format("{:016x}", hash);
}

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
      RAYSTEER_VERSION, calibration_id(rig), toml_text(meta.session), toml_text(meta.verdict), exact(meta.rms_px));
  if (meta.held_out_p95_px > 0) {
    text += fmt::format("held_out_p95_px = {}\n", exact(meta.held_out_p95_px));
  }
  text += fmt::format("views_used = {}\ncorners_used = {}\ntarget_sag_m = {}\n", meta.views_used, meta.corners_used,
                      array(std::array{meta.sag_x_m, meta.sag_y_m}));
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
