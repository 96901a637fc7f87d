#include "host/cli/rig_words.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace raysteer::host::cli {
namespace {

using calib::steer::Evaluation;
using calib::steer::Solution;

// docs/decisions/0005: what a look that was not calibrated may miss by, 95 %, on the surface.
constexpr double kGoodMm = 1;
constexpr double kUsableMm = 2.5;

Json accuracy(double median_px, double p95_px, double median_mm, double p95_mm) {
  return {{"median_px", median_px}, {"p95_px", p95_px}, {"median_mm", median_mm}, {"p95_mm", p95_mm}};
}

}  // namespace

std::string rig_verdict(const Evaluation& evaluation) {
  return evaluation.p95_mm <= kGoodMm ? "good" : evaluation.p95_mm <= kUsableMm ? "usable" : "redo";
}

report::Judgement judge_rig(const std::string& verdict, const Evaluation& evaluation, const Solution& solution,
                            bool tied) {
  report::Judgement judgement{.verdict = verdict,
                              .summary = fmt::format("Looks that were not calibrated are hit within {:.2f} mm "
                                                     "({:.2f} px), 95 %.",
                                                     evaluation.p95_mm, evaluation.p95_px),
                              .reasons = {},
                              .advice = {}};
  if (!tied) {
    judgement.reasons.emplace_back("The rig is consistent with itself, but not tied to the room.");
    judgement.advice.emplace_back("Survey four datums or more, and give --survey.");
  }
  if (verdict != "good") {
    judgement.reasons.push_back(fmt::format("{:.1f} mm are asked for, 95 %.", kGoodMm));
    judgement.advice.emplace_back("Take the looks that 'raysteer plan looks' chooses, with the mirror warmed up.");
  }
  if (!solution.off_drawing.empty()) {
    judgement.reasons.push_back(fmt::format("{} numbers are further from the board file than its tolerances explain.",
                                            solution.off_drawing.size()));
    judgement.advice.emplace_back(
        "Measure those parts and correct the board file: the next calibration starts nearer.");
  }
  return judgement;
}

void print_room(Context& context, const std::optional<rig::InRoom>& room) {
  context.json()["tied_to_room"] = room.has_value();
  if (!room) {
    context.print("room             consistent with itself, not tied to the room: give --survey\n");
    return;
  }
  Json& json = context.json()["room"];
  double worst = 0;
  for (const calib::datum::Miss& miss : room->tie.misses) {
    json["datums"].push_back({{"name", miss.name}, {"miss_mm", 1e3 * miss.miss_m.norm()}});
    worst = std::max(worst, 1e3 * miss.miss_m.norm());
  }
  context.print(fmt::format("room             tied by {} datums, none off by more than {:.2f} mm\n",
                            room->tie.misses.size(), worst));
  if (room->tie.scale) {
    json["scale"] = room->tie.scale->value;
    json["scale_sigma"] = room->tie.scale->sigma;
    context.print(fmt::format("scale            {:.1f} of 1000.0 mm by {} (+- {:.1f})\n", 1000 * room->tie.scale->value,
                              room->tie.scale->by_lengths ? "known lengths" : "surveyed places",
                              1000 * room->tie.scale->sigma));
  }
}

void print_accuracy(Context& context, const Solution& solution, const Evaluation& evaluation,
                    const std::optional<rig::TruthError>& truth, const std::string& verdict) {
  Json& json = context.json();
  json["verdict"] = verdict;
  json["looks"] = solution.looks.size();
  json["held_out_looks"] = evaluation.looks.size();
  json["held_out"] = accuracy(evaluation.median_px, evaluation.p95_px, evaluation.median_mm, evaluation.p95_mm);
  json["held_out"]["raw_median_px"] = evaluation.raw_median_px;
  json["held_out"]["raw_p95_px"] = evaluation.raw_p95_px;
  json["held_out"]["predicted_rms_px"] = evaluation.predicted_rms_px;
  json["whitened_rms"] = solution.whitened_rms;
  json["repeatability_urad"] = 1e6 * solution.repeatability_rad;
  json["points"] = {{"used", solution.used}, {"dropped", solution.dropped}};
  if (truth) {
    json["truth"] = accuracy(truth->median_px, truth->p95_px, truth->median_mm, truth->p95_mm);
  }
  context.print(fmt::format("{}: looks that were not calibrated are hit within {:.2f} mm ({:.2f} px), 95 %\n", verdict,
                            evaluation.p95_mm, evaluation.p95_px));
  context.print("\n");
  context.print(fmt::format("held out         {} looks: {:.3f} px median, {:.3f} px (95 %); {:.3f} / {:.3f} mm\n",
                            evaluation.looks.size(), evaluation.median_px, evaluation.p95_px, evaluation.median_mm,
                            evaluation.p95_mm));
  context.print(fmt::format("solved           {} looks, {} points ({} left out), whitened RMS {:.3f}\n",
                            solution.looks.size(), solution.used, solution.dropped, solution.whitened_rms));
  context.print(fmt::format("mirror           repeats within {:.0f} urad ({})\n", 1e6 * solution.repeatability_rad,
                            solution.repeatability_estimated ? "estimated" : "as drawn"));
  for (const calib::steer::OffDrawing& off : solution.off_drawing) {
    context.print(fmt::format("off its drawing  {} by {:.1f} sigma\n", off.parameter, off.sigmas));
  }
  if (truth) {
    context.print(fmt::format("error against the truth: {:.3f} px median, {:.3f} px (95 %); {:.3f} / {:.3f} mm\n",
                              truth->median_px, truth->p95_px, truth->median_mm, truth->p95_mm));
  }
}

void print_reach(Context& context, const report::RigResult& result) {
  if (result.reach.empty()) {
    return;
  }
  context.json()["reach"] = {{"median_95_mm", result.reach_median_95_mm}, {"worst_95_mm", result.reach_worst_95_mm}};
  context.print(
      fmt::format("reach            sure to {:.2f} mm (95 %) over half of it, {:.2f} mm at its worst place, on {}\n",
                  result.reach_median_95_mm, result.reach_worst_95_mm, result.floor));
  for (const report::StationRow& station : result.stations) {
    context.json()["stations"].push_back({{"name", station.name},
                                          {"bound_95_mm", station.bound_95_mm},
                                          {"tolerance_mm", station.tolerance_mm},
                                          {"within", station.within}});
    context.print(fmt::format("  {:<14} {:.2f} mm{}\n", station.name, station.bound_95_mm,
                              station.within ? "" : fmt::format(" (allowed {:.1f})", station.tolerance_mm)));
  }
}

}  // namespace raysteer::host::cli
