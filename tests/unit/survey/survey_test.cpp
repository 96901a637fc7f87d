#include "proto/survey/survey.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "hal/base/datum_code.hpp"

namespace raysteer::proto::survey {
namespace {

const std::string kSurvey = R"(format = 1
name = "hall"

[[datum]]
name = "door"
code = 23
radius_m = 0.03
position_m = [-2, -1.5, 0.0005]
sigma_mm = 0.3

[[datum]]
name = "pillar"
code = 0b000001001111
radius_m = 0.03
position_m = [2, -1.5, 0.0005]
normal = [0.7071, 0, 0.7071]
sigma_mm = 0.3

[[datum]]
name = "gate"
code = 101
radius_m = 0.03
position_m = [2, 1.5, 0]
sigma_mm = 0.5

[[length]]
from = "door"
to = "gate"
length_m = 5
sigma_mm = 0.2
)";

std::string with(std::string from, const std::string& to) {
  std::string text = kSurvey;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

void expect_refused(const std::string& text, RCode rcode, const std::string& words) {
  const Result<Survey> survey = read_survey(text, "datums.toml");
  ASSERT_FALSE(survey) << words;
  EXPECT_EQ(survey.error().rcode, rcode) << survey.error().message();
  EXPECT_NE(survey.error().note.find(words), std::string::npos) << survey.error().note;
}

TEST(Survey, is_read_and_written_to_the_same_value) {
  const Result<Survey> survey = read_survey(kSurvey, "datums.toml");
  ASSERT_TRUE(survey) << survey.error().message();
  ASSERT_EQ(survey->datums.size(), 3U);
  EXPECT_EQ(survey->find("pillar")->code, 79U);
  EXPECT_NEAR(survey->find("pillar")->normal[2], std::sqrt(0.5), 1e-9);
  EXPECT_EQ(survey->find_code(101)->name, "gate");
  EXPECT_EQ(survey->find("nobody"), nullptr);
  EXPECT_FALSE(survey->by_rig);
  const Result<Survey> again = read_survey(write_survey(*survey), "again.toml");
  ASSERT_TRUE(again) << again.error().message();
  EXPECT_EQ(*again, *survey);
}

TEST(Survey, by_the_rig_stays_one) {
  Survey survey = *read_survey(kSurvey, "datums.toml");
  survey.by_rig = true;
  EXPECT_EQ(*read_survey(write_survey(survey), "again.toml"), survey);
}

TEST(Survey, takes_a_turned_code_as_the_same_one) {
  EXPECT_EQ(read_survey(with("code = 23", "code = 46"), "datums.toml")->datums[0].code, 23U);
}

TEST(Survey, with_what_is_not_asked_for_or_missing_is_refused_by_line) {
  expect_refused(with("code = 23", "kode = 23"), RCode::kUnknownKey, "datums.toml:6");
  expect_refused(with("code = 23\n", ""), RCode::kMissingKey, "code");
  expect_refused(with("format = 1", "format = 2"), RCode::kFormatVersion, "datums.toml:1");
  expect_refused(with("0.3", "nan"), RCode::kBadValue, "sigma_mm");
  expect_refused(with("[-2, -1.5, 0.0005]", "[-2, inf, 0]"), RCode::kBadValue, "position_m");
  expect_refused(with("[-2, -1.5, 0.0005]", "[-2000, -1500, 0]"), RCode::kBadValue, "metres");
  expect_refused(with("[-2, -1.5, 0.0005]", "[]"), RCode::kBadValue, "position_m");
  expect_refused(with("radius_m = 0.03", "radius_m = 30"), RCode::kBadValue, "metres");
  expect_refused(with("[0.7071, 0, 0.7071]", "[0, 0, 0]"), RCode::kBadValue, "normal");
  expect_refused(with("\"gate\"\nlength_m", "\"window\"\nlength_m"), RCode::kBadValue, "'window'");
  expect_refused("format = 1\nname = \"empty\"\n", RCode::kMissingKey, "datum");
  expect_refused("format = ", RCode::kTomlSyntax, "datums.toml:1");
}

TEST(Survey, with_a_code_that_is_too_like_another_is_refused_with_the_list) {
  expect_refused(with("code = 101", "code = 0b000000101011"), RCode::kBadValue, "take one of 23 79");
}

TEST(Survey, that_cannot_fix_a_frame_is_unusable) {
  expect_refused(with("code = 101", "code = 23"), RCode::kSurveyUnusable, "code 23 is surveyed twice");
  expect_refused(with("name = \"gate\"", "name = \"door\""), RCode::kSurveyUnusable, "two datums are called 'door'");
  expect_refused(with("[2, 1.5, 0]", "[2.01, -1.5, 0]"), RCode::kSurveyUnusable, "on one another");
  expect_refused(with("[2, 1.5, 0]", "[0, -1.49, 0]"), RCode::kSurveyUnusable, "line from 'door' to 'pillar'");
  expect_refused(with("to = \"gate\"", "to = \"door\""), RCode::kSurveyUnusable, "begins and ends");
  Survey two = *read_survey(kSurvey, "datums.toml");
  two.datums.pop_back();
  two.lengths.clear();
  EXPECT_EQ(check(two).error().rcode, RCode::kSurveyUnusable);
}

TEST(Survey, made_in_memory_is_checked_as_strictly) {
  const Survey good = *read_survey(kSurvey, "datums.toml");
  EXPECT_TRUE(check(good));
  Survey bad = good;
  bad.datums[1].position_m[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(check(bad).error().rcode, RCode::kNotFinite);
  bad = good;
  bad.lengths[0].length_m = std::numeric_limits<double>::infinity();
  EXPECT_EQ(check(bad).error().rcode, RCode::kNotFinite);
  bad = good;
  bad.datums[1].code = 46;
  EXPECT_EQ(check(bad).error().rcode, RCode::kBadValue);
  bad = good;
  bad.datums[1].sigma_mm = 0;
  EXPECT_EQ(check(bad).error().rcode, RCode::kBadValue);
}

}  // namespace
}  // namespace raysteer::proto::survey
