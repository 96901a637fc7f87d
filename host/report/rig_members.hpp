// bound to one thread: the members of a rig's result, for archive.hpp.
#pragma once

#include "host/report/archive.hpp"
#include "host/report/rig_result.hpp"

namespace raysteer::host::report {

template <class Archive>
void members(Archive& archive, FloorCell& value) {
  archive("outline_m", value.outline_m);
  archive("mm", value.mm);
}

template <class Archive>
void members(Archive& archive, FloorArrow& value) {
  archive("x_m", value.x_m);
  archive("y_m", value.y_m);
  archive("dx_mm", value.dx_mm);
  archive("dy_mm", value.dy_mm);
}

template <class Archive>
void members(Archive& archive, LookRow& value) {
  archive("name", value.name);
  archive("held_out", value.held_out);
  archive("x_m", value.x_m);
  archive("y_m", value.y_m);
  archive("command_mrad", value.command_mrad);
  archive("latent_urad", value.latent_urad);
  archive("whitened_rms", value.whitened_rms);
  archive("median_px", value.median_px);
  archive("p95_px", value.p95_px);
}

template <class Archive>
void members(Archive& archive, DatumRow& value) {
  archive("name", value.name);
  archive("x_m", value.x_m);
  archive("y_m", value.y_m);
  archive("miss_mm", value.miss_mm);
  archive("size_mm", value.size_mm);
  archive("sigma_mm", value.sigma_mm);
}

template <class Archive>
void members(Archive& archive, LengthRow& value) {
  archive("between", value.between);
  archive("measured_mm", value.measured_mm);
  archive("known_mm", value.known_mm);
  archive("sigma_mm", value.sigma_mm);
}

template <class Archive>
void members(Archive& archive, StationRow& value) {
  archive("name", value.name);
  archive("outline_m", value.outline_m);
  archive("bound_95_mm", value.bound_95_mm);
  archive("error_mm", value.error_mm);
  archive("sure_mm", value.sure_mm);
  archive("tolerance_mm", value.tolerance_mm);
  archive("within", value.within);
  archive("off", value.off);
  archive("moved_mm", value.moved_mm);
}

template <class Archive>
void members(Archive& archive, OffDrawingRow& value) {
  archive("parameter", value.parameter);
  archive("sigmas", value.sigmas);
}

template <class Archive>
void members(Archive& archive, RigDifferenceResult& value) {
  archive("earlier", value.earlier);
  archive("frame", value.frame);
  archive("sentence", value.sentence);
  archive("mean_mm", value.mean_mm);
  archive("p95_mm", value.p95_mm);
  archive("max_mm", value.max_mm);
  archive("whole_rms_mm", value.whole_rms_mm);
  archive("inside_rms_mm", value.inside_rms_mm);
  archive("beyond_chance", value.beyond_chance);
  archive("turned_mrad", value.turned_mrad);
  archive("shifted_mm", value.shifted_mm);
  archive("cells", value.cells);
  archive("arrows", value.arrows);
}

template <class Archive>
void members(Archive& archive, RigResult& value) {
  archive("kind", value.kind);
  archive("judgement", value.judgement);
  archive("session", value.session);
  archive("board", value.board);
  archive("calibration_id", value.calibration_id);
  archive("floor", value.floor);
  archive("floor_pose", value.floor_pose);
  archive("tied_to_room", value.tied_to_room);
  archive("reach_median_95_mm", value.reach_median_95_mm);
  archive("reach_worst_95_mm", value.reach_worst_95_mm);
  archive("reach", value.reach);
  archive("looks", value.looks);
  archive("held_out", value.held_out);
  archive("held_out_median_px", value.held_out_median_px);
  archive("held_out_p95_px", value.held_out_p95_px);
  archive("held_out_median_mm", value.held_out_median_mm);
  archive("held_out_p95_mm", value.held_out_p95_mm);
  archive("whitened_rms", value.whitened_rms);
  archive("repeatability_urad", value.repeatability_urad);
  archive("points_used", value.points_used);
  archive("points_dropped", value.points_dropped);
  archive("panel_width", value.panel_width);
  archive("panel_height", value.panel_height);
  archive("residuals", value.residuals);
  archive("datums", value.datums);
  archive("scale", value.scale);
  archive("scale_sigma", value.scale_sigma);
  archive("scale_by_lengths", value.scale_by_lengths);
  archive("lengths", value.lengths);
  archive("off_drawing", value.off_drawing);
  archive("stations", value.stations);
  archive("difference", value.difference);
  archive("facts", value.facts);
}

}  // namespace raysteer::host::report
