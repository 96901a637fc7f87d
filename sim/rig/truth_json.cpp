#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "sim/rig/truth.hpp"

namespace raysteer::sim::rig {
namespace {

using Json = nlohmann::ordered_json;

// A surface of more is left out: nobody compares with it point by point.
constexpr std::size_t kMostTriangles = 5'000;

Json json_of(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Json json_of(const Eigen::Isometry3d& T) {
  const Eigen::Quaterniond q(T.linear());
  return {{"rotation_wxyz", {q.w(), q.x(), q.y(), q.z()}}, {"translation_m", json_of(T.translation())}};
}

Json device(const std::string& name, const char* kind, int width, int height, const optics::Lens& lens,
            const Eigen::Isometry3d& T_device_rig) {
  const optics::LensNumbers& numbers = lens.numbers();
  Json distortion = Json::array();
  for (const double k : numbers.distortion) {
    distortion.push_back(k);
  }
  distortion.insert(distortion.end(), {0.0, 0.0, 0.0});  // k4 to k6 of the widest lens model
  return {{"name", name},
          {"kind", kind},
          {"width", width},
          {"height", height},
          {"fx", numbers.focal_px.x()},
          {"fy", numbers.focal_px.y()},
          {"cx", numbers.centre_px.x()},
          {"cy", numbers.centre_px.y()},
          {"lens", numbers.distortion[4] == 0 ? "bc4" : "bc5"},
          {"distortion", distortion},
          {"T_device_rig", json_of(T_device_rig)}};
}

Json mirror(const Truth& truth) {
  const optics::TrueMirror& mirror = truth.rig.mirror;
  Json json{{"kind", mirror.head ? "head" : "galvo-pair"}, {"frame", "projector"}};
  for (std::size_t k = 0; k < static_cast<std::size_t>(mirror.count()); ++k) {
    const optics::MirrorPart& part = mirror.parts[k];
    json["planes"].push_back({{"axis", json_of(part.axis)},
                              {"point_m", json_of(part.point)},
                              {"normal", json_of(part.normal)},
                              {"offset_m", part.offset_m},
                              {"size_m", {2 * part.half_size_m.x(), 2 * part.half_size_m.y()}},
                              {"outline", part.ellipse ? "ellipse" : "rectangle"}});
  }
  if (mirror.head) {
    json["outer_axis"] = json_of(mirror.outer_axis);
    json["outer_point_m"] = json_of(mirror.outer_point);
  }
  for (const hal::mock::CommandCurve& curve : truth.curves) {
    json["curves"].push_back({{"half_range_rad", curve.half_range},
                              {"gain", curve.gain},
                              {"quadratic", curve.quadratic},
                              {"cubic", curve.cubic},
                              {"cross_talk", curve.cross_talk}});
  }
  return json;
}

// Every surface but targets, which are moved about, and people.
void add_surfaces(Json& json, const scene::Scene& scene) {
  const Eigen::Isometry3d T_rig_room = scene.T_room_rig.inverse();
  json["meshes"] = Json::array();
  json["meshes_complete"] = true;
  for (const scene::Surface& surface : scene.surfaces) {
    const auto pose = surface.pose({});
    if (surface.moves() || surface.is_target || !pose) {
      continue;
    }
    if (surface.mesh.triangles.size() > kMostTriangles) {
      json["meshes_complete"] = false;
      continue;
    }
    const Eigen::Isometry3d T_rig_surface = T_rig_room * *pose;
    Json mesh{{"name", surface.name}, {"points_m", Json::array()}, {"triangles", Json::array()}};
    for (const Eigen::Vector3d& p : surface.mesh.vertices) {
      mesh["points_m"].push_back(json_of(T_rig_surface * p));
    }
    for (const scene::Triangle& triangle : surface.mesh.triangles) {
      mesh["triangles"].push_back({triangle[0], triangle[1], triangle[2]});
    }
    json["meshes"].push_back(std::move(mesh));
  }
}

}  // namespace

std::string truth_json(const Truth& truth, const scene::Scene& scene, std::span<const LookTruth> looks) {
  Json json{{"format", 1}, {"seed", truth.seed}, {"devices", Json::array()}};
  for (const optics::TrueCamera& camera : truth.rig.cameras) {
    json["devices"].push_back(
        device(camera.name, "camera", camera.width, camera.height, camera.lens, camera.T_camera_rig));
  }
  // As it is mounted, without its mirrors: not what a calibration of one look
  // finds.
  const optics::TrueProjector& projector = truth.rig.projector;
  json["projector"] =
      device("projector", "projector", projector.width, projector.height, projector.lens, projector.T_projector_rig);
  json["projector"]["lumens"] = projector.lumens;
  json["projector"]["focus_m"] = projector.focus_m;
  json["projector"]["pupil_m"] = projector.pupil_m;
  json["mirror"] = mirror(truth);
  json["T_room_rig"] = json_of(scene.T_room_rig);
  add_surfaces(json, scene);
  for (const LookTruth& look : looks) {
    json["looks"].push_back({{"name", look.name}, {"mirror_rad", look.mirror_rad}});
  }
  return json.dump(1) + "\n";
}

}  // namespace raysteer::sim::rig
