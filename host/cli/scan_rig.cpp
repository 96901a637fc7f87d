#include "host/cli/scan_rig.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "host/exchange/rig_file.hpp"
#include "host/exchange/surface_file.hpp"
#include "host/exchange/write_file.hpp"
#include "host/pretend/truth_file.hpp"
#include "host/report/picture.hpp"
#include "host/report/result.hpp"
#include "host/rig/scan_surface.hpp"

namespace raysteer::host::cli {
namespace {

using calib::scene::FusedSurface;
using calib::scene::Overlap;
using rig::ScannedLook;
using rig::ScannedSurface;

/// Light that is off by more sigmas than one look in a million, and by enough to matter.
constexpr double kStrayLightSigma = 5.3;
constexpr double kStrayLightPx = 1;

bool strayed(const ScannedLook& look) {
  return look.light_off_px && *look.light_off_px > kStrayLightPx && look.light_off_sigma > kStrayLightSigma;
}

/// Looks that share places with no other: nothing says how well they fit in.
std::vector<std::string> lonely(const FusedSurface& fused) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < fused.looks.size() && fused.looks.size() > 1; ++k) {
    if (std::ranges::none_of(fused.overlaps, [&](const Overlap& o) { return o.first == k || o.second == k; })) {
      names.push_back(fused.looks[k].name);
    }
  }
  return names;
}

report::ScanResult result_of(const ScannedSurface& surface, const ScanRigRequest& request, const std::string& id) {
  const FusedSurface& fused = surface.fused;
  report::ScanResult result;
  result.session = request.session;
  result.calibration = request.rig;
  result.calibration_id = id;
  result.points = static_cast<std::int64_t>(fused.points.size());
  result.decoded_fraction = 0;
  for (const ScannedLook& look : surface.looks) {
    result.matched_projector_pixels += static_cast<std::int64_t>(look.matched);
    result.decoded_fraction += look.decoded_fraction / static_cast<double>(surface.looks.size());
  }
  report::Judgement& judgement = result.judgement;
  for (const rig::MissedLook& look : surface.missed) {
    judgement.reasons.push_back(fmt::format("look '{}' could not be used: {}", look.name, look.error.message()));
  }
  for (const ScannedLook& look : surface.looks) {
    if (strayed(look)) {
      judgement.reasons.push_back(
          fmt::format("look '{}' was lit {:.1f} px beside where its command should ({:.0f} sigma)", look.name,
                      *look.light_off_px, look.light_off_sigma));
      judgement.advice.push_back(
          fmt::format("Check the command of look '{}', or scan with --without {}; if all looks "
                      "are off, the mirror moved: calibrate the rig again.",
                      look.name, look.name));
    }
  }
  for (const std::string& name : lonely(fused)) {
    judgement.reasons.push_back(fmt::format("look '{}' overlaps no other; nothing says how well it fits in", name));
  }
  judgement.verdict = judgement.reasons.empty() ? "good" : "usable";
  judgement.summary = fused.shared > 0
                          ? fmt::format(
                                "{} looks make one surface of {} places; where they overlap they differ by "
                                "{:.2f} mm (median), {:.2f} mm (95 %).",
                                fused.looks.size(), fused.points.size(), fused.median_mm, fused.p95_mm)
                          : fmt::format("{} look(s) make a surface of {} places; none overlap.", fused.looks.size(),
                                        fused.points.size());
  for (const Overlap& overlap : fused.overlaps) {
    result.facts.push_back({fmt::format("{} and {}", fused.looks[overlap.first].name, fused.looks[overlap.second].name),
                            fmt::format("{:.2f} / {:.2f} mm apart, median / 95 %, at {} places", overlap.median_mm,
                                        overlap.p95_mm, overlap.shared)});
  }
  return result;
}

Json details(const ScannedSurface& surface) {
  const FusedSurface& fused = surface.fused;
  Json json = {{"triangles", fused.triangles.size()},
               {"cell_mrad", 1e3 * fused.cell},
               {"contested", fused.contested},
               {"shared", fused.shared},
               {"looks", Json::array()},
               {"overlaps", Json::array()},
               {"missed", Json::array()}};
  if (fused.shared > 0) {
    json["overlap_median_mm"] = fused.median_mm;
    json["overlap_p95_mm"] = fused.p95_mm;
  }
  for (std::size_t k = 0; k < surface.looks.size(); ++k) {
    const ScannedLook& look = surface.looks[k];
    Json one = {{"name", look.name},
                {"points", fused.looks[k].points},
                {"places", fused.looks[k].places},
                {"dropped", fused.looks[k].dropped}};
    if (look.light_off_px) {
      one["light_off_px"] = *look.light_off_px;
      one["light_off_sigma"] = look.light_off_sigma;
    }
    json["looks"].push_back(std::move(one));
  }
  for (const Overlap& overlap : fused.overlaps) {
    json["overlaps"].push_back({{"first", fused.looks[overlap.first].name},
                                {"second", fused.looks[overlap.second].name},
                                {"shared", overlap.shared},
                                {"median_mm", overlap.median_mm},
                                {"p95_mm", overlap.p95_mm},
                                {"bias_mm", overlap.bias_mm},
                                {"whitened", overlap.whitened},
                                {"apart", overlap.apart}});
  }
  for (const rig::MissedLook& look : surface.missed) {
    json["missed"].push_back({{"name", look.name}, {"code", std::string(to_string(look.error.rcode))}});
  }
  return json;
}

/// As the left eye sees it, one pixel a place.
std::string picture(const FusedSurface& fused) {
  std::vector<report::PanelPoint> points;
  int left = std::numeric_limits<int>::max(), top = left, right = std::numeric_limits<int>::min(), bottom = right;
  for (const Eigen::Vector3d& p : fused.points) {
    const int i = static_cast<int>(std::lround(p.x() / p.z() / fused.cell));
    const int j = static_cast<int>(std::lround(p.y() / p.z() / fused.cell));
    const Eigen::Vector3f at = p.cast<float>();
    points.push_back({i, j, at.x(), at.y(), at.z()});
    left = std::min(left, i);
    right = std::max(right, i);
    top = std::min(top, j);
    bottom = std::max(bottom, j);
  }
  for (report::PanelPoint& point : points) {
    point.i -= left;
    point.j -= top;
  }
  return report::cloud_picture(points, right - left + 1, bottom - top + 1);
}

}  // namespace

Result<ExitCode> scan_rig(Context& context, const session::Session& session, const ScanRigRequest& request) {
  const auto calibration = exchange::read_rig(request.rig);
  RAYSTEER_TRY(calibration);
  // With the room, its datums have corrected the cameras: stations are aimed at with these.
  const auto room = calibration->in_room();
  const auto surface =
      rig::scan_surface(session, room ? room->solution : calibration->solution,
                        {.looks = request.looks, .without = request.without}, context.stage("scanning looks"));
  RAYSTEER_TRY(surface);
  report::ScanResult result = result_of(*surface, request, calibration->id);
  const auto truth = pretend::truth_beside(session.file());
  RAYSTEER_TRY(truth);
  std::optional<pretend::SurfaceError> error;
  if (*truth && (*truth)->has_surfaces) {
    error = pretend::surface_error(**truth, surface->fused.points);
    result.facts.push_back({"distance from the true surface, RMS / 95 %",
                            fmt::format("{:.3f} / {:.3f} mm", 1e3 * error->rms_m, 1e3 * error->p95_m)});
  }
  if (context.has_out()) {
    const Tick tick = context.stage("writing");
    const exchange::SurfaceFile file{.rig_id = calibration->id,
                                     .points = surface->fused.points,
                                     .sigma_m = surface->fused.sigma_m,
                                     .triangles = surface->fused.triangles};
    RAYSTEER_TRY(exchange::write_file(context.out() / exchange::kSurfaceFile, exchange::to_ply(file)));
    RAYSTEER_TRY(exchange::write_file(context.out() / "surface.png", picture(surface->fused)));
    result.picture = "surface.png";
    RAYSTEER_TRY(report::write_result(context.out(), result));
  }
  context.json() = report::summary_json(result);
  context.json()["surface"] = details(*surface);
  if (error) {
    context.json()["truth"] = {{"surface_rms_m", error->rms_m}, {"surface_p95_m", error->p95_m}};
  }
  context.print(fmt::format("{}: {}\n", result.judgement.verdict, result.judgement.summary));
  for (const std::string& reason : result.judgement.reasons) {
    context.print("  " + reason + "\n");
  }
  for (const std::string& advice : result.judgement.advice) {
    context.print("  -> " + advice + "\n");
  }
  context.print(fmt::format("\nplaces     {} in {} triangles; {} left out, where looks disagree\n", result.points,
                            surface->fused.triangles.size(), surface->fused.contested));
  for (const report::Fact& fact : result.facts) {
    context.print(fmt::format("{}: {}\n", fact.name, fact.value));
  }
  return ExitCode::kDone;
}

}  // namespace raysteer::host::cli
