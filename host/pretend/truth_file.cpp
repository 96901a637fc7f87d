#include "host/pretend/truth_file.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>
#include <vector>

#include "host/exchange/write_file.hpp"

namespace raysteer::host::pretend {
namespace {

using Json = nlohmann::ordered_json;
using calib::model::Camera;
using calib::model::Device;
using calib::model::DeviceKind;
using calib::model::Pose;
using calib::model::Rig;

constexpr int kFormat = 1;

Json list(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

Json json_of(const Pose& pose) {
  return {{"rotation_wxyz", {pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z()}}, {"translation_m", list(pose.t)}};
}

// These throw what nlohmann throws; truth_from_json() catches it.

Eigen::Vector3d vector_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

Pose pose_of(const Json& json) {
  const Json& q = json.at("rotation_wxyz");
  Pose pose;
  pose.q =
      Eigen::Quaterniond(q.at(0).get<double>(), q.at(1).get<double>(), q.at(2).get<double>(), q.at(3).get<double>())
          .normalized();
  pose.t = vector_of(json.at("translation_m"));
  return pose;
}

Device device_of(const Json& json) {
  Device device;
  device.name = json.at("name").get<std::string>();
  device.kind = json.at("kind") == "projector" ? DeviceKind::kProjector : DeviceKind::kCamera;
  Camera& camera = device.camera;
  camera.width = json.at("width").get<int>();
  camera.height = json.at("height").get<int>();
  camera.fx = json.at("fx").get<double>();
  camera.fy = json.at("fy").get<double>();
  camera.cx = json.at("cx").get<double>();
  camera.cy = json.at("cy").get<double>();
  camera.lens = calib::model::lens_from_string(json.at("lens").get<std::string>()).value_or(camera.lens);
  camera.k = json.at("distortion").get<std::array<double, 8>>();
  device.T_device_rig = pose_of(json.at("T_device_rig"));
  return device;
}

calib::model::SteeredProjector projector_of(const Json& projector, const Json& mirror) {
  calib::model::SteeredProjector steered;
  const Device device = device_of(projector);
  steered.lens = device.camera;
  steered.T_projector_rig = device.T_device_rig;
  const bool head = mirror.at("kind") == "head";
  steered.kind = head ? calib::model::MirrorKind::kHead : calib::model::MirrorKind::kGalvoPair;
  for (std::size_t k = 0; k < (head ? 1U : 2U); ++k) {
    const Json& plane = mirror.at("planes").at(k);
    steered.parts[k] = {.axis = vector_of(plane.at("axis")),
                        .point = vector_of(plane.at("point_m")),
                        .normal = vector_of(plane.at("normal")),
                        .offset_m = plane.at("offset_m").get<double>(),
                        .size_m = {plane.at("size_m").at(0).get<double>(), plane.at("size_m").at(1).get<double>()},
                        .ellipse = plane.at("outline") == "ellipse"};
  }
  if (head) {
    steered.outer_axis = vector_of(mirror.at("outer_axis"));
    steered.outer_point = vector_of(mirror.at("outer_point_m"));
  }
  for (std::size_t k = 0; k < 2; ++k) {
    const Json& curve = mirror.at("curves").at(k);
    steered.curves[k] = {.half_range = curve.at("half_range_rad").get<double>(),
                         .gain = curve.at("gain").get<double>(),
                         .quadratic = curve.at("quadratic").get<double>(),
                         .cubic = curve.at("cubic").get<double>(),
                         .cross_talk = curve.at("cross_talk").get<double>()};
  }
  return steered;
}

void add_mesh(const Json& json, std::vector<Triangle>& triangles) {
  const Json& points = json.at("points_m");
  for (const Json& corners : json.at("triangles")) {
    Triangle& triangle = triangles.emplace_back();
    for (std::size_t k = 0; k < triangle.size(); ++k) {
      triangle[k] = vector_of(points.at(corners.at(k).get<std::size_t>()));
    }
  }
}

/// Rotation vector of `solved` after `truth`: the left increment of Rig's covariance.
Eigen::Vector3d turn(const Pose& solved, const Pose& truth) {
  const Eigen::AngleAxisd turned(solved.q * truth.q.conjugate());
  return turned.angle() * turned.axis();
}

}  // namespace

std::string to_json(const TruthFile& truth) {
  Json json{{"format", kFormat}, {"seed", truth.seed}};
  for (const Device& device : truth.rig.devices) {
    const Camera& camera = device.camera;
    json["devices"].push_back({{"name", device.name},
                               {"kind", device.kind == DeviceKind::kProjector ? "projector" : "camera"},
                               {"width", camera.width},
                               {"height", camera.height},
                               {"fx", camera.fx},
                               {"fy", camera.fy},
                               {"cx", camera.cx},
                               {"cy", camera.cy},
                               {"lens", to_string(camera.lens)},
                               {"distortion", camera.k},
                               {"T_device_rig", json_of(device.T_device_rig)}});
  }
  json["plates"] = Json::array();
  for (const calib::synth::Plate& plate : truth.scene.plates) {
    json["plates"].push_back(
        {{"u_m", {plate.u0, plate.u1}}, {"v_m", {plate.v0, plate.v1}}, {"T_rig_plate", json_of(plate.T_rig_plate)}});
  }
  json["balls"] = Json::array();
  for (const calib::synth::Ball& ball : truth.scene.balls) {
    json["balls"].push_back({{"centre_m", list(ball.centre)}, {"radius_m", ball.radius}});
  }
  return json.dump(2) + "\n";
}

Result<TruthFile> truth_from_json(std::string_view text) {
  try {
    const Json json = Json::parse(text);
    TruthFile truth;
    if (json.at("format") != kFormat) {
      return fail(RCode::kBadValue, "truth.json: format must be 1");
    }
    truth.seed = json.at("seed").get<std::uint64_t>();
    for (const Json& device : json.at("devices")) {
      truth.rig.devices.push_back(device_of(device));
    }
    for (const Json& each : json.value("plates", Json::array())) {
      calib::synth::Plate plate;
      plate.T_rig_plate = pose_of(each.at("T_rig_plate"));
      plate.u0 = each.at("u_m").at(0).get<double>();
      plate.u1 = each.at("u_m").at(1).get<double>();
      plate.v0 = each.at("v_m").at(0).get<double>();
      plate.v1 = each.at("v_m").at(1).get<double>();
      truth.scene.plates.push_back(std::move(plate));
    }
    for (const Json& ball : json.value("balls", Json::array())) {
      truth.scene.balls.push_back({vector_of(ball.at("centre_m")), ball.at("radius_m").get<double>()});
    }
    for (const Json& mesh : json.value("meshes", Json::array())) {
      add_mesh(mesh, truth.triangles);
    }
    truth.has_surfaces = json.value("meshes_complete", true);
    if (json.contains("projector") && json.contains("mirror")) {
      truth.projector = projector_of(json.at("projector"), json.at("mirror"));
    }
    if (json.contains("T_room_rig")) {
      truth.T_room_rig = pose_of(json.at("T_room_rig"));
    }
    for (const Json& look : json.value("looks", Json::array())) {
      const Json& angles = look.at("mirror_rad");
      truth.angles_rad[look.at("name").get<std::string>()] = {angles.at(0).get<double>(), angles.at(1).get<double>()};
    }
    return truth;
  } catch (const std::exception& exception) {
    return fail(RCode::kBadValue, std::string("truth.json: ") + exception.what());
  }
}

Result<std::optional<TruthFile>> truth_beside(const std::filesystem::path& session_file) {
  const std::filesystem::path path = session_file.parent_path() / kTruthFile;
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    return std::optional<TruthFile>();
  }
  const auto text = exchange::read_file(path);
  if (!text) {
    return text.error();
  }
  auto truth = truth_from_json(*text);
  if (!truth) {
    return truth.error();
  }
  return std::optional(*std::move(truth));
}

// C. Ericson, Real-Time Collision Detection (2005), 5.1.5: which corner, edge or inside is nearest.
double distance_to(const Triangle& triangle, const Eigen::Vector3d& p) {
  const auto& [a, b, c] = triangle;
  const Eigen::Vector3d ab = b - a;
  const Eigen::Vector3d ac = c - a;
  const Eigen::Vector3d ap = p - a;
  const double d1 = ab.dot(ap);
  const double d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) {
    return ap.norm();
  }
  const Eigen::Vector3d bp = p - b;
  const double d3 = ab.dot(bp);
  const double d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) {
    return bp.norm();
  }
  const Eigen::Vector3d cp = p - c;
  const double d5 = ab.dot(cp);
  const double d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) {
    return cp.norm();
  }
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    return (ap - d1 / (d1 - d3) * ab).norm();
  }
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    return (ap - d2 / (d2 - d6) * ac).norm();
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    return (bp - (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b)).norm();
  }
  return std::abs(ab.cross(ac).normalized().dot(ap));
}

SurfaceError surface_error(const TruthFile& truth, std::span<const Eigen::Vector3d> points) {
  // Every triangle is asked for every point: of many points some are enough.
  constexpr std::size_t kMostPairs = 50'000'000;
  const std::size_t every = 1 + points.size() * truth.triangles.size() / kMostPairs;
  std::vector<double> distances;
  distances.reserve(points.size());
  double sum = 0;
  for (std::size_t k = 0; k < points.size(); k += every) {
    const Eigen::Vector3d& p = points[k];
    distances.push_back(calib::synth::distance_to(truth.scene, p));
    for (const Triangle& triangle : truth.triangles) {
      distances.back() = std::min(distances.back(), distance_to(triangle, p));
    }
    sum += distances.back() * distances.back();
  }
  if (distances.empty()) {
    return {};
  }
  const auto p95 = distances.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(distances.size() - 1));
  std::nth_element(distances.begin(), p95, distances.end());
  return {std::sqrt(sum / static_cast<double>(distances.size())), *p95};
}

std::optional<RigError> rig_error(const Rig& solved, const Rig& truth) {
  RigError error;
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(solved.devices.empty() ? 0 : solved.offset(solved.devices.size()));
  for (std::size_t i = 0; i < solved.devices.size(); ++i) {
    const Device& device = solved.devices[i];
    const Device* found = truth.find(device.name);
    if (found == nullptr || coefficients(found->camera.lens) > coefficients(device.camera.lens)) {
      return std::nullopt;
    }
    Device real = *found;
    real.camera.lens = device.camera.lens;  // coefficients that the truth lacks are 0
    Eigen::VectorXd difference = parameters(device, i > 0) - parameters(real, i > 0);
    if (i > 0) {
      difference.segment<3>(difference.size() - 6) = turn(device.T_device_rig, real.T_device_rig);
    }
    delta.segment(solved.offset(i), solved.count(i)) = difference;
    error.focal =
        std::max({error.focal, std::abs(difference[0] / real.camera.fx), std::abs(difference[1] / real.camera.fy)});
    error.centre_px = std::max({error.centre_px, std::abs(difference[2]), std::abs(difference[3])});
    if (i == 1) {
      error.baseline_m = std::abs(device.T_device_rig.t.norm() - real.T_device_rig.t.norm());
    }
  }
  if (delta.size() == 0) {
    return std::nullopt;
  }
  // Parameters held fixed have no variance and do not count; the others are scaled, since units differ widely.
  if (solved.covariance.rows() == delta.size()) {
    std::vector<Eigen::Index> free;
    for (Eigen::Index i = 0; i < delta.size(); ++i) {
      if (solved.covariance(i, i) > 0) {
        free.push_back(i);
      }
    }
    const Eigen::MatrixXd covariance = solved.covariance(free, free);
    const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd correlation = scale.asDiagonal() * covariance * scale.asDiagonal();
    const Eigen::VectorXd scaled = scale.asDiagonal() * Eigen::VectorXd(delta(free));
    error.chi_square = scaled.dot(correlation.ldlt().solve(scaled));
    error.degrees_of_freedom = static_cast<int>(free.size());
  }
  return error;
}

}  // namespace raysteer::host::pretend
