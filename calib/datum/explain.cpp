#include "calib/datum/explain.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace raysteer::calib::datum {
namespace {

constexpr double kLeastMove_m = 1e-3;
constexpr double kLeastMoveSigmas = 4;
constexpr double kWorth = 30;  // of chi-square an explanation must take away: 3 unknowns do by chance in 1e-6
constexpr double kPerUnknown =
    8;  // chi-square that an unknown more must be worth: two moves must not pass for an exchange
constexpr double kAsGood = 11;  // chi-square between explanations that are not told apart
constexpr double kLeastScale = 2e-3;
constexpr double kScaleSigmas = 4;

std::string millimetres(double metres) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f mm", 1e3 * metres);
  return text.data();
}

struct Explanation {
  enum Kind { kScale, kExchanged, kMoved } kind = kScale;
  std::vector<std::size_t> datums;
  Fit fit;
  double cost() const { return fit.chi_square + kPerUnknown * static_cast<double>(fit.cov.rows() - 6); }
  bool fits() const { return fit.faces && fit.dof > 0 && fit.chi_square < acceptable(fit.dof); }
};

Pairs exchanged(Pairs pairs, std::size_t i, std::size_t j) {
  // Sigmas stay with the places: it is the numbers that were exchanged.
  std::swap(pairs.measured[i], pairs.measured[j]);
  const auto a = 3 * static_cast<Eigen::Index>(i);
  const auto b = 3 * static_cast<Eigen::Index>(j);
  for (Eigen::Index k = 0; k < 3; ++k) {
    pairs.cov_measured.row(a + k).swap(pairs.cov_measured.row(b + k));
    pairs.cov_measured.col(a + k).swap(pairs.cov_measured.col(b + k));
  }
  return pairs;
}

void try_exchanges(const Pairs& pairs, std::vector<Explanation>& found) {
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (auto each = fit(exchanged(pairs, j, i), {})) {
        found.push_back({.kind = Explanation::kExchanged, .datums = {j, i}, .fit = std::move(*each)});
      }
    }
  }
}

// One more moved datum at a time, the one that helps most, until the rest fits.
void try_moves(const Pairs& pairs, std::vector<Explanation>& found) {
  std::vector<std::size_t> moved;
  while (pairs.size() - moved.size() > 3) {
    std::vector<Explanation> each;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (std::ranges::find(moved, i) != moved.end()) {
        continue;
      }
      Freedom freedom{.scale = false, .moved = moved};
      freedom.moved.push_back(i);
      if (auto one = fit(pairs, freedom); one && one->dof > 0) {
        each.push_back({.kind = Explanation::kMoved, .datums = freedom.moved, .fit = std::move(*one)});
      }
    }
    if (each.empty()) {
      return;
    }
    const auto best = std::ranges::min_element(each, {}, &Explanation::cost);
    moved = best->datums;
    const bool enough = best->fits();
    found.insert(found.end(), std::make_move_iterator(each.begin()), std::make_move_iterator(each.end()));
    if (enough) {
      return;
    }
  }
}

std::string name_moves(const Explanation& each, const std::vector<std::string>& names) {
  std::string note;
  for (std::size_t k = 0; k < each.datums.size(); ++k) {
    note += (k > 0 ? " and '" : "'") + names[each.datums[k]] + "' by " + millimetres(each.fit.moved[k].norm());
  }
  return note;
}

bool worth_saying(const Explanation& moved) {
  const Eigen::Index first = moved.fit.cov.rows() - 3 * static_cast<Eigen::Index>(moved.fit.moved.size());
  for (std::size_t k = 0; k < moved.fit.moved.size(); ++k) {
    const Eigen::Matrix3d cov =
        moved.fit.cov.block<3, 3>(first + 3 * static_cast<Eigen::Index>(k), first + 3 * static_cast<Eigen::Index>(k));
    const Eigen::Vector3d& move = moved.fit.moved[k];
    if (move.norm() > kLeastMove_m && move.dot(cov.ldlt().solve(move)) > kLeastMoveSigmas * kLeastMoveSigmas) {
      return true;
    }
  }
  return false;
}

// What else would explain it as well, in words; empty when nothing would.
std::string alternatives(const std::vector<Explanation>& found, const Explanation& best,
                         const std::vector<std::string>& names) {
  std::string note;
  for (const Explanation& each : found) {
    if (&each == &best || each.kind != best.kind || each.datums.size() != best.datums.size() || !each.fits() ||
        each.cost() > best.cost() + kAsGood) {
      continue;
    }
    note += each.kind == Explanation::kExchanged
                ? ", or '" + names[each.datums[0]] + "' and '" + names[each.datums[1]] + "'"
                : ", or " + name_moves(each, names);
  }
  return note.empty() ? "" : note + "; these datums cannot tell which";
}

Error say(const Explanation& best, const std::vector<Explanation>& found, const Pairs& pairs,
          const std::vector<std::string>& names) {
  const std::string others = alternatives(found, best, names);
  if (best.kind == Explanation::kExchanged) {
    return fail(RCode::kDatumsExchanged, "'" + names[best.datums[0]] + "' and '" + names[best.datums[1]] + "'" +
                                             others + ": with their numbers exchanged all " +
                                             std::to_string(pairs.size()) + " datums fit");
  }
  return fail(RCode::kDatumMoved, name_moves(best, names) + others);
}

}  // namespace

bool is_wrong(double scale, double sigma) {
  return std::abs(scale - 1) > kLeastScale && std::abs(scale - 1) > kScaleSigmas * sigma;
}

std::string scale_note(double measured_m, double known_m, double sigma_m) {
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), "measured %.1f mm where there are %.1f mm (%+.2f %%, give or take %.2f %%)",
                1e3 * measured_m, 1e3 * known_m, 100 * (measured_m / known_m - 1), 100 * sigma_m / known_m);
  return text.data();
}

std::optional<Error> explain(const Pairs& pairs, const std::vector<std::string>& names, const Fit& rigid,
                             bool try_scale) {
  std::vector<Explanation> found;
  if (try_scale) {
    if (auto scaled = fit(pairs, {.scale = true, .moved = {}})) {
      found.push_back({.kind = Explanation::kScale, .datums = {}, .fit = std::move(*scaled)});
    }
  }
  try_exchanges(pairs, found);
  try_moves(pairs, found);
  const Explanation* best = nullptr;
  const Explanation* nearest = nullptr;
  for (const Explanation& each : found) {
    const bool explains = rigid.chi_square - each.fit.chi_square > kWorth || !rigid.faces;
    best = explains && each.fits() && (best == nullptr || each.cost() < best->cost()) ? &each : best;
    nearest =
        each.kind == Explanation::kMoved && (nearest == nullptr || each.cost() < nearest->cost()) ? &each : nearest;
  }
  if (best != nullptr && best->kind == Explanation::kScale) {
    const double sigma = std::sqrt(best->fit.cov(6, 6));
    // A rig metre is `scale` room metres: what is 1 m in the room measures 1 / scale.
    return is_wrong(best->fit.scale, sigma)
               ? std::optional(fail(RCode::kScaleWrong, scale_note(1 / best->fit.scale, 1, sigma)))
               : std::nullopt;
  }
  if (best != nullptr) {
    return best->kind == Explanation::kExchanged || worth_saying(*best) ? std::optional(say(*best, found, pairs, names))
                                                                        : std::nullopt;
  }
  if (!rigid.faces) {
    return fail(RCode::kDatumsExchanged, "which ones cannot be told: as surveyed, the rig would stand behind them");
  }
  const auto worst = std::ranges::max_element(rigid.misses, {}, [](const auto& miss) { return miss.norm(); });
  if (worst->norm() < kLeastMove_m || rigid.chi_square < acceptable(rigid.dof)) {
    return std::nullopt;
  }
  const std::string& name = names[static_cast<std::size_t>(worst - rigid.misses.begin())];
  return fail(RCode::kDatumMoved, (pairs.size() < 4 ? "one of three, which cannot be told; '" : "more than one; '") +
                                      name + "' misses its place by " + millimetres(worst->norm()) +
                                      (nearest != nullptr ? ", best explained by " + name_moves(*nearest, names) : ""));
}

}  // namespace raysteer::calib::datum
