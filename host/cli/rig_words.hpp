// How well a rig came out, in words and numbers: what 'calibrate rig' prints, and its verdict.
#pragma once

#include <optional>
#include <string>

#include "calib/steer/evaluate.hpp"
#include "calib/steer/solve.hpp"
#include "host/cli/context.hpp"
#include "host/report/result.hpp"
#include "host/rig/room.hpp"
#include "host/rig/truth_error.hpp"

namespace raysteer::host::cli {

/// "good", "usable" or "redo", by what looks that were not calibrated are missed by (docs/decisions/0005).
std::string rig_verdict(const calib::steer::Evaluation& evaluation);

/// The verdict's reasons, and what to do.
report::Judgement judge_rig(const std::string& verdict, const calib::steer::Evaluation& evaluation,
                            const calib::steer::Solution& solution, bool tied);

/// Held-out looks, the solve, and the error against the truth where there is one.
void print_accuracy(Context& context, const calib::steer::Solution& solution,
                    const calib::steer::Evaluation& evaluation, const std::optional<rig::TruthError>& truth,
                    const std::string& verdict);

/// The tie to the room; `room` is nothing without a survey.
void print_room(Context& context, const std::optional<rig::InRoom>& room);

/// How sure light is over the floor and at the stations; nothing where no floor was found.
void print_reach(Context& context, const report::RigResult& result);

}  // namespace raysteer::host::cli
