#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "hal/base/datum_code.hpp"
#include "proto/survey/survey.hpp"

namespace raysteer::proto::survey {
namespace {

// Beside the longest length, how far a datum must stand from that line: a turn about the line is then known to
// 1/0.02 of what one datum's place would give.
constexpr double kLeastHeight = 0.02;

Vec3 minus(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double norm(const Vec3& v) { return std::hypot(v[0], v[1], v[2]); }
Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
bool is_finite(const Vec3& v) {
  return std::ranges::all_of(v, [](double x) { return std::isfinite(x); });
}

Error unusable(const std::string& note) { return fail(RCode::kSurveyUnusable, note); }

Status check_each(const SurveyedDatum& datum) {
  if (!is_finite(datum.position_m) || !is_finite(datum.normal) || !std::isfinite(datum.radius_m) ||
      !std::isfinite(datum.sigma_mm)) {
    return fail(RCode::kNotFinite, "datum '" + datum.name + "'");
  }
  if (!(datum.radius_m > 0) || !(datum.sigma_mm > 0) || std::abs(norm(datum.normal) - 1) > 1e-6) {
    return fail(RCode::kBadValue,
                "datum '" + datum.name + "' needs a radius, a sigma above 0 and a normal of length 1");
  }
  if (datum.code != smallest_rotation(datum.code)) {
    return fail(RCode::kBadValue, "datum '" + datum.name + "': code " + std::to_string(datum.code) + " turned is " +
                                      std::to_string(smallest_rotation(datum.code)) + "; write that");
  }
  if (Status known = check_datum_code(datum.code); !known) {
    return with_context(std::move(known).error(), "datum '" + datum.name + "': ");
  }
  return ok();
}

Status check_places(const std::vector<SurveyedDatum>& datums) {
  double longest = 0;
  const SurveyedDatum* from = nullptr;
  const SurveyedDatum* to = nullptr;
  for (std::size_t i = 0; i < datums.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double length = norm(minus(datums[i].position_m, datums[j].position_m));
      if (length < datums[i].radius_m + datums[j].radius_m) {
        return unusable("'" + datums[j].name + "' and '" + datums[i].name + "' lie on one another");
      }
      if (length > longest) {
        longest = length;
        from = &datums[j];
        to = &datums[i];
      }
    }
  }
  double height = 0;
  const Vec3 line = minus(to->position_m, from->position_m);
  for (const SurveyedDatum& datum : datums) {
    height = std::max(height, norm(cross(line, minus(datum.position_m, from->position_m))) / longest);
  }
  if (height < kLeastHeight * longest) {
    return unusable("all " + std::to_string(datums.size()) + " datums stand within " +
                    std::to_string(static_cast<int>(std::ceil(1000 * height))) + " mm of the line from '" + from->name +
                    "' to '" + to->name + "'; a turn about it would not be seen");
  }
  return ok();
}

Status check_lengths(const Survey& survey) {
  for (const KnownLength& known : survey.lengths) {
    for (const std::string& end : {known.from, known.to}) {
      if (survey.find(end) == nullptr) {
        return fail(RCode::kBadValue, "a length ends at '" + end + "', which is no datum of this survey");
      }
    }
    if (!std::isfinite(known.length_m) || !std::isfinite(known.sigma_mm)) {
      return fail(RCode::kNotFinite, "the length from '" + known.from + "' to '" + known.to + "'");
    }
    if (!(known.length_m > 0) || !(known.sigma_mm > 0)) {
      return fail(RCode::kBadValue,
                  "the length from '" + known.from + "' to '" + known.to + "' and its sigma must be above 0");
    }
    if (known.from == known.to) {
      return unusable("a length begins and ends at '" + known.from + "'");
    }
  }
  return ok();
}

}  // namespace

const SurveyedDatum* Survey::find(std::string_view datum) const {
  const auto found = std::ranges::find(datums, datum, &SurveyedDatum::name);
  return found == datums.end() ? nullptr : &*found;
}

const SurveyedDatum* Survey::find_code(unsigned code) const {
  const auto found = std::ranges::find(datums, code, &SurveyedDatum::code);
  return found == datums.end() ? nullptr : &*found;
}

Status check(const Survey& survey) {
  if (survey.datums.size() < 3) {
    return unusable(std::to_string(survey.datums.size()) + " datums; three fix a frame, with four one can be checked");
  }
  std::set<std::string> names;
  std::set<unsigned> codes;
  for (const SurveyedDatum& datum : survey.datums) {
    RAYSTEER_TRY(check_each(datum));
    if (!names.insert(datum.name).second) {
      return unusable("two datums are called '" + datum.name + "'");
    }
    if (!codes.insert(datum.code).second) {
      return unusable("code " + std::to_string(datum.code) + " is surveyed twice, the second time as '" + datum.name +
                      "'");
    }
  }
  RAYSTEER_TRY(check_places(survey.datums));
  return check_lengths(survey);
}

}  // namespace raysteer::proto::survey
