#include "host/report/result.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <type_traits>

#include "host/exchange/write_file.hpp"
#include "host/report/page.hpp"

namespace raysteer::host::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFormatVersion = 1;

// Each structure lists its members once; Writer and Reader walk the list in turn.

template <class Archive>
void members(Archive& archive, Grid& grid) {
  archive("columns", grid.columns);
  archive("rows", grid.rows);
  archive("values", grid.values);
}

template <class Archive>
void members(Archive& archive, Judgement& judgement) {
  archive("verdict", judgement.verdict);
  archive("summary", judgement.summary);
  archive("reasons", judgement.reasons);
  archive("advice", judgement.advice);
}

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
void members(Archive& archive, Fact& fact) {
  archive("name", fact.name);
  archive("value", fact.value);
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

class Writer {
 public:
  template <class T>
  void operator()(const char* key, T& value) {
    object_[key] = to_json(value);
  }
  template <class T>
  static Json write(T& value) {
    Writer writer;
    members(writer, value);
    return std::move(writer.object_);
  }

 private:
  static Json to_json(double value) {
    if (std::isfinite(value)) {
      return value;
    }
    return std::isinf(value) ? Json(value > 0 ? "infinite" : "-infinite") : Json();
  }
  static Json to_json(bool value) { return value; }
  static Json to_json(int value) { return value; }
  static Json to_json(std::int64_t value) { return value; }
  static Json to_json(std::string& value) { return value; }
  // Thousands of these: an array each, to a ten-thousandth of a pixel.
  static Json to_json(ResidualVector& value) {
    const auto round = [](double number) { return std::round(number * 1e4) / 1e4; };
    return Json::array({value.view, round(value.x), round(value.y), round(value.dx), round(value.dy), value.kept});
  }
  template <class T>
  static Json to_json(std::vector<T>& values) {
    Json array = Json::array();
    for (T& value : values) {
      array.push_back(to_json(value));
    }
    return array;
  }
  template <class T>
  requires std::is_class_v<T>
  static Json to_json(T& value) { return write(value); }

  Json object_ = Json::object();
};

// Throws nlohmann's exceptions or std::runtime_error; read_result turns them into an error.
class Reader {
 public:
  explicit Reader(const Json& object) : object_(object) {}
  template <class T>
  void operator()(const char* key, T& value) {
    try {
      from_json(object_.at(key), value);
    } catch (const Json::exception& error) {
      throw std::runtime_error(std::string(key) + ": " + error.what());
    }
  }

 private:
  static void from_json(const Json& json, double& value) {
    if (json.is_string()) {
      value = json.get<std::string>() == "infinite" ? HUGE_VAL : -HUGE_VAL;
    } else {
      value = json.is_null() ? kUnknown : json.get<double>();
    }
  }
  static void from_json(const Json& json, bool& value) { json.get_to(value); }
  static void from_json(const Json& json, int& value) { json.get_to(value); }
  static void from_json(const Json& json, std::int64_t& value) { json.get_to(value); }
  static void from_json(const Json& json, std::string& value) { json.get_to(value); }
  static void from_json(const Json& json, ResidualVector& value) {
    value = {json.at(0), json.at(1), json.at(2), json.at(3), json.at(4), json.at(5)};
  }
  template <class T>
  static void from_json(const Json& json, std::vector<T>& values) {
    values.clear();
    for (const Json& item : json) {
      from_json(item, values.emplace_back());
    }
  }
  static void from_json(const Json& json, Grid& grid) {
    Reader reader(json);
    members(reader, grid);
    if (grid.columns < 0 || grid.rows < 0 || grid.columns > 1000 || grid.rows > 1000 ||
        grid.values.size() != static_cast<std::size_t>(grid.columns * grid.rows)) {
      throw std::runtime_error("a map has " + std::to_string(grid.values.size()) + " values for " +
                               std::to_string(grid.columns) + " x " + std::to_string(grid.rows) + " cells");
    }
  }
  template <class T>
  requires std::is_class_v<T>
  static void from_json(const Json& json, T& value) {
    Reader reader(json);
    members(reader, value);
  }

  const Json& object_;
};

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

}  // namespace

Json summary_json(const AnyResult& result) {
  return std::visit([](const auto& known) { return summary_of(known); }, result);
}

Json result_json(const AnyResult& result) {
  Json object = {{"format_version", kFormatVersion}, {"created_by", "raysteer " RAYSTEER_VERSION}};
  object.update(summary_json(result));
  AnyResult copy = result;  // the member lists serve reading too, so they want a changeable value
  object["detail"] = std::visit([](auto& known) { return Writer::write(known); }, copy);
  return object;
}

Status write_result(const std::filesystem::path& folder, const AnyResult& result) {
  const std::string text = result_json(result).dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
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
    return fail(RCode::kNothingToReport, path.string() + ": its kind is '" + kind + "', not calibration or scan");
  } catch (const std::exception& error) {
    return fail(RCode::kBadValue, path.string() + ": " + error.what());
  }
}

}  // namespace raysteer::host::report
