#include "host/exchange/device_read.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace raysteer::host::exchange {

using calib::model::Device;
using calib::model::DeviceKind;
using calib::model::LensModel;
using proto::document::TomlTable;

namespace {

constexpr double kHuge = 1e12;  // beyond any number of a rig, and far from overflow
constexpr std::int64_t kMaxSide = 1 << 16;

// The key of the first number that is NaN or infinite: "device[1].focal_px[0]".
std::string find_not_finite(const toml::node& node, const std::string& key) {
  if (const auto* number = node.as_floating_point()) {
    return std::isfinite(number->get()) ? std::string() : key;
  }
  if (const toml::table* table = node.as_table()) {
    for (const auto& [name, child] : *table) {
      const std::string found = find_not_finite(child, (key.empty() ? "" : key + ".") + std::string(name.str()));
      if (!found.empty()) {
        return found;
      }
    }
  }
  if (const toml::array* array = node.as_array()) {
    for (std::size_t i = 0; i < array->size(); ++i) {
      const std::string found = find_not_finite((*array)[i], key + "[" + std::to_string(i) + "]");
      if (!found.empty()) {
        return found;
      }
    }
  }
  return {};
}

// Correlations make the test independent of units: pixels, radians and metres stand side by side.
std::string what_is_wrong(const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd sigma = covariance.diagonal().cwiseMax(0).cwiseSqrt();
  if (covariance.diagonal().minCoeff() < 0) {
    return "has a negative variance";
  }
  Eigen::MatrixXd correlation = covariance;
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    for (Eigen::Index j = 0; j < covariance.cols(); ++j) {
      const double scale = sigma[i] * sigma[j];
      if (scale == 0 && covariance(i, j) != 0) {
        return "ties a fixed parameter to another";
      }
      correlation(i, j) = scale == 0 ? 0 : covariance(i, j) / scale;
    }
  }
  // Inverting a matrix of condition 1e10 in doubles leaves about 1e-6 of asymmetry and of negative eigenvalues.
  constexpr double kRounding = 1e-6;
  if ((correlation - correlation.transpose()).cwiseAbs().maxCoeff() > kRounding) {
    return "is not symmetric";
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver((correlation + correlation.transpose()) / 2,
                                                              Eigen::EigenvaluesOnly);
  return solver.eigenvalues().minCoeff() < -kRounding * static_cast<double>(correlation.rows())
             ? "is not positive semidefinite"
             : "";
}

}  // namespace

std::vector<double> numbers(TomlTable& table, std::string_view key, std::size_t count) {
  std::vector<double> values = table.numbers(key);
  if (!table.has(key)) {
    table.fault(RCode::kMissingKey, key, "");
  } else if (values.size() != count && !values.empty()) {
    table.fault(RCode::kBadCalibrationFile, key,
                "must hold " + std::to_string(count) + " numbers, got " + std::to_string(values.size()));
  }
  values.resize(count);
  return values;
}

calib::model::Pose read_pose(TomlTable& table, bool is_first) {
  calib::model::Pose pose;
  const std::vector<double> q = numbers(table, "rotation_wxyz", 4);
  const std::vector<double> t = numbers(table, "translation_m", 3);
  pose.q = Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
  pose.t = {t[0], t[1], t[2]};
  // A quaternion written with all its digits has unit length to 1e-15; by hand with ten digits to 1e-9.
  if (std::abs(pose.q.norm() - 1) > 1e-6) {
    table.fault(RCode::kBadCalibrationFile, "rotation_wxyz", "is not a rotation: its length is not 1");
  }
  if (is_first && (pose.t.norm() > 0 || pose.q.vec().norm() > 0)) {
    table.fault(RCode::kBadCalibrationFile, "translation_m",
                "and the rotation of the first device must be none: it carries the rig's frame");
  }
  return pose;
}

Device read_device(TomlTable& table, bool is_first) {
  Device device;
  device.name = table.text("name");
  if (device.name.empty()) {
    table.fault(RCode::kBadValue, "name", "must not be empty");
  }
  device.kind = table.choice("kind", {"camera", "projector"}) == 0 ? DeviceKind::kCamera : DeviceKind::kProjector;
  calib::model::Camera& camera = device.camera;
  camera.width = static_cast<int>(table.integer("width", {1, kMaxSide}));
  camera.height = static_cast<int>(table.integer("height", {1, kMaxSide}));
  const std::vector<double> focal = numbers(table, "focal_px", 2);
  const std::vector<double> center = numbers(table, "center_px", 2);
  camera.fx = focal[0];
  camera.fy = focal[1];
  camera.cx = center[0];
  camera.cy = center[1];
  if (!(camera.fx > 0 && camera.fy > 0 && camera.fx < kHuge && camera.fy < kHuge)) {
    table.fault(RCode::kBadValue, "focal_px", "must be positive");
  }
  constexpr std::array kLenses{LensModel::kBc4, LensModel::kBc5, LensModel::kBc8};
  camera.lens = kLenses[static_cast<std::size_t>(table.choice("lens", {"bc4", "bc5", "bc8"}))];
  const std::vector<double> distortion =
      numbers(table, "distortion", static_cast<std::size_t>(coefficients(camera.lens)));
  std::ranges::copy(distortion, camera.k.begin());
  device.T_device_rig = read_pose(table, is_first);
  table.finish();
  return device;
}

void read_covariance(TomlTable& table, std::size_t count, std::vector<std::string>& parameters,
                     Eigen::MatrixXd& covariance) {
  parameters = table.texts("parameters");
  const std::vector<std::vector<double>> rows = table.matrix("matrix");
  table.finish();
  if (parameters.size() != count) {
    table.fault(RCode::kBadCalibrationFile, "parameters",
                "must name " + std::to_string(count) + ", got " + std::to_string(parameters.size()));
    return;
  }
  if (rows.size() != count || rows.front().size() != count) {
    table.fault(RCode::kBadCalibrationFile, "matrix",
                "must be " + std::to_string(count) + " x " + std::to_string(count) + ", got " +
                    std::to_string(rows.size()) + " x " + std::to_string(rows.empty() ? 0 : rows.front().size()));
    return;
  }
  covariance.resize(static_cast<Eigen::Index>(count), static_cast<Eigen::Index>(count));
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) {
      covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = rows[i][j];
    }
  }
  if (const std::string wrong = what_is_wrong(covariance); !wrong.empty()) {
    table.fault(RCode::kBadCalibrationFile, "matrix", wrong);
  }
}

Result<toml::table> parse_numbers(std::string_view text, std::string_view name) {
  toml::parse_result parsed = toml::parse(text, name);
  if (!parsed) {
    const toml::parse_error& error = parsed.error();
    return fail(RCode::kTomlSyntax, std::string(name) + ":" + std::to_string(error.source().begin.line) + ": " +
                                        std::string(error.description()));
  }
  return std::move(parsed).table();
}

Status check_format(const toml::table& root, std::string_view expected, std::int64_t version, std::string_view name) {
  const std::optional<std::string> format = root["format"].value<std::string>();
  if (format != expected) {
    return fail(RCode::kBadCalibrationFile,
                std::string(name) + (format ? ": its format is '" + *format + "'" : ": it has no 'format'") +
                    ", expected '" + std::string(expected) + "'");
  }
  const std::optional<std::int64_t> found = root["format_version"].value<std::int64_t>();
  if (found != version) {
    return fail(RCode::kFormatVersion, std::string(name) + ": format_version is " +
                                           (found ? std::to_string(*found) : "missing") + ", known is " +
                                           std::to_string(version));
  }
  if (const std::string key = find_not_finite(root, ""); !key.empty()) {
    return fail(RCode::kNotFinite, std::string(name) + ": '" + key + "'");
  }
  return ok();
}

}  // namespace raysteer::host::exchange
