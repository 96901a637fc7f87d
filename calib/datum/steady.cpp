#include "calib/datum/steady.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace raysteer::calib::datum {
namespace {

constexpr double kShift_px = 0.15;   // from view to view: more is no noise...
constexpr double kShiftSigmas = 5;   // ...when it is this unlikely, too
constexpr double kFloor_px = 0.005;  // what does not average out: how the disc lies on the pixels

struct Sighting {
  std::size_t view = 0;
  const target::SeenDatum* seen = nullptr;
  double shift_px = 0;  ///< from the median of all views
  bool shifted = false;
};

double middle(std::vector<double> values) {
  const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, half);
  return *half;
}

bool is_usable(const target::SeenDatum& seen) {
  return seen.q.allFinite() && seen.cov.allFinite() && seen.cov(0, 0) > 0 && seen.cov.determinant() > 0;
}

void mark_shifted(std::vector<Sighting>& sightings) {
  std::vector<double> x, y;
  for (const Sighting& sighting : sightings) {
    x.push_back(sighting.seen->q.x());
    y.push_back(sighting.seen->q.y());
  }
  const Eigen::Vector2d q(middle(x), middle(y));
  for (Sighting& sighting : sightings) {
    const Eigen::Vector2d shift = sighting.seen->q - q;
    sighting.shift_px = shift.norm();
    sighting.shifted = sighting.shift_px > kShift_px &&
                       shift.dot(sighting.seen->cov.inverse() * shift) > 2 * kShiftSigmas * kShiftSigmas;
  }
}

MeanSighting mean_of(const std::vector<Sighting>& sightings) {
  Eigen::Matrix2d weight = Eigen::Matrix2d::Zero();
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Sighting& sighting : sightings) {
    if (!sighting.shifted) {
      const Eigen::Matrix2d one = sighting.seen->cov.inverse();
      weight += one;
      sum += one * sighting.seen->q;
    }
  }
  const Eigen::Matrix2d cov = weight.inverse();
  return {.q = cov * sum, .cov = cov + kFloor_px * kFloor_px * Eigen::Matrix2d::Identity()};
}

using Key = std::pair<unsigned, std::size_t>;  // code, eye

// The rig moved when half of what a view shows is elsewhere; a single datum did when it alone is.
Status check_still(const std::vector<View>& views, const std::map<Key, std::vector<Sighting>>& all) {
  for (std::size_t view = 0; view < views.size(); ++view) {
    int seen = 0, shifted = 0;
    std::vector<double> shifts;
    for (const auto& [key, sightings] : all) {
      for (const Sighting& sighting : sightings) {
        if (sighting.view == view && sightings.size() > 1) {
          ++seen;
          shifted += sighting.shifted ? 1 : 0;
          shifts.push_back(sighting.shift_px);
        }
      }
    }
    if (shifted >= 3 && 2 * shifted >= seen) {
      return fail(RCode::kRigMoved,
                  "in look '" + views[view].name + "' the datums are " + std::to_string(middle(shifts)).substr(0, 4) +
                      " px from where the other looks show them",
                  static_cast<std::int64_t>(view));
    }
  }
  for (const auto& [key, sightings] : all) {
    const auto shifted = std::ranges::find(sightings, true, &Sighting::shifted);
    if (4 * std::ranges::count(sightings, true, &Sighting::shifted) >= static_cast<int>(sightings.size()) &&
        shifted != sightings.end()) {
      return fail(RCode::kDatumMoved,
                  "code " + std::to_string(key.first) + " is elsewhere in look '" + views[shifted->view].name +
                      "' than in others, by " + std::to_string(shifted->shift_px).substr(0, 4) + " px",
                  key.first);
    }
  }
  return ok();
}

}  // namespace

Result<std::map<unsigned, std::array<std::optional<MeanSighting>, 2>>> steady(const std::vector<View>& views) {
  std::map<Key, std::vector<Sighting>> all;
  for (std::size_t view = 0; view < views.size(); ++view) {
    for (std::size_t eye = 0; eye < 2; ++eye) {
      for (const target::SeenDatum& seen : views[view].eyes[eye]) {
        if (!is_usable(seen)) {
          return fail(RCode::kNotFinite, "the place of datum " + std::to_string(seen.code) + " in look '" +
                                             views[view].name + "', or its covariance");
        }
        all[{seen.code, eye}].push_back({.view = view, .seen = &seen, .shift_px = 0, .shifted = false});
      }
    }
  }
  for (auto& [key, sightings] : all) {
    mark_shifted(sightings);
  }
  RAYSTEER_TRY(check_still(views, all));
  std::map<unsigned, std::array<std::optional<MeanSighting>, 2>> means;
  for (const auto& [key, sightings] : all) {
    means[key.first][key.second] = mean_of(sightings);
  }
  return means;
}

}  // namespace raysteer::calib::datum
