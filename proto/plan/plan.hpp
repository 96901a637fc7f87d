// value: what to capture: the same sequence at each of some looks ("plan.toml", docs/plan-format.md).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/pattern.hpp"
#include "hal/base/result.hpp"
#include "hal/base/target.hpp"

namespace raysteer::proto::plan {

struct PlannedLook {
  std::string name;                    ///< unique; becomes the session's look
  std::array<double, 2> mirror_rad{};  ///< mechanical, axis1 and axis2
  std::string prepare;                 ///< what a person does first ("target pose 3"); empty: nothing
  bool operator==(const PlannedLook&) const = default;
};

struct PlannedTarget {
  TargetSpec spec;
  std::vector<std::string> looks;  ///< empty: all
  bool operator==(const PlannedTarget&) const = default;
};

struct Plan {
  std::string name;
  std::vector<PatternBlock> blocks;  ///< empty: the set asked for on the command line
  std::optional<double> exposure_us;
  std::vector<PlannedLook> looks;  ///< at least one
  std::vector<PlannedTarget> targets;
  bool operator==(const Plan&) const = default;
};

/// Reads a plan. Errors name file, line and what was expected: kTomlSyntax, kFormatVersion, kUnknownKey, kMissingKey,
/// kBadValue.
Result<Plan> read_plan(std::string_view text, const std::string& file);

/// The named pattern sets of algorithms 2.3 for a panel: "default", "fast", "best", "gray"; each begins with white and
/// black. kBadValue lists the names.
Result<PatternSequence> pattern_set(std::string_view name, int panel_width, int panel_height);

}  // namespace raysteer::proto::plan
