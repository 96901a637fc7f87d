// A steered rig's page: what a person must find there, and that nothing from a file becomes markup.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "host/report/floor_map.hpp"
#include "host/report/page.hpp"
#include "host/report/result.hpp"
#include "tests/support/process.hpp"

namespace raysteer::host::report {
namespace {

RigResult rig() {
  RigResult rig;
  rig.judgement = {
      .verdict = "usable", .summary = "Looks are hit within 1.2 mm.", .reasons = {"one"}, .advice = {"two"}};
  rig.session = "looks <b>";
  rig.board = "mock-galvo";
  rig.calibration_id = "0123456789abcdef";
  rig.floor = "the room's floor (z = 0)";
  rig.floor_pose = {1, 0, 0, 0, 0, 0, 0};
  rig.tied_to_room = true;
  rig.reach_median_95_mm = 0.71;
  rig.reach_worst_95_mm = 1.53;
  for (int i = 0; i < 4; ++i) {
    rig.reach.push_back({.outline_m = {1.0 * i, 0, i + 1.0, 0, i + 1.0, 1, 1.0 * i, 1}, .mm = 0.5 + 0.3 * i});
  }
  rig.looks.push_back({.name = "look-01",
                       .held_out = false,
                       .x_m = 0.5,
                       .y_m = 0.5,
                       .command_mrad = {10, -20},
                       .latent_urad = {3, -4},
                       .whitened_rms = 1.01});
  rig.looks.push_back({.name = "check-01",
                       .held_out = true,
                       .x_m = 2.5,
                       .y_m = 0.5,
                       .command_mrad = {30, 5},
                       .latent_urad = {},
                       .median_px = 0.2,
                       .p95_px = 0.4});
  rig.held_out = {{.x_m = 2.5, .y_m = 0.5, .dx_mm = 0.4, .dy_mm = -0.2}};
  rig.held_out_median_mm = 0.3;
  rig.held_out_p95_mm = 1.2;
  rig.whitened_rms = 1.02;
  rig.panel_width = 1920;
  rig.panel_height = 1200;
  for (int i = 0; i < 50; ++i) {
    rig.residuals.push_back({.view = 0, .x = 30.0 * i, .y = 20.0 * i, .dx = 0.1, .dy = -0.1});
  }
  rig.datums.push_back(
      {.name = "north <i>", .x_m = 1, .y_m = 0.2, .miss_mm = {0.3, -0.1, 0.2}, .size_mm = 0.37, .sigma_mm = 0.2});
  rig.scale = 1.0002;
  rig.scale_sigma = 0.0003;
  rig.off_drawing = {{"projector.fx", 4.2}, {"axis1.gain", -6.1}};
  rig.stations.push_back({.name = "press",
                          .outline_m = {1, 0.2, 1.5, 0.2, 1.5, 0.6, 1, 0.6},
                          .bound_95_mm = 2.4,
                          .error_mm = 1.3,
                          .sure_mm = 1.1,
                          .tolerance_mm = 2,
                          .within = false,
                          .off = {{.x_m = 1, .y_m = 0.2, .dx_mm = 1, .dy_mm = 0.8}},
                          .moved_mm = 0.6});
  rig.difference.push_back({.earlier = "fedcba9876543210",
                            .frame = "the room",
                            .sentence = "Light falls 2 mm off.",
                            .mean_mm = 2,
                            .p95_mm = 3,
                            .max_mm = 4,
                            .whole_rms_mm = 2,
                            .inside_rms_mm = 0.2,
                            .beyond_chance = 0.9,
                            .turned_mrad = 0.5,
                            .shifted_mm = 1,
                            .cells = rig.reach,
                            .arrows = rig.held_out});
  return rig;
}

std::string content(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(RigPage, says_the_verdict_first_and_shows_every_part) {
  const std::string page = report::page(rig(), ".");
  const std::size_t verdict = page.find("Looks are hit within 1.2\u00a0mm.");
  ASSERT_NE(verdict, std::string::npos);
  std::size_t at = verdict;
  for (const char* part :
       {"Against the earlier calibration", "Light falls 2 mm off.", "Reach on the room", "press",
        "Predicted against measured", "What datums are missed by", "1000.20", "Residuals", "axis1.gain", "look-01"}) {
    const std::size_t found = page.find(part, at);
    EXPECT_NE(found, std::string::npos) << part;
    at = found == std::string::npos ? at : found;
  }
  EXPECT_NE(page.find("metres"), std::string::npos);
  EXPECT_NE(page.find("times as long"), std::string::npos);  // the arrows' exaggeration
  EXPECT_NE(page.find("not sure"), std::string::npos);       // 1.3 mm measured, 2.0 allowed, sure to 1.1 only
}

TEST(RigPage, needs_no_network_and_takes_no_markup_from_names) {
  const std::string page = report::page(rig(), ".");
  EXPECT_EQ(page.find("<i>"), std::string::npos);
  EXPECT_EQ(page.find("looks <b>"), std::string::npos);
  for (const char* never : {"http://", "https://", "<script", "src=\"/"}) {
    EXPECT_EQ(page.find(never), std::string::npos) << never;
  }
  EXPECT_LT(page.size(), 1'500'000U);
}

TEST(RigPage, is_the_same_from_the_file_and_keeps_the_commands_keys) {
  const support::ScratchFolder folder;
  RigResult result = rig();
  for (const char* kind : {"rig", "tables", "verification"}) {
    result.kind = kind;
    const nlohmann::ordered_json more = {{"verdict", "usable"}, {"looks", 16}, {"mean_mm", 1.5}};
    ASSERT_TRUE(write_result(folder.path(), result, more));
    const auto read = read_result(folder.path());
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_EQ(page(*read, folder.path()), page(result, folder.path()));
    const auto json = nlohmann::json::parse(content(folder.path() / "result.json"));
    EXPECT_EQ(json.at("looks"), 16);
    EXPECT_EQ(json.at("mean_mm"), 1.5);
    EXPECT_EQ(json.at("kind"), kind);
    EXPECT_EQ(json.at("difference").at("mean_mm"), 2);
  }
}

TEST(RigPage, of_nothing_is_still_a_page) {
  const RigResult empty;
  const std::string page = report::page(empty, ".");
  EXPECT_NE(page.find("</html>"), std::string::npos);
  EXPECT_EQ(page.find("nan"), std::string::npos);
  EXPECT_EQ(floor_map({}, {"nothing", ""}), "");
}

TEST(RigPage, of_a_damaged_result_does_not_crash) {
  const support::ScratchFolder folder;
  RigResult odd = rig();
  odd.reach[0].outline_m = {1};  // half a place
  odd.reach[1].outline_m.clear();
  odd.looks[0].command_mrad = {1, 2, 3};
  odd.datums[0].miss_mm.clear();
  odd.held_out[0].dx_mm = kUnknown;
  EXPECT_NE(page(odd, ".").find("</html>"), std::string::npos);
  std::ofstream(folder.path() / "result.json") << R"({"format_version": 1, "kind": "rig", "detail": {"kind": 3}})";
  EXPECT_FALSE(read_result(folder.path()));
  std::ofstream(folder.path() / "result.json") << R"({"format_version": 1, "kind": "rug", "detail": {}})";
  const auto unknown = read_result(folder.path());
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().rcode, RCode::kNothingToReport);
}

}  // namespace
}  // namespace raysteer::host::report
