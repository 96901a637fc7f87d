#include "host/tour/show.hpp"

#include <string>
#include <system_error>
#include <utility>

#include "host/exchange/write_file.hpp"
#include "host/session/image_codec.hpp"

namespace raysteer::host::tour {
namespace {

using sim::Json;

Json json_of(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

// These throw what nlohmann throws; show() catches it.
Eigen::Vector3d vector_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

std::vector<std::filesystem::path> files_of(const Json& json, const std::filesystem::path& folder,
                                            std::size_t expected) {
  std::vector<std::filesystem::path> files;
  for (const Json& name : json) {
    files.push_back(folder / name.get<std::string>());
  }
  if (files.size() != expected) {
    throw std::out_of_range(std::to_string(files.size()) + " files instead of " + std::to_string(expected));
  }
  return files;
}

Shown answer(const Json& json, const ShowRequest& request, std::size_t pictures, const std::filesystem::path& folder) {
  Shown shown;
  const std::size_t photographs = request.photograph ? pictures : 0;
  shown.frames = {files_of(json.at("left"), folder, photographs), files_of(json.at("right"), folder, photographs)};
  shown.room = files_of(json.at("room"), folder, request.room ? pictures : 0);
  for (const Json& point : json.at("lit_points")) {
    shown.lit_points.push_back(point.is_null() ? std::nullopt : std::optional(vector_of(point)));
  }
  if (shown.lit_points.size() != request.panel_pixels.size()) {
    throw std::out_of_range("lit points are not one a panel pixel");
  }
  if (const Json& target = json.at("target"); !target.is_null()) {
    shown.T_rig_target = calib::model::Pose{calib::model::rotation_by(vector_of(target.at("rotation"))),
                                            vector_of(target.at("translation"))};
  }
  return shown;
}

}  // namespace

std::optional<Eigen::Vector2d> RoomView::pixel(const Eigen::Vector3d& p) const {
  const Eigen::Vector3d forward = (look_at - eye).normalized();
  const Eigen::Vector3d right = forward.cross(up).normalized();
  const Eigen::Vector3d to = p - eye;
  const double depth = to.dot(forward);
  if (depth <= 1e-6) {
    return std::nullopt;
  }
  return Eigen::Vector2d(0.5 * (width - 1), 0.5 * (height - 1)) +
         focal_px / depth * Eigen::Vector2d(to.dot(right), to.dot(forward.cross(right)));
}

Result<Shown> show(const sim::PretendOptions& pretend, const ShowRequest& request,
                   const std::vector<Image<std::uint8_t>>& pictures, const std::filesystem::path& folder,
                   const sim::Listener& listener) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    return fail(RCode::kWriteFailed, folder.string() + ": " + error.message(), error.value());
  }
  Json json{{"mirror_rad", request.mirror_rad},
            {"prepare", request.prepare},
            {"expose_for", request.expose_for_first ? "first" : "white"},
            {"pictures", Json::array()},
            {"photograph", request.photograph},
            {"panel_pixels", Json::array()}};
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const std::string name = "picture_" + std::to_string(i) + ".png";
    const auto png = session::encode_png(pictures[i].view());
    if (!png) {
      return png.error();
    }
    RAYSTEER_TRY(session::write_file(folder / name, *png));
    json["pictures"].push_back(name);
  }
  if (request.room) {
    const RoomView& room = *request.room;
    json["room"] = {{"width", room.width},
                    {"height", room.height},
                    {"focal_px", room.focal_px},
                    {"eye", json_of(room.eye)},
                    {"look_at", json_of(room.look_at)},
                    {"up", json_of(room.up)}};
  }
  for (const Eigen::Vector2d& x : request.panel_pixels) {
    json["panel_pixels"].push_back({x.x(), x.y()});
  }
  RAYSTEER_TRY(exchange::write_file(folder / "request.json", json.dump(1) + "\n"));

  std::vector<std::string> words = pretend.arguments();
  words.insert(words.begin(), "show");
  words.insert(words.end(), {"--request", (folder / "request.json").string(), "--out", folder.string()});
  const Result<Json> shown = sim::run(std::move(words), listener);
  if (!shown) {
    return shown.error();
  }
  try {
    return answer(*shown, request, pictures.size(), folder);
  } catch (const std::exception& exception) {
    return fail(RCode::kBadValue,
                "raysteer-sim show answered something else than asked: " + std::string(exception.what()));
  }
}

}  // namespace raysteer::host::tour
