#include "host/cli/scan_result.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string_view>
#include <utility>

namespace raysteer::host::cli {
namespace {

using calib::scene::EpipolarCell;
using report::Fact;
using report::Histogram;

/// Beyond these the cloud is coarse, or useless: a pixel of noise is ten times what a sharp pair has.
constexpr double kCoarsePx = 0.5;
constexpr double kUselessPx = 1.0;
/// A refit that changes depths by more than this contradicts the calibration's lengths.
constexpr double kDepthChange = 0.01;

template <class Values, class Get>
Histogram histogram(const Values& values, double low, double high, const Get& get) {
  constexpr int kBins = 64;
  Histogram bins{low, high, std::vector<std::int64_t>(kBins)};
  for (const auto& value : values) {
    const double place = (get(value) - low) / (high - low) * kBins;
    if (place >= 0 && place < kBins) {
      ++bins.counts[static_cast<std::size_t>(place)];
    }
  }
  return bins;
}

report::Grid grid(const std::vector<EpipolarCell>& cells) {
  report::Grid grid;
  for (const EpipolarCell& cell : cells) {
    grid.columns = std::max(grid.columns, cell.column + 1);
    grid.rows = std::max(grid.rows, cell.row + 1);
  }
  grid.values.assign(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows), report::kUnknown);
  for (const EpipolarCell& cell : cells) {
    grid.values[static_cast<std::size_t>(cell.row) * static_cast<std::size_t>(grid.columns) +
                static_cast<std::size_t>(cell.column)] = cell.median_px;
  }
  return grid;
}

double mean(const std::vector<double>& values) {
  return std::reduce(values.begin(), values.end()) / static_cast<double>(values.size());
}

report::Judgement judge(const scan::Scan& scan, const ScanNames& names) {
  report::Judgement judgement;
  bool usable = false;
  bool redo = false;
  const auto object = [&](std::string reason, std::string advice) {
    judgement.reasons.push_back(std::move(reason));
    judgement.advice.push_back(std::move(advice));
    usable = true;
  };
  if (scan.moved()) {
    object(moved_sentence(scan, names) +
               (scan.refitted ? "; the cloud is made with the pose solved again"
                              : fmt::format("; it costs {:.2f} px of disagreement", scan.refit->effect_px)),
           scan.refitted ? "Calibrate the cameras again to trust lengths."
                         : "Scan with --refit-pose, or calibrate the cameras again.");
    redo = !scan.refitted && scan.refit->effect_px > kUselessPx;
  }
  if (scan.refitted && std::abs(scan.depth_ratio - 1) > kDepthChange) {
    object(fmt::format("the refitted pose changes depths by {:+.1f} %: lengths are no better known than that",
                       100 * (scan.depth_ratio - 1)),
           "Measure something of known length in the scene, or calibrate the cameras again.");
  }
  const double noise = scan.epipolar.within_cell_px;
  if (noise > kCoarsePx) {
    object(fmt::format("matches scatter by {:.2f} px", noise),
           "Focus cameras and projector, raise the exposure, keep the scene still.");
    redo = redo || noise > kUselessPx;
  }
  if (!scan.moved() && scan.epipolar.sigma_px > kUselessPx) {
    object(fmt::format("{} and {} disagree by {:.2f} px", names.left, names.right, scan.epipolar.sigma_px),
           "Use the calibration made with these cameras as they stand now.");
    redo = true;
  }
  const double kept = static_cast<double>(scan.cloud.points.size()) / static_cast<double>(scan.matches.measured.size());
  if (kept < 0.8) {
    object(fmt::format("only {:.0f} % of the matches became points", 100 * kept),
           "Look at the map of the disagreement: where it is large the calibration or the decoding is wrong.");
    redo = redo || kept < 0.5;
  }
  if (const double decoded = mean(scan.decoded_fraction); decoded < 0.05) {
    object(fmt::format("only {:.1f} % of the camera pixels show the projection", 100 * decoded),
           "Aim the cameras at the projection, or raise the exposure.");
  }
  judgement.verdict = redo ? "redo" : usable ? "usable" : "good";
  judgement.summary = fmt::format("{} points between {:.3f} and {:.3f} m; matches scatter by {:.2f} px.",
                                  scan.cloud.points.size(), scan.depth.p1_m, scan.depth.p99_m, noise);
  return judgement;
}

std::vector<Fact> facts(const scan::Scan& scan) {
  std::vector<Fact> list;
  for (std::size_t k = 0; k < scan.decoded_fraction.size(); ++k) {
    list.push_back(
        {fmt::format("camera {}: pixels decoded", k + 1), fmt::format("{:.1f} %", 100 * scan.decoded_fraction[k])});
  }
  list.push_back({"matches within 1.5 px", fmt::format("{}", scan.epipolar.within_1_5_px)});
  list.push_back(
      {"left out: epipolar / depth / isolated", fmt::format("{} / {} / {}", scan.cloud.rejected.epipolar,
                                                            scan.cloud.rejected.depth, scan.cloud.rejected.isolated)});
  list.push_back({"depth, 1st percentile / median / 99th",
                  fmt::format("{:.4f} / {:.4f} / {:.4f} m", scan.depth.p1_m, scan.depth.median_m, scan.depth.p99_m)});
  if (scan.plane) {
    list.push_back(
        {"largest plane", fmt::format("{} points, {:.2f} mm RMS", scan.plane->inliers, 1e3 * scan.plane->rms_m)});
  }
  if (scan.refitted) {
    list.push_back({"depth with the refitted pose", fmt::format("{:+.2f} %", 100 * (scan.depth_ratio - 1))});
  }
  return list;
}

Json vector_json(const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

}  // namespace

std::string moved_sentence(const scan::Scan& scan, const ScanNames& names) {
  return fmt::format("{} and {} moved by {:.2f} mrad since calibration (one sigma {:.2f} mrad)", names.left,
                     names.right, 1e3 * scan.refit->moved_rad, 1e3 * scan.refit->moved_sigma_rad);
}

report::ScanResult scan_result(const scan::Scan& scan, const ScanNames& names) {
  report::ScanResult result;
  result.judgement = judge(scan, names);
  result.session = names.session;
  result.calibration = names.calibration;
  result.calibration_id = names.calibration_id;
  result.points = std::ssize(scan.cloud.points);
  result.matched_projector_pixels = std::ssize(scan.matches.measured);
  result.interpolated_projector_pixels = static_cast<std::int64_t>(scan.matches.interpolated);
  result.decoded_fraction = mean(scan.decoded_fraction);
  result.epipolar_sigma_px = scan.epipolar.sigma_px;
  result.epipolar_within_cell_px = scan.epipolar.within_cell_px;
  result.epipolar_systematic_px = scan.epipolar.systematic_px;
  result.epipolar_cells_px = grid(scan.epipolar.cells);
  result.epipolar_histogram = histogram(scan.disagreement, -2, 2, [](double d) { return d; });
  result.depth_histogram = histogram(scan.cloud.points, scan.depth.p1_m, scan.depth.p99_m,
                                     [](const calib::scene::CloudPoint& point) { return point.p.z(); });
  if (scan.flatness) {
    result.patch_rms_m = scan.flatness->patch_rms_m;
    result.patch_predicted_rms_m = scan.flatness->predicted_rms_m;
    result.patches = static_cast<std::int64_t>(scan.flatness->patches);
  }
  if (scan.refit) {
    result.pose_moved_rad = scan.refit->moved_rad;
    result.pose_moved_sigma_rad = scan.refit->moved_sigma_rad;
    result.pose_moved = scan.refit->moved;
    result.held_out_before_px = scan.refit->held_out_before_px;
    result.held_out_after_px = scan.refit->held_out_after_px;
  }
  result.pose_refitted = scan.refitted;
  result.facts = facts(scan);
  return result;
}

void add_scan_details(Json& json, const scan::Scan& scan) {
  json["decoded_fractions"] = scan.decoded_fraction;
  json["depth"] = {{"p1_m", scan.depth.p1_m}, {"median_m", scan.depth.median_m}, {"p99_m", scan.depth.p99_m}};
  json["rejected"] = {{"epipolar", scan.cloud.rejected.epipolar},
                      {"depth", scan.cloud.rejected.depth},
                      {"isolated", scan.cloud.rejected.isolated}};
  json["epipolar"]["within_1_5_px"] = scan.epipolar.within_1_5_px;
  if (scan.plane) {
    json["plane"] = {{"normal", vector_json(scan.plane->normal)},
                     {"distance_m", scan.plane->distance_m},
                     {"distance_sigma_m", std::sqrt(scan.plane->covariance(2, 2))},
                     {"tilt_sigma_rad", std::sqrt(scan.plane->covariance.diagonal().head<2>().maxCoeff())},
                     {"rms_m", scan.plane->rms_m},
                     {"points", scan.plane->inliers}};
  }
  if (scan.refit) {
    const calib::scene::PoseRefit& refit = *scan.refit;
    const Eigen::AngleAxisd turn(refit.T_right_left.q);
    json["refit"] = {{"used", scan.refitted},
                     {"moved_rad", refit.moved_rad},
                     {"moved_sigma_rad", refit.moved_sigma_rad},
                     {"baseline_turned_rad", refit.baseline_turned_rad},
                     {"chi_square", refit.chi_square},
                     {"effect_px", refit.effect_px},
                     {"fitted", refit.fitted},
                     {"held_out", refit.held_out},
                     {"held_out_before_px", refit.held_out_before_px},
                     {"held_out_after_px", refit.held_out_after_px},
                     {"depth_ratio", scan.depth_ratio},
                     {"rotation_rad", vector_json(turn.angle() * turn.axis())},
                     {"translation_m", vector_json(refit.T_right_left.t)}};
  }
}

}  // namespace raysteer::host::cli
