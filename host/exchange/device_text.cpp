#include "host/exchange/device_text.hpp"

#include <fmt/core.h>

#include <array>
#include <cstddef>
#include <cstdint>

#include "proto/document/toml_text.hpp"

namespace raysteer::host::exchange {

using calib::model::Device;
namespace document = proto::document;

std::string number_array(std::span<const double> values) {
  std::string text;
  for (const double value : values) {
    text += (text.empty() ? "" : ", ") + exact(value);
  }
  return "[" + text + "]";
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
      document::quoted(device.name), device.kind == calib::model::DeviceKind::kProjector ? "projector" : "camera",
      camera.width, camera.height, number_array(std::array{camera.fx, camera.fy}),
      number_array(std::array{camera.cx, camera.cy}), calib::model::to_string(camera.lens), number_array(distortion),
      number_array(std::array{q.w(), q.x(), q.y(), q.z()}), number_array(std::array{t.x(), t.y(), t.z()}));
}

std::string covariance_text(const std::vector<std::string>& parameters, const Eigen::MatrixXd& covariance) {
  std::string text = "\n[covariance]\nparameters = [";
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    text += (i == 0 ? "" : ", ") + document::quoted(parameters[i]);
  }
  text += "]\nmatrix = [\n";
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    const Eigen::VectorXd row = covariance.row(i);
    text += "  " + number_array({row.data(), static_cast<std::size_t>(row.size())}) + ",\n";
  }
  return text + "]\n";
}

std::string text_id(std::string_view text) {
  // FNV-1a, 64 bits (Fowler, Noll, Vo): finds mistakes and mix-ups; it is no protection against forgery.
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char letter : text) {
    hash = (hash ^ static_cast<unsigned char>(letter)) * 1099511628211ULL;
  }
  return fmt::format("{:016x}", hash);
}

}  // namespace raysteer::host::exchange
