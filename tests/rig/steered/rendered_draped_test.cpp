// Pictures on a scanned box: looks aimed at them, scanned, baked, shown, and measured where their light truly fell.
// Rendered.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/technician.hpp"

namespace raysteer {
namespace {

using support::Technician;

/// The stations' lines that do not begin with one of the words.
std::string without(const std::string& stations, const std::vector<std::string>& words) {
  std::istringstream lines(stations);
  std::string kept;
  for (std::string line; std::getline(lines, line);) {
    if (std::ranges::none_of(words, [&](const std::string& word) { return line.starts_with(word); })) {
      kept += line + "\n";
    }
  }
  return kept;
}

// Pixels of the small board are four times as wide as the reference rig's; stations ask for twice its 2.5 mm.
TEST(RenderedDraped, pictures_lie_on_a_box_that_was_scanned) {
  Technician rig("mock-small");
  rig.calibrate();
  const std::string stations = Technician::data("steered/data/draped.toml");
  // Looks that were planned for the calibration leave gaps; those of the stations' planes light all of each picture.
  rig.write("aims.toml", without(support::read_all(stations), {"surface", "eye_m"}));
  rig.run({"bake", "--rig", rig.made("rig"), "--stations", rig.in("aims.toml"), "--out", rig.in("aims")});
  rig.capture(Technician::room(), rig.in("aims/looks.toml"), rig.in("lit"));
  const auto scan = rig.run({"scan", rig.in("lit"), "--rig", rig.made("rig"), "--out", rig.in("scan")});
  EXPECT_LT(scan.at("truth").at("surface_p95_m"), 3e-3);

  const auto tables = rig.run({"bake", "--rig", rig.made("rig"), "--surface", rig.in("scan"), "--stations", stations,
                               "--out", rig.in("tables")});
  ASSERT_EQ(tables.at("stations").size(), 3U);
  for (const auto& station : tables.at("stations")) {
    EXPECT_LT(station.at("surface_missing"), station.at("name") == "edge" ? 0.15 : 0.01) << station;
    EXPECT_LT(station.at("bound_95_mm"), 2.5) << station;
  }
  rig.capture(Technician::room(), rig.in("tables/looks.toml"), rig.in("seen"));
  const auto verified = rig.run(
      {"verify", rig.in("seen"), "--rig", rig.made("rig"), "--surface", rig.in("scan"), "--stations", stations});
  EXPECT_LT(verified.at("mean_mm"), 0.7);
  EXPECT_LT(verified.at("max_mm"), 2.5);
  EXPECT_LT(verified.at("truth").at("mean_mm"), 0.7);
  EXPECT_LT(verified.at("truth").at("max_mm"), 2.5);
  for (const auto& station : verified.at("stations")) {
    EXPECT_GT(station.at("points"), 50) << station;
    EXPECT_LT(station.at("picture_95_mm"), 2.5) << station;
  }
}

}  // namespace
}  // namespace raysteer
