#include "calib/datum/tie.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/datum/explain.hpp"
#include "calib/datum/fit.hpp"

namespace raysteer::calib::datum {
namespace {

using proto::survey::Survey;
using proto::survey::SurveyedDatum;

Eigen::Vector3d vec(const proto::survey::Vec3& v) { return {v[0], v[1], v[2]}; }

/// The datums that were measured and surveyed, in the survey's order.
struct Joined {
  Pairs pairs;
  std::vector<const SurveyedDatum*> datums;
  std::vector<std::size_t> at;  ///< in Measured
  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const SurveyedDatum* datum : datums) {
      names.push_back(datum->name);
    }
    return names;
  }
};

bool is_left_out(const TieOptions& options, const SurveyedDatum& datum) {
  return std::ranges::find(options.leave_out, datum.name) != options.leave_out.end();
}

Joined join(const Survey& survey, const Measured& measured, const TieOptions& options) {
  Joined joined;
  for (const SurveyedDatum& datum : survey.datums) {
    const auto found = std::ranges::find(measured.codes, datum.code);
    if (found != measured.codes.end() && !is_left_out(options, datum)) {
      joined.datums.push_back(&datum);
      joined.at.push_back(static_cast<std::size_t>(found - measured.codes.begin()));
    }
  }
  Pairs& pairs = joined.pairs;
  const auto n = static_cast<Eigen::Index>(joined.at.size());
  pairs.cov_measured.resize(3 * n, 3 * n);
  pairs.cov_surveyed = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    pairs.surveyed.push_back(vec(joined.datums[k]->position_m));
    pairs.normals.push_back(vec(joined.datums[k]->normal));
    pairs.measured.push_back(measured.p[joined.at[k]]);
    const double sigma = 1e-3 * joined.datums[k]->sigma_mm;
    pairs.cov_surveyed.block<3, 3>(3 * i, 3 * i) = sigma * sigma * Eigen::Matrix3d::Identity();
    for (Eigen::Index j = 0; j < n; ++j) {
      pairs.cov_measured.block<3, 3>(3 * i, 3 * j) =
          measured.cov.block<3, 3>(3 * static_cast<Eigen::Index>(joined.at[k]),
                                   3 * static_cast<Eigen::Index>(joined.at[static_cast<std::size_t>(j)]));
    }
  }
  return joined;
}

std::string list(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) {
    text += (text.empty() ? "'" : ", '") + name + "'";
  }
  return text.empty() ? "none" : text;
}

Error missing(const Joined& joined, const Survey& survey) {
  const std::string seen = std::to_string(joined.at.size()) + " of " + std::to_string(survey.datums.size());
  return fail(RCode::kDatumsMissing,
              "both eyes see " + seen + " datums (" + list(joined.names()) +
                  (joined.at.size() < 3 ? "), three are needed" : "), and those stand in one line") +
                  ": the calibration is consistent with itself, not tied to the room");
}

std::vector<Length> lengths_of(const Survey& survey, const Joined& joined) {
  std::vector<Length> lengths;
  const auto at = [&](const std::string& name) {
    const auto found = std::ranges::find(joined.datums, name, [](const SurveyedDatum* datum) { return datum->name; });
    return static_cast<std::size_t>(found - joined.datums.begin());
  };
  for (const proto::survey::KnownLength& known : survey.lengths) {
    const std::size_t i = at(known.from), j = at(known.to);
    if (i == joined.datums.size() || j == joined.datums.size()) {
      continue;
    }
    const Pairs& pairs = joined.pairs;
    const Eigen::Vector3d along = pairs.measured[j] - pairs.measured[i];
    const Eigen::RowVector3d unit = along.normalized().transpose();
    Eigen::RowVectorXd by = Eigen::RowVectorXd::Zero(pairs.cov_measured.rows());
    by.segment<3>(3 * static_cast<Eigen::Index>(i)) = -unit;
    by.segment<3>(3 * static_cast<Eigen::Index>(j)) = unit;
    const double measured = (by * pairs.cov_measured * by.transpose())(0);
    lengths.push_back({.from = known.from,
                       .to = known.to,
                       .measured_m = along.norm(),
                       .known_m = known.length_m,
                       .sigma_m = std::sqrt(measured + 1e-6 * known.sigma_mm * known.sigma_mm)});
  }
  return lengths;
}

/// What the lengths say together. Their measured ends share cameras: the larger of what counting them as independent
/// and what the best one alone leaves is stated.
Scale scale_by(const std::vector<Length>& lengths) {
  double weights = 0, sum = 0, least = 1;
  for (const Length& length : lengths) {
    const double sigma = length.sigma_m / length.known_m;
    weights += 1 / (sigma * sigma);
    sum += length.measured_m / length.known_m / (sigma * sigma);
    least = std::min(least, sigma);
  }
  return {.value = sum / weights, .sigma = std::max(least, 1 / std::sqrt(weights)), .by_lengths = true};
}

/// The scale, and an error when it is wrong. Nothing when nobody but the rig measured a length.
Result<std::optional<Scale>> check_scale(const Survey& survey, const Joined& joined,
                                         const std::vector<Length>& lengths) {
  if (!lengths.empty()) {
    const Scale scale = scale_by(lengths);
    if (is_wrong(scale.value, scale.sigma)) {
      const Length& first = lengths.front();
      return fail(RCode::kScaleWrong, "from '" + first.from + "' to '" + first.to +
                                          "': " + scale_note(first.measured_m, first.known_m, first.sigma_m));
    }
    return std::optional(scale);
  }
  if (survey.by_rig) {
    return std::optional<Scale>();
  }
  const auto scaled = fit(joined.pairs, {.scale = true, .moved = {}});
  if (!scaled) {
    return std::optional<Scale>();
  }
  return std::optional(Scale{.value = 1 / scaled->scale, .sigma = std::sqrt(scaled->cov(6, 6)), .by_lengths = false});
}

std::map<unsigned, Disc> discs_of(const Survey& survey, const model::Pose& T_room_rig) {
  std::map<unsigned, Disc> discs;
  for (const SurveyedDatum& datum : survey.datums) {
    discs[datum.code] = {.radius_m = datum.radius_m, .normal = T_room_rig.q.conjugate() * vec(datum.normal)};
  }
  return discs;
}

Tie tie_of(const Survey& survey, const Measured& measured, const Joined& joined, const Fit& rigid) {
  Tie tie;
  tie.T_room_rig = rigid.T_room_rig;
  tie.dof = rigid.dof;
  tie.whitened_rms = rigid.dof > 0 ? std::sqrt(rigid.chi_square / rigid.dof) : 0;
  const double raised = rigid.chi_square > acceptable(rigid.dof) ? tie.whitened_rms * tie.whitened_rms : 1;
  tie.cov = raised * rigid.cov.topLeftCorner<6, 6>();
  Eigen::MatrixXd with_cameras(3 * static_cast<Eigen::Index>(joined.at.size()), measured.cov_cameras.cols());
  for (std::size_t k = 0; k < joined.at.size(); ++k) {
    with_cameras.middleRows<3>(3 * static_cast<Eigen::Index>(k)) =
        rigid.T_room_rig.rotation() * measured.cov_cameras.middleRows<3>(3 * static_cast<Eigen::Index>(joined.at[k]));
    tie.misses.push_back({.name = joined.datums[k]->name,
                          .code = joined.datums[k]->code,
                          .miss_m = rigid.misses[k],
                          .sigma_m = rigid.sigmas.segment<3>(3 * static_cast<Eigen::Index>(k))});
  }
  tie.cov_cameras = rigid.gain.topRows<6>() * with_cameras;
  for (const SurveyedDatum& datum : survey.datums) {
    if (std::ranges::find(measured.codes, datum.code) == measured.codes.end()) {
      tie.not_seen.push_back(datum.name);
    }
  }
  for (const unsigned code : measured.codes) {
    if (survey.find_code(code) == nullptr) {
      tie.not_surveyed.push_back(code);
    }
  }
  return tie;
}

Error with_name(Error error, const Survey& survey) {
  const SurveyedDatum* datum =
      error.rcode == RCode::kDatumMoved ? survey.find_code(static_cast<unsigned>(error.detail)) : nullptr;
  return datum != nullptr ? with_context(std::move(error), "'" + datum->name + "': ") : error;
}

}  // namespace

Result<Tie> tie_to_room(const model::Rig& cameras, const Survey& survey, const std::vector<View>& views,
                        const TieOptions& options) {
  RAYSTEER_TRY(proto::survey::check(survey));
  Result<Measured> measured = measure(cameras, views);
  if (!measured && measured.error().rcode == RCode::kTooFewMatches) {
    return missing({}, survey);
  }
  if (!measured) {
    return with_name(std::move(measured).error(), survey);
  }
  Joined joined = join(survey, *measured, options);
  std::optional<Fit> rigid = fit(joined.pairs, {});
  if (!rigid) {
    return missing(joined, survey);
  }
  // Now that it is known how the discs are tilted, once more.
  measured = measure(cameras, views, discs_of(survey, rigid->T_room_rig));
  RAYSTEER_TRY(measured);
  joined = join(survey, *measured, options);
  rigid = fit(joined.pairs, {});
  if (!rigid) {
    return missing(joined, survey);
  }
  const std::vector<Length> lengths = lengths_of(survey, joined);
  if (rigid->chi_square > unsuspicious(rigid->dof) || !rigid->faces) {
    const bool by_places = !survey.by_rig;
    if (auto error = explain(joined.pairs, joined.names(), *rigid, by_places)) {
      return std::move(*error);
    }
  }
  const auto scale = check_scale(survey, joined, lengths);
  RAYSTEER_TRY(scale);
  Tie tie = tie_of(survey, *measured, joined, *rigid);
  tie.scale = *scale;
  tie.lengths = lengths;
  return tie;
}

}  // namespace raysteer::calib::datum
