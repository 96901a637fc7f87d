#include "host/report/result.hpp"

#include <cmath>
#include <utility>

#include "host/exchange/write_file.hpp"
#include "host/report/archive.hpp"
#include "host/report/page.hpp"
#include "host/report/rig_members.hpp"

namespace raysteer::host::report {

template <class Archive>
void members(Archive& archive, ParameterRow& row) {
  archive("name", row.name);
  archive("value", row.value);
  archive("sigma", row.sigma);
  archive("unit", row.unit);
}

template <class Archive>
void members(Archive& archive, DeviceResult& device) {
  archive("name", device.name);
  archive("kind", device.kind);
  archive("width", device.width);
  archive("height", device.height);
  archive("lens", device.lens);
  archive("focal_px", device.focal_px);
  archive("rms_px", device.rms_px);
  archive("corners_seen", device.corners_seen);
  archive("corners_kept", device.corners_kept);
  archive("parameters", device.parameters);
  archive("residuals", device.residuals);
  archive("coverage", device.coverage);
  archive("uncertainty_px", device.uncertainty_px);
  archive("uncertainty_range_m", device.uncertainty_range_m);
  archive("odd_even_px", device.odd_even_px);
  archive("odd_even_median_px", device.odd_even_median_px);
  archive("odd_even_p95_px", device.odd_even_p95_px);
}

template <class Archive>
void members(Archive& archive, ViewRow& view) {
  archive("name", view.name);
  archive("used", view.used);
  archive("code", view.code);
  archive("why", view.why);
  archive("rms_px", view.rms_px);
  archive("tilt_rad", view.tilt_rad);
  archive("distance_m", view.distance_m);
}

template <class Archive>
void members(Archive& archive, LensRow& row) {
  archive("device", row.device);
  archive("lens", row.lens);
  archive("held_out_px", row.held_out_px);
  archive("monotonic", row.monotonic);
  archive("chosen", row.chosen);
}

template <class Archive>
void members(Archive& archive, DifferenceResult& difference) {
  archive("device", difference.device);
  archive("px", difference.px);
  archive("mm", difference.mm);
  archive("range_m", difference.range_m);
  archive("median_px", difference.median_px);
  archive("p95_px", difference.p95_px);
}

template <class Archive>
void members(Archive& archive, CalibrationResult& result) {
  archive("judgement", result.judgement);
  archive("session", result.session);
  archive("target", result.target);
  archive("calibration_id", result.calibration_id);
  archive("rms_px", result.rms_px);
  archive("baseline_m", result.baseline_m);
  archive("folds", result.folds);
  archive("held_out_corners", result.held_out_corners);
  archive("held_out_rms_px", result.held_out_rms_px);
  archive("held_out_median_px", result.held_out_median_px);
  archive("held_out_p95_px", result.held_out_p95_px);
  archive("leave_one_out_px", result.leave_one_out_px);
  archive("pixel_rms_px", result.pixel_rms_px);
  archive("sag_m", result.sag_m);
  archive("sag_sigma_m", result.sag_sigma_m);
  archive("devices", result.devices);
  archive("views", result.views);
  archive("lenses", result.lenses);
  archive("correlated", result.correlated);
  archive("differences", result.differences);
}

template <class Archive>
void members(Archive& archive, Histogram& histogram) {
  archive("low", histogram.low);
  archive("high", histogram.high);
  archive("counts", histogram.counts);
}

template <class Archive>
void members(Archive& archive, ScanResult& result) {
  archive("judgement", result.judgement);
  archive("session", result.session);
  archive("calibration", result.calibration);
  archive("calibration_id", result.calibration_id);
  archive("points", result.points);
  archive("matched_projector_pixels", result.matched_projector_pixels);
  archive("interpolated_projector_pixels", result.interpolated_projector_pixels);
  archive("decoded_fraction", result.decoded_fraction);
  archive("epipolar_sigma_px", result.epipolar_sigma_px);
  archive("epipolar_within_cell_px", result.epipolar_within_cell_px);
  archive("epipolar_systematic_px", result.epipolar_systematic_px);
  archive("epipolar_cells_px", result.epipolar_cells_px);
  archive("epipolar_histogram", result.epipolar_histogram);
  archive("patch_rms_m", result.patch_rms_m);
  archive("patch_predicted_rms_m", result.patch_predicted_rms_m);
  archive("patches", result.patches);
  archive("pose_moved_rad", result.pose_moved_rad);
  archive("pose_moved_sigma_rad", result.pose_moved_sigma_rad);
  archive("pose_moved", result.pose_moved);
  archive("pose_refitted", result.pose_refitted);
  archive("held_out_before_px", result.held_out_before_px);
  archive("held_out_after_px", result.held_out_after_px);
  archive("depth_histogram", result.depth_histogram);
  archive("picture", result.picture);
  archive("facts", result.facts);
}

namespace {

constexpr int kFormatVersion = 1;

void add_known(Json& object, const char* key, double value) {
  if (std::isfinite(value)) {
    object[key] = value;
  }
}

void add_judgement(Json& object, const Judgement& judgement) {
  object["verdict"] = judgement.verdict;
  object["summary"] = judgement.summary;
  object["reasons"] = judgement.reasons;
  object["advice"] = judgement.advice;
}

Json device_summary(const DeviceResult& device) {
  Json object = {{"name", device.name}, {"width", device.width}, {"height", device.height}, {"lens", device.lens}};
  add_known(object, "rms_px", device.rms_px);
  add_known(object, "focal_px", device.focal_px);
  object["corners_seen"] = device.corners_seen;
  object["corners_kept"] = device.corners_kept;
  add_known(object, "odd_even_median_px", device.odd_even_median_px);
  add_known(object, "odd_even_p95_px", device.odd_even_p95_px);
  Json parameters = Json::object();
  for (const ParameterRow& row : device.parameters) {
    Json& entry = parameters[row.name];
    entry["value"] = row.value;
    add_known(entry, "sigma", row.sigma);
    entry["unit"] = row.unit;
  }
  object["parameters"] = parameters;
  return object;
}

Json summary_of(const CalibrationResult& result) {
  Json object = {{"kind", "calibration"}};
  add_judgement(object, result.judgement);
  object["session"] = result.session;
  object["target"] = result.target;
  object["calibration_id"] = result.calibration_id;
  add_known(object, "rms_px", result.rms_px);
  object["cameras"] = Json::array();
  for (const DeviceResult& device : result.devices) {
    if (device.kind == "camera") {
      object["cameras"].push_back(device_summary(device));
    } else {
      object["projector"] = device_summary(device);
    }
  }
  if (object["cameras"].size() >= 2) {
    Json& stereo = object["stereo"] = Json::object();
    add_known(stereo, "rms_px", result.rms_px);
    add_known(stereo, "baseline_m", result.baseline_m);
  }
  Json cross = Json::object();
  add_known(cross, "rms_px", result.held_out_rms_px);
  add_known(cross, "median_px", result.held_out_median_px);
  add_known(cross, "p95_px", result.held_out_p95_px);
  cross["folds"] = result.folds;
  cross["corners"] = result.held_out_corners;
  object["cross_validation"] = cross;
  add_known(object, "leave_one_out_px", result.leave_one_out_px);
  add_known(object, "pixel_rms_px", result.pixel_rms_px);
  Json views = Json::array();
  for (const ViewRow& view : result.views) {
    Json row = {{"name", view.name}, {"used", view.used}};
    if (!view.used) {
      row["code"] = view.code;
      row["why"] = view.why;
    }
    views.push_back(row);
  }
  object["views"] = views;
  return object;
}

Json summary_of(const ScanResult& result) {
  Json object = {{"kind", "scan"}};
  add_judgement(object, result.judgement);
  object["session"] = result.session;
  object["calibration"] = result.calibration;
  object["calibration_id"] = result.calibration_id;
  object["points"] = result.points;
  object["matched_projector_pixels"] = result.matched_projector_pixels;
  object["interpolated_projector_pixels"] = result.interpolated_projector_pixels;
  add_known(object, "decoded_fraction", result.decoded_fraction);
  Json& epipolar = object["epipolar"] = Json::object();
  add_known(epipolar, "sigma_px", result.epipolar_sigma_px);
  add_known(epipolar, "within_cell_px", result.epipolar_within_cell_px);
  add_known(epipolar, "systematic_px", result.epipolar_systematic_px);
  add_known(epipolar, "held_out_before_px", result.held_out_before_px);
  add_known(epipolar, "held_out_after_px", result.held_out_after_px);
  Json& flatness = object["flatness"] = Json::object();
  add_known(flatness, "patch_rms_m", result.patch_rms_m);
  add_known(flatness, "predicted_rms_m", result.patch_predicted_rms_m);
  flatness["patches"] = result.patches;
  add_known(object, "pose_moved_rad", result.pose_moved_rad);
  add_known(object, "pose_moved_sigma_rad", result.pose_moved_sigma_rad);
  object["pose_moved"] = result.pose_moved;
  object["pose_refitted"] = result.pose_refitted;
  return object;
}

Json summary_of(const RigResult& result) {
  Json object = {{"kind", result.kind}};
  add_judgement(object, result.judgement);
  object["session"] = result.session;
  object["board"] = result.board;
  object["calibration_id"] = result.calibration_id;
  object["tied_to_room"] = result.tied_to_room;
  Json reach = Json::object();
  add_known(reach, "median_95_mm", result.reach_median_95_mm);
  add_known(reach, "worst_95_mm", result.reach_worst_95_mm);
  if (!reach.empty()) {
    object["reach"] = reach;
  }
  for (const StationRow& station : result.stations) {
    Json row = {{"name", station.name}, {"tolerance_mm", station.tolerance_mm}, {"within", station.within}};
    add_known(row, "error_mm", station.error_mm);
    add_known(row, "bound_95_mm", station.bound_95_mm);
    add_known(row, "moved_mm", station.moved_mm);
    object["stations"].push_back(row);
  }
  for (const RigDifferenceResult& difference : result.difference) {
    object["difference"] = difference_json(difference);
  }
  return object;
}

}  // namespace

Json difference_json(const RigDifferenceResult& difference) {
  Json object = {{"earlier", difference.earlier}, {"frame", difference.frame}, {"sentence", difference.sentence}};
  add_known(object, "mean_mm", difference.mean_mm);
  add_known(object, "p95_mm", difference.p95_mm);
  add_known(object, "max_mm", difference.max_mm);
  add_known(object, "whole_rms_mm", difference.whole_rms_mm);
  add_known(object, "inside_rms_mm", difference.inside_rms_mm);
  add_known(object, "beyond_chance", difference.beyond_chance);
  add_known(object, "turned_mrad", difference.turned_mrad);
  add_known(object, "shifted_mm", difference.shifted_mm);
  return object;
}

Json summary_json(const AnyResult& result) {
  return std::visit([](const auto& known) { return summary_of(known); }, result);
}

namespace {

Json whole_json(const AnyResult& result, const Json& more) {
  Json object = {{"format_version", kFormatVersion}, {"created_by", "raysteer " RAYSTEER_VERSION}};
  object.update(summary_json(result));
  object.update(more);
  AnyResult copy = result;  // the member lists serve reading too, so they want a changeable value
  object["detail"] = std::visit([](auto& known) { return Writer::write(known); }, copy);
  return object;
}

}  // namespace

Json result_json(const AnyResult& result) { return whole_json(result, Json::object()); }

Status write_result(const std::filesystem::path& folder, const AnyResult& result) {
  return write_result(folder, result, Json::object());
}

Status write_result(const std::filesystem::path& folder, const AnyResult& result, const Json& more) {
  const std::string text = whole_json(result, more).dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
  RAYSTEER_TRY(exchange::write_file(folder / "result.json", text));
  return exchange::write_file(folder / "report.html", page(result, folder));
}

Result<AnyResult> read_result(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "result.json";
  const Result<std::string> text = exchange::read_file(path);
  if (!text) {
    return fail(RCode::kNothingToReport, text.error().note);
  }
  try {
    const Json object = Json::parse(*text);
    if (const int version = object.at("format_version"); version != kFormatVersion) {
      return fail(RCode::kFormatVersion, path.string() + ": format_version is " + std::to_string(version) +
                                             ", known is " + std::to_string(kFormatVersion));
    }
    const std::string kind = object.at("kind");
    Reader reader(object);
    if (kind == "calibration") {
      CalibrationResult result;
      reader("detail", result);
      return AnyResult(std::move(result));
    }
    if (kind == "scan") {
      ScanResult result;
      reader("detail", result);
      return AnyResult(std::move(result));
    }
    if (kind == "rig" || kind == "tables" || kind == "verification") {
      RigResult result;
      reader("detail", result);
      return AnyResult(std::move(result));
    }
    return fail(RCode::kNothingToReport, path.string() + ": its kind is '" + kind +
                                             "', expected calibration, scan, rig, tables or verification");
  } catch (const std::exception& error) {
    return fail(RCode::kBadValue, path.string() + ": " + error.what());
  }
}

}  // namespace raysteer::host::report
