// What is delivered reads, and fits together.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "proto/stations/stations.hpp"
#include "proto/survey/survey.hpp"
#include "sim/scene/read_scene.hpp"
#include "sim/scene/scene.hpp"
#include "tests/support/paths.hpp"

namespace raysteer::proto {
namespace {

std::string text_of(const std::string& path) {
  std::ifstream file(support::source_root() / path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST(Hall, has_its_datums_where_the_survey_says_within_four_sigma) {
  const auto survey = survey::read_survey(text_of("surveys/hall.toml"), "surveys/hall.toml");
  ASSERT_TRUE(survey) << survey.error().message();
  const auto scene = sim::scene::load_scene(support::source_root() / "scenes" / "hall.toml");
  ASSERT_TRUE(scene) << scene.error().message();
  int met = 0;
  for (const sim::scene::Surface& surface : scene->surfaces) {
    const survey::SurveyedDatum* datum = survey->find(surface.name);
    if (datum == nullptr) {
      continue;
    }
    ++met;
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(surface.T_room_surface.translation()[static_cast<Eigen::Index>(k)], datum->position_m[k],
                  4e-3 * datum->sigma_mm)
          << datum->name;
    }
    const auto* print =
        surface.material.texture ? std::get_if<sim::scene::RingDatum>(&surface.material.texture->kind()) : nullptr;
    ASSERT_NE(print, nullptr) << datum->name;
    EXPECT_EQ(print->code, datum->code);
    EXPECT_EQ(print->radius_m, datum->radius_m);
  }
  EXPECT_EQ(met, 8);
}

TEST(Hall, has_fifteen_stations_of_the_floor_task_on_six_by_four_metres) {
  const auto stations = stations::read_stations(text_of("stations/floor-task.toml"), "stations/floor-task.toml");
  ASSERT_TRUE(stations) << stations.error().message();
  ASSERT_EQ(stations->stations.size(), 15U);
  for (const stations::Station& station : stations->stations) {
    EXPECT_EQ(station.size_m, (std::array<double, 2>{0.5, 0.3125})) << station.name;
    EXPECT_LE(std::abs(station.position_m[0]) + 0.25, 3.0) << station.name;
    EXPECT_LE(std::abs(station.position_m[1]) + 0.15625, 2.0) << station.name;
  }
}

}  // namespace
}  // namespace raysteer::proto
