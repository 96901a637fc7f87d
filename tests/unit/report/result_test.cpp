#include "host/report/result.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "host/exchange/write_file.hpp"

namespace raysteer::host::report {
namespace {

namespace fs = std::filesystem;

class ResultFile : public ::testing::Test {
 protected:
  ResultFile() : folder_(fs::temp_directory_path() / ("raysteer-result-" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~ResultFile() override { fs::remove_all(folder_); }
  void replace(const std::string& from, const std::string& to) {
    std::string text = *exchange::read_file(folder_ / "result.json");
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos);
    ASSERT_TRUE(exchange::write_file(folder_ / "result.json", text.replace(at, from.size(), to)));
  }
  fs::path folder_;
};

CalibrationResult calibration() {
  CalibrationResult result;
  result.judgement = {"usable", "Usable: corners are hit within 0.16 px.", {"few views <3>"}, {"Add views."}};
  result.session = "a \"session\".toml";
  result.rms_px = 0.1655;
  result.baseline_m = 0.25;
  result.held_out_p95_px = 0.33;
  result.folds = 5;
  DeviceResult left;
  left.name = "left";
  left.kind = "camera";
  left.width = 640;
  left.height = 480;
  left.rms_px = 0.16;
  left.focal_px = 800;
  left.parameters = {{"left.fx", 800.5, 0.25, "px"}};
  left.residuals = {{0, 12.5, 30.25, 0.1234, -0.5, true}, {1, 600, 400, 3, 4, false}};
  left.coverage = {2, 1, {5, 0}};
  left.uncertainty_px = {2, 1, {0.1, kUnknown}};
  left.uncertainty_range_m = HUGE_VAL;
  result.devices = {left, left};
  result.devices[1].name = "right";
  result.views = {{"0", true, "", "", {0.1, kUnknown}, 0.3, 1.5}, {"1", false, "R0306", "foreign", {}, 0, kUnknown}};
  return result;
}

TEST_F(ResultFile, reads_back_what_was_written) {
  ASSERT_TRUE(write_result(folder_, calibration()));
  const Result<AnyResult> read = read_result(folder_);
  ASSERT_TRUE(read) << read.error().message();
  const auto& result = std::get<CalibrationResult>(*read);
  EXPECT_EQ(result.judgement.summary, calibration().judgement.summary);
  EXPECT_EQ(result.rms_px, 0.1655);
  ASSERT_EQ(result.devices.size(), 2U);
  EXPECT_EQ(result.devices[0].residuals[0].dx, 0.1234);
  EXPECT_FALSE(result.devices[0].residuals[1].kept);
  EXPECT_TRUE(std::isnan(result.devices[0].uncertainty_px.values[1]));
  EXPECT_TRUE(std::isinf(result.devices[0].uncertainty_range_m));
  EXPECT_TRUE(std::isnan(result.views[0].rms_px[1]));
  EXPECT_EQ(result.views[1].code, "R0306");
  // Nothing is lost: what was read writes the same file.
  EXPECT_EQ(result_json(*read), result_json(calibration()));
}

TEST_F(ResultFile, reads_back_a_scan) {
  ScanResult scan;
  scan.points = 490788;
  scan.epipolar_histogram = {-2, 2, {1, 5, 9, 5}};
  scan.facts = {{"left: decoded", "31 %"}};
  ASSERT_TRUE(write_result(folder_, scan));
  const Result<AnyResult> read = read_result(folder_);
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(result_json(*read), result_json(scan));
}

TEST_F(ResultFile, refuses_what_is_damaged) {
  EXPECT_EQ(read_result(folder_).error().rcode, RCode::kNothingToReport);
  ASSERT_TRUE(write_result(folder_, calibration()));
  replace("\"columns\": 2", "\"columns\": 3");
  EXPECT_EQ(read_result(folder_).error().rcode, RCode::kBadValue);
  EXPECT_NE(read_result(folder_).error().note.find("2 values for 3 x 1 cells"), std::string::npos);
  ASSERT_TRUE(write_result(folder_, calibration()));
  replace("\"format_version\": 1", "\"format_version\": 2");
  EXPECT_EQ(read_result(folder_).error().rcode, RCode::kFormatVersion);
  ASSERT_TRUE(exchange::write_file(folder_ / "result.json", "{\"format_version\": 1, "));
  EXPECT_EQ(read_result(folder_).error().rcode, RCode::kBadValue);
  ASSERT_TRUE(exchange::write_file(folder_ / "result.json", "[]"));
  EXPECT_EQ(read_result(folder_).error().rcode, RCode::kBadValue);
}

TEST(Summary, has_the_keys_that_scripts_rely_on) {
  const auto json = summary_json(calibration());
  EXPECT_EQ(json.at("cameras").at(0).at("name"), "left");
  EXPECT_EQ(json.at("cameras").at(0).at("rms_px"), 0.16);
  EXPECT_EQ(json.at("stereo").at("rms_px"), 0.1655);
  EXPECT_EQ(json.at("stereo").at("baseline_m"), 0.25);
  EXPECT_EQ(json.at("cross_validation").at("p95_px"), 0.33);
  EXPECT_EQ(json.at("verdict"), "usable");
  EXPECT_FALSE(json.contains("leave_one_out_px")) << "not known, so left out";

  CalibrationResult projector = calibration();
  projector.devices[1].kind = "projector";
  projector.devices[1].focal_px = 2100;
  projector.leave_one_out_px = 0.3;
  const auto with_projector = summary_json(projector);
  EXPECT_EQ(with_projector.at("projector").at("focal_px"), 2100);
  EXPECT_EQ(with_projector.at("leave_one_out_px"), 0.3);
  EXPECT_FALSE(with_projector.contains("stereo"));

  ScanResult scan;
  scan.points = 7;
  scan.epipolar_sigma_px = 0.5;
  scan.patch_rms_m = 1e-4;
  scan.decoded_fraction = 0.3;
  scan.pose_moved_rad = 1e-3;
  const auto scanned = summary_json(scan);
  EXPECT_EQ(scanned.at("points"), 7);
  EXPECT_EQ(scanned.at("matched_projector_pixels"), 0);
  EXPECT_EQ(scanned.at("epipolar").at("sigma_px"), 0.5);
  EXPECT_EQ(scanned.at("flatness").at("patch_rms_m"), 1e-4);
  EXPECT_EQ(scanned.at("decoded_fraction"), 0.3);
  EXPECT_EQ(scanned.at("pose_moved_rad"), 1e-3);
}

}  // namespace
}  // namespace raysteer::host::report
