#include "calib/decode/plan.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace raysteer::calib::decode {
namespace {

const char* name(Axis axis) { return axis == Axis::kX ? "x" : "y"; }

/// Do the phases of all periods together tell the finest period's orders apart? Two places m periods apart must differ
/// by 0.01 periods or more in another phase: less is below the noise of any camera.
bool orders_are_unique(const std::vector<PatternBlock>& phases, const AxisPlan& axis) {
  constexpr double kLeastDifference = 0.01;
  const double finest = phases[axis.phases.front()].period_px;
  const int orders = static_cast<int>(std::floor((axis.panel - 1e-6 * finest) / finest));
  for (int m = 1; m <= orders; ++m) {
    double largest = 0;
    for (const int index : axis.phases) {
      const double periods = m * finest / phases[index].period_px;
      largest = std::max(largest, std::abs(periods - std::round(periods)));
    }
    if (largest < kLeastDifference) {
      return false;
    }
  }
  return true;
}

Status check_axis(const Plan& plan, Axis which) {
  const AxisPlan& axis = plan.axis(which);
  const std::string where = std::string("axis ") + name(which) + ": ";
  if (axis.gray && !axis.phases.empty()) {
    for (const int index : axis.phases) {
      const double period = plan.phases[index].period_px;
      if (axis.gray->stripe_px > period / 2 * (1 + 1e-9)) {
        return fail(RCode::kBadSequence, where + "Gray stripes of " + std::to_string(axis.gray->stripe_px) +
                                             " px cannot order periods of " + std::to_string(period) +
                                             " px; half a period or less is needed");
      }
    }
  }
  if (!axis.gray && !axis.phases.empty() && !orders_are_unique(plan.phases, axis)) {
    return fail(
        RCode::kBadSequence,
        where + "the " + std::to_string(axis.phases.size()) +
            " phase block(s) repeat within the panel: add a Gray block or a period whose beat covers the panel");
  }
  return ok();
}

}  // namespace

Result<Plan> plan(const PatternSequence& sequence) {
  RAYSTEER_TRY(check(sequence));
  Plan plan;
  plan.frames = sequence.patterns();
  plan.x.panel = sequence.panel_width;
  plan.y.panel = sequence.panel_height;
  for (const PatternBlock& block : sequence.blocks) {
    plan.phase_of_block.push_back(-1);
    AxisPlan& axis = plan.axis(block.axis);
    switch (block.kind) {
      case PatternKind::kWhite:
        plan.white = true;
        break;
      case PatternKind::kBlack:
        plan.black = true;
        break;
      case PatternKind::kGray:
        if (axis.gray) {
          return fail(RCode::kBadSequence, std::string("axis ") + name(block.axis) + " has two Gray blocks");
        }
        axis.gray = block;
        break;
      case PatternKind::kPhase:
        plan.phase_of_block.back() = static_cast<int>(plan.phases.size());
        axis.phases.push_back(static_cast<int>(plan.phases.size()));
        plan.phases.push_back(block);
        break;
    }
  }
  if (!plan.x.used() && !plan.y.used()) {
    return fail(RCode::kBadSequence, "no Gray and no phase block: nothing is coded");
  }
  for (const Axis which : {Axis::kX, Axis::kY}) {
    AxisPlan& axis = plan.axis(which);
    std::ranges::sort(axis.phases, {}, [&](int index) { return plan.phases[index].period_px; });
    if (axis.gray && !axis.gray->inverse) {
      if (!axis.phases.empty()) {
        axis.threshold = Threshold::kPhaseMean;
      } else if (plan.white && plan.black) {
        axis.threshold = Threshold::kWhiteAndBlack;
      } else {
        return fail(RCode::kBadSequence, std::string("axis ") + name(which) +
                                             ": Gray patterns without inverse need white and black, or a phase block "
                                             "on the same axis, to be thresholded by");
      }
    }
    RAYSTEER_TRY(check_axis(plan, which));
  }
  return plan;
}

}  // namespace raysteer::calib::decode
