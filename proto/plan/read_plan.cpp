#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "proto/document/parse.hpp"
#include "proto/document/paths.hpp"
#include "proto/document/pattern_table.hpp"
#include "proto/document/target_table.hpp"
#include "proto/plan/plan.hpp"

namespace raysteer::proto::plan {

using document::Faults;
using document::TomlTable;
namespace {

// Bounds that only nonsense exceeds; they keep memory and time small whatever the file says.
constexpr std::size_t kMostLooks = 10'000;
constexpr std::size_t kMostBlocks = 256;

PlannedLook read_look(TomlTable& table) {
  constexpr double kMost = 3200;
  PlannedLook look{.name = table.text("name"), .mirror_rad = {}, .prepare = table.text("prepare", "")};
  // Names become names of files.
  if (!document::is_file_name(look.name)) {
    table.fault(RCode::kBadValue, "name", "is '" + look.name + "', which cannot be part of a file name");
  }
  const bool given = table.has("mirror_mrad");
  const std::vector<double> angles = table.numbers("mirror_mrad");
  if (angles.size() == 2) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      if (!(angles[axis] >= -kMost && angles[axis] <= kMost)) {
        table.fault(RCode::kBadValue, "mirror_mrad",
                    "has " + std::to_string(angles[axis]) +
                        ", which is beyond half a turn; angles are in milliradians (1 degree is 17.45)");
      }
      look.mirror_rad[axis] = angles[axis] * 1e-3;
    }
  } else if (!given) {
    table.fault(RCode::kMissingKey, "mirror_mrad", "is needed: two angles, as in [0, 0]");
  } else if (!angles.empty()) {
    table.fault(RCode::kBadValue, "mirror_mrad", "must be two angles, got " + std::to_string(angles.size()));
  }
  table.finish();
  return look;
}

void read_looks(TomlTable& root, Plan& plan) {
  std::vector<TomlTable> tables = root.tables("look");
  if (!root.has("look")) {
    root.fault(RCode::kMissingKey, "look", "is needed: at least one [[look]]");
  } else if (tables.empty()) {
    root.fault(RCode::kBadValue, "look", "must be at least one");
  } else if (tables.size() > kMostLooks) {
    root.fault(RCode::kBadValue, "look", "are more than " + std::to_string(kMostLooks));
    return;
  }
  std::set<std::string> names;
  for (TomlTable& table : tables) {
    plan.looks.push_back(read_look(table));
    if (!names.insert(plan.looks.back().name).second) {
      root.fault(RCode::kBadValue, "look", "has '" + plan.looks.back().name + "' twice");
    }
  }
}

void read(TomlTable& root, Plan& plan, Faults& faults) {
  plan.name = root.text("name");
  if (root.has("exposure_us")) {
    plan.exposure_us = root.number("exposure_us", {1, 1e8}, {}, "exposures are in microseconds");
  }
  root.number("exposure_us", {1, 1e8}, 1.0);  // known, there or not
  for (TomlTable& table : root.tables("sequence")) {
    if (plan.blocks.size() == kMostBlocks) {
      root.fault(RCode::kBadValue, "sequence", "has more than " + std::to_string(kMostBlocks) + " blocks");
      break;
    }
    plan.blocks.push_back(document::read_pattern_block(table, 0, 0, faults));
  }
  read_looks(root, plan);
  for (TomlTable& table : root.tables("target")) {
    PlannedTarget target{.spec = document::read_target_spec(table), .looks = table.texts("looks")};
    for (const std::string& name : target.looks) {
      if (std::ranges::find(plan.looks, name, &PlannedLook::name) == plan.looks.end()) {
        table.fault(RCode::kBadValue, "looks", "has '" + name + "', which is no look of this plan");
      }
    }
    table.finish();
    plan.targets.push_back(std::move(target));
  }
}

}  // namespace

Result<Plan> read_plan(std::string_view text, const std::string& file) {
  return document::read_document<Plan>(text, file, read);
}

}  // namespace raysteer::proto::plan
