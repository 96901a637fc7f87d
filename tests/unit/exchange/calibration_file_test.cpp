#include "host/exchange/calibration_file.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "host/exchange/number_text.hpp"

namespace raysteer::host::exchange {
namespace {

using calib::model::Device;
using calib::model::DeviceKind;
using calib::model::LensModel;
using calib::model::Rig;

CalibrationMeta meta() {
  CalibrationMeta meta;
  meta.session = "shots \"of\" monday/session.toml";
  meta.target = {TargetKind::kCharuco, 14, 9, 0.02, 0.015, "5X5_1000", CharucoLayout::kLegacy};
  meta.verdict = "usable";
  meta.rms_px = 0.1 + 0.2;
  meta.held_out_p95_px = 0.33;
  meta.views_used = 28;
  meta.corners_used = 2711;
  meta.sag_x_m = -1.5e-4;
  return meta;
}

// A camera, another with eight coefficients, and a projector; numbers with all their bits set.
Rig rig() {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> some(-1, 1);
  Rig rig;
  for (const LensModel lens : {LensModel::kBc5, LensModel::kBc8, LensModel::kBc4}) {
    Device device;
    device.name = std::string(to_string(lens)) + " eye";
    device.kind = lens == LensModel::kBc4 ? DeviceKind::kProjector : DeviceKind::kCamera;
    device.camera = {1280, 800, 1000 + some(random), 1001 + some(random), 640 + some(random), 401 + some(random), lens};
    for (int i = 0; i < coefficients(lens); ++i) {
      device.camera.k[static_cast<std::size_t>(i)] = some(random) * 1e-3;
    }
    if (!rig.devices.empty()) {
      device.T_device_rig.q = Eigen::Quaterniond(1, some(random), some(random), some(random)).normalized();
      device.T_device_rig.t = {some(random), some(random), some(random)};
    }
    rig.devices.push_back(device);
  }
  const int count = rig.offset(2) + rig.count(2);
  Eigen::MatrixXd root(count, count);
  for (int i = 0; i < count; ++i) {
    rig.parameters.push_back("p" + std::to_string(i));
    for (int j = 0; j < count; ++j) {
      root(i, j) = some(random) * (i % 2 == 0 ? 1 : 1e-5);
    }
  }
  rig.covariance = root * root.transpose();
  rig.covariance = (rig.covariance + rig.covariance.transpose()).eval() / 2;
  rig.covariance.row(3).setZero();  // a parameter held fixed
  rig.covariance.col(3).setZero();
  return rig;
}

std::string changed(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

// Without the id, which would be wrong after any change of the numbers.
std::string text_without_id() {
  std::string text = to_toml(rig(), meta());
  const std::size_t at = text.find("id = ");
  return text.erase(at, text.find('\n', at) + 1 - at);
}

Error error_of(const std::string& text) {
  const Result<Calibration> read = from_toml(text, "c.toml");
  EXPECT_FALSE(read.has_value());
  return read ? fail(RCode::kNone) : read.error();
}

TEST(CalibrationFile, reads_back_the_same_bits) {
  const Rig written = rig();
  const Result<Calibration> read = from_toml(to_toml(written, meta()), "c.toml");
  ASSERT_TRUE(read) << read.error().message();
  ASSERT_EQ(read->rig.devices.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const Device& a = written.devices[i];
    const Device& b = read->rig.devices[i];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.kind, b.kind);
    EXPECT_EQ(a.camera.fx, b.camera.fx);
    EXPECT_EQ(a.camera.fy, b.camera.fy);
    EXPECT_EQ(a.camera.cx, b.camera.cx);
    EXPECT_EQ(a.camera.cy, b.camera.cy);
    EXPECT_EQ(a.camera.lens, b.camera.lens);
    EXPECT_EQ(a.camera.k, b.camera.k);
    EXPECT_EQ(a.T_device_rig.q.coeffs(), b.T_device_rig.q.coeffs());
    EXPECT_EQ(a.T_device_rig.t, b.T_device_rig.t);
  }
  EXPECT_EQ(read->rig.covariance, written.covariance);
  EXPECT_EQ(read->rig.parameters, written.parameters);
  EXPECT_EQ(read->meta.session, meta().session);
  EXPECT_EQ(read->meta.target, meta().target);
  EXPECT_EQ(read->meta.rms_px, meta().rms_px);
  EXPECT_EQ(read->meta.sag_x_m, meta().sag_x_m);
  EXPECT_EQ(read->meta.views_used, 28);
  EXPECT_EQ(read->id, calibration_id(written));
  EXPECT_EQ(to_toml(read->rig, read->meta), to_toml(written, meta()));
}

TEST(CalibrationFile, id_follows_the_numbers_not_the_origin) {
  CalibrationMeta other = meta();
  other.session = "elsewhere";
  const Rig a = rig();
  Rig b = rig();
  EXPECT_EQ(from_toml(to_toml(a, meta()), "a")->id, from_toml(to_toml(a, other), "b")->id);
  b.devices[0].camera.fx = std::nextafter(b.devices[0].camera.fx, 2000);
  EXPECT_NE(calibration_id(a), calibration_id(b));
}

TEST(CalibrationFile, refuses_numbers_changed_by_hand) {
  const std::string text = to_toml(rig(), meta());
  const Error error = error_of(changed(text, "width = 1280", "width = 1281"));
  EXPECT_EQ(error.rcode, RCode::kBadCalibrationFile);
  EXPECT_NE(error.note.find("changed after it was written"), std::string::npos) << error.note;
}

TEST(CalibrationFile, names_the_key_that_is_not_finite) {
  for (const std::string bad : {"nan", "inf", "-inf"}) {
    const Error error = error_of(changed(text_without_id(), "focal_px = [", "focal_px = [" + bad + ", "));
    EXPECT_EQ(error.rcode, RCode::kNotFinite);
    EXPECT_EQ(error.note, "c.toml: 'device[0].focal_px[0]'");
  }
  EXPECT_EQ(error_of(changed(text_without_id(), "matrix = [\n  [", "matrix = [\n  [nan, ")).note,
            "c.toml: 'covariance.matrix[0][0]'");
}

TEST(CalibrationFile, names_the_nearest_known_key) {
  const Error error = error_of(changed(text_without_id(), "focal_px", "focul_px"));
  EXPECT_EQ(error.rcode, RCode::kUnknownKey);
  EXPECT_NE(error.note.find("'focal_px'"), std::string::npos) << error.note;
}

TEST(CalibrationFile, refuses_another_version_and_other_files) {
  EXPECT_EQ(error_of(changed(text_without_id(), "format_version = 1", "format_version = 2")).rcode,
            RCode::kFormatVersion);
  EXPECT_EQ(error_of(changed(text_without_id(), "raysteer-calibration", "something")).rcode,
            RCode::kBadCalibrationFile);
  EXPECT_EQ(error_of("").rcode, RCode::kBadCalibrationFile);
  EXPECT_EQ(error_of("a = ").rcode, RCode::kTomlSyntax);
}

TEST(CalibrationFile, refuses_sizes_that_do_not_fit) {
  EXPECT_EQ(error_of(changed(text_without_id(), "distortion = [", "distortion = [1.0, ")).rcode,
            RCode::kBadCalibrationFile);
  EXPECT_EQ(error_of(changed(text_without_id(), "parameters = [", "parameters = [\"more\", ")).rcode,
            RCode::kBadCalibrationFile);
  EXPECT_EQ(error_of(changed(text_without_id(), "matrix = [\n  [", "matrix = [\n  [0.0, ")).rcode, RCode::kBadValue)
      << "rows of different length";
  EXPECT_EQ(error_of(changed(text_without_id(), "lens = \"bc5\"", "lens = \"bc8\"")).rcode, RCode::kBadCalibrationFile);
}

TEST(CalibrationFile, refuses_a_covariance_that_is_none) {
  const auto with = [](const auto& change) {
    Rig bad = rig();
    change(bad.covariance);
    return error_of(to_toml(bad, meta()));
  };
  const Error crooked = with([](Eigen::MatrixXd& c) { c(0, 1) += 0.1 * std::sqrt(c(0, 0) * c(1, 1)); });
  EXPECT_EQ(crooked.rcode, RCode::kBadCalibrationFile);
  EXPECT_NE(crooked.note.find("not symmetric"), std::string::npos);
  const Error negative = with([](Eigen::MatrixXd& c) { c(5, 5) = -c(5, 5); });
  EXPECT_NE(negative.note.find("negative variance"), std::string::npos);
  const Error indefinite = with([](Eigen::MatrixXd& c) { c(0, 2) = c(2, 0) = 1.1 * std::sqrt(c(0, 0) * c(2, 2)); });
  EXPECT_NE(indefinite.note.find("not positive semidefinite"), std::string::npos);
  const Error tied = with([](Eigen::MatrixXd& c) { c(3, 4) = c(4, 3) = 1e-9; });
  EXPECT_NE(tied.note.find("fixed parameter"), std::string::npos);
}

TEST(CalibrationFile, refuses_what_is_no_rotation_and_doubled_names) {
  Rig bad = rig();
  bad.devices[1].T_device_rig.q.coeffs() *= 1.01;
  EXPECT_EQ(error_of(to_toml(bad, meta())).rcode, RCode::kBadCalibrationFile);
  bad = rig();
  bad.devices[2].name = bad.devices[1].name;
  EXPECT_EQ(error_of(to_toml(bad, meta())).rcode, RCode::kBadCalibrationFile);
  bad = rig();
  bad.devices[0].T_device_rig.t.x() = 0.1;
  EXPECT_EQ(error_of(to_toml(bad, meta())).rcode, RCode::kBadCalibrationFile);
}

TEST(CalibrationFile, refuses_to_write_what_is_not_finite) {
  Rig bad = rig();
  bad.devices[1].camera.cx = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(write_calibration("/nowhere", bad, meta()).error().rcode, RCode::kNotFinite);
  bad = rig();
  bad.covariance(2, 2) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(write_calibration("/nowhere", bad, meta()).error().rcode, RCode::kNotFinite);
}

TEST(CalibrationFile, never_crashes_on_damaged_text) {
  const std::string text = to_toml(rig(), meta());
  const unsigned seed = 20241122;
  std::mt19937 random(seed);
  for (int trial = 0; trial < 20; ++trial) {
    std::string damaged = text;
    const std::size_t at = random() % damaged.size();
    trial % 2 == 0 ? damaged.resize(at) : static_cast<void>(damaged[at] = static_cast<char>(random() % 256));
    const Result<Calibration> read = from_toml(damaged, "c.toml");
    // A change within a comment or the origin is none of the numbers.
    EXPECT_TRUE(!read || read->id == calibration_id(rig())) << "seed " << seed << ", trial " << trial;
  }
}

TEST(Exact, is_short_and_reads_back) {
  EXPECT_EQ(exact(0.1), "0.1");
  EXPECT_EQ(exact(800), "800.0");
  EXPECT_EQ(exact(-0.0), "-0.0");
  EXPECT_EQ(exact(1e-7), "1e-07");
  EXPECT_EQ(std::stod(exact(0.1 + 0.2)), 0.1 + 0.2);
}

}  // namespace
}  // namespace raysteer::host::exchange
