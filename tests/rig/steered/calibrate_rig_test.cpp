// From nothing to light that lies where it was wanted: cameras, looks, rig, tables, verified. Rendered, both mirrors.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
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
  EXPECT_GT(rig.at("whitened_rms"), 0.85);
  EXPECT_LT(rig.at("whitened_rms"), 1.15);
  EXPECT_TRUE(rig.at("tied_to_room"));

  // Another survey than the earlier rig's: what is compared may be the surveys.
  std::ofstream(in("edited.toml")) << support::read_all(data("survey.toml")) << "# measured again\n";
  const auto notes = [&](const std::string& survey) {
    return raysteer({"calibrate", "rig", in("looks"), "--cameras", in("cameras"), "--board", GetParam(), "--survey",
                     survey, "--previous", in("rig")})
        .err;
  };
  EXPECT_NE(notes(in("edited.toml")).find("the survey changed since"), std::string::npos);
  EXPECT_EQ(notes(data("survey.toml")).find("the survey changed since"), std::string::npos);

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

// No board is ever shown: cameras start as the board file draws them, metres come from one length on the floor.
TEST_P(SteeredRig, comes_out_of_relief_without_any_board) {
  run({"plan", "looks", "--board", GetParam(), "--looks", "14", "--check", "3", "--out", in("plan")});
  capture(data("relief.toml"), in("plan/looks.toml"), "looks");
  const auto rig = run({"calibrate", "rig", in("looks"), "--cameras", "drawn", "--length", "23-115=4.580393", "--board",
                        GetParam(), "--survey", data("survey.toml"), "--out", in("rig")});
  ASSERT_TRUE(rig.is_object());
  EXPECT_TRUE(rig.at("cameras").at("drawn"));
  EXPECT_LT(rig.at("truth").at("focal_error"), 4e-4);
  EXPECT_LT(rig.at("held_out").at("p95_px"), 0.3);
  EXPECT_LT(rig.at("truth").at("p95_px"), 0.2);
  EXPECT_LT(rig.at("truth").at("p95_mm"), 1);
  const auto tables = run({"bake", "--rig", in("rig"), "--stations", data("stations.toml"), "--out", in("tables")});
  EXPECT_TRUE(tables.is_object());
}

/// The plan with a first look in which the scenes' target lies on the floor.
std::string with_board_on_the_floor(const std::string& plan) {
  std::ostringstream text;
  text << std::ifstream(plan).rdbuf();
  std::string whole = text.str();
  whole.insert(whole.find("mirror_mrad"), "prepare = \"target away\"\n");
  whole.insert(whole.find("[[look]]"),
               "[[target]]\nkind = \"chessboard\"\ncolumns = 13\nrows = 8\nsquare_m = 0.055\nlooks = [\"board\"]\n\n"
               "[[look]]\nname = \"board\"\nprepare = \"target on floor\"\nmirror_mrad = [0, 0]\n\n");
  return whole;
}

TEST_P(SteeredRig, takes_looks_that_one_eye_saw_on_a_known_plane) {
  capture("floor", "cameras", "cameras-session");
  run({"calibrate", "cameras", in("cameras-session"), "--out", in("cameras")});
  run({"plan", "looks", "--board", GetParam(), "--looks", "10", "--check", "2", "--out", in("plan")});
  std::ofstream(in("plan.toml")) << with_board_on_the_floor(in("plan/looks.toml"));
  capture("floor", in("plan.toml"), "looks");
  // Something stands before the right eye: whatever is shown, it sees the same.
  for (const char* look : {"look-02", "look-05", "look-08"}) {
    const auto frames = std::filesystem::path(in("looks/right")) / look;
    for (const auto& frame : std::filesystem::directory_iterator(frames)) {
      if (frame.path().filename() != "000.rsf") {
        std::filesystem::copy_file(frames / "000.rsf", frame.path(), std::filesystem::copy_options::overwrite_existing);
      }
    }
  }
  const std::vector<std::string> words{"calibrate",   "rig",     in("looks"), "--cameras",
                                       in("cameras"), "--board", GetParam(),  "--plane"};
  const auto with = [&](const std::string& look) {
    auto all = words;
    all.push_back(look);
    return all;
  };
  const auto rig = run(with("board"));
  ASSERT_TRUE(rig.is_object());
  EXPECT_EQ(rig.at("one_eyed_looks"), 3);
  EXPECT_EQ(rig.at("looks"), 10);
  EXPECT_LT(rig.at("held_out").at("p95_px"), 0.25);
  EXPECT_LT(rig.at("truth").at("p95_px"), 0.15);
  // One eye is enough for the board, and a target that names no looks may lie in this one only.
  for (const auto& frame : std::filesystem::directory_iterator(in("looks/right/board"))) {
    std::filesystem::copy_file(in("looks/right/look-01/000.rsf"), frame.path(),
                               std::filesystem::copy_options::overwrite_existing);
  }
  std::string manifest = support::read_all(in("looks/session.toml"));
  const std::string named = "looks = [\"board\"]\n";
  ASSERT_NE(manifest.find(named), std::string::npos) << manifest;
  std::ofstream(in("looks/session.toml")) << manifest.erase(manifest.find(named), named.size());
  const auto alone = run(with("board"));
  ASSERT_TRUE(alone.is_object());
  EXPECT_EQ(alone.at("one_eyed_looks"), 3);
  EXPECT_LT(alone.at("truth").at("p95_px"), 0.15);
  // Where no board lies there is no plane, and drawn cameras cannot tell where it is.
  const auto neither = raysteer(with("look-01"));
  EXPECT_EQ(neither.exit_code, 1);
  EXPECT_NE(neither.err.find("camera 'left'"), std::string::npos) << neither.err;
  EXPECT_NE(neither.err.find("camera 'right'"), std::string::npos) << neither.err;
  auto drawn = with("board");
  drawn[4] = "drawn";
  EXPECT_EQ(raysteer(drawn).exit_code, 2);
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
