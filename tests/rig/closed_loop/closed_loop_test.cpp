// Where open loop is not sure enough, a look at the station closes the loop; the truth says that it does. Rendered.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "tests/support/technician.hpp"

namespace raysteer {
namespace {

using nlohmann::json;
using support::Technician;

/// The looks of a plan file, last one first: the same places after other aims.
std::string reversed(const std::string& plan) {
  const auto first = plan.find("\n[[look]]");
  std::string text = plan.substr(0, first);
  for (auto at = plan.rfind("\n[[look]]"); at != std::string::npos && at >= first;
       at = at == 0 ? std::string::npos : plan.rfind("\n[[look]]", at - 1)) {
    const auto end = plan.find("\n[[look]]", at + 1);
    text += plan.substr(at, end == std::string::npos ? end : end - at) + "\n";
  }
  return text;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

/// Gain of axis 1, as the truth beside a session says.
double true_gain(const std::string& session) {
  return json::parse(support::read_all(session + "/truth.json")).at("mirror").at("curves").at(0).at("gain");
}

TEST(ClosedLoop, a_mirror_that_drifted_since_its_calibration_is_corrected_at_all_stations) {
  Technician rig("mock-small");
  rig.calibrate();
  const std::string stations = Technician::data("steered/data/stations.toml");
  rig.run({"bake", "--rig", rig.made("rig"), "--stations", stations, "--out", rig.in("tables")});
  EXPECT_FALSE(std::filesystem::exists(rig.in("tables/refine.toml")));

  // The same rig with other electronics, whose gains lie a twentieth farther off, and knocked by a milliradian.
  const support::ScratchFolder folder;
  std::ofstream(folder / "hot.toml") << replaced(support::read_all(support::source_root() / "boards/mock-small.toml"),
                                                 "gain = 0.02\n", "gain = 0.021\n");
  const Technician hot((folder / "hot.toml").string());
  const std::vector<std::string> knocked{"--fault", "mirror.bump=1e-3"};
  hot.capture(Technician::room(), rig.in("tables/looks.toml"), rig.in("seen"), knocked);
  const json open = rig.run({"verify", rig.in("seen"), "--rig", rig.made("rig"), "--stations", stations}, 5);
  EXPECT_GT(open.at("max_mm"), 5);

  const json refined = rig.run({"bake", "--rig", rig.made("rig"), "--stations", stations, "--refine", rig.in("seen"),
                                "--out", rig.in("refined")});
  for (const int axis : {0, 1}) {
    EXPECT_NEAR(refined.at("drift").at("offset_urad").at(axis), 1000, 150);
  }
  const double gain = true_gain(rig.made("looks"));
  const double drifted = (true_gain(rig.in("seen")) - gain) / (1 + gain);
  EXPECT_GT(std::abs(drifted), 1e-3);
  EXPECT_NEAR(refined.at("drift").at("gain").at(0), drifted, 7e-4);
  for (const json& station : refined.at("stations")) {
    EXPECT_FALSE(station.at("refined")) << "a drift that is corrected leaves nothing to refine";
  }

  // Another day: as far off as before, and the mirror errs anew at each aim.
  rig.write("again.toml", reversed(support::read_all(rig.in("tables/looks.toml"))));
  hot.capture(Technician::room(), rig.in("again.toml"), rig.in("again"), knocked);
  const json closed = rig.run(
      {"verify", rig.in("again"), "--rig", rig.made("rig"), "--stations", stations, "--refine", rig.in("seen")});
  EXPECT_LT(closed.at("max_mm"), 2);
  EXPECT_LT(closed.at("truth").at("max_mm"), 2);
}

TEST(ClosedLoop, a_poor_mirror_needs_it_at_each_visit) {
  std::string board = support::read_all(support::source_root() / "boards/mock-small-head.toml");
  const std::string preset = "preset = \"head\"";
  board.replace(board.find(preset), preset.size(), "preset = \"cheap-head\"");
  const support::ScratchFolder folder;
  std::ofstream(folder / "cheap.toml") << board;
  Technician rig((folder / "cheap.toml").string());
  const json calibrated = rig.calibrate("16");
  EXPECT_GT(calibrated.at("repeatability_urad"), 100);

  const std::string strict = Technician::data("closed_loop/data/strict.toml");
  const json open = rig.run({"bake", "--rig", rig.made("rig"), "--stations", strict, "--out", rig.in("tables")}, 5);
  for (const json& station : open.at("stations")) {
    EXPECT_GT(station.at("bound_95_mm"), 2);
    EXPECT_LT(station.at("closed_loop_95_mm"), 2);
  }
  rig.capture(Technician::room(), rig.in("tables/refine.toml"), rig.in("visit"));
  const json measured = rig.run({"verify", rig.in("visit"), "--rig", rig.made("rig"), "--stations", strict}, 5);
  EXPECT_GT(measured.at("max_mm"), 2);

  // Tables hold where the mirror still stands, and the truth of each visit confirms what was stated for it.
  const json refined =
      rig.run({"bake", "--rig", rig.made("rig"), "--stations", strict, "--refine", rig.in("visit")}, 5);
  const json& stations = refined.at("stations");
  for (std::size_t k = 0; k < stations.size(); ++k) {
    EXPECT_TRUE(stations[k].at("refined"));
    EXPECT_LT(stations[k].at("bound_95_mm"), 2);
    EXPECT_GT(stations[k].at("again_95_mm"), 2);
    EXPECT_EQ(stations[k].at("within"), k + 1 == stations.size());
    EXPECT_NEAR(stations[k].at("bound_95_mm"), open.at("stations")[k].at("closed_loop_95_mm"), 0.5) << "as forecast";
  }
  const json closed =
      rig.run({"verify", rig.in("visit"), "--rig", rig.made("rig"), "--stations", strict, "--refine", rig.in("visit")});
  EXPECT_LT(closed.at("max_mm"), 1);
  EXPECT_LT(closed.at("truth").at("max_mm"), 1);

  rig.write(
      "one.toml", "format = 1\nname = \"one\"\n" + [&] {
        const std::string plan = support::read_all(rig.in("tables/refine.toml"));
        const auto first = plan.find("\n[[look]]");
        return plan.substr(first, plan.find("\n[[look]]", first + 1) - first);
      }() + "\n");
  rig.capture(Technician::room(), rig.in("one.toml"), rig.in("stands"));
  const json one = rig.run({"bake", "--rig", rig.made("rig"), "--stations",
                            Technician::data("closed_loop/data/one.toml"), "--refine", rig.in("stands")});
  EXPECT_EQ(one.at("verdict"), "good");
}

}  // namespace
}  // namespace raysteer
