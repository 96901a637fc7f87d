// value: where the datums of a room are, and what is known of lengths between them ("datums.toml",
// docs/survey-format.md). Whoever holds a Survey from read_survey() or check() can fix a frame by it.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/result.hpp"

namespace raysteer::proto::survey {

using Vec3 = std::array<double, 3>;

struct SurveyedDatum {
  std::string name;
  unsigned code = 0;     ///< one of datum_codes(), in its smallest rotation
  double radius_m = 0;   ///< of the white disc
  Vec3 position_m{};     ///< of its middle, the room's frame
  Vec3 normal{0, 0, 1};  ///< unit, out of its face
  double sigma_mm = 0;   ///< one standard deviation of each coordinate
  bool operator==(const SurveyedDatum&) const = default;
};

/// A length that somebody measured with a tape or a bar.
struct KnownLength {
  std::string from;  ///< names of datums
  std::string to;
  double length_m = 0;
  double sigma_mm = 0;
  bool operator==(const KnownLength&) const = default;
};

struct Survey {
  std::string name;
  bool by_rig = false;  ///< the rig measured the places itself: they say nothing about its scale
  std::vector<SurveyedDatum> datums;
  std::vector<KnownLength> lengths;
  bool operator==(const Survey&) const = default;

  const SurveyedDatum* find(std::string_view datum) const;
  const SurveyedDatum* find_code(unsigned code) const;
};

/// Reads a survey. Errors name file, line and what was expected: kTomlSyntax, kFormatVersion, kUnknownKey, kMissingKey,
/// kBadValue (a number that is none or out of range, a code that is not offered, a length between datums that are not
/// there), kSurveyUnusable.
Result<Survey> read_survey(std::string_view text, const std::string& file);

/// The text of a survey: read_survey() gives the same value.
std::string write_survey(const Survey& survey);

/// Can the survey fix a frame? kNotFinite; kBadValue; kSurveyUnusable: fewer than three datums, a name or code twice,
/// two at one place, all in one line, a length known between one datum and itself.
Status check(const Survey& survey);

}  // namespace raysteer::proto::survey
