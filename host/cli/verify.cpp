// raysteer verify: does the light land where it was wanted? Measured at a look at each station.
#include "host/rig/verify.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "host/cli/commands.hpp"
#include "host/pretend/truth_file.hpp"
#include "host/rig/aimed_rig.hpp"
#include "host/rig/gather.hpp"
#include "host/session/session.hpp"

namespace raysteer::host::cli {
namespace {

struct Summary {
  double mean_mm = 0;
  double max_mm = 0;
};

Summary summarise(const std::vector<double>& millimetres) {
  Summary summary;
  for (const double one : millimetres) {
    summary.mean_mm += one / static_cast<double>(millimetres.size());
    summary.max_mm = std::max(summary.max_mm, one);
  }
  return summary;
}

/// Where the true projector, without the mirror's repeatability, lights what should be a station's corners.
std::vector<double> true_errors(const std::vector<rig::AimedStation>& aimed, const pretend::TruthFile& truth) {
  std::vector<double> errors;
  for (const rig::AimedStation& one : aimed) {
    const auto view = truth.projector->at(*one.station.command_rad);
    const Eigen::Vector3d eye = *truth.T_room_rig * view.centre();
    for (std::size_t k = 0; k < 4; ++k) {
      const auto ray = view.ray(one.panel[k]);
      if (!ray) {
        continue;
      }
      const Eigen::Vector3d direction = truth.T_room_rig->q * *ray;
      const Eigen::Vector3d& corner = one.corners_room[k];
      const double way = one.normal_room.dot(corner - eye) / one.normal_room.dot(direction);
      errors.push_back(1e3 * (eye + way * direction - corner).norm());
    }
  }
  return errors;
}

class Verify : public Command {
 public:
  Manual manual() const override {
    return {.summary = "Measure by how many millimetres the light misses its stations",
            .description =
                "Takes a session with a look at each station, as the looks.toml that 'raysteer bake' writes makes it, "
                "and measures where the pixels that should light each station's corners land. The rig's cameras and "
                "datums are the measure. Exit code 5 when a station is off by more than its tolerance.",
            .example =
                "raysteer capture --sim --looks tables/looks.toml --patterns fast --scene hall --out look\n"
                "raysteer verify look --rig rig --stations stations.toml",
            .out = TakesOut::kNo,
            .takes_frames = true};
  }

  void declare(Options& options) override {
    options.argument("SESSION", &session_, "session file or its folder").required();
    options.option("--rig", "FILE", &rig_, "calibration of the rig, or its folder").required();
    options.option("--stations", "FILE", &stations_, "stations file, or an installed one's name").required();
  }

  Result<ExitCode> run(Context& context) override {
    const auto rig = rig::read_aimed_rig(rig_, stations_);
    RAYSTEER_TRY(rig);
    const auto session = session::Session::open(session_, context.frames_root());
    RAYSTEER_TRY(session);
    const auto gathered = rig::gather(*session, rig->room.solution.cameras, {.columns = 60, .rows = 40, .looks = {}},
                                      context.stage("decoding looks"));
    RAYSTEER_TRY(gathered);
    std::vector<rig::VerifiedStation> verified;
    std::vector<std::string> missing;
    for (const rig::AimedStation& one : rig->aimed) {
      const auto* look = rig::look_at(gathered->observations.looks, one);
      if (look == nullptr) {
        missing.push_back(one.station.name);
        continue;
      }
      const auto station = rig::verify_station(rig->room, one, *look);
      RAYSTEER_TRY(station);
      verified.push_back(*station);
    }
    if (verified.empty()) {
      return fail(RCode::kTooFewLooks, "the session looks at no station of " + stations_ +
                                           "; capture the looks.toml that 'raysteer bake' writes");
    }
    const auto truth = pretend::truth_beside(session->file());
    RAYSTEER_TRY(truth);
    return report(context, rig->aimed, verified, missing, *truth);
  }

 private:
  static ExitCode report(Context& context, const std::vector<rig::AimedStation>& aimed,
                         const std::vector<rig::VerifiedStation>& verified, const std::vector<std::string>& missing,
                         const std::optional<pretend::TruthFile>& truth) {
    Json& json = context.json();
    std::vector<double> errors;
    std::vector<std::string> lines;
    std::size_t within = 0;
    for (const rig::VerifiedStation& one : verified) {
      const auto& station = std::ranges::find(aimed, one.name, [](const auto& a) { return a.station.name; })->station;
      const bool good = station.tolerance_mm <= 0 || one.error_mm <= station.tolerance_mm;
      within += good ? 1 : 0;
      errors.insert(errors.end(), one.corner_mm.begin(), one.corner_mm.end());
      json["stations"].push_back({{"name", one.name},
                                  {"error_mm", one.error_mm},
                                  {"corners_mm", one.corner_mm},
                                  {"tolerance_mm", station.tolerance_mm},
                                  {"within", good}});
      lines.push_back(fmt::format("{:<16} {:.2f} mm{}\n", one.name, one.error_mm,
                                  good ? "" : fmt::format(" (allowed {:.1f})", station.tolerance_mm)));
    }
    const Summary summary = summarise(errors);
    const bool all = within == verified.size() && missing.empty();
    json["mean_mm"] = summary.mean_mm;
    json["max_mm"] = summary.max_mm;
    json["verdict"] = all ? "good" : "redo";
    context.print(
        fmt::format("{} of {} stations within tolerance; corners {:.2f} mm off in the mean, {:.2f} mm at most\n",
                    within, verified.size() + missing.size(), summary.mean_mm, summary.max_mm));
    for (const std::string& line : lines) {
      context.print(line);
    }
    for (const std::string& name : missing) {
      json["not_looked_at"].push_back(name);
      context.print(fmt::format("{:<16} was not looked at\n", name));
    }
    if (truth && truth->projector && truth->T_room_rig) {
      const Summary real = summarise(true_errors(aimed, *truth));
      json["truth"] = {{"mean_mm", real.mean_mm}, {"max_mm", real.max_mm}};
      context.print(fmt::format("error against the truth: {:.2f} mm in the mean, {:.2f} mm at most\n", real.mean_mm,
                                real.max_mm));
    }
    return all ? ExitCode::kDone : ExitCode::kVerdictRedo;
  }

  std::string session_;
  std::string rig_;
  std::string stations_;
};

}  // namespace

std::unique_ptr<Command> verify() { return std::make_unique<Verify>(); }

}  // namespace raysteer::host::cli
