// A plan becomes a session folder with the truth beside it.
#include <algorithm>
#include <system_error>
#include <utility>

#include "firmware/capture/session_writer.hpp"
#include "proto/plan/plan.hpp"
#include "sim/app/find_file.hpp"
#include "sim/app/modes.hpp"
#include "sim/app/write_file.hpp"
#include "sim/rig/run_capture.hpp"

namespace raysteer::sim::app {
namespace {

using firmware::capture::Findings;

Result<proto::plan::Plan> load_plan(const std::string& name) {
  if (name.empty()) {
    return proto::plan::Plan{.name = "straight ahead",
                             .blocks = {},
                             .exposure_us = {},
                             .looks = {{.name = "scene", .mirror_rad = {}, .prepare = {}}},
                             .targets = {}};
  }
  const Result<std::filesystem::path> file = find_file("plans", name);
  if (!file) {
    return file.error();
  }
  const Result<std::string> text = read_text(*file);
  if (!text) {
    return text.error();
  }
  return proto::plan::read_plan(*text, file->string());
}

Result<PatternSequence> sequence_of(const proto::plan::Plan& plan, const std::string& patterns,
                                    const proto::board::Projector& panel) {
  if (plan.blocks.empty()) {
    return proto::plan::pattern_set(patterns, panel.width, panel.height);
  }
  PatternSequence sequence{.panel_width = panel.width, .panel_height = panel.height, .blocks = plan.blocks};
  RAYSTEER_TRY(check(sequence));
  return sequence;
}

double micros(std::chrono::nanoseconds duration) { return std::chrono::duration<double, std::micro>(duration).count(); }

Json json_of(const Findings& findings) {
  Json json;
  int retaken = 0;
  Json retakes = Json::object();
  for (const auto* counts : {&findings.retakes, &findings.look_retakes}) {
    for (const auto& [rcode, count] : *counts) {
      retakes[to_string(rcode)] = retakes.value(to_string(rcode), 0) + count;
      retaken += count;
    }
  }
  json["retaken"] = retaken;
  json["retakes"] = std::move(retakes);
  json["exposure_us"] = micros(findings.exposure);
  json["latency_us"] = nullptr;
  if (findings.latency) {
    json["latency_us"] = micros(*findings.latency);
  }
  json["flicker_hz"] = nullptr;
  if (findings.flicker && findings.flicker->noticed) {
    json["flicker_hz"] = findings.flicker->hz;
  }
  return json;
}

}  // namespace

Result<Json> capture(const CaptureRequest& request, Say& say) {
  Result<LoadedRig> loaded = load_rig(request.which);
  if (!loaded) {
    return std::move(loaded).error();
  }
  const Result<proto::plan::Plan> plan = load_plan(request.looks);
  if (!plan) {
    return plan.error();
  }
  const Result<PatternSequence> sequence = sequence_of(*plan, request.patterns, loaded->board.projector);
  if (!sequence) {
    return sequence.error();
  }
  std::error_code error;
  std::filesystem::create_directories(request.out, error);
  if (error) {
    return fail(RCode::kWriteFailed, request.out.string() + ": " + error.message(), error.value());
  }
  rig::PretendRig& rig = *loaded->rig;
  // Before session.toml, which makes the folder a session.
  RAYSTEER_TRY(write_whole(request.out / "truth.json", rig::truth_json(rig.truth(), rig.world().scene())));

  firmware::capture::SessionWriter writer(request.out);
  const EventLog log([&say](LogLevel level, std::string_view line) {
    if (level <= LogLevel::kWarn) {
      say.note(std::string(line));
    }
  });
  firmware::capture::Options options;
  options.rig = loaded->board.name + " seed " + std::to_string(request.which.seed);
  options.settle_timeout = settle_timeout(loaded->board);
  std::vector<rig::LookTruth> looks;
  rig::RunOptions run{.paced = request.paced, .progress = [&](const firmware::capture::Progress& progress) {
                        // Some of a look's shots are taken: the mirror stands.
                        const auto look = static_cast<std::size_t>(progress.looks_done);
                        if (look == looks.size() && look < plan->looks.size() &&
                            progress.shots_done > progress.looks_done * sequence->frames()) {
                          const hal::MirrorAngles angles = rig.mock().mirror().true_angles(rig.now());
                          looks.push_back({plan->looks[look].name, {angles.axis1.raw(), angles.axis2.raw()}});
                        }
                        const int total = std::max(progress.shots_total, 1);
                        say.progress(progress.shots_done == 0 ? "measuring light and latency" : "capturing",
                                     static_cast<double>(progress.shots_done) / total);
                        return !cancelled();
                      }};
  const Result<Findings> findings = run_capture(rig, *plan, *sequence, options, writer, log, run);
  if (!findings) {
    return findings.error();
  }
  RAYSTEER_TRY(write_whole(request.out / "truth.json", rig::truth_json(rig.truth(), rig.world().scene(), looks)));
  Json json{{"board", loaded->board.name},
            {"scene", loaded->scene},
            {"seed", request.which.seed},
            {"looks", plan->looks.size()},
            {"shots", plan->looks.size() * static_cast<std::size_t>(sequence->frames())}};
  json.update(json_of(*findings));
  json["rig_s"] = std::chrono::duration<double>(rig.now().time_since_epoch()).count();
  return json;
}

}  // namespace raysteer::sim::app
