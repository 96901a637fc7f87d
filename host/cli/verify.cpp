// raysteer verify: does the light land where it was wanted? Measured at a look at each station.
#include "host/rig/verify.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "calib/bake/ray_caster.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/rig_result.hpp"
#include "host/pretend/truth_file.hpp"
#include "host/rig/aimed_rig.hpp"
#include "host/rig/close_loop.hpp"
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

/// The room's true surfaces; nothing where the truth does not hold them all.
std::optional<calib::bake::RayCaster> true_surfaces(const pretend::TruthFile& truth) {
  calib::bake::TriangleMesh mesh;
  for (const pretend::Triangle& triangle : truth.triangles) {
    const auto first = static_cast<std::uint32_t>(mesh.points.size());
    mesh.points.insert(mesh.points.end(), triangle.begin(), triangle.end());
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  auto caster = calib::bake::RayCaster::make(std::move(mesh));
  return truth.has_surfaces && caster ? std::optional(*std::move(caster)) : std::nullopt;
}

/// Where the true projector, without the mirror's repeatability, lights what should be a station's corners: how far
/// off across the way they are looked at.
/// Once the loop was closed, with the mirror as it stood at the look.
std::vector<double> true_errors(const std::vector<rig::AimedStation>& aimed, std::span<const calib::steer::Look> looks,
                                const pretend::TruthFile& truth) {
  std::vector<double> errors;
  const auto surfaces = true_surfaces(truth);
  for (const rig::AimedStation& one : aimed) {
    const auto* look = rig::look_at(looks, one);
    const auto stood = look == nullptr ? truth.angles_rad.end() : truth.angles_rad.find(look->name);
    const bool known = one.station.stands_as_rad && stood != truth.angles_rad.end();
    const auto view =
        truth.projector->at_angles(known ? stood->second : truth.projector->angles(*one.station.command_rad));
    const Eigen::Vector3d eye = *truth.T_room_rig * view.centre();
    for (std::size_t k = 0; k < 4; ++k) {
      const auto ray = view.ray(one.panel[k]);
      if (!ray) {
        continue;
      }
      const Eigen::Vector3d direction = truth.T_room_rig->q * *ray;
      const Eigen::Vector3d& corner = one.corners_room[k];
      double way = one.normals_room[k].dot(corner - eye) / one.normals_room[k].dot(direction);
      if (!one.content.plane) {
        const auto triangle = surfaces ? surfaces->first(view.centre(), *ray) : std::nullopt;
        if (!triangle) {
          continue;
        }
        const calib::bake::SurfacePlane& plane = surfaces->plane(*triangle);
        way = (plane.distance_m - plane.normal.dot(view.centre())) / plane.normal.dot(*ray);
      }
      const Eigen::Vector3d off = eye + way * direction - corner;
      const Eigen::Vector3d& sight = one.sights_room[k];
      errors.push_back(1e3 * (off - sight * sight.dot(off)).norm());
    }
  }
  return errors;
}

class Verify : public Command {
 public:
  Manual manual() const override {
    return {
        .summary = "Measure by how many millimetres the light misses its stations",
        .description =
            "Takes a session with a look at each station, as the looks.toml that 'raysteer bake' writes makes it, "
            "and measures where the pixels that should light each station's corners land. The rig's cameras and "
            "datums are the measure, and how sure they are is stated with each station (95 %). Stations on a scanned "
            "surface need --surface as they did when baked. Exit code 5 when what was measured and what it may be "
            "off by are together more than a station's tolerance.\n\nWith --out DIR: result.json and report.html.",
        .example =
            "raysteer capture --sim --looks tables/looks.toml --patterns fast --scene hall --out look\n"
            "raysteer verify look --rig rig --stations stations.toml",
        .out = TakesOut::kOptional,
        .takes_frames = true};
  }

  void declare(Options& options) override {
    options.argument("SESSION", &session_, "session file or its folder").required();
    options.option("--rig", "FILE", &rig_, "calibration of the rig, or its folder").required();
    options.option("--stations", "FILE", &stations_, "stations file, or an installed one's name").required();
    options.option("--surface", "FILE", &surface_, "scanned surface, or its folder");
    options.option("--refine", "SESSION", &refine_, "as for 'raysteer bake': the loop was closed by these looks");
  }

  Result<ExitCode> run(Context& context) override {
    auto rig = rig::read_aimed_rig(rig_, stations_, surface_);
    RAYSTEER_TRY(rig);
    if (!refine_.empty()) {
      const auto dots = session::Session::open(refine_, context.frames_root());
      RAYSTEER_TRY(dots);
      const auto closed = rig::close_loop_by(*dots, *rig, context.stage("closing the loop"));
      RAYSTEER_TRY(closed);
    }
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
      const auto station = rig::verify_station(rig->room, one, *look, rig->scene ? &*rig->scene : nullptr);
      RAYSTEER_TRY(station);
      verified.push_back(*station);
    }
    if (verified.empty()) {
      return fail(RCode::kTooFewLooks, "the session looks at no station of " + stations_ +
                                           "; capture the looks.toml that 'raysteer bake' writes");
    }
    const auto truth = pretend::truth_beside(session->file());
    RAYSTEER_TRY(truth);
    const ExitCode code = report(context, rig->aimed, verified, missing, gathered->observations.looks, *truth);
    if (context.has_out()) {
      RAYSTEER_TRY(report::write_result(context.out(), result(*rig, verified, context), context.json()));
    }
    return code;
  }

 private:
  report::RigResult result(const rig::AimedRig& rig, const std::vector<rig::VerifiedStation>& verified,
                           Context& context) const {
    report::RigResult result;
    result.kind = "verification";
    result.session = session_;
    result.board = rig.calibration.meta.board;
    add_reach(result, placed(rig.calibration));
    add_stations(result, rig.aimed);
    add_verified(result, rig.aimed, verified);
    const auto within = std::ranges::count_if(result.stations, &report::StationRow::within);
    result.judgement.verdict = context.json()["verdict"];
    result.judgement.summary = fmt::format(
        "{} of {} stations surely lie within tolerance (95 %); corners are {:.2f} mm off in the mean, {:.2f} mm at "
        "most.",
        within, result.stations.size(), context.json()["mean_mm"].get<double>(),
        context.json()["max_mm"].get<double>());
    for (const report::StationRow& station : result.stations) {
      if (!std::isfinite(station.error_mm)) {
        result.judgement.reasons.push_back("Station '" + station.name + "' was not looked at.");
      } else if (!station.within) {
        result.judgement.reasons.push_back(fmt::format("Station '{}': {:.2f} mm (sure to {:.2f}), allowed {:.1f}.",
                                                       station.name, station.error_mm, station.sure_mm,
                                                       station.tolerance_mm));
      }
    }
    return result;
  }

  static ExitCode report(Context& context, const std::vector<rig::AimedStation>& aimed,
                         const std::vector<rig::VerifiedStation>& verified, const std::vector<std::string>& missing,
                         std::span<const calib::steer::Look> looks, const std::optional<pretend::TruthFile>& truth) {
    Json& json = context.json();
    std::vector<double> errors;
    std::vector<std::string> lines;
    std::size_t within = 0;
    for (const rig::VerifiedStation& one : verified) {
      const auto& station = std::ranges::find(aimed, one.name, [](const auto& a) { return a.station.name; })->station;
      const bool good = one.within(station.tolerance_mm);
      within += good ? 1 : 0;
      errors.insert(errors.end(), one.corner_mm.begin(), one.corner_mm.end());
      json["stations"].push_back({{"name", one.name},
                                  {"error_mm", one.error_mm},
                                  {"sure_mm", one.bound_95_mm - one.error_mm},
                                  {"bound_95_mm", one.bound_95_mm},
                                  {"corners_mm", one.corner_mm},
                                  {"corners_sure_mm", one.sure_mm},
                                  {"tolerance_mm", station.tolerance_mm},
                                  {"within", good}});
      if (one.points > 0) {
        json["stations"].back()["picture_95_mm"] = one.picture_95_mm;
        json["stations"].back()["points"] = one.points;
      }
      lines.push_back(fmt::format("{:<16} {:.2f} mm (sure to {:.2f}){}{}\n", one.name, one.error_mm,
                                  one.bound_95_mm - one.error_mm,
                                  station.tolerance_mm > 0 ? fmt::format(", allowed {:.1f}", station.tolerance_mm) : "",
                                  good ? "" : ": not sure to be within"));
    }
    const Summary summary = summarise(errors);
    const bool all = within == verified.size() && missing.empty();
    json["mean_mm"] = summary.mean_mm;
    json["max_mm"] = summary.max_mm;
    json["verdict"] = all ? "good" : "redo";
    context.print(fmt::format(
        "{} of {} stations surely within tolerance (95 %); corners {:.2f} mm off in the mean, {:.2f} mm at most\n",
        within, verified.size() + missing.size(), summary.mean_mm, summary.max_mm));
    for (const std::string& line : lines) {
      context.print(line);
    }
    for (const std::string& name : missing) {
      json["not_looked_at"].push_back(name);
      context.print(fmt::format("{:<16} was not looked at\n", name));
    }
    if (truth && truth->projector && truth->T_room_rig) {
      const Summary real = summarise(true_errors(aimed, looks, *truth));
      json["truth"] = {{"mean_mm", real.mean_mm}, {"max_mm", real.max_mm}};
      context.print(fmt::format("error against the truth: {:.2f} mm in the mean, {:.2f} mm at most\n", real.mean_mm,
                                real.max_mm));
    }
    return all ? ExitCode::kDone : ExitCode::kVerdictRedo;
  }

  std::string session_;
  std::string rig_;
  std::string stations_;
  std::string surface_;
  std::string refine_;
};

}  // namespace

std::unique_ptr<Command> verify() { return std::make_unique<Verify>(); }

}  // namespace raysteer::host::cli
