#include "proto/stations/stations.hpp"

#include <gtest/gtest.h>

namespace raysteer::proto::stations {
namespace {

const std::string kStations = R"(format = 1
name = "two"

[[station]]
name = "s-01"
position_m = [-2, 1.5, 0]
turn_deg = 30
size_m = [0.5, 0.3125]
content = "pictures/one.png"
tolerance_mm = 2.5

[[station]]
name = "wall"
position_m = [0, 2, 1]
rotation_deg = [90, 0, 0]
size_m = [0.4, 0.3]
surface = "scan"
tolerance_mm = 1
eye_m = [0, 0, 1.7]

[[keep_out]]
name = "desk"
corners_m = [[1, 1], [2, 1], [2, 2], [1, 2]]

[[keep_out]]
corners_m = [[1, 1, 0.8], [2, 1, 0.8], [2, 2, 0.8]]
)";

std::string with(std::string from, const std::string& to) {
  std::string text = kStations;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

void expect_refused(const std::string& text, RCode rcode, const std::string& words) {
  const Result<Stations> stations = read_stations(text, "stations.toml");
  ASSERT_FALSE(stations) << words;
  EXPECT_EQ(stations.error().rcode, rcode) << stations.error().message();
  EXPECT_NE(stations.error().note.find(words), std::string::npos) << stations.error().note;
}

TEST(Stations, are_read_and_written_to_the_same_value) {
  const Result<Stations> stations = read_stations(kStations, "stations.toml");
  ASSERT_TRUE(stations) << stations.error().message();
  ASSERT_EQ(stations->stations.size(), 2U);
  EXPECT_EQ(stations->stations[0].rotation_deg, (Vec3{0, 0, 30}));
  EXPECT_EQ(stations->stations[0].surface, Surface::kPlane);
  EXPECT_EQ(stations->stations[1].eye_m, (Vec3{0, 0, 1.7}));
  EXPECT_EQ(stations->keep_out[0].corners_m[2], (Vec3{2, 2, 0}));
  const Result<Stations> again = read_stations(write_stations(*stations), "again.toml");
  ASSERT_TRUE(again) << again.error().message();
  EXPECT_EQ(*again, *stations);
}

TEST(Stations, are_found_by_name_or_named_all) {
  const Stations stations = *read_stations(kStations, "stations.toml");
  EXPECT_EQ((*stations.find("wall"))->size_m[0], 0.4);
  const auto unknown = stations.find("well");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().rcode, RCode::kStationUnknown);
  EXPECT_NE(unknown.error().note.find("s-01 wall"), std::string::npos);
}

TEST(Stations, with_what_is_not_asked_for_or_missing_is_refused_by_line) {
  expect_refused(with("size_m", "sice_m"), RCode::kUnknownKey, "stations.toml:8");
  expect_refused(with("tolerance_mm = 2.5\n", ""), RCode::kMissingKey, "tolerance_mm");
  expect_refused(with("position_m = [-2, 1.5, 0]\n", ""), RCode::kMissingKey, "position_m");
  expect_refused(with("[-2, 1.5, 0]", "[-2, nan, 0]"), RCode::kBadValue, "position_m");
  expect_refused(with("[-2, 1.5, 0]", "[-2, 1.5]"), RCode::kBadValue, "3 numbers");
  expect_refused(with("[0.5, 0.3125]", "[500, 312.5]"), RCode::kBadValue, "metres");
  expect_refused(with("[0.5, 0.3125]", "[0.5, -0.3]"), RCode::kBadValue, "size_m");
  expect_refused(with("tolerance_mm = 2.5", "tolerance_mm = 0"), RCode::kBadValue, "tolerance_mm");
  expect_refused(with("s-01", "wall"), RCode::kBadValue, "second time");
  expect_refused(with("s-01", "a/b"), RCode::kBadValue, "file name");
  expect_refused(with("\"scan\"", "\"scans\""), RCode::kBadValue, "scan");
  expect_refused(with("turn_deg = 30", "turn_deg = 30\nrotation_deg = [0, 0, 30]"), RCode::kBadValue, "keep one");
  expect_refused("format = 1\nname = \"none\"\n", RCode::kMissingKey, "station");
  expect_refused("format = 1\nname = \"none\"\nstation = []\n", RCode::kBadValue, "station");
}

TEST(Stations, take_pictures_from_beside_or_below_only) {
  for (const std::string path : {"/etc/passwd", "../x.png", "a/../../x.png", "c:x.png", "..\\\\x.png"}) {
    expect_refused(with("pictures/one.png", path), RCode::kPathOutside, "beside");
  }
  EXPECT_TRUE(read_stations(with("pictures/one.png", "a/..b/one.png"), "stations.toml"));
}

TEST(Stations, keep_out_outlines_that_enclose_something) {
  const std::string desk = "[[1, 1], [2, 1], [2, 2], [1, 2]]";
  expect_refused(with(desk, "[[1, 1], [2, 1]]"), RCode::kBadValue, "3 to 1000");
  expect_refused(with(desk, "[[1, 1], [2, 2], [3, 3]]"), RCode::kBadValue, "no area");
  expect_refused(with(desk, "[[1, 1], [2, 2], [2, 1], [1, 3]]"), RCode::kBadValue, "crosses itself");
  expect_refused(with(desk, "[[1, 1, 0], [2, 1, 0], [2, 2, 0.5], [1, 2, 0]]"), RCode::kBadValue, "not flat");
  expect_refused(with(desk, "[[1], [2], [3]]"), RCode::kBadValue, "[x, y]");
  EXPECT_TRUE(read_stations(with(desk, "[[0, 0], [3, 0], [3, 3], [2, 1], [0, 3]]"), "stations.toml"));
}

}  // namespace
}  // namespace raysteer::proto::stations
