// raysteer scan: a session and a calibration become a point cloud.
#include "host/scan/scan.hpp"

#include <fmt/core.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/scene/normals.hpp"
#include "calib/scene/row_match.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/scan_result.hpp"
#include "host/cli/scan_rig.hpp"
#include "host/exchange/calibration_file.hpp"
#include "host/exchange/ply.hpp"
#include "host/exchange/write_file.hpp"
#include "host/pretend/truth_file.hpp"
#include "host/report/picture.hpp"
#include "host/session/session.hpp"

namespace raysteer::host::cli {
namespace {

using session::Session;

std::vector<exchange::PlyPoint> ply_points(const scan::Scan& scan) {
  const std::vector<Eigen::Vector3f> normals = calib::scene::normals(scan.cloud.points, scan.matches.measured);
  std::vector<exchange::PlyPoint> points;
  points.reserve(normals.size());
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  for (std::size_t k = 0; k < normals.size(); ++k) {
    const calib::scene::CloudPoint& point = scan.cloud.points[k];
    const Eigen::Vector3f p = point.p.cast<float>();
    exchange::PlyPoint out{p.x(), p.y(), p.z(), normals[k].x(), normals[k].y(), normals[k].z()};
    eigen.computeDirect(point.covariance, Eigen::EigenvaluesOnly);
    out.sigma = static_cast<float>(std::sqrt(std::max(0.0, eigen.eigenvalues()[2])));
    const Eigen::Vector2i q = scan.matches.measured[point.match].q_left.array().round().cast<int>();
    out.grey = scan.white.view().contains(q.x(), q.y()) ? scan.white(q.x(), q.y()) : 200;
    points.push_back(out);
  }
  return points;
}

/// The cloud against the surfaces it was rendered from; nothing for a session that was not rendered.
Result<std::optional<pretend::SurfaceError>> truth_error(const scan::Scan& scan, const calib::model::Rig& rig,
                                                         const std::string& session_file) {
  const Result<std::optional<pretend::TruthFile>> truth = pretend::truth_beside(session_file);
  if (!truth) {
    return truth.error();
  }
  if (!*truth || !(*truth)->has_surfaces) {
    return std::optional<pretend::SurfaceError>();
  }
  const calib::model::Pose T_rig_left = rig.devices[scan.devices.left].T_device_rig.inverse();
  std::vector<Eigen::Vector3d> points;
  points.reserve(scan.cloud.points.size());
  for (const calib::scene::CloudPoint& point : scan.cloud.points) {
    points.push_back(T_rig_left * point.p);
  }
  return std::optional(pretend::surface_error(**truth, points));
}

std::string picture(const scan::Scan& scan, const PatternSequence& sequence) {
  std::vector<report::PanelPoint> points;
  points.reserve(scan.cloud.points.size());
  for (const calib::scene::CloudPoint& point : scan.cloud.points) {
    const calib::scene::Match& match = scan.matches.measured[point.match];
    const Eigen::Vector3f p = point.p.cast<float>();
    points.push_back({match.i, match.j, p.x(), p.y(), p.z()});
  }
  return report::cloud_picture(points, sequence.panel_width, sequence.panel_height);
}

class Scan : public Command {
 public:
  Manual manual() const override {
    return {
        .summary = "Make a point cloud from a session",
        .description =
            "Takes two calibrated cameras, or one and a calibrated projector. Says by how much the cameras disagree "
            "and whether they moved since they were calibrated; --refit-pose then solves their relative pose again "
            "from half of the matches and reports on the other half. The length of the baseline is kept.\n\n"
            "With --out DIR: cloud.ply (metres, left camera's frame), result.json and report.html.\n\n"
            "--rectified needs no calibration: the views of a rectified pair are matched along their rows, and "
            "disparities are judged in pixels.\n\n"
            "--rig takes the calibration of a steered rig, and all looks of the session: they become one surface, and "
            "where looks overlap it says by how many millimetres they differ. With --out DIR: surface.ply, a mesh that "
            "'raysteer bake --surface' puts pictures on.",
        .example =
            "raysteer scan scene.toml --calibration calibration.toml --out scan\n"
            "raysteer scan scene.toml --calibration calibration.toml --refit-pose --json\n"
            "raysteer scan figurine.toml --rectified\n"
            "raysteer scan looks --rig rig --out surface\n"
            "raysteer scan looks --rig rig --without look-3 --json",
        .out = TakesOut::kOptional,
        .takes_frames = true};
  }

  void declare(Options& options) override {
    options.argument("SESSION", &session_, "session file").required();
    options.option("--calibration", "FILE", &calibration_, "calibration to scan with, or its folder");
    options.flag("--refit-pose", refit_pose_, "solve the cameras' relative pose again from this scan");
    options.flag("--rectified", rectified_, "no calibration: match the rows of a rectified pair");
    options.option("--rig", "FILE", &rig_, "calibration of a steered rig, or its folder: all looks, one surface");
    options.option("--look", "NAME", &look_, "which look of the session [the first; with --rig all]");
    options.option("--without", "NAME", &without_, "with --rig: leave this look out; may be given again");
  }

  Result<ExitCode> run(Context& context) override {
    if (int{!calibration_.empty()} + int{!rig_.empty()} + int{rectified_} != 1) {
      return fail(
          RCode::kUsage,
          "raysteer scan: give --calibration FILE, --rig FILE for a steered rig, or --rectified for a rectified "
          "pair");
    }
    if (!rig_.empty() && refit_pose_) {
      return fail(RCode::kUsage, "raysteer scan: --refit-pose goes with --calibration; a rig is calibrated as a whole");
    }
    if (rig_.empty() && !without_.empty()) {
      return fail(RCode::kUsage, "raysteer scan: --without needs --rig FILE");
    }
    if (rectified_ && refit_pose_) {
      return fail(RCode::kUsage, "raysteer scan: --refit-pose needs --calibration FILE");
    }
    const Result<Session> session = Session::open(session_, context.frames_root());
    if (!session) {
      return session.error();
    }
    if (!rig_.empty()) {
      const auto named = [](const std::string& name) {
        return name.empty() ? std::vector<std::string>() : std::vector{name};
      };
      return scan_rig(context, *session,
                      {.session = session_, .rig = rig_, .looks = named(look_), .without = without_});
    }
    int look = 0;
    if (!look_.empty()) {
      const std::optional<int> number = session->look_number(look_);
      if (!number) {
        return fail(RCode::kUsage, "raysteer scan: " + session_ + " has no look '" + look_ + "'");
      }
      look = *number;
    }
    return rectified_ ? run_rectified(context, *session, look) : run_calibrated(context, *session, look);
  }

 private:
  Result<ExitCode> run_calibrated(Context& context, const Session& session, int look) const {
    const Result<exchange::Calibration> calibration = exchange::read_calibration(calibration_);
    if (!calibration) {
      return calibration.error();
    }
    scan::ScanOptions options;
    options.refit_pose = refit_pose_;
    const Result<scan::Scan> scan = scan::scan(session, look, calibration->rig, options,
                                               [&](std::string name) { return context.stage(std::move(name)); });
    if (!scan) {
      return scan.error();
    }
    const std::vector<calib::model::Device>& devices = calibration->rig.devices;
    const ScanNames names{session_, calibration_, calibration->id, devices[scan->devices.left].name,
                          devices[scan->devices.right].name};
    report::ScanResult result = scan_result(*scan, names);
    const Result<std::optional<pretend::SurfaceError>> truth = truth_error(*scan, calibration->rig, session_);
    if (!truth) {
      return truth.error();
    }
    if (*truth) {
      result.facts.push_back({"distance from the true surface, RMS / 95 %",
                              fmt::format("{:.3f} / {:.3f} mm", 1e3 * (*truth)->rms_m, 1e3 * (*truth)->p95_m)});
    }
    if (scan->moved()) {
      context.note(fmt::format("warning[{}]: {}", to_string(RCode::kPoseMoved), moved_sentence(*scan, names)));
    }
    if (context.has_out()) {
      const Tick tick = context.stage("writing");
      RAYSTEER_TRY(exchange::write_file(context.out() / "cloud.ply", exchange::to_ply(ply_points(*scan))));
      RAYSTEER_TRY(exchange::write_file(context.out() / "cloud.png", picture(*scan, session.manifest().sequence)));
      result.picture = "cloud.png";
      RAYSTEER_TRY(report::write_result(context.out(), result));
    }
    context.json() = report::summary_json(result);
    add_scan_details(context.json(), *scan);
    if (*truth) {
      context.json()["truth"] = {{"surface_rms_m", (*truth)->rms_m}, {"surface_p95_m", (*truth)->p95_m}};
    }
    print(context, result);
    return result.judgement.verdict == "redo" ? ExitCode::kVerdictRedo : ExitCode::kDone;
  }

  static void print(Context& context, const report::ScanResult& result) {
    context.print(fmt::format("{}: {}\n", result.judgement.verdict, result.judgement.summary));
    for (const std::string& reason : result.judgement.reasons) {
      context.print("  " + reason + "\n");
    }
    for (const std::string& advice : result.judgement.advice) {
      context.print("  -> " + advice + "\n");
    }
    context.print(fmt::format("\npoints                    {}\n", result.points));
    context.print(fmt::format("matched projector pixels  {} (and {} between neighbours, not used)\n",
                              result.matched_projector_pixels, result.interpolated_projector_pixels));
    context.print(fmt::format("epipolar disagreement     {:.3f} px; {:.3f} within a cell, {:.3f} systematic\n",
                              result.epipolar_sigma_px, result.epipolar_within_cell_px, result.epipolar_systematic_px));
    if (std::isfinite(result.held_out_after_px)) {
      context.print(fmt::format("  held out of a refit     {:.3f} px, {:.3f} px with the refitted pose\n",
                                result.held_out_before_px, result.held_out_after_px));
    }
    if (result.patches > 0) {
      context.print(fmt::format("wall in 10 mm patches     {:.3f} mm RMS ({:.3f} predicted, {} patches)\n",
                                1e3 * result.patch_rms_m, 1e3 * result.patch_predicted_rms_m, result.patches));
    }
    for (const report::Fact& fact : result.facts) {
      context.print(fmt::format("{}: {}\n", fact.name, fact.value));
    }
  }

  Result<ExitCode> run_rectified(Context& context, const Session& session, int look) const {
    if (session.cameras() != 2) {
      return fail(RCode::kCameraCount, fmt::format("{} camera(s); --rectified matches two", session.cameras()));
    }
    const Result<std::vector<scan::DecodedLook>> looks =
        scan::decode_cameras(session, look, {}, context.stage("decoding"));
    if (!looks) {
      return looks.error();
    }
    const calib::decode::CodeMap& left = (*looks)[0].codes;
    const calib::decode::CodeMap& right = (*looks)[1].codes;
    const Result<calib::scene::RowMatches> rows = calib::scene::match_rows(left, right);
    if (!rows) {
      return rows.error();
    }
    const auto share = [](const calib::decode::Diagnostics& d) {
      return static_cast<double>(d.valid) / static_cast<double>(d.pixels);
    };
    const double decoded = (share(left.diagnostics) + share(right.diagnostics)) / 2;
    const double order = std::fmax(left.diagnostics.order_residual_x, right.diagnostics.order_residual_x);
    const double partners = static_cast<double>(rows->matched) / static_cast<double>(rows->valid_left);

    report::ScanResult result;
    result.session = session_;
    result.judgement.verdict = partners < 0.5 ? "usable" : "good";
    result.judgement.summary =
        fmt::format("{} of {} decoded left pixels have a partner in their row, within {:.3f} px (95 %).", rows->matched,
                    rows->valid_left, rows->p95_px);
    if (partners < 0.5) {
      result.judgement.reasons.emplace_back("more than half of the left pixels have no partner in their row");
      result.judgement.advice.emplace_back(
          "Check that the pair is rectified and that left and right are not exchanged.");
    }
    result.decoded_fraction = decoded;
    result.facts = {
        {"partners in the row", fmt::format("{}", rows->matched)},
        {"disparity noise, 1.4826 MAD", fmt::format("{:.3f} px", rows->sigma_px)},
        {"disparity noise, 95 %", fmt::format("{:.3f} px", rows->p95_px)},
        {"95 % by row, median / worst row",
         fmt::format("{:.3f} / {:.3f} px of {} rows", rows->row_p95_median_px, rows->row_p95_worst_px, rows->rows)}};
    if (std::isfinite(order)) {
      result.facts.push_back({"order of the period off an integer, median", fmt::format("{:.3f} periods", order)});
    }
    if (context.has_out()) {
      RAYSTEER_TRY(report::write_result(context.out(), result));
    }
    Json& json = context.json();
    json = report::summary_json(result);
    json["decoded_fractions"] = {share(left.diagnostics), share(right.diagnostics)};
    json["coverage"] = {left.diagnostics.coverage, right.diagnostics.coverage};
    if (std::isfinite(order)) {
      json["order_residual_periods"] = order;
    }
    json["row_match"] = {{"matched", rows->matched},
                         {"decoded_left", rows->valid_left},
                         {"sigma_px", rows->sigma_px},
                         {"p95_px", rows->p95_px},
                         {"row_p95_median_px", rows->row_p95_median_px},
                         {"row_p95_worst_px", rows->row_p95_worst_px},
                         {"rows", rows->rows}};
    context.print(fmt::format("{}: {}\n\ndecoded: {:.2f} %\n", result.judgement.verdict, result.judgement.summary,
                              100 * decoded));
    for (const report::Fact& fact : result.facts) {
      context.print(fmt::format("{}: {}\n", fact.name, fact.value));
    }
    return ExitCode::kDone;
  }

  std::string session_;
  std::string calibration_;
  std::string rig_;
  std::string look_;
  std::vector<std::string> without_;
  bool refit_pose_ = false;
  bool rectified_ = false;
};

}  // namespace

std::unique_ptr<Command> scan() { return std::make_unique<Scan>(); }

}  // namespace raysteer::host::cli
