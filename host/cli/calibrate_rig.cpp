// raysteer calibrate rig: looks of a steered projector become one model that predicts every other look.
#include <fmt/core.h>

#include <algorithm>
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
#include "host/cli/rig_cameras.hpp"
#include "host/cli/rig_plane.hpp"
#include "host/cli/rig_result.hpp"
#include "host/cli/rig_words.hpp"
#include "host/exchange/rig_file.hpp"
#include "host/exchange/write_file.hpp"
#include "host/pretend/truth_file.hpp"
#include "host/rig/drawing.hpp"
#include "host/rig/gather.hpp"
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

/// Looks of this name are never solved with, but predicted.
constexpr std::string_view kCheck = "check";
/// Without any such look, every so manieth is taken.
constexpr std::size_t kEvery = 4;

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
    cameras_.declare(options);
    options.option("--board", "FILE", &board_, "board file, or an installed one's name: how the rig is drawn")
        .required();
    plane_.declare(options);
    options.option("--survey", "FILE", &survey_, "where the room's datums are, or an installed survey's name");
    options.option("--previous", "FILE", &previous_, "earlier calibration of this rig, or its folder, to compare with");
    options.option("--stations", "FILE", &stations_, "stations whose bounds are wanted, or an installed file's name");
  }

  Result<ExitCode> run(Context& context) override {
    RAYSTEER_TRY(cameras_.read_length());
    const auto session = session::Session::open(session_, context.frames_root());
    RAYSTEER_TRY(session);
    const auto board = rig::read_board(board_);
    RAYSTEER_TRY(board);
    const auto done = calibrate(context, *session, *board);
    RAYSTEER_TRY(done);
    const auto truth = pretend::truth_beside(session->file());
    RAYSTEER_TRY(truth);
    std::optional<rig::TruthError> error;
    if (*truth && (*truth)->projector) {
      auto found = rig::truth_error(done->solution, **truth, done->held_out);
      RAYSTEER_TRY(found);
      error = *found;
    }
    const auto result = describe(context, *done);
    RAYSTEER_TRY(result);
    print_accuracy(context, done->solution, done->evaluation, error, done->verdict);
    cameras_.report(context, done->solution, *truth ? &(*truth)->rig : nullptr);
    print_room(context, done->room);
    print_reach(context, *result);
    print_difference(context, *result);
    if (context.has_out()) {
      RAYSTEER_TRY(exchange::write_file(context.out() / "rig.toml", rig_file(*done)));
      RAYSTEER_TRY(report::write_result(context.out(), *result, context.json()));
    }
    return done->verdict == "redo" ? ExitCode::kVerdictRedo : ExitCode::kDone;
  }

 private:
  /// The room's survey, and where the session's looks show its datums.
  struct Surveyed {
    rig::SurveyFile file;
    std::vector<calib::datum::View> views;
  };

  struct Done {
    Solution solution;
    Evaluation evaluation;
    std::vector<Look> held_out;
    std::string verdict;
    std::optional<Surveyed> surveyed;
    std::optional<rig::InRoom> room;  ///< with a survey

    std::optional<exchange::RoomTie> tie() const {
      return room ? std::optional(exchange::room_tie(room->rig, static_cast<int>(room->tie.misses.size()),
                                                     room->tie.scale ? room->tie.scale->value : 1))
                  : std::nullopt;
    }
    const Solution& final_solution() const { return room ? room->rig.solution : solution; }
  };

  /// From the session to a rig that was tried on the looks held out, and tied to the room where that is surveyed.
  Result<Done> calibrate(Context& context, const session::Session& session, const proto::board::Board& board) const {
    const auto drawing = rig::drawing_of(board);
    RAYSTEER_TRY(drawing);
    const auto cameras = cameras_.read(board, board_, session);
    RAYSTEER_TRY(cameras);
    auto surveyed = see_room(context, session);
    RAYSTEER_TRY(surveyed);
    auto gathered = gather(context, session, *cameras);
    RAYSTEER_TRY(gathered);
    Parts parts = split(std::move(gathered->observations.looks));
    gathered->observations.looks = std::move(parts.solved);
    const auto length = cameras_.find_length(context, session);
    RAYSTEER_TRY(length);
    const auto solving = context.stage("solving");
    auto solution = cameras_.drawn() ? calib::steer::solve_without_board(gathered->observations, *drawing, *length)
                                     : calib::steer::solve(gathered->observations, *drawing);
    RAYSTEER_TRY(solution);
    RAYSTEER_TRY(plane_.check(*gathered, *solution, *drawing));
    RAYSTEER_TRY(Context::poll());
    auto evaluation = calib::steer::evaluate(*solution, parts.held_out);
    RAYSTEER_TRY(evaluation);
    Done done{.solution = *std::move(solution),
              .evaluation = *std::move(evaluation),
              .held_out = std::move(parts.held_out),
              .verdict = {},
              .surveyed = *std::move(surveyed),
              .room = {}};
    done.verdict = rig_verdict(done.evaluation);
    if (done.surveyed) {
      auto tied = rig::tie_to_room(done.solution, done.surveyed->file.survey, done.surveyed->views);
      RAYSTEER_TRY(tied);
      done.room = *std::move(tied);
    }
    return done;
  }

  /// No value without --survey. Before anything is decoded, so that a rig that moved is named at once.
  Result<std::optional<Surveyed>> see_room(Context& context, const session::Session& session) const {
    if (survey_.empty()) {
      return std::optional<Surveyed>();
    }
    auto file = rig::read_survey(survey_);
    RAYSTEER_TRY(file);
    auto views = rig::see_datums(session, rig::kDatumLooks, context.stage("finding datums"));
    RAYSTEER_TRY(views);
    return std::optional(Surveyed{*std::move(file), *std::move(views)});
  }

  Result<rig::Gathered> gather(Context& context, const session::Session& session,
                               const calib::model::Rig& cameras) const {
    rig::GatherOptions options;
    options.cameras_drawn = cameras_.drawn();
    RAYSTEER_TRY(plane_.find(context, session, cameras, options));
    auto gathered = rig::gather(session, cameras, options, context.stage("decoding looks"));
    RAYSTEER_TRY(gathered);
    for (const rig::MissedLook& missed : gathered->missed) {
      context.note(fmt::format("look '{}' left out [{}]: {}", missed.name, to_string(missed.error.rcode),
                               missed.error.message()));
    }
    plane_.report(context, *gathered);
    return gathered;
  }

  /// All that the report shows.
  Result<report::RigResult> describe(Context& context, const Done& done) const {
    PlacedRig now = placed(done.solution, done.room, exchange::rig_id(done.final_solution(), done.tie()));
    now.survey_id = done.surveyed ? done.surveyed->file.id : "";
    const auto aimed = aim(now);
    RAYSTEER_TRY(aimed);
    report::RigResult result;
    result.session = session_;
    result.board = board_;
    result.judgement = judge_rig(done.verdict, done.evaluation, done.solution, done.room.has_value());
    add_reach(result, now);
    add_solution(result, now, done.solution, done.evaluation, done.held_out);
    if (done.room) {
      add_datums(result, done.room->tie, done.surveyed->file.survey);
    }
    add_stations(result, *aimed);
    const auto before = earlier(context);
    RAYSTEER_TRY(before);
    if (*before) {
      RAYSTEER_TRY(add_difference(result, now, **before, *aimed));
      if (now.tied && !(*before)->survey_id.empty() && (*before)->survey_id != now.survey_id) {
        context.note("the survey changed since the earlier calibration: what the light moved by may be the datums");
      }
    }
    return result;
  }

  std::string rig_file(const Done& done) const {
    return exchange::to_toml(done.final_solution(), done.tie(),
                             {.session = session_,
                              .board = board_,
                              .verdict = done.verdict,
                              .whitened_rms = done.solution.whitened_rms,
                              .held_out_median_px = done.evaluation.median_px,
                              .held_out_p95_px = done.evaluation.p95_px,
                              .held_out_median_mm = done.evaluation.median_mm,
                              .held_out_p95_mm = done.evaluation.p95_mm,
                              .looks = static_cast<int>(done.solution.looks.size()),
                              .survey = done.surveyed ? done.surveyed->file.survey.name : "",
                              .survey_id = done.surveyed ? done.surveyed->file.id : ""});
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

  std::string session_;
  RigCameras cameras_;
  std::string board_;
  RigPlane plane_;
  std::string survey_;
  std::string previous_;
  std::string stations_;
};

}  // namespace

std::unique_ptr<Command> calibrate_rig() { return std::make_unique<CalibrateRig>(); }

}  // namespace raysteer::host::cli
