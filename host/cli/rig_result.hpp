// What calibrating, baking and verifying a steered rig found, as result.json and the page say it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/steer/evaluate.hpp"
#include "host/cli/context.hpp"
#include "host/exchange/rig_file.hpp"
#include "host/report/result.hpp"
#include "host/rig/aimed_rig.hpp"
#include "host/rig/reach.hpp"
#include "host/rig/room.hpp"
#include "host/rig/verify.hpp"
#include "proto/survey/survey.hpp"

namespace raysteer::host::cli {

/// A rig where it stands, or in its own frame.
struct PlacedRig {
  calib::steer::InRoom rig;
  bool tied = false;
  std::string id;
  std::string survey_id{};  ///< of the survey that tied it; empty where it is not told
};
PlacedRig placed(const exchange::RigCalibration& calibration);
PlacedRig placed(const calib::steer::Solution& solution, const std::optional<rig::InRoom>& room, const std::string& id);

/// Floor and reach; nothing is drawn where there is no floor.
void add_reach(report::RigResult& result, const PlacedRig& rig);

/// Looks, held-out looks, residuals, what is off its drawing. After add_reach(): looks are drawn on its floor.
void add_solution(report::RigResult& result, const PlacedRig& rig, const calib::steer::Solution& solution,
                  const calib::steer::Evaluation& evaluation, const std::vector<calib::steer::Look>& held_out);

/// Datums, their misses and the metric check.
void add_datums(report::RigResult& result, const calib::datum::Tie& tie, const proto::survey::Survey& survey);

void add_stations(report::RigResult& result, const std::vector<rig::AimedStation>& aimed);
/// After add_stations(): what was measured instead of what is expected.
void add_verified(report::RigResult& result, const std::vector<rig::AimedStation>& aimed,
                  const std::vector<rig::VerifiedStation>& verified);

/// What the light does now against what it did by an earlier calibration: in the room where both are tied to one, else
/// in the rig's own frame. After add_reach() and add_stations(), whose stations get what they moved by. Errors:
/// kCalibrationMismatch (another rig), kTooFewCorrespondences.
Status add_difference(report::RigResult& result, const PlacedRig& now, const PlacedRig& before,
                      const std::vector<rig::AimedStation>& aimed);

/// The sentence for the terminal and the JSON: nothing where nothing was compared.
void print_difference(Context& context, const report::RigResult& result);

}  // namespace raysteer::host::cli
