// rig.toml: the same bits come back, and nothing that is no steered rig is taken for one.
#include "host/exchange/rig_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "calib/model/steered_parameters.hpp"

namespace raysteer::host::exchange {
namespace {

using calib::model::MirrorKind;
using calib::steer::Solution;

/// Numbers with all their bits set; a covariance of full rank.
Solution solution(MirrorKind kind = MirrorKind::kGalvoPair) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> some(-1, 1);
  Solution solution;
  int cameras = 0;
  for (const char* name : {"left", "right"}) {
    calib::model::Device device;
    device.name = name;
    device.camera = {.width = 1280,
                     .height = 800,
                     .fx = 1000 + some(random),
                     .fy = 1000 + some(random),
                     .cx = 640,
                     .cy = 400,
                     .k = {some(random) * 1e-2, some(random) * 1e-2, 1e-4, -1e-4}};
    if (!solution.cameras.devices.empty()) {
      device.T_device_rig.t = {-0.3 + 0.01 * some(random), 0, 0};
    }
    solution.cameras.devices.push_back(device);
    cameras += solution.cameras.count(solution.cameras.devices.size() - 1);
  }
  calib::model::SteeredProjector& projector = solution.projector;
  projector.kind = kind;
  projector.lens = {.width = 1920, .height = 1200, .fx = 2400 + some(random), .fy = 2401, .cx = 960, .cy = 1300};
  projector.T_projector_rig.t = {0.1, some(random), 0.2};
  projector.parts[1].axis = Eigen::Vector3d(some(random), some(random), 1).normalized();
  projector.parts[0].size_m = {0.05, 0.08};
  for (auto& curve : projector.curves) {
    curve = {.half_range = 0.2, .gain = some(random) * 1e-2, .quadratic = 1e-3, .cubic = -1e-3, .cross_talk = 1e-4};
  }
  projector.least_rad = {-0.2, -0.15};
  projector.most_rad = {0.2, 0.15};
  solution.repeatability_rad = 21e-6;
  const int all = cameras + solution.projector_parameters();
  const int projectors = solution.projector_parameters();
  Eigen::MatrixXd root(all, all);
  for (int i = 0; i < all; ++i) {
    solution.parameters.push_back(i < cameras ? "camera." + std::to_string(i) : "");
    for (int j = 0; j < all; ++j) {
      root(i, j) = some(random) * (i % 2 == 0 ? 1e-2 : 1e-5);
    }
  }
  const auto names = calib::model::steered_parameter_names(kind);
  for (int i = 0; i < projectors; ++i) {
    solution.parameters[static_cast<std::size_t>(cameras + i)] = "projector." + names[static_cast<std::size_t>(i)];
  }
  solution.covariance = root * root.transpose();
  solution.covariance = (solution.covariance + solution.covariance.transpose()).eval() / 2;
  solution.cameras.covariance = solution.covariance.topLeftCorner(cameras, cameras);
  return solution;
}

RoomTie room(const Solution& solution) {
  const Eigen::Index n = solution.covariance.rows();
  RoomTie tie{.T_rig_room = {Eigen::Quaterniond(1, 0.1, 0.2, 0.3).normalized(), {0.1, -0.2, 2.5}},
              .covariance = 1e-6 * Eigen::MatrixXd::Identity(n + 6, n + 6),
              .datums = 6,
              .scale = 1.0003};
  tie.covariance.topLeftCorner(n, n) = solution.covariance;
  return tie;
}

const RigMeta kMeta{.session = "looks",
                    .board = "mock-galvo",
                    .verdict = "good",
                    .whitened_rms = 1.01,
                    .looks = 16,
                    .survey = "hall",
                    .survey_id = survey_id("a survey")};

std::string text() { return to_toml(solution(), room(solution()), kMeta); }

/// Without the id, so that a change is judged by itself.
std::string plain() {
  std::string all = text();
  const std::size_t at = all.find("id = \"");
  return all.erase(at, all.find('\n', at) + 1 - at);
}

std::string changed(std::string all, const std::string& from, const std::string& to) {
  const std::size_t at = all.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? all : all.replace(at, from.size(), to);
}

/// The value of the first `key` after `table` replaced.
std::string with(const std::string& table, const std::string& key, const std::string& value) {
  std::string all = plain();
  const std::size_t from = table.empty() ? 0 : all.find(table);
  EXPECT_NE(from, std::string::npos) << table;
  const std::size_t at = all.find("\n" + key + " = ", from);
  EXPECT_NE(at, std::string::npos) << key;
  const std::size_t begin = at + key.size() + 4;
  return all.replace(begin, all.find('\n', begin) - begin, value);
}

Error refusal(const std::string& all) {
  auto rig = rig_from_toml(all, "rig.toml");
  EXPECT_FALSE(rig) << "was accepted";
  return rig ? Error{} : std::move(rig).error();
}

TEST(RigFile, reads_back_the_same_bits) {
  for (const MirrorKind kind : {MirrorKind::kGalvoPair, MirrorKind::kHead}) {
    const Solution before = solution(kind);
    const std::string first = to_toml(before, room(before), kMeta);
    const auto read = rig_from_toml(first, "rig.toml");
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_EQ(to_toml(read->solution, read->room, read->meta), first);
    EXPECT_EQ(read->solution.covariance, before.covariance);
    ASSERT_TRUE(read->in_room());
    EXPECT_EQ(read->in_room()->covariance.rows(), before.covariance.rows() + 6);
    const auto untied = rig_from_toml(to_toml(before, {}, kMeta), "rig.toml");
    ASSERT_TRUE(untied) << untied.error().message();
    EXPECT_FALSE(untied->in_room());
  }
}

TEST(RigFile, a_file_without_an_id_is_taken_and_an_edited_one_is_not) {
  EXPECT_TRUE(rig_from_toml(plain(), "rig.toml"));
  EXPECT_EQ(refusal(changed(text(), "gain = ", "gain = 1")).rcode, RCode::kBadCalibrationFile);
  EXPECT_EQ(refusal(changed(text(), "datums = 6", "datums = 7")).rcode, RCode::kBadCalibrationFile);
}

struct Bad {
  const char* table;
  const char* key;
  const char* value;
  RCode rcode;
};

TEST(RigFile, every_number_that_makes_no_sense_is_refused_by_name) {
  using enum RCode;
  const std::vector<Bad> all{
      {"", "format", "\"raysteer-calibration\"", kBadCalibrationFile},
      {"", "format_version", "2", kFormatVersion},
      {"", "format_version", "\"1\"", kFormatVersion},
      {"", "repeatability_rad", "nan", kNotFinite},
      {"", "repeatability_rad", "-1e-6", kBadValue},
      {"", "repeatability_rad", "\"21e-6\"", kBadValue},
      {"[[device]]", "focal_px", "[1000.0, inf]", kNotFinite},
      {"[[device]]", "focal_px", "[-1000.0, 1000.0]", kBadValue},
      {"[[device]]", "focal_px", "[1000.0]", kBadCalibrationFile},
      {"[[device]]", "kind", "\"projector\"", kBadCalibrationFile},
      {"[[device]]", "rotation_wxyz", "[0.5, 0.0, 0.0, 0.0]", kBadCalibrationFile},
      {"[mirror]", "kind", "\"galvo\"", kBadValue},
      {"[mirror]", "kind", "\"head\"", kMissingKey},
      {"[mirror]", "least_rad", "[nan, 0.0]", kNotFinite},
      {"[mirror]", "least_rad", "[0.3, -0.15]", kBadCalibrationFile},
      {"[mirror]", "most_rad", "0.2", kBadValue},
      {"[[mirror.plane]]", "axis", "[0.0, 0.0, 0.0]", kBadCalibrationFile},
      {"[[mirror.plane]]", "axis", "[0.0, 2.0, 0.0]", kBadCalibrationFile},
      {"[[mirror.plane]]", "normal", "[0.0, 1.0]", kBadCalibrationFile},
      {"[[mirror.plane]]", "offset_m", "-inf", kNotFinite},
      {"[[mirror.plane]]", "size_m", "[-0.05, 0.08]", kBadCalibrationFile},
      {"[[mirror.plane]]", "outline", "\"round\"", kBadValue},
      {"[[mirror.curve]]", "half_range_rad", "0.0", kBadValue},
      {"[[mirror.curve]]", "gain", "nan", kNotFinite},
      {"[room]", "rotation_wxyz", "[1.0, 1.0, 0.0, 0.0]", kBadCalibrationFile},
      {"[room]", "translation_m", "[0.0, 0.0]", kBadCalibrationFile},
      {"[room]", "datums", "-1", kBadValue},
      {"[room]", "scale", "0.0", kBadValue},
      {"[covariance]", "parameters", "[\"left.fx\"]", kBadCalibrationFile},
  };
  for (const Bad& bad : all) {
    const Error error = refusal(with(bad.table, bad.key, bad.value));
    EXPECT_EQ(error.rcode, bad.rcode) << bad.table << " " << bad.key << " = " << bad.value << ": " << error.message();
    EXPECT_NE(error.note.find("rig.toml"), std::string::npos) << error.note;
  }
}

TEST(RigFile, keys_that_are_missing_or_unknown_are_named) {
  // A misspelt key is one that is missing and one that is unknown: whichever is said, it is said by its name.
  for (const std::string key : {"repeatability_rad", "kind", "cubic", "outline", "scale"}) {
    const Error error = refusal(changed(plain(), "\n" + key + " = ", "\n" + key + "x = "));
    EXPECT_TRUE(error.rcode == RCode::kMissingKey || error.rcode == RCode::kUnknownKey) << error.message();
    EXPECT_NE(error.note.find("'" + key), std::string::npos) << error.note;
  }
  EXPECT_EQ(refusal(changed(plain(), "[mirror]", "[mirrors]")).rcode, RCode::kMissingKey);
  EXPECT_EQ(refusal(changed(plain(), "\nrepeatability_rad", "\nspare = 1\nrepeatability_rad")).rcode,
            RCode::kUnknownKey);
  std::string without = plain();
  without.resize(without.find("\n[covariance]"));
  EXPECT_EQ(refusal(without).rcode, RCode::kMissingKey);
}

TEST(RigFile, a_covariance_that_is_none_is_refused) {
  const Solution good = solution();
  const auto refused = [&](const Eigen::MatrixXd& covariance) {
    Solution bad = good;
    bad.covariance = covariance;
    return refusal(to_toml(bad, {}, kMeta));
  };
  Eigen::MatrixXd covariance = good.covariance;
  covariance(4, 4) = -covariance(4, 4);
  EXPECT_EQ(refused(covariance).rcode, RCode::kBadCalibrationFile);
  covariance = good.covariance;
  covariance(2, 7) += 1e-3 * std::sqrt(covariance(2, 2) * covariance(7, 7));
  EXPECT_EQ(refused(covariance).rcode, RCode::kBadCalibrationFile);  // not symmetric
  covariance = good.covariance;
  covariance(2, 7) = covariance(7, 2) = 1.5 * std::sqrt(covariance(2, 2) * covariance(7, 7));
  EXPECT_EQ(refused(covariance).rcode, RCode::kBadCalibrationFile);  // a correlation above 1
  covariance = good.covariance;
  covariance(3, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refused(covariance).rcode, RCode::kNotFinite);
}

// Cut anywhere but in the last line's end, the file is no rig.
TEST(RigFile, a_truncated_file_is_refused) {
  const std::string all = text();
  const std::size_t last = all.find_last_not_of("\n]");
  std::mt19937 random(3);
  for (int k = 0; k < 40; ++k) {
    const std::size_t at = std::uniform_int_distribution<std::size_t>(0, last)(random);
    EXPECT_FALSE(rig_from_toml(all.substr(0, at), "rig.toml")) << "cut after " << at << " of " << all.size();
  }
}

}  // namespace
}  // namespace raysteer::host::exchange
