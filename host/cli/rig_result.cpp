#include "host/cli/rig_result.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/assess/rig_difference.hpp"

namespace raysteer::host::cli {
namespace {

constexpr double kMilli = 1e3;  // per metre, per radian

std::vector<double> numbers(const calib::model::Pose& pose) {
  return {pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z(), pose.t.x(), pose.t.y(), pose.t.z()};
}

/// The floor that add_reach() found.
std::optional<rig::Floor> floor_in(const report::RigResult& result) {
  const std::vector<double>& n = result.floor_pose;
  const Eigen::Quaterniond q =
      n.size() == 7 ? Eigen::Quaterniond(n[0], n[1], n[2], n[3]) : Eigen::Quaterniond(0, 0, 0, 0);
  if (!(std::abs(q.norm() - 1) < 1e-6)) {
    return std::nullopt;
  }
  return rig::Floor{.T_floor_frame = {q, {n[4], n[5], n[6]}}, .name = result.floor};
}

template <class Corners>
std::vector<double> outline(const Corners& corners) {
  std::vector<double> flat;
  for (const Eigen::Vector2d& corner : corners) {
    flat.insert(flat.end(), {corner.x(), corner.y()});
  }
  return flat;
}

report::FloorArrow arrow(const rig::Floor& floor, const Eigen::Vector3d& p, const Eigen::Vector3d& off_m) {
  const Eigen::Vector2d at = floor(p);
  const Eigen::Vector3d off = kMilli * (floor.T_floor_frame.q * off_m);
  return {.x_m = at.x(), .y_m = at.y(), .dx_mm = off.x(), .dy_mm = off.y()};
}

/// A few arrows of a look, each the mean of its part: more would hide each other.
std::vector<report::FloorArrow> thinned(const rig::Floor& floor, const calib::steer::InRoom& rig,
                                        const std::vector<calib::steer::HeldOutPoint>& points) {
  constexpr int kAcross = 3;
  const calib::model::Pose T_frame_rig = rig.T_rig_room.inverse();
  Eigen::Vector2d least = Eigen::Vector2d::Constant(1e9);
  Eigen::Vector2d most = -least;
  for (const calib::steer::HeldOutPoint& point : points) {
    const Eigen::Vector2d at = floor(T_frame_rig * point.p);
    least = least.cwiseMin(at);
    most = most.cwiseMax(at);
  }
  struct Part {
    Eigen::Vector3d p = Eigen::Vector3d::Zero(), off = Eigen::Vector3d::Zero();
    int count = 0;
  };
  std::vector<Part> parts(kAcross * kAcross);
  for (const calib::steer::HeldOutPoint& point : points) {
    const Eigen::Vector3d p = T_frame_rig * point.p;
    const Eigen::Vector2d place = kAcross * (floor(p) - least).cwiseQuotient((most - least).cwiseMax(1e-9));
    const auto column = static_cast<std::size_t>(std::clamp(place.x(), 0.0, kAcross - 1.0));
    const auto row = static_cast<std::size_t>(std::clamp(place.y(), 0.0, kAcross - 1.0));
    Part& part = parts[row * kAcross + column];
    part.p += p;
    part.off += T_frame_rig.q * point.off_m;
    ++part.count;
  }
  std::vector<report::FloorArrow> arrows;
  for (const Part& part : parts) {
    if (part.count >= 3) {
      arrows.push_back(arrow(floor, part.p / part.count, part.off / part.count));
    }
  }
  return arrows;
}

void add_looks(report::RigResult& result, const std::optional<rig::Floor>& floor, const PlacedRig& rig,
               const calib::steer::Solution& solution, const calib::steer::Evaluation& evaluation,
               const std::vector<calib::steer::Look>& held_out) {
  const auto row = [&](const std::string& name, const Eigen::Vector2d& command) -> report::LookRow& {
    report::LookRow& look = result.looks.emplace_back();
    look.name = name;
    look.command_mrad = {kMilli * command.x(), kMilli * command.y()};
    if (const auto at = floor ? rig::middle_on(*floor, rig.rig, command) : std::nullopt) {
      look.x_m = at->x();
      look.y_m = at->y();
    }
    return look;
  };
  for (const calib::steer::SolvedLook& solved : solution.looks) {
    report::LookRow& look = row(solved.name, solved.command_rad);
    look.latent_urad = {1e6 * solved.latent_rad.x(), 1e6 * solved.latent_rad.y()};
    look.whitened_rms = solved.whitened_rms;
  }
  for (const calib::steer::HeldOutLook& missed : evaluation.looks) {
    const auto found = std::ranges::find(held_out, missed.name, &calib::steer::Look::name);
    if (found != held_out.end()) {
      report::LookRow& look = row(missed.name, found->command_rad);
      look.held_out = true;
      look.median_px = missed.median_px;
      look.p95_px = missed.p95_px;
    }
    if (floor) {
      const auto arrows = thinned(*floor, rig.rig, missed.points);
      result.held_out.insert(result.held_out.end(), arrows.begin(), arrows.end());
    }
  }
}

/// Of both calibrations' light, in words.
std::string sentence(const calib::assess::RigDifference& found, bool in_room, double inside_chance) {
  std::string text = fmt::format(
      "Light falls {:.2f} mm in the mean (95 %: {:.2f} mm, at most {:.2f} mm) from where the earlier calibration put "
      "it",
      found.mean_mm, found.p95_mm, found.max_mm);
  // Where nothing moved, a twentieth is beyond chance; places move together, so that it may be some more.
  if (found.beyond_chance < 0.2) {
    return text + ": no more than both calibrations say they may be off by.";
  }
  const std::string whole =
      in_room ? "the rig as a whole moved against the room" : "projector and mirror as one moved against the cameras";
  const std::string inside = in_room ? "something changed inside the rig" : "projector or mirror changed in themselves";
  if (found.inside_rms_mm < std::max(0.3 * found.whole_rms_mm, inside_chance)) {
    text += fmt::format(": {} ({:.2f} mm of it, RMS); what is left, {:.2f} mm, is small", whole, found.whole_rms_mm,
                        found.inside_rms_mm);
  } else if (found.whole_rms_mm < 0.3 * found.inside_rms_mm) {
    text += fmt::format(": {}, which no movement of the whole explains ({:.2f} mm of it, RMS)", inside,
                        found.inside_rms_mm);
  } else {
    text += fmt::format(": {} ({:.2f} mm, RMS), and {} ({:.2f} mm)", whole, found.whole_rms_mm, inside,
                        found.inside_rms_mm);
  }
  return text + (in_room ? "." : ". The two were not compared in the room: not both are tied to it.");
}

}  // namespace

PlacedRig placed(const exchange::RigCalibration& calibration) {
  const auto room = calibration.in_room();
  return {.rig = room ? *room : calib::assess::in_own_frame(calibration.solution),
          .tied = room.has_value(),
          .id = calibration.id,
          .survey_id = calibration.meta.survey_id};
}

PlacedRig placed(const calib::steer::Solution& solution, const std::optional<rig::InRoom>& room,
                 const std::string& id) {
  return {.rig = room ? room->rig : calib::assess::in_own_frame(solution), .tied = room.has_value(), .id = id};
}

void add_reach(report::RigResult& result, const PlacedRig& rig) {
  result.tied_to_room = rig.tied;
  result.calibration_id = rig.id;
  const auto floor = rig::floor_of(rig.rig, rig.tied);
  if (!floor) {
    return;
  }
  const rig::Reach reach = rig::reach_on(*floor, rig.rig, rig.tied);
  if (reach.cells.empty()) {
    return;
  }
  result.floor = floor->name;
  result.floor_pose = numbers(floor->T_floor_frame);
  result.reach_median_95_mm = reach.median_95_mm;
  result.reach_worst_95_mm = reach.worst_95_mm;
  for (const rig::ReachedCell& cell : reach.cells) {
    result.reach.push_back({.outline_m = outline(cell.outline_m), .mm = cell.worst_95_mm});
  }
}

void add_solution(report::RigResult& result, const PlacedRig& rig, const calib::steer::Solution& solution,
                  const calib::steer::Evaluation& evaluation, const std::vector<calib::steer::Look>& held_out) {
  result.held_out_median_px = evaluation.median_px;
  result.held_out_p95_px = evaluation.p95_px;
  result.held_out_median_mm = evaluation.median_mm;
  result.held_out_p95_mm = evaluation.p95_mm;
  result.whitened_rms = solution.whitened_rms;
  result.repeatability_urad = 1e6 * solution.repeatability_rad;
  result.points_used = static_cast<std::int64_t>(solution.used);
  result.points_dropped = static_cast<std::int64_t>(solution.dropped);
  result.panel_width = solution.projector.lens.width;
  result.panel_height = solution.projector.lens.height;
  add_looks(result, floor_in(result), rig, solution, evaluation, held_out);
  for (std::size_t k = 0; k < solution.looks.size(); ++k) {
    for (const calib::steer::PointResidual& point : solution.looks[k].points) {
      result.residuals.push_back({.view = static_cast<int>(k),
                                  .x = point.x.x(),
                                  .y = point.x.y(),
                                  .dx = point.error.x(),
                                  .dy = point.error.y(),
                                  .kept = point.used});
    }
  }
  for (const calib::steer::OffDrawing& off : solution.off_drawing) {
    result.off_drawing.push_back({.parameter = off.parameter, .sigmas = off.sigmas});
  }
  result.facts.push_back({"points used / left out", fmt::format("{} / {}", solution.used, solution.dropped)});
  result.facts.push_back({"residuals with latent angles known, RMS", fmt::format("{:.3f} px", solution.panel_rms_px)});
  result.facts.push_back({"looks held out: expected by the model's covariance, RMS",
                          fmt::format("{:.3f} px", evaluation.predicted_rms_px)});
  result.facts.push_back({"mirror's repeatability", solution.repeatability_estimated ? "estimated" : "as drawn"});
}

void add_datums(report::RigResult& result, const calib::datum::Tie& tie, const proto::survey::Survey& survey) {
  const auto floor = floor_in(result);
  for (const calib::datum::Miss& miss : tie.misses) {
    report::DatumRow row;
    row.name = miss.name;
    row.miss_mm = {kMilli * miss.miss_m.x(), kMilli * miss.miss_m.y(), kMilli * miss.miss_m.z()};
    row.size_mm = kMilli * miss.miss_m.norm();
    row.sigma_mm = kMilli * miss.sigma_m.maxCoeff();
    if (const auto* datum = survey.find(miss.name); datum != nullptr && floor) {
      const Eigen::Vector2d at = (*floor)({datum->position_m[0], datum->position_m[1], datum->position_m[2]});
      row.x_m = at.x();
      row.y_m = at.y();
    }
    result.datums.push_back(std::move(row));
  }
  if (tie.scale) {
    result.scale = tie.scale->value;
    result.scale_sigma = tie.scale->sigma;
    result.scale_by_lengths = tie.scale->by_lengths;
  }
  for (const calib::datum::Length& length : tie.lengths) {
    result.lengths.push_back({.between = length.from + " – " + length.to,
                              .measured_mm = kMilli * length.measured_m,
                              .known_mm = kMilli * length.known_m,
                              .sigma_mm = kMilli * length.sigma_m});
  }
}

void add_stations(report::RigResult& result, const std::vector<rig::AimedStation>& aimed) {
  const auto floor = floor_in(result);
  for (const rig::AimedStation& one : aimed) {
    report::StationRow& row = result.stations.emplace_back();
    row.name = one.station.name;
    row.bound_95_mm = one.worst_95_mm;
    row.tolerance_mm = one.station.tolerance_mm;
    row.within = one.within();
    for (const Eigen::Vector3d& corner : one.corners_room) {
      const Eigen::Vector2d at = floor ? (*floor)(corner) : Eigen::Vector2d(corner.head<2>());
      row.outline_m.insert(row.outline_m.end(), {at.x(), at.y()});
    }
  }
}

void add_verified(report::RigResult& result, const std::vector<rig::AimedStation>& aimed,
                  const std::vector<rig::VerifiedStation>& verified) {
  const auto floor = floor_in(result);
  for (report::StationRow& row : result.stations) {
    const auto station = std::ranges::find(aimed, row.name, [](const auto& one) { return one.station.name; });
    const auto found = std::ranges::find(verified, row.name, &rig::VerifiedStation::name);
    row.within = found != verified.end() && found->within(row.tolerance_mm);
    row.bound_95_mm = found != verified.end() ? found->bound_95_mm : report::kUnknown;
    if (found == verified.end() || station == aimed.end()) {
      continue;
    }
    row.error_mm = found->error_mm;
    row.sure_mm = found->bound_95_mm - found->error_mm;
    const auto& corners = station->corners_room;
    const Eigen::Vector3d right = (corners[1] - corners[0]).normalized();
    const Eigen::Vector3d down = (corners[3] - corners[0]).normalized();
    for (std::size_t k = 0; k < 4 && floor; ++k) {
      const Eigen::Vector2d& off = found->off_mm[k];
      row.off.push_back(arrow(*floor, corners[k], (off.x() * right + off.y() * down) / kMilli));
    }
  }
}

Status add_difference(report::RigResult& result, const PlacedRig& now, const PlacedRig& before,
                      const std::vector<rig::AimedStation>& aimed) {
  const bool in_room = now.tied && before.tied;
  const calib::steer::InRoom ours = in_room ? now.rig : calib::assess::in_own_frame(now.rig.solution);
  const calib::steer::InRoom theirs = in_room ? before.rig : calib::assess::in_own_frame(before.rig.solution);
  auto floor = floor_in(result);
  if (!floor) {
    return fail(RCode::kTooFewCorrespondences, "nothing to compare on: the rig lights no floor that is known");
  }
  if (now.tied && !in_room) {
    floor->T_floor_frame = floor->T_floor_frame * now.rig.T_rig_room.inverse();
    floor->name += ", in the rig's frame";
  }
  const rig::Reach reach = rig::reach_on(*floor, ours, in_room, 18, 12);
  const auto places = rig::lit_places(reach, ours.solution.projector);
  const auto found = calib::assess::rig_difference(ours, theirs, floor->surface(), places);
  RAYSTEER_TRY(found);
  report::RigDifferenceResult& difference = result.difference.emplace_back();
  difference.earlier = before.id;
  difference.frame = in_room ? "the room" : "the rig's own frame";
  double chance = 0;
  for (const calib::assess::MovedPlace& place : found->places) {
    chance += place.chance_95_mm / static_cast<double>(found->places.size());
  }
  difference.sentence = sentence(*found, in_room, chance);
  difference.mean_mm = found->mean_mm;
  difference.p95_mm = found->p95_mm;
  difference.max_mm = found->max_mm;
  difference.whole_rms_mm = found->whole_rms_mm;
  difference.inside_rms_mm = found->inside_rms_mm;
  difference.beyond_chance = found->beyond_chance;
  difference.turned_mrad = kMilli * found->whole.head<3>().norm();
  difference.shifted_mm = kMilli * found->whole.tail<3>().norm();
  // A cell's colour and arrow are those of its picture's middle.
  for (const rig::ReachedCell& cell : reach.cells) {
    const auto middle = std::ranges::find(found->places, cell.command_rad,
                                          [](const calib::assess::MovedPlace& place) { return place.lit.command_rad; });
    if (middle != found->places.end()) {
      difference.cells.push_back({.outline_m = outline(cell.outline_m), .mm = kMilli * middle->moved_m.norm()});
      difference.arrows.push_back(arrow(*floor, middle->p, middle->moved_m));
    }
  }
  for (std::size_t k = 0; k < aimed.size() && k < result.stations.size() && in_room; ++k) {
    const rig::AimedStation& one = aimed[k];
    std::vector<calib::assess::LitPlace> corners;
    for (int repeat = 0; repeat < 2; ++repeat) {  // eight: a movement of the whole takes six
      for (const Eigen::Vector2d& x : one.panel) {
        corners.push_back({.command_rad = *one.station.command_rad, .x = x});
      }
    }
    const calib::steer::Surface plane{.point = one.corners_room[0], .normal = one.normals_room[0]};
    if (const auto moved = calib::assess::rig_difference(ours, theirs, plane, corners)) {
      result.stations[k].moved_mm = moved->max_mm;
    }
  }
  return ok();
}

void print_difference(Context& context, const report::RigResult& result) {
  for (const report::RigDifferenceResult& difference : result.difference) {
    context.json()["difference"] = report::difference_json(difference);
    context.print(fmt::format("against before   {}\n", difference.sentence));
    for (const report::StationRow& station : result.stations) {
      if (std::isfinite(station.moved_mm)) {
        context.json()["difference"]["stations"].push_back({{"name", station.name}, {"moved_mm", station.moved_mm}});
        context.print(fmt::format("  {:<14} {:.2f} mm\n", station.name, station.moved_mm));
      }
    }
  }
}

}  // namespace raysteer::host::cli
