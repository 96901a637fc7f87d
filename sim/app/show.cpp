// Content pictures at one look, photographed and explained by the truth:
// docs/show-format.md.
#include <system_error>
#include <utility>
#include <variant>

#include "proto/session/raw_frame.hpp"
#include "sim/app/find_file.hpp"
#include "sim/app/grey_picture.hpp"
#include "sim/app/modes.hpp"
#include "sim/app/onlooker.hpp"
#include "sim/app/write_file.hpp"
#include "sim/rig/showing.hpp"
#include "sim/world/png.hpp"

namespace raysteer::sim::app {
namespace {

namespace fs = std::filesystem;

struct Request {
  std::array<double, 2> mirror_rad{};
  std::vector<std::string> prepare;  // one for all pictures, or one a picture
  std::vector<std::string> pictures;
  bool expose_for_first = false;  // instead of for white
  std::optional<std::chrono::microseconds> exposure;
  bool photograph = true;
  std::optional<world::RoomView> room;
  std::vector<ProjectorPx> panel_pixels;
};

// These throw what nlohmann throws; read_request() catches it.
Eigen::Vector3d vector_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

world::RoomView room_of(const Json& json) {
  world::RoomView view;
  view.width = json.value("width", view.width);
  view.height = json.value("height", view.height);
  view.focal_px = json.value("focal_px", view.focal_px);
  view.eye = vector_of(json.at("eye"));
  view.look_at = vector_of(json.at("look_at"));
  view.up = vector_of(json.at("up"));
  return view;
}

Result<Request> read_request(const fs::path& file) {
  const Result<std::string> text = read_text(file);
  if (!text) {
    return text.error();
  }
  constexpr std::array kKnown{"mirror_rad", "prepare", "pictures",     "exposure_us",
                              "photograph", "room",    "panel_pixels", "expose_for"};
  try {
    const Json json = Json::parse(*text);
    for (const auto& [key, value] : json.items()) {
      if (std::ranges::find(kKnown, key) == kKnown.end()) {
        return fail(RCode::kUnknownKey, file.string() + ": '" + key + "'");
      }
    }
    Request request;
    request.mirror_rad = {json.at("mirror_rad").at(0).get<double>(), json.at("mirror_rad").at(1).get<double>()};
    request.pictures = json.at("pictures").get<std::vector<std::string>>();
    if (const Json prepare = json.value("prepare", Json("")); prepare.is_array()) {
      request.prepare = prepare.get<std::vector<std::string>>();
    } else {
      request.prepare = {prepare.get<std::string>()};
    }
    if (request.prepare.size() != 1 && request.prepare.size() != request.pictures.size()) {
      return fail(RCode::kBadValue, file.string() + ": 'prepare' is one text, or one a picture");
    }
    const std::string expose_for = json.value("expose_for", "white");
    if (expose_for != "white" && expose_for != "first") {
      return fail(RCode::kBadValue, file.string() + ": 'expose_for' is \"white\" or \"first\"");
    }
    request.expose_for_first = expose_for == "first" && !request.pictures.empty();
    if (json.contains("exposure_us")) {
      request.exposure = std::chrono::microseconds(json["exposure_us"].get<std::int64_t>());
    }
    request.photograph = json.value("photograph", true);
    if (json.contains("room")) {
      request.room = room_of(json["room"]);
    }
    for (const Json& pixel : json.value("panel_pixels", Json::array())) {
      request.panel_pixels.emplace_back(pixel.at(0).get<double>(), pixel.at(1).get<double>());
    }
    return request;
  } catch (const std::exception& exception) {
    return fail(RCode::kBadValue, file.string() + ": " + exception.what());
  }
}

Status write_raw(const fs::path& file, const Frame& frame) {
  const std::vector<std::uint8_t> bytes =
      std::visit([](const auto& pixels) { return proto::session::write_raw_frame(pixels.view()); }, frame);
  return write_whole(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

Json lit_points(rig::PretendRig& rig, const std::vector<ProjectorPx>& pixels) {
  const hal::MirrorAngles mirror = rig.mock().mirror().true_angles(rig.now());
  const ProjectorPx drift = rig.mock().projector().drift(rig.now());
  Json points = Json::array();
  for (const ProjectorPx& x : pixels) {
    const auto lit = rig.world().lit_point(mirror, {x.x + drift.x, x.y + drift.y}, rig.now());
    points.push_back(lit ? Json{lit->p.x(), lit->p.y(), lit->p.z()} : Json());
  }
  return points;
}

Json target(const rig::PretendRig& rig, const scene::Scene& scene) {
  if (scene.targets.empty()) {
    return nullptr;
  }
  const auto T_room_target =
      scene.surfaces[scene.targets.front().surface].pose({.time = rig.now(), .target_pose = rig.target_pose()});
  if (!T_room_target) {
    return nullptr;
  }
  const Eigen::Isometry3d T = scene.T_room_rig.inverse() * *T_room_target;
  const Eigen::AngleAxisd turn(T.linear());
  const Eigen::Vector3d rotation = turn.angle() * turn.axis();
  return {{"rotation", {rotation.x(), rotation.y(), rotation.z()}},
          {"translation", {T.translation().x(), T.translation().y(), T.translation().z()}}};
}

Status make_folders(const fs::path& out) {
  std::error_code error;
  for (const char* name : {"left", "right", "room"}) {
    fs::create_directories(out / name, error);
    if (error) {
      return fail(RCode::kWriteFailed, (out / name).string() + ": " + error.message(), error.value());
    }
  }
  return ok();
}

// One picture: shown, photographed, looked at.
struct Stage {
  rig::PretendRig& rig;
  rig::Showing& showing;
  const Request& request;
  const fs::path& out;
  std::optional<std::chrono::microseconds> exposure;

  Status one(std::size_t k, const Image<std::uint8_t>& content, Json& shown) {
    if (request.prepare.size() > 1) {
      RAYSTEER_TRY(rig.prepare(request.prepare[k]));
    }
    RAYSTEER_TRY(showing.show(content.view()));
    const std::string number = std::to_string(k);
    if (request.photograph) {
      const Result<hal::FramePair> pair = showing.photograph(*exposure);
      RAYSTEER_TRY(pair);
      RAYSTEER_TRY(write_raw(out / "left" / (number + ".raw"), pair->left->pixels));
      RAYSTEER_TRY(write_raw(out / "right" / (number + ".raw"), pair->right->pixels));
      shown["left"].push_back("left/" + number + ".raw");
      shown["right"].push_back("right/" + number + ".raw");
    }
    if (request.room) {
      const Image<std::uint8_t> seen = rig.world().room_picture(*request.room, glance(rig));
      RAYSTEER_TRY(world::save_png(seen.view(), (out / "room" / (number + ".png")).string()));
      shown["room"].push_back("room/" + number + ".png");
    }
    return ok();
  }
};

}  // namespace

Result<Json> show(const ShowRequest& asked, Say& say) {
  const Result<Request> request = read_request(asked.request);
  if (!request) {
    return request.error();
  }
  Result<LoadedRig> loaded = load_rig(asked.which);
  if (!loaded) {
    return std::move(loaded).error();
  }
  std::vector<Image<std::uint8_t>> contents;
  for (const std::string& name : request->pictures) {
    Result<Image<std::uint8_t>> read = read_grey(asked.request.parent_path() / name);
    if (!read) {
      return std::move(read).error();
    }
    contents.push_back(*std::move(read));
  }
  RAYSTEER_TRY(make_folders(asked.out));
  rig::PretendRig& rig = *loaded->rig;
  const scene::Scene& scene = rig.world().scene();
  RAYSTEER_TRY(rig.prepare(request->prepare.front()));
  rig::Showing showing(rig, settle_timeout(loaded->board));
  RAYSTEER_TRY(showing.aim(request->mirror_rad));
  Stage stage{rig, showing, *request, asked.out, request->exposure};
  if (request->photograph && !stage.exposure) {
    Image<std::uint8_t> white(loaded->board.projector.width, loaded->board.projector.height);
    white.fill(255);
    RAYSTEER_TRY(showing.show(request->expose_for_first ? contents.front().view() : std::as_const(white).view()));
    const Result<std::chrono::microseconds> exposure = showing.choose_exposure();
    RAYSTEER_TRY(exposure);
    stage.exposure = *exposure;
  }
  Json shown{{"left", Json::array()}, {"right", Json::array()}, {"exposure_us", 0}, {"room", Json::array()}};
  for (std::size_t k = 0; k < contents.size(); ++k) {
    say.progress("showing", static_cast<double>(k) / static_cast<double>(contents.size()));
    if (cancelled()) {
      return fail(RCode::kCancelled);
    }
    RAYSTEER_TRY(stage.one(k, contents[k], shown));
  }
  shown["exposure_us"] = stage.exposure.value_or(std::chrono::microseconds{}).count();
  shown["lit_points"] = lit_points(rig, request->panel_pixels);
  shown["target"] = target(rig, scene);
  shown["shots"] = showing.shots();
  shown["reshot"] = showing.reshot();
  shown["virtual_s"] = std::chrono::duration<double>(rig.now().time_since_epoch()).count();
  RAYSTEER_TRY(write_whole(asked.out / "shown.json", shown.dump(1) + "\n"));
  return shown;
}

}  // namespace raysteer::sim::app
