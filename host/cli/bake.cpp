// raysteer bake: a solved rig and stations become the tables that the device shows pictures by.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "calib/bake/lut_set.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/rig_result.hpp"
#include "host/exchange/write_file.hpp"
#include "host/rig/aimed_rig.hpp"
#include "host/rig/close_loop.hpp"
#include "host/session/session.hpp"

namespace raysteer::host::cli {
namespace {

class Bake : public Command {
 public:
  Manual manual() const override {
    return {.summary = "Bake a rig's stations into tables for its device",
            .description =
                "Aims at each station, says within how many millimetres its corners will lie (95 %), and bakes the "
                "steering table and a warp map a station (docs/lut-format.md). Stations on a scanned surface need it: "
                "--surface takes what 'raysteer scan --rig' made, and keeps pictures out of shadows, too.\n\nWith "
                "--out DIR: tables.rlut, "
                "result.json, report.html, and looks.toml, a plan that looks at every station, for 'raysteer verify'. "
                "Exit code 5 "
                "when a station is less sure than its tolerance. looks.toml names such stations, and refine.toml looks "
                "at them alone: --refine with a session of it closes the loop. A drift of the mirror is corrected at "
                "all stations; a station that still is not sure enough is baked for where its look found the mirror. "
                "That holds until the mirror is aimed again, so only the session's last look counts then.",
            .example =
                "raysteer bake --rig rig --stations stations.toml --out tables\n"
                "raysteer bake --rig rig --stations stations.toml --surface scan --out tables\n"
                "raysteer bake --rig rig --stations stations.toml --refine dots --out refined",
            .out = TakesOut::kOptional,
            .takes_frames = true};
  }

  void declare(Options& options) override {
    options.option("--rig", "FILE", &rig_, "calibration of the rig, or its folder").required();
    options.option("--stations", "FILE", &stations_, "stations file, or an installed one's name").required();
    options.option("--surface", "FILE", &surface_, "scanned surface, or its folder");
    options.option("--refine", "SESSION", &refine_, "looks at stations that close the loop there");
  }

  Result<ExitCode> run(Context& context) override {
    auto rig = rig::read_aimed_rig(rig_, stations_, surface_);
    RAYSTEER_TRY(rig);
    calib::bake::MirrorDrift drift;
    if (!refine_.empty()) {
      const auto session = session::Session::open(refine_, context.frames_root());
      RAYSTEER_TRY(session);
      const auto closed = rig::close_loop_by(*session, *rig, context.stage("decoding looks"));
      RAYSTEER_TRY(closed);
      report_loop(context, *closed);
      if (closed->drift) {
        drift = {.offset_rad = closed->drift->offset_rad, .gain = closed->drift->gain};
      }
    }
    const Tick baking = context.stage("baking");
    const auto set = calib::bake::bake_lut_set(rig->room.solution.projector, request(*rig, drift));
    RAYSTEER_TRY(set);
    const auto bytes = proto::lut::write_lut_set(*set);
    RAYSTEER_TRY(bytes);
    if (context.has_out()) {
      RAYSTEER_TRY(exchange::write_file(context.out() / "tables.rlut", std::string(bytes->begin(), bytes->end())));
      RAYSTEER_TRY(exchange::write_file(context.out() / "looks.toml", plan(*rig, false)));
      if (!std::ranges::all_of(rig->aimed, rig::holds)) {
        RAYSTEER_TRY(exchange::write_file(context.out() / "refine.toml", plan(*rig, true)));
      }
    }
    const ExitCode code = report(context, *rig, *bytes);
    if (context.has_out()) {
      RAYSTEER_TRY(report::write_result(context.out(), result(*rig, context), context.json()));
    }
    return code;
  }

 private:
  static calib::bake::LutSetRequest request(const rig::AimedRig& rig, const calib::bake::MirrorDrift& drift) {
    calib::bake::LutSetRequest request;
    request.calibration_id = rig.calibration.id;
    request.board_id = rig.calibration.meta.board;
    request.steering.frame = proto::lut::Frame::kDatums;
    request.steering.T_rig_plane = rig.room.T_rig_room;
    request.steering.drift = drift;
    for (const proto::stations::KeepOut& zone : rig.wanted.keep_out) {
      proto::lut::KeepOut& kept = request.keep_out.emplace_back();
      kept.name = zone.name;
      for (const proto::stations::Vec3& corner : zone.corners_m) {
        kept.corners.push_back({corner[0], corner[1]});
      }
    }
    for (const rig::AimedStation& one : rig.aimed) {
      if (one.to_scale) {
        request.stations.push_back(one.station);
      } else {
        request.further.push_back({.content = one.content,
                                   .command_rad = *one.station.command_rad,
                                   .stands_as_rad = one.station.stands_as_rad});
      }
    }
    if (rig.scene) {
      request.scene = &rig.scene->surface;
      // What a scan's own noise holds up is no shadow.
      request.warp.light.shadow_m += 4 * rig.scene->sigma_95_m;
    }
    return request;
  }

  static void report_loop(Context& context, const rig::ClosedLoop& closed) {
    Json& json = context.json()["drift"];
    if (closed.drift) {
      const auto& drift = *closed.drift;
      json = {{"offset_urad", {1e6 * drift.offset_rad.x(), 1e6 * drift.offset_rad.y()}},
              {"gain", {drift.gain.x(), drift.gain.y()}}};
      context.print(fmt::format("mirror           drifted since its calibration by {:.0f} and {:.0f} urad; corrected\n",
                                1e6 * drift.offset_rad.x(), 1e6 * drift.offset_rad.y()));
    }
  }

  /// `only_unsure`: of stations that need the loop closed.
  static std::string plan(const rig::AimedRig& rig, bool only_unsure) {
    std::string text =
        fmt::format("# A look at every station{}, planned by 'raysteer bake', for '{}'.\nformat = 1\nname = \"{}\"\n",
                    only_unsure ? " that needs the loop closed" : "",
                    only_unsure ? "raysteer bake --refine" : "raysteer verify", rig.wanted.name);
    for (const rig::AimedStation& one : rig.aimed) {
      const bool unsure = !rig::holds(one);
      if (only_unsure && !unsure) {
        continue;
      }
      text += unsure ? fmt::format("\n# Needs the loop closed: {:.2f} mm, allowed {:.1f}.", one.worst_95_mm,
                                   one.station.tolerance_mm)
                     : "";
      text += fmt::format("\n[[look]]\nname = \"{}\"\nmirror_mrad = [{:.6f}, {:.6f}]\n", one.station.name,
                          1e3 * one.station.command_rad->x(), 1e3 * one.station.command_rad->y());
    }
    return text;
  }

  /// What is said behind a station's bound.
  static std::string remark(const rig::AimedStation& one, double closed_mm) {
    std::string text;
    if (one.refined) {
      const bool again = one.within(one.refined->again_95_mm);
      text = one.refined->stands ? " (refined" : " (refined, and the mirror was aimed elsewhere since";
      text += again ? ")" : fmt::format("; {:.2f} once the mirror is aimed again)", one.refined->again_95_mm);
    }
    if (!one.within()) {
      text += fmt::format(" (allowed {:.1f}", one.station.tolerance_mm);
      text +=
          std::isfinite(closed_mm) ? fmt::format("; {:.2f} expected with the loop closed: --refine)", closed_mm) : ")";
    }
    return text;
  }

  static report::RigResult result(const rig::AimedRig& rig, Context& context) {
    report::RigResult result;
    result.kind = "tables";
    result.board = rig.calibration.meta.board;
    add_reach(result, placed(rig.calibration));
    add_stations(result, rig.aimed);
    const auto within = std::ranges::count_if(rig.aimed, rig::holds);
    result.judgement.verdict = context.json()["verdict"];
    result.judgement.summary =
        fmt::format("{} of {} stations are sure to lie within their tolerance (95 %).", within, rig.aimed.size());
    if (within < static_cast<std::ptrdiff_t>(rig.aimed.size())) {
      result.judgement.advice.push_back(
          "Calibrate with more looks near the stations that are not sure, or close the loop there.");
    }
    result.facts.push_back({"tables", fmt::format("{} bytes", context.json()["bytes"].get<std::size_t>())});
    result.facts.push_back({"tables' id", context.json()["id"].get<std::string>()});
    return result;
  }

  static ExitCode report(Context& context, const rig::AimedRig& rig, const std::vector<std::uint8_t>& bytes) {
    const std::vector<rig::AimedStation>& aimed = rig.aimed;
    const auto within = std::ranges::count_if(aimed, rig::holds);
    const bool all = within == static_cast<std::ptrdiff_t>(aimed.size());
    Json& json = context.json();
    json["verdict"] = all ? "good" : "redo";
    json["id"] = proto::lut::object_id(bytes);
    json["bytes"] = bytes.size();
    context.print(
        fmt::format("{} of {} stations are sure to lie within their tolerance (95 %)\n", within, aimed.size()));
    for (const rig::AimedStation& one : aimed) {
      const double closed_mm =
          one.within() ? std::numeric_limits<double>::infinity() : rig::closed_loop_95_mm(rig.room, one);
      Json& station = json["stations"].emplace_back(
          Json{{"name", one.station.name},
               {"command_rad", {one.station.command_rad->x(), one.station.command_rad->y()}},
               {"bound_95_mm", one.worst_95_mm},
               {"tolerance_mm", one.station.tolerance_mm},
               {"within", rig::holds(one)},
               {"refined", one.refined.has_value()}});
      if (one.refined) {
        station["again_95_mm"] = one.refined->again_95_mm;
        station["stands"] = one.refined->stands;
      }
      if (std::isfinite(closed_mm)) {
        station["closed_loop_95_mm"] = closed_mm;
      }
      if (!one.content.plane) {
        station["surface_missing"] = one.missing;
      }
      context.print(fmt::format("{:<16} {:.2f} mm{}{}\n", one.station.name, one.worst_95_mm, remark(one, closed_mm),
                                one.missing > 0 ? fmt::format("; {:.0f} % not scanned", 100 * one.missing) : ""));
    }
    context.print(
        fmt::format("tables           {} bytes, id {}\n", bytes.size(), json["id"].get<std::string>().substr(0, 16)));
    return all ? ExitCode::kDone : ExitCode::kVerdictRedo;
  }

  std::string rig_;
  std::string stations_;
  std::string surface_;
  std::string refine_;
};

}  // namespace

std::unique_ptr<Command> bake() { return std::make_unique<Bake>(); }

}  // namespace raysteer::host::cli
