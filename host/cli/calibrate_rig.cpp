// raysteer calibrate rig: looks of a steered projector become one model that predicts every other look.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "calib/steer/evaluate.hpp"
#include "calib/steer/solve.hpp"
#include "calib/steer/without_board.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/rig_result.hpp"
#include "host/exchange/calibration_file.hpp"
#include "host/exchange/rig_file.hpp"
#include "host/exchange/write_file.hpp"
#include "host/pretend/truth_file.hpp"
#include "host/rig/drawing.hpp"
#include "host/rig/gather.hpp"
#include "host/rig/known_length.hpp"
#include "host/rig/known_plane.hpp"
#include "host/rig/read_files.hpp"
#include "host/rig/room.hpp"
#include "host/rig/stations.hpp"
#include "host/rig/truth_error.hpp"
#include "host/session/session.hpp"

namespace raysteer::host::cli {
namespace {

using calib::steer::Evaluation;
using calib::steer::Look;
using calib::steer::Solution;

/// Instead of a calibration of the cameras.
constexpr std::string_view kDrawn = "drawn";
/// Looks of this name are never solved with, but predicted.
constexpr std::string_view kCheck = "check";
/// Without any such look, every so manieth is taken.
constexpr std::size_t kEvery = 4;

// docs/decisions/0005: what a look that was not calibrated may miss by, 95 %, on the surface.
constexpr double kGoodMm = 1;
constexpr double kUsableMm = 2.5;

/// The rig stands still: so many looks at its datums are enough.
constexpr int kDatumLooks = 8;

struct Parts {
  std::vector<Look> solved;
  std::vector<Look> held_out;
};

Parts split(std::vector<Look> looks) {
  const auto is_check = [](const Look& look) { return look.name.starts_with(kCheck); };
  const bool named = std::ranges::any_of(looks, is_check);
  Parts parts;
  for (std::size_t k = 0; k < looks.size(); ++k) {
    const bool held_out = named ? is_check(looks[k]) : k % kEvery == kEvery - 1;
    (held_out ? parts.held_out : parts.solved).push_back(std::move(looks[k]));
  }
  return parts;
}

Json accuracy(double median_px, double p95_px, double median_mm, double p95_mm) {
  return {{"median_px", median_px}, {"p95_px", p95_px}, {"median_mm", median_mm}, {"p95_mm", p95_mm}};
}

class CalibrateRig : public Command {
 public:
  Manual manual() const override {
    return {
        .summary = "Calibrate projector and steered mirror from some looks",
        .description =
            "Decodes every look of the session, and solves cameras, projector and mirror as one model that "
            "predicts every other look. The start and how far a part may be off come from the board file. With "
            "'--cameras drawn' the cameras come from there too: no board was ever shown, but the looks must see "
            "depth, and how long a metre is must come from --length or --baseline. Looks whose names begin with "
            "'check' are never solved with but predicted, and what they are missed by is the accuracy stated; "
            "without such looks every fourth is taken.\n\n"
            "With --previous, and when --out replaces an earlier calibration, says by how many millimetres the light "
            "moved since, and whether the rig as a whole did or something inside it.\n\n"
            "With --out DIR: rig.toml (docs/rig-format.md), result.json and report.html.",
        .example =
            "raysteer calibrate rig looks --cameras cameras --board mock-galvo --out rig\n"
            "raysteer calibrate rig looks --cameras cameras --board mock-head --survey hall --json\n"
            "raysteer calibrate rig looks --cameras drawn --length 3-7=2.514 --board mock-galvo --out rig",
        .out = TakesOut::kOptional,
        .takes_frames = true};
  }

  void declare(Options& options) override {
    options.argument("SESSION", &session_, "session file or its folder").required();
    options
        .option("--cameras", "FILE", &cameras_,
                "calibration of the cameras, or its folder; 'drawn': none, cameras are solved too")
        .required();
    options.option("--board", "FILE", &board_, "board file, or an installed one's name: how the rig is drawn")
        .required();
    options.option("--baseline", "METRES", &baseline_, "with '--cameras drawn': measured from lens to lens");
    options.option("--length", "A-B=METRES", &length_,
                   "with '--cameras drawn': measured between the datums coded A and B");
    options.option("--plane", "LOOK", &plane_,
                   "look in which the session's board lies on the plane that all light "
                   "falls on; looks that one eye sees count then too");
    options.option("--survey", "FILE", &survey_, "where the room's datums are, or an installed survey's name");
    options.option("--previous", "FILE", &previous_, "earlier calibration of this rig, or its folder, to compare with");
    options.option("--stations", "FILE", &stations_, "stations whose bounds are wanted, or an installed file's name");
  }

  Result<ExitCode> run(Context& context) override {
    const auto session = session::Session::open(session_, context.frames_root());
    RAYSTEER_TRY(session);
    const auto board = rig::read_board(board_);
    RAYSTEER_TRY(board);
    const auto drawing = rig::drawing_of(*board);
    RAYSTEER_TRY(drawing);
    const auto length = known_length();
    RAYSTEER_TRY(length);
    const auto cameras = this->cameras(*board);
    RAYSTEER_TRY(cameras);
    const auto surveyed = see_room(context, *session);
    RAYSTEER_TRY(surveyed);
    const auto options = gather_options(context, *session, *cameras);
    RAYSTEER_TRY(options);
    auto gathered = rig::gather(*session, *cameras, *options, context.stage("decoding looks"));
    RAYSTEER_TRY(gathered);
    for (const rig::MissedLook& missed : gathered->missed) {
      context.note(fmt::format("look '{}' left out [{}]: {}", missed.name, to_string(missed.error.rcode),
                               missed.error.message()));
    }
    context.json()["one_eyed_looks"] = gathered->one_eyed.size();
    for (const std::string& name : gathered->one_eyed) {
      context.note(fmt::format("look '{}': seen by one eye, placed on the plane of look '{}'", name, plane_));
    }
    Parts parts = split(std::move(gathered->observations.looks));
    gathered->observations.looks = std::move(parts.solved);
    const auto known = found(context, *session, *length);
    RAYSTEER_TRY(known);
    const auto solving = context.stage("solving");
    const auto solution = is_drawn() ? calib::steer::solve_without_board(gathered->observations, *drawing, *known)
                                     : calib::steer::solve(gathered->observations, *drawing);
    RAYSTEER_TRY(solution);
    const double drawn_rad = drawing->tolerance.repeatability_rad;
    if (!gathered->one_eyed.empty() && solution->repeatability_rad > calib::steer::kMostScatter * drawn_rad) {
      return fail(
          RCode::kRigNotSolved,
          fmt::format("the mirror would repeat to {:.0f} urad, drawn are {:.0f}: does all light of the looks that "
                      "one eye saw fall on the plane of look '{}'?",
                      1e6 * solution->repeatability_rad, 1e6 * drawn_rad, plane_));
    }
    RAYSTEER_TRY(Context::poll());
    const auto evaluation = calib::steer::evaluate(*solution, parts.held_out);
    RAYSTEER_TRY(evaluation);
    std::optional<rig::InRoom> room;
    if (*surveyed) {
      auto tied = rig::tie_to_room(*solution, (*surveyed)->survey, (*surveyed)->views);
      RAYSTEER_TRY(tied);
      room = *std::move(tied);
    }
    const auto truth = pretend::truth_beside(session->file());
    RAYSTEER_TRY(truth);
    std::optional<rig::TruthError> error;
    if (*truth && (*truth)->projector) {
      auto found = rig::truth_error(*solution, **truth, parts.held_out);
      RAYSTEER_TRY(found);
      error = *found;
    }
    const std::string verdict = evaluation->p95_mm <= kGoodMm     ? "good"
                                : evaluation->p95_mm <= kUsableMm ? "usable"
                                                                  : "redo";
    const auto stated = room ? std::optional(tie_of(*room)) : std::nullopt;
    const auto& final_solution = room ? room->rig.solution : *solution;
    const PlacedRig now = placed(*solution, room, exchange::rig_id(final_solution, stated));
    const auto aimed = aim(now);
    RAYSTEER_TRY(aimed);
    report::RigResult result;
    result.session = session_;
    result.board = board_;
    result.judgement = judge(verdict, *evaluation, *solution, room.has_value());
    add_reach(result, now);
    add_solution(result, now, *solution, *evaluation, parts.held_out);
    if (room) {
      add_datums(result, room->tie, (*surveyed)->survey);
    }
    add_stations(result, *aimed);
    const auto before = earlier(context);
    RAYSTEER_TRY(before);
    if (*before) {
      RAYSTEER_TRY(add_difference(result, now, **before, *aimed));
    }
    report(context, *solution, *evaluation, error, verdict);
    report_cameras(context, *solution, *truth ? &(*truth)->rig : nullptr);
    report_room(context, room);
    report_reach(context, result);
    print_difference(context, result);
    if (context.has_out()) {
      const exchange::RigMeta meta{.session = session_,
                                   .board = board_,
                                   .verdict = verdict,
                                   .whitened_rms = solution->whitened_rms,
                                   .held_out_median_px = evaluation->median_px,
                                   .held_out_p95_px = evaluation->p95_px,
                                   .held_out_median_mm = evaluation->median_mm,
                                   .held_out_p95_mm = evaluation->p95_mm,
                                   .looks = static_cast<int>(solution->looks.size()),
                                   .survey = *surveyed ? (*surveyed)->survey.name : "",
                                   .survey_id = *surveyed ? (*surveyed)->id : ""};
      RAYSTEER_TRY(exchange::write_file(context.out() / "rig.toml", exchange::to_toml(final_solution, stated, meta)));
      RAYSTEER_TRY(report::write_result(context.out(), result, context.json()));
    }
    return verdict == "redo" ? ExitCode::kVerdictRedo : ExitCode::kDone;
  }

 private:
  /// The room's survey, and where the session's looks show its datums.
  struct Surveyed {
    proto::survey::Survey survey;
    std::string id;
    std::vector<calib::datum::View> views;
  };

  /// No value without --survey. Before anything is decoded, so that a rig that moved is named at once.
  Result<std::optional<Surveyed>> see_room(Context& context, const session::Session& session) const {
    if (survey_.empty()) {
      return std::optional<Surveyed>();
    }
    auto survey = rig::read_survey(survey_);
    RAYSTEER_TRY(survey);
    auto id = rig::survey_id(survey_);
    RAYSTEER_TRY(id);
    auto views = rig::see_datums(session, kDatumLooks, context.stage("finding datums"));
    RAYSTEER_TRY(views);
    return std::optional(Surveyed{*std::move(survey), *std::move(id), *std::move(views)});
  }

  /// Nobody gave the cameras' calibration.
  bool is_drawn() const { return cameras_ == kDrawn; }

  Result<calib::model::Rig> cameras(const proto::board::Board& board) const {
    if (is_drawn()) {
      return rig::cameras_of(board);
    }
    auto file = exchange::read_calibration(cameras_);
    RAYSTEER_TRY(file);
    return std::move(file->rig);
  }

  Result<rig::GatherOptions> gather_options(Context& context, const session::Session& session,
                                            const calib::model::Rig& cameras) const {
    rig::GatherOptions options;
    options.cameras_drawn = is_drawn();
    if (plane_.empty()) {
      return options;
    }
    if (is_drawn()) {
      return fail(RCode::kUsage, "--plane takes calibrated cameras: a board's pose cannot be told from drawn ones");
    }
    auto plane = rig::find_plane(session, cameras, plane_, context.stage("finding the plane"));
    RAYSTEER_TRY(plane);
    options.plane = *plane;
    options.plane_look = plane_;
    return options;
  }

  /// What --baseline or --length says; no value without them.
  Result<std::optional<rig::MeasuredLength>> known_length() const {
    if (baseline_.empty() && length_.empty()) {
      return std::optional<rig::MeasuredLength>();
    }
    if (!is_drawn() || (!baseline_.empty() && !length_.empty())) {
      return fail(RCode::kUsage,
                  "expected one of --baseline and --length, and only with '--cameras drawn': calibrated "
                  "cameras know how long a metre is");
    }
    const auto length = length_.empty() ? rig::read_baseline(baseline_) : rig::read_length(length_);
    RAYSTEER_TRY(length);
    return std::optional(*length);
  }

  /// The same, with its ends found in the session.
  Result<std::optional<calib::steer::KnownLength>> found(Context& context, const session::Session& session,
                                                         const std::optional<rig::MeasuredLength>& length) const {
    if (!length) {
      return std::optional<calib::steer::KnownLength>();
    }
    auto known = rig::find_length(session, *length, kDatumLooks, context.stage("finding the known length"));
    RAYSTEER_TRY(known);
    return std::optional(*std::move(known));
  }

  /// Stations that were asked for.
  Result<std::vector<rig::AimedStation>> aim(const PlacedRig& now) const {
    if (stations_.empty()) {
      return std::vector<rig::AimedStation>();
    }
    if (!now.tied) {
      return fail(RCode::kDatumsMissing, "stations are places in a room; --stations needs --survey");
    }
    const auto wanted = rig::read_stations(stations_);
    RAYSTEER_TRY(wanted);
    return rig::aim_stations(now.rig, *wanted);
  }

  /// The calibration to compare with: the one named, else the one that --out replaces, where there is one.
  Result<std::optional<PlacedRig>> earlier(Context& context) const {
    if (!previous_.empty()) {
      const auto read = exchange::read_rig(previous_);
      RAYSTEER_TRY(read);
      return std::optional(placed(*read));
    }
    const auto replaced = context.previous_out();
    std::error_code ignored;
    if (!replaced || !std::filesystem::exists(*replaced / "rig.toml", ignored)) {
      return std::optional<PlacedRig>();
    }
    const auto read = exchange::read_rig(*replaced);
    if (!read) {
      context.note("no comparison with the calibration that is replaced: " + read.error().message());
      return std::optional<PlacedRig>();
    }
    return std::optional(placed(*read));
  }

  static report::Judgement judge(const std::string& verdict, const Evaluation& evaluation, const Solution& solution,
                                 bool tied) {
    report::Judgement judgement{.verdict = verdict,
                                .summary = fmt::format("Looks that were not calibrated are hit within {:.2f} mm "
                                                       "({:.2f} px), 95 %.",
                                                       evaluation.p95_mm, evaluation.p95_px),
                                .reasons = {},
                                .advice = {}};
    if (!tied) {
      judgement.reasons.push_back("The rig is consistent with itself, but not tied to the room.");
      judgement.advice.push_back("Survey four datums or more, and give --survey.");
    }
    if (verdict != "good") {
      judgement.reasons.push_back(fmt::format("{:.1f} mm are asked for, 95 %.", kGoodMm));
      judgement.advice.push_back("Take the looks that 'raysteer plan looks' chooses, with the mirror warmed up.");
    }
    if (!solution.off_drawing.empty()) {
      judgement.reasons.push_back(fmt::format("{} numbers are further from the board file than its tolerances explain.",
                                              solution.off_drawing.size()));
      judgement.advice.push_back("Measure those parts and correct the board file: the next calibration starts nearer.");
    }
    return judgement;
  }

  static void report_reach(Context& context, const report::RigResult& result) {
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

  static exchange::RoomTie tie_of(const rig::InRoom& room) {
    return exchange::room_tie(room.rig, static_cast<int>(room.tie.misses.size()),
                              room.tie.scale ? room.tie.scale->value : 1);
  }

  static void report_room(Context& context, const std::optional<rig::InRoom>& room) {
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
      context.print(fmt::format(
          "scale            {:.1f} of 1000.0 mm by {} (+- {:.1f})\n", 1000 * room->tie.scale->value,
          room->tie.scale->by_lengths ? "known lengths" : "surveyed places", 1000 * room->tie.scale->sigma));
    }
  }

  static void report(Context& context, const Solution& solution, const Evaluation& evaluation,
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
    context.print(fmt::format("{}: looks that were not calibrated are hit within {:.2f} mm ({:.2f} px), 95 %\n",
                              verdict, evaluation.p95_mm, evaluation.p95_px));
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

  /// What the cameras came out as, where they were not given.
  void report_cameras(Context& context, const Solution& solution, const calib::model::Rig* truth) const {
    Json& json = context.json();
    json["cameras"]["drawn"] = is_drawn();
    if (!is_drawn()) {
      return;
    }
    double sigma = 0;
    double error = 0;
    for (std::size_t i = 0; i < solution.cameras.devices.size(); ++i) {
      const double f = solution.cameras.devices[i].camera.fx;
      const int at = solution.cameras.offset(i);
      sigma = std::max(sigma, std::sqrt(solution.covariance(at, at)) / f);
      error = truth != nullptr ? std::max(error, std::abs(f / truth->devices[i].camera.fx - 1)) : 0;
    }
    const double baseline = solution.cameras.devices[1].T_device_rig.t.norm();
    json["cameras"]["focal_sigma"] = sigma;
    json["cameras"]["baseline_m"] = baseline;
    json["cameras"]["scale_by"] = !length_.empty() ? "length" : !baseline_.empty() ? "baseline" : "drawing";
    context.print(
        fmt::format("cameras          solved from the drawing: focal length +- {:.3f} %, {:.1f} mm apart; "
                    "metres by {}\n",
                    100 * sigma, 1e3 * baseline,
                    !length_.empty()     ? "the known length"
                    : !baseline_.empty() ? "the measured baseline"
                                         : "the drawn baseline: give --length or --baseline for true ones"));
    if (truth != nullptr) {
      json["truth"]["focal_error"] = error;
      context.print(fmt::format("focal lengths against the truth: {:.3f} %\n", 100 * error));
    }
  }

  std::string session_;
  std::string cameras_;
  std::string board_;
  std::string plane_;
  std::string baseline_;
  std::string length_;
  std::string survey_;
  std::string previous_;
  std::string stations_;
};

}  // namespace

std::unique_ptr<Command> calibrate_rig() { return std::make_unique<CalibrateRig>(); }

}  // namespace raysteer::host::cli
