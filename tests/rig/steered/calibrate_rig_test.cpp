// From nothing to light that lies where it was wanted: cameras, looks, rig, tables, verified. Rendered, both mirrors.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/contract/cli/program.hpp"

namespace raysteer::host::cli {
namespace {

std::string data(const std::string& name) {
  return (support::source_root() / "tests/rig/steered/data" / name).string();
}

/// One rig, command by command, as a technician would.
class SteeredRig : public testing::TestWithParam<const char*> {
 protected:
  std::string in(const std::string& name) const { return (folder_.path() / name).string(); }

  nlohmann::json run(std::vector<std::string> words) {
    words.insert(words.end(), {"--json", "--quiet"});
    const auto finished = raysteer(words);
    EXPECT_EQ(finished.exit_code, 0) << words[0] << " " << words[1] << ": " << finished.out << finished.err;
    return parse_one(finished.out);
  }

  void capture(const std::string& scene, const std::string& looks, const std::string& out) {
    run({"capture", "--sim", "--board", GetParam(), "--seed", "20261122", "--scene", scene, "--patterns", "fast",
         "--looks", looks, "--out", in(out)});
  }

  support::ScratchFolder folder_;
};

INSTANTIATE_TEST_SUITE_P(Mirrors, SteeredRig, testing::Values("mock-small", "mock-small-head"), [](const auto& mirror) {
  return std::string(mirror.param) == "mock-small" ? "galvo" : "head";
});

// Pixels of the small boards are four times as wide as the reference rig's, and so are the limits.
TEST_P(SteeredRig, predicts_unseen_looks_and_puts_stations_where_they_belong) {
  capture("floor", "cameras", "cameras-session");
  run({"calibrate", "cameras", in("cameras-session"), "--out", in("cameras")});
  run({"plan", "looks", "--board", GetParam(), "--looks", "10", "--check", "3", "--out", in("plan")});
  capture(data("scene.toml"), in("plan/looks.toml"), "looks");

  const auto rig = run({"calibrate", "rig", in("looks"), "--cameras", in("cameras"), "--board", GetParam(), "--survey",
                        data("survey.toml"), "--out", in("rig")});
  ASSERT_TRUE(rig.is_object());
  EXPECT_LT(rig.at("held_out").at("median_px"), 0.25);
  EXPECT_LT(rig.at("held_out").at("p95_px"), 0.55);
  EXPECT_LT(rig.at("held_out").at("p95_mm"), 4 * 0.8);
  EXPECT_LT(rig.at("truth").at("p95_px"), 0.55);
  EXPECT_LT(rig.at("truth").at("p95_mm"), 4 * 0.8);
  EXPECT_GT(rig.at("whitened_rms"), 0.3);
  EXPECT_LT(rig.at("whitened_rms"), 1.15);
  EXPECT_TRUE(rig.at("tied_to_room"));

  const auto tables = run({"bake", "--rig", in("rig"), "--stations", data("stations.toml"), "--out", in("tables")});
  ASSERT_TRUE(tables.is_object());
  EXPECT_EQ(tables.at("stations").size(), 3U);

  capture(data("scene.toml"), in("tables/looks.toml"), "seen");
  const auto verified = run({"verify", in("seen"), "--rig", in("rig"), "--stations", data("stations.toml")});
  ASSERT_TRUE(verified.is_object());
  EXPECT_LT(verified.at("mean_mm"), 4 * 0.7);
  EXPECT_LT(verified.at("max_mm"), 4 * 2.5);
  EXPECT_LT(verified.at("truth").at("mean_mm"), 4 * 0.7);
  EXPECT_LT(verified.at("truth").at("max_mm"), 4 * 2.5);

  // The same looks are a scan: all that they lit as one surface.
  const auto scan = run({"scan", in("looks"), "--rig", in("rig"), "--out", in("scan")});
  ASSERT_TRUE(scan.is_object());
  const auto& surface = scan.at("surface");
  EXPECT_EQ(surface.at("looks").size(), 13U);
  EXPECT_GT(surface.at("overlaps").size(), 10U);
  EXPECT_LT(surface.at("overlap_median_mm"), 4 * 1.5);
  EXPECT_LT(surface.at("overlap_p95_mm"), 4 * 5);
  EXPECT_LT(scan.at("truth").at("surface_p95_m"), 4 * 3e-3);
}

TEST(SteeredRigInput, is_refused_with_its_own_message) {
  EXPECT_EQ(raysteer({"calibrate", "rig", "nowhere", "--cameras", "nowhere", "--board", "mock-small"}).exit_code, 3);
  EXPECT_EQ(raysteer({"calibrate", "rig", "nowhere"}).exit_code, 2);
  EXPECT_EQ(raysteer({"plan", "looks", "--board", "mock-small", "--looks", "4"}).exit_code, 1);
  EXPECT_EQ(raysteer({"bake", "--rig", "nowhere", "--stations", data("stations.toml")}).exit_code, 3);
  EXPECT_EQ(raysteer({"scan", "nowhere", "--rig", "nowhere"}).exit_code, 3);
  EXPECT_EQ(raysteer({"scan", "nowhere", "--rig", "nowhere", "--rectified"}).exit_code, 2);
  EXPECT_EQ(raysteer({"scan", "nowhere", "--calibration", "nowhere", "--without", "look"}).exit_code, 2);
}

}  // namespace
}  // namespace raysteer::host::cli
