#include "proto/survey/survey.hpp"

#include <cmath>
#include <utility>

#include "hal/base/datum_code.hpp"
#include "proto/document/fixed_numbers.hpp"
#include "proto/document/parse.hpp"
#include "proto/document/toml_text.hpp"

namespace raysteer::proto::survey {

using document::Faults;
using document::TomlTable;
namespace {

// Bounds that only nonsense exceeds.
constexpr std::size_t kMostDatums = 100;
constexpr std::size_t kMostLengths = 1000;
constexpr document::Range<double> kPlace{-1000, 1000};
constexpr document::Range<double> kSigma{0.001, 1000};
constexpr std::string_view kMetres = "lengths are in metres (25 mm is 0.025)";
constexpr Vec3 kUp{0, 0, 1};

SurveyedDatum read_datum(TomlTable& table) {
  SurveyedDatum datum;
  datum.name = table.text("name");
  if (datum.name.empty() && table.has("name")) {
    table.fault(RCode::kBadValue, "name", "must not be empty: messages call the datum by it");
  }
  datum.code = smallest_rotation(static_cast<unsigned>(table.integer("code", {0, (1 << kDatumBits) - 1})));
  datum.radius_m = table.number("radius_m", {1e-3, 1}, {}, kMetres);
  datum.position_m = document::read_numbers<3>(table, "position_m", kPlace, nullptr, kMetres);
  datum.normal = document::read_numbers<3>(table, "normal", {-1.01, 1.01}, &kUp);
  // People write 0.7071: a length within a percent of 1 is made 1; one that is 1 already stays as it is.
  const double length = std::hypot(datum.normal[0], datum.normal[1], datum.normal[2]);
  if (std::abs(length - 1) > 0.01) {
    table.fault(RCode::kBadValue, "normal", "must be a direction of length 1, got length " + std::to_string(length));
  } else if (std::abs(length - 1) > 1e-9) {
    for (double& part : datum.normal) {
      part /= length;
    }
  }
  datum.sigma_mm = table.number("sigma_mm", kSigma, {}, "how far each coordinate may be off, in millimetres");
  table.finish();
  return datum;
}

KnownLength read_length(TomlTable& table) {
  KnownLength known;
  known.from = table.text("from");
  known.to = table.text("to");
  known.length_m = table.number("length_m", {1e-3, 2000}, {}, kMetres);
  known.sigma_mm = table.number("sigma_mm", kSigma, {}, "how far the length may be off, in millimetres");
  table.finish();
  return known;
}

void read(TomlTable& root, Survey& survey, Faults&) {
  survey.name = root.text("name");
  survey.by_rig = root.choice("measured_by", {"hand", "rig"}, 0) == 1;
  if (!root.has("datum")) {
    root.fault(RCode::kMissingKey, "datum", "is needed: at least three [[datum]]");
  }
  for (TomlTable& table : root.tables("datum")) {
    if (survey.datums.size() == kMostDatums) {
      root.fault(RCode::kBadValue, "datum", "are more than " + std::to_string(kMostDatums));
      break;
    }
    survey.datums.push_back(read_datum(table));
  }
  for (TomlTable& table : root.tables("length")) {
    if (survey.lengths.size() == kMostLengths) {
      root.fault(RCode::kBadValue, "length", "are more than " + std::to_string(kMostLengths));
      break;
    }
    survey.lengths.push_back(read_length(table));
  }
}

}  // namespace

Result<Survey> read_survey(std::string_view text, const std::string& file) {
  Result<Survey> survey = document::read_document<Survey>(text, file, read);
  RAYSTEER_TRY(survey);
  if (Status usable = check(*survey); !usable) {
    return with_context(std::move(usable).error(), file + ": ");
  }
  return survey;
}

std::string write_survey(const Survey& survey) {
  using document::array;
  using document::number;
  using document::quoted;
  std::string text = "format = 1\nname = " + quoted(survey.name) + "\n";
  text += survey.by_rig ? "measured_by = \"rig\"\n" : "";
  for (const SurveyedDatum& datum : survey.datums) {
    text += "\n[[datum]]\nname = " + quoted(datum.name) + "\ncode = " + number(std::int64_t{datum.code}) +
            "\nradius_m = " + number(datum.radius_m) + "\nposition_m = " + array(datum.position_m) + "\n";
    text += datum.normal == kUp ? "" : "normal = " + array(datum.normal) + "\n";
    text += "sigma_mm = " + number(datum.sigma_mm) + "\n";
  }
  for (const KnownLength& known : survey.lengths) {
    text += "\n[[length]]\nfrom = " + quoted(known.from) + "\nto = " + quoted(known.to) +
            "\nlength_m = " + number(known.length_m) + "\nsigma_mm = " + number(known.sigma_mm) + "\n";
  }
  return text;
}

}  // namespace raysteer::proto::survey
