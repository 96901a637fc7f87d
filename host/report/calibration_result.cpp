#include "host/report/calibration_result.hpp"

#include <fmt/core.h>

#include <cmath>
#include <utility>

namespace raysteer::host::report {
namespace {

namespace assess = calib::assess;
namespace solve = calib::solve;

Grid to_grid(const assess::GridMap& map) { return {map.columns, map.rows, map.values}; }

DeviceResult device_result(const calib::model::Device& device, const solve::DeviceFit& fit) {
  DeviceResult result;
  result.name = device.name;
  result.kind = device.kind == calib::model::DeviceKind::kProjector ? "projector" : "camera";
  result.width = device.camera.width;
  result.height = device.camera.height;
  result.lens = calib::model::to_string(device.camera.lens);
  result.focal_px = (device.camera.fx + device.camera.fy) / 2;
  result.rms_px = fit.rms_px;
  result.corners_seen = fit.corners_seen;
  result.corners_kept = fit.corners_kept;
  for (const solve::Residual& residual : fit.residuals) {
    result.residuals.push_back(
        {residual.view, residual.q.x(), residual.q.y(), residual.error.x(), residual.error.y(), residual.kept});
  }
  return result;
}

void add_assessment(DeviceResult& result, const assess::DeviceAssessment& assessment) {
  for (const assess::Parameter& parameter : assessment.parameters) {
    result.parameters.push_back({parameter.name, parameter.value, parameter.sigma, parameter.unit});
  }
  result.coverage = to_grid(assessment.coverage.corners);
  if (!assessment.uncertainty.empty()) {
    result.uncertainty_px = to_grid(assessment.uncertainty.front().sigma_px);
    result.uncertainty_range_m = assessment.uncertainty.front().range_m;
  }
  result.odd_even_px = to_grid(assessment.odd_even_px);
  if (!result.odd_even_px.empty()) {
    result.odd_even_median_px = assessment.odd_even_median_px;
    result.odd_even_p95_px = assessment.odd_even_p95_px;
  }
}

ViewRow view_row(const solve::ViewFit& view) {
  ViewRow row;
  row.name = view.name;
  row.used = view.used;
  if (!view.used) {
    row.code = view.why == RCode::kNone ? std::string() : to_string(view.why);
    row.why = view.why_note.empty() ? std::string(explain(view.why).sentence) : view.why_note;
  }
  for (const double rms : view.rms_px) {
    row.rms_px.push_back(rms > 0 ? rms : kUnknown);
  }
  row.tilt_rad = view.tilt_rad;
  row.distance_m = view.distance_m > 0 ? view.distance_m : kUnknown;
  return row;
}

}  // namespace

std::string describe(const TargetSpec& target) {
  const double square_mm = 1000 * target.square_m;
  if (target.kind == TargetKind::kCharuco) {
    return fmt::format("ChArUco, {} x {} squares of {:g} mm, {}", target.columns, target.rows, square_mm,
                       target.dictionary);
  }
  return fmt::format("chessboard, {} x {} corners of {:g} mm", target.columns, target.rows, square_mm);
}

CalibrationResult calibration_result(const solve::Solution& solution, const assess::Assessment& assessment,
                                     const TargetSpec& target, std::string session, std::string calibration_id) {
  CalibrationResult result;
  result.judgement = {std::string(to_string(assessment.verdict)), assessment.summary, assessment.reasons,
                      assessment.advice};
  result.session = std::move(session);
  result.target = describe(target);
  result.calibration_id = std::move(calibration_id);
  result.rms_px = solution.rms_px;
  for (std::size_t i = 0; i < solution.rig.devices.size() && i < solution.devices.size(); ++i) {
    DeviceResult device = device_result(solution.rig.devices[i], solution.devices[i]);
    for (const assess::DeviceAssessment& assessed : assessment.devices) {
      if (assessed.name == device.name) {
        add_assessment(device, assessed);
      }
    }
    result.devices.push_back(std::move(device));
  }
  if (solution.rig.devices.size() >= 2) {
    result.baseline_m = solution.rig.devices[1].T_device_rig.t.norm();
  }
  const assess::CrossValidation& cross = assessment.cross_validation;
  result.folds = cross.folds;
  if (cross.folds > 0) {
    result.held_out_corners = cross.corners;
    result.held_out_rms_px = cross.rms_px;
    result.held_out_median_px = cross.median_px;
    result.held_out_p95_px = cross.p95_px;
  }
  if (cross.leave_one_out_px > 0) {
    result.leave_one_out_px = cross.leave_one_out_px;
  }
  if (!solution.pixels.empty()) {
    result.pixel_rms_px = solution.pixel_rms_px;
  }
  result.sag_m = {solution.sag_m.x(), solution.sag_m.y()};
  result.sag_sigma_m = {solution.sag_sigma_m.x(), solution.sag_sigma_m.y()};
  for (const solve::ViewFit& view : solution.views) {
    result.views.push_back(view_row(view));
  }
  for (const solve::LensTrial& trial : solution.lenses) {
    result.lenses.push_back({trial.device, std::string(calib::model::to_string(trial.lens)), trial.held_out_px,
                             trial.monotonic, trial.chosen});
  }
  result.correlated = assessment.correlated;
  for (const assess::Difference& difference : assessment.differences) {
    result.differences.push_back({difference.device, to_grid(difference.px), to_grid(difference.mm), difference.range_m,
                                  difference.median_px, difference.p95_px});
  }
  return result;
}

}  // namespace raysteer::host::report
