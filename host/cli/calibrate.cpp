#include "host/cli/calibrate.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "calib/assess/assess.hpp"
#include "host/exchange/calibration_file.hpp"
#include "host/pretend/truth_file.hpp"
#include "host/report/calibration_result.hpp"
#include "host/report/result.hpp"

namespace raysteer::host::cli {
namespace {

namespace assess = calib::assess;
namespace solve = calib::solve;

std::string_view layout_name(CharucoLayout layout) {
  return layout == CharucoLayout::kLegacy ? "legacy" : layout == CharucoLayout::kCurrent ? "current" : "auto";
}

Result<std::optional<calib::model::Rig>> previous_rig(const Context& context, const std::string& named) {
  if (!named.empty()) {
    auto calibration = exchange::read_calibration(named);
    if (!calibration) {
      return std::move(calibration).error();
    }
    return std::optional(std::move(calibration->rig));
  }
  if (const auto folder = context.previous_out()) {
    // An output of another kind, or of an older format, is no reason not to calibrate.
    if (auto calibration = exchange::read_calibration(*folder)) {
      return std::optional(std::move(calibration->rig));
    }
  }
  return std::optional<calib::model::Rig>{};
}

exchange::CalibrationMeta meta_of(const CalibrateInput& input, const TargetSpec& target,
                                  const solve::Solution& solution, const assess::Assessment& assessment) {
  exchange::CalibrationMeta meta;
  meta.session = input.session;
  meta.target = target;
  meta.verdict = assess::to_string(assessment.verdict);
  meta.rms_px = solution.rms_px;
  meta.held_out_p95_px = assessment.cross_validation.p95_px;
  meta.views_used = static_cast<int>(std::ranges::count_if(solution.views, &solve::ViewFit::used));
  for (const solve::DeviceFit& device : solution.devices) {
    meta.corners_used += device.corners_kept;
  }
  meta.sag_x_m = solution.sag_m.x();
  meta.sag_y_m = solution.sag_m.y();
  return meta;
}

double sigma_of(const assess::DeviceAssessment& device, std::string_view name) {
  const auto found =
      std::ranges::find_if(device.parameters, [&](const assess::Parameter& row) { return row.name.ends_with(name); });
  return found == device.parameters.end() ? report::kUnknown : found->sigma;
}

void add_details(Json& json, const TargetSpec& target, const solve::Solution& solution,
                 const assess::Assessment& assessment) {
  if (target.kind == TargetKind::kCharuco) {
    json["layout"] = layout_name(target.layout);
  }
  json["whitened_rms"] = solution.whitened_rms;
  json["all_corners_rms_px"] = solution.all_corners_rms_px;
  if (std::isfinite(solution.plain_fit_rms_px)) {
    json["plain_fit_rms_px"] = solution.plain_fit_rms_px;
  }
  std::size_t camera = 0;
  for (std::size_t d = 0; d < solution.devices.size(); ++d) {
    const bool projector = solution.rig.devices[d].kind == calib::model::DeviceKind::kProjector;
    Json& device = projector ? json["projector"] : json["cameras"][camera++];
    device["kept_share"] = solution.devices[d].kept_share();
    device["sigma_px"] = solution.devices[d].sigma_px;
    device["focal_sigma_px"] = sigma_of(assessment.devices[d], ".fx");
    device["principal_point_sigma_px"] = {sigma_of(assessment.devices[d], ".cx"),
                                          sigma_of(assessment.devices[d], ".cy")};
    if (projector) {
      json["single_pixel_px"] = solution.pixel_rms_px;
      json["corners"] = solution.devices[d].corners_seen;
    }
  }
  json["target_sag_m"] = {solution.sag_m.x(), solution.sag_m.y()};
}

void print(Context& context, const TargetSpec& target, const solve::Solution& solution,
           const assess::Assessment& assessment) {
  context.print(assessment.summary + "\n");
  for (const std::string& reason : assessment.reasons) {
    context.print("  " + reason + "\n");
  }
  for (const std::string& advice : assessment.advice) {
    context.print("  -> " + advice + "\n");
  }
  context.print("\n");
  if (target.kind == TargetKind::kCharuco) {
    context.print(fmt::format("board layout     {} (found out)\n", layout_name(target.layout)));
  }
  for (std::size_t d = 0; d < solution.devices.size(); ++d) {
    const calib::model::Camera& camera = solution.rig.devices[d].camera;
    const assess::DeviceAssessment& device = assessment.devices[d];
    context.print(
        fmt::format("{:<16} {:.3f} px RMS, {} of {} corners; {} f {:.2f} +- {:.2f} px, centre ({:.1f}, {:.1f}) +- "
                    "({:.1f}, {:.1f}) px\n",
                    device.name, solution.devices[d].rms_px, solution.devices[d].corners_kept,
                    solution.devices[d].corners_seen, calib::model::to_string(camera.lens), camera.fx,
                    sigma_of(device, ".fx"), camera.cx, camera.cy, sigma_of(device, ".cx"), sigma_of(device, ".cy")));
    if (std::isfinite(device.odd_even_p95_px)) {
      context.print(fmt::format("{:<16} odd against even views: {:.2f} px median, {:.2f} px (95 %)\n", "",
                                device.odd_even_median_px, device.odd_even_p95_px));
    }
  }
  if (solution.rig.devices.size() > 1) {
    context.print(fmt::format("{:<16} {:.3f} px RMS, baseline {:.3f} mm\n", "together", solution.rms_px,
                              1e3 * solution.rig.devices[1].T_device_rig.t.norm()));
  }
  const assess::CrossValidation& cross = assessment.cross_validation;
  context.print(fmt::format("held-out corners {:.3f} px RMS, {:.3f} px (95 %), {} folds\n", cross.rms_px, cross.p95_px,
                            cross.folds));
  context.print(
      fmt::format("every corner     {:.3f} px RMS, those left out included; {:.3f} px in a plain fit to all\n",
                  solution.all_corners_rms_px, solution.plain_fit_rms_px));
  if (!solution.pixels.empty()) {
    context.print(fmt::format("single pixels    {:.3f} px RMS on the panel; poses left out {:.3f} px\n",
                              solution.pixel_rms_px, cross.leave_one_out_px));
  }
  for (const solve::ViewFit& view : solution.views) {
    if (!view.used) {
      context.print(
          fmt::format("left out         view '{}' [{}]: {}\n", view.name, to_string(view.why), view.why_note));
    }
  }
}

/// How far a rig that was rendered is from its truth; nothing for a session that was not rendered.
Result<std::optional<pretend::RigError>> truth_error(const std::string& session, const calib::model::Rig& rig) {
  const auto truth = pretend::truth_beside(session);
  if (!truth) {
    return truth.error();
  }
  return *truth ? pretend::rig_error(rig, (*truth)->rig) : std::optional<pretend::RigError>();
}

void add_truth(Context& context, const pretend::RigError& error) {
  context.json()["truth"] = {{"focal_relative", error.focal},
                             {"principal_point_px", error.centre_px},
                             {"baseline_m", error.baseline_m},
                             {"chi_square", error.chi_square},
                             {"degrees_of_freedom", error.degrees_of_freedom}};
  context.print(fmt::format(
      "error against the truth: focal length {:.3f} %, principal point {:.2f} px, baseline {:.3f} mm; chi-square "
      "{:.1f} "
      "for {} parameters\n",
      100 * error.focal, error.centre_px, 1e3 * error.baseline_m, error.chi_square, error.degrees_of_freedom));
}

}  // namespace

Status set_lens(std::string_view text, solve::SolveOptions& options) {
  if (text.empty() || text == "auto") {
    return ok();
  }
  options.lens = calib::model::lens_from_string(text);
  if (!options.lens) {
    return fail(RCode::kUsage, "--lens is auto, bc4, bc5 or bc8, not '" + std::string(text) + "'");
  }
  return ok();
}

Result<ExitCode> calibrate(Context& context, const calibrate::Gathered& gathered, CalibrateInput input) {
  const auto previous = previous_rig(context, input.previous);
  if (!previous) {
    return previous.error();
  }
  const TargetSpec& target = gathered.observations.target;
  const Tick solving = context.stage("solving");
  input.options.progress = [&](std::string_view, double done) { solving(done); };
  auto solution = solve::solve(gathered.observations, input.options);
  if (!solution) {
    return std::move(solution).error();
  }
  calibrate::explain_missed(gathered.missed, *solution);
  RAYSTEER_TRY(Context::poll());

  const Tick judging = context.stage("cross-validating");
  assess::AssessOptions options;
  options.previous = previous->has_value() ? &**previous : nullptr;
  options.progress = [&](std::string_view, double done) { judging(done); };
  const auto assessment = assess::assess(gathered.observations, *solution, options);
  if (!assessment) {
    return assessment.error();
  }
  RAYSTEER_TRY(Context::poll());

  std::string id = exchange::calibration_id(solution->rig);
  if (context.has_out()) {
    const auto written =
        exchange::write_calibration(context.out(), solution->rig, meta_of(input, target, *solution, *assessment));
    if (!written) {
      return written.error();
    }
    id = *written;
  }
  const report::CalibrationResult result =
      report::calibration_result(*solution, *assessment, target, input.session, id);
  if (context.has_out()) {
    RAYSTEER_TRY(report::write_result(context.out(), result));
  }
  context.json() = report::summary_json(result);
  add_details(context.json(), target, *solution, *assessment);
  print(context, target, *solution, *assessment);
  const auto truth = truth_error(input.session, solution->rig);
  if (!truth) {
    return truth.error();
  }
  if (*truth) {
    add_truth(context, **truth);
  }
  return assessment->verdict == assess::Verdict::kRedo ? ExitCode::kVerdictRedo : ExitCode::kDone;
}

}  // namespace raysteer::host::cli
