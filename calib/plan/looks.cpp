#include "calib/plan/looks.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "calib/plan/choose.hpp"
#include "calib/plan/order.hpp"

namespace raysteer::calib::plan {
namespace {

using Box = Eigen::AlignedBox2d;

/// The usable commands: a box round them, and of its grid those that can be used, with their mean spread.
struct Reach {
  Box box;
  std::vector<Candidate> candidates;
  Eigen::MatrixXd spread_px;
  Eigen::MatrixXd spread_mm;
  double repeatability_px2 = 0;
  double repeatability_mm2 = 0;
};

Eigen::Vector2d on_grid(const Box& box, int column, int row, int count) {
  return box.min() + Eigen::Vector2d(column, row).cwiseProduct(box.sizes()) / (count - 1);
}

Box usable_box(const Forecaster& forecaster) {
  constexpr int kFine = 41;
  const model::SteeredProjector& projector = forecaster.drawing().projector;
  const Box limits(projector.least_rad, projector.most_rad);
  Box usable;
  for (int row = 0; row < kFine; ++row) {
    for (int column = 0; column < kFine; ++column) {
      const Eigen::Vector2d command = on_grid(limits, column, row, kFine).cwiseMax(limits.min()).cwiseMin(limits.max());
      if (forecaster.usable(command)) {
        usable.extend(command);
      }
    }
  }
  return usable;
}

Result<Reach> survey(const Forecaster& forecaster, int per_axis) {
  Reach reach;
  reach.box = usable_box(forecaster);
  if (!reach.box.isEmpty()) {
    for (int row = 0; row < per_axis; ++row) {
      for (int column = 0; column < per_axis; ++column) {
        const Eigen::Vector2d command =
            on_grid(reach.box, column, row, per_axis).cwiseMax(reach.box.min()).cwiseMin(reach.box.max());
        auto forecast = forecaster.usable(command) ? forecaster.at(command) : std::nullopt;
        if (forecast) {
          reach.candidates.push_back({.forecast = *std::move(forecast), .column = column, .row = row});
        }
      }
    }
  }
  if (reach.candidates.size() < kFewestLooks) {
    return fail(RCode::kTooFewLooks,
                "of " + std::to_string(per_axis * per_axis) + " commands only " +
                    std::to_string(reach.candidates.size()) +
                    " light a place that both cameras see past the mirrors' outlines; expected at least " +
                    std::to_string(kFewestLooks) + "; check limits, outlines and cameras of the board file");
  }
  const Eigen::Index n = forecaster.parameters();
  reach.spread_px = Eigen::MatrixXd::Zero(n, n);
  reach.spread_mm = Eigen::MatrixXd::Zero(n, n);
  const double share = 1.0 / static_cast<double>(reach.candidates.size());
  for (const Candidate& candidate : reach.candidates) {
    reach.spread_px += share * candidate.forecast.spread_px;
    reach.spread_mm += share * candidate.forecast.spread_mm;
    reach.repeatability_px2 += share * candidate.forecast.repeatability_px2;
    reach.repeatability_mm2 += share * candidate.forecast.repeatability_mm2;
  }
  return reach;
}

Prediction predicted(const Reach& reach, const Eigen::MatrixXd& information) {
  const double px2 = mean_squared(information, reach.spread_px);
  const double mm2 = mean_squared(information, reach.spread_mm);
  return {.model_px = std::sqrt(px2),
          .model_mm = std::sqrt(mm2),
          .unseen_px = std::sqrt(px2 + reach.repeatability_px2),
          .unseen_mm = std::sqrt(mm2 + reach.repeatability_mm2)};
}

/// 4 x 4 within the box, those that can be used (algorithms 4.7).
std::vector<Eigen::Vector2d> regular_grid(const Forecaster& forecaster, const Box& box) {
  constexpr std::array kLevels{-0.95, -0.32, 0.32, 0.95};
  std::vector<Eigen::Vector2d> commands;
  for (const double y : kLevels) {
    for (const double x : kLevels) {
      const Eigen::Vector2d command = box.center() + Eigen::Vector2d(x, y).cwiseProduct(box.sizes()) / 2;
      if (forecaster.usable(command)) {
        commands.push_back(command);
      }
    }
  }
  return commands;
}

/// Low-discrepancy points (R2: Roberts 2018, the plane's golden ratio) that keep away from looks already there.
void add_held_out(const Forecaster& forecaster, const Box& box, int count, std::vector<PlannedLook>& looks) {
  constexpr double kRatio = 1.32471795724474602596;
  constexpr int kTries = 500;
  const Eigen::Vector2d half = box.sizes() / 2;
  int added = 0;
  for (double apart = 0.15; added < count && apart > 1e-3; apart /= 2) {
    for (int i = 1; i <= kTries && added < count; ++i) {
      const Eigen::Vector2d r(0.5 + i / kRatio, 0.5 + i / (kRatio * kRatio));
      const Eigen::Vector2d command = box.min() + (r - r.array().floor().matrix()).cwiseProduct(box.sizes());
      const bool near = std::ranges::any_of(looks, [&](const PlannedLook& look) {
        return (look.command_rad - command).cwiseQuotient(half).norm() < apart;
      });
      if (!near && forecaster.usable(command)) {
        looks.push_back({command, true});
        ++added;
      }
    }
  }
}

Status check(const LookOptions& options) {
  if (options.looks < kFewestLooks) {
    return fail(RCode::kTooFewLooks, "expected at least " + std::to_string(kFewestLooks) + " looks, got " +
                                         std::to_string(options.looks) + "; 16 are usual");
  }
  constexpr int kMostCandidates = 41;
  if (options.candidates < kFewestLevels || options.candidates > kMostCandidates) {
    return fail(RCode::kBadValue, "candidates: expected 4 to 41 per axis, got " + std::to_string(options.candidates));
  }
  if (options.looks > options.candidates * options.candidates || options.held_out < 0 || options.held_out > 100) {
    return fail(RCode::kBadValue, "expected at most " + std::to_string(options.candidates * options.candidates) +
                                      " looks and 0 to 100 held out, got " + std::to_string(options.looks) + " and " +
                                      std::to_string(options.held_out));
  }
  return ok();
}

void put_in_order(LookPlan& plan) {
  std::vector<Eigen::Vector2d> commands;
  for (const PlannedLook& look : plan.looks) {
    commands.push_back(look.command_rad);
  }
  const auto order = visiting_order(commands, (plan.most_rad - plan.least_rad).cwiseMax(1e-9));
  std::vector<PlannedLook> sorted;
  commands.clear();
  for (const std::size_t i : order) {
    sorted.push_back(plan.looks[i]);
    commands.push_back(plan.looks[i].command_rad);
  }
  plan.looks = std::move(sorted);
  plan.from_above = approached_from_above(commands);
}

}  // namespace

Result<LookPlan> plan_looks(const steer::Drawing& drawing, const model::Rig& cameras, const ScenePlane& plane,
                            const LookOptions& options) {
  RAYSTEER_TRY(check(options));
  const auto forecaster = Forecaster::make(drawing, cameras, plane, options.measuring);
  RAYSTEER_TRY(forecaster);
  const auto reach = survey(*forecaster, options.candidates);
  RAYSTEER_TRY(reach);
  LookPlan plan;
  plan.usable = static_cast<int>(reach->candidates.size());
  plan.least_rad = reach->box.min();
  plan.most_rad = reach->box.max();
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(forecaster->parameters(), forecaster->parameters());
  plan.regular = plan.usable < options.looks;
  if (plan.regular) {
    for (const Eigen::Vector2d& command : regular_grid(*forecaster, reach->box)) {
      if (const auto forecast = forecaster->at(command)) {
        information += forecast->information;
        plan.looks.push_back({command, false});
      }
    }
    if (plan.looks.size() < kFewestLooks) {
      return fail(RCode::kTooFewLooks, "only " + std::to_string(plan.looks.size()) +
                                           " looks of a 4 x 4 grid can be used; expected at least " +
                                           std::to_string(kFewestLooks) + "; check limits, outlines and cameras");
    }
  } else {
    for (const std::size_t i : choose(reach->candidates, reach->spread_px, static_cast<std::size_t>(options.looks))) {
      information += reach->candidates[i].forecast.information;
      plan.looks.push_back({reach->candidates[i].forecast.command_rad, false});
    }
  }
  plan.prediction = predicted(*reach, information);
  add_held_out(*forecaster, reach->box, options.held_out, plan.looks);
  put_in_order(plan);
  return plan;
}

Result<Prediction> predict(const steer::Drawing& drawing, const model::Rig& cameras, const ScenePlane& plane,
                           std::span<const Eigen::Vector2d> commands_rad, const LookOptions& options) {
  RAYSTEER_TRY(check(options));
  const auto forecaster = Forecaster::make(drawing, cameras, plane, options.measuring);
  RAYSTEER_TRY(forecaster);
  const auto reach = survey(*forecaster, options.candidates);
  RAYSTEER_TRY(reach);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(forecaster->parameters(), forecaster->parameters());
  for (const Eigen::Vector2d& command : commands_rad) {
    if (const auto forecast = forecaster->at(command)) {
      information += forecast->information;
    }
  }
  return predicted(*reach, information);
}

}  // namespace raysteer::calib::plan
