#include <fmt/core.h>

#include <array>
#include <string>
#include <vector>

#include "host/exchange/device_text.hpp"
#include "host/exchange/rig_file.hpp"
#include "proto/document/toml_text.hpp"

namespace raysteer::host::exchange {
namespace {

using calib::model::SteeredProjector;
using calib::steer::Solution;
namespace document = proto::document;

constexpr std::array kRoomParameters{"room.rx", "room.ry", "room.rz", "room.tx", "room.ty", "room.tz"};

std::string vector_text(const Eigen::Vector3d& v) { return number_array(std::array{v.x(), v.y(), v.z()}); }

std::string pose_text(const calib::model::Pose& pose) {
  return fmt::format("rotation_wxyz = {}\ntranslation_m = {}\n",
                     number_array(std::array{pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z()}), vector_text(pose.t));
}

std::string mirror_text(const SteeredProjector& projector) {
  const bool head = projector.kind == calib::model::MirrorKind::kHead;
  std::string text =
      fmt::format("\n[mirror]\nkind = \"{}\"\nleast_rad = {}\nmost_rad = {}\n", head ? "head" : "galvo-pair",
                  number_array(std::array{projector.least_rad.x(), projector.least_rad.y()}),
                  number_array(std::array{projector.most_rad.x(), projector.most_rad.y()}));
  if (head) {
    text += fmt::format("outer_axis = {}\nouter_point_m = {}\n", vector_text(projector.outer_axis),
                        vector_text(projector.outer_point));
  }
  for (std::size_t k = 0; k < (head ? 1U : 2U); ++k) {
    const calib::model::MirrorPart& part = projector.parts[k];
    text += fmt::format(
        "\n[[mirror.plane]]\naxis = {}\npoint_m = {}\nnormal = {}\noffset_m = {}\nsize_m = {}\noutline = \"{}\"\n",
        vector_text(part.axis), vector_text(part.point), vector_text(part.normal), exact(part.offset_m),
        number_array(std::array{part.size_m.x(), part.size_m.y()}), part.ellipse ? "ellipse" : "rectangle");
  }
  for (const calib::model::CommandCurve& curve : projector.curves) {
    text +=
        fmt::format("\n[[mirror.curve]]\nhalf_range_rad = {}\ngain = {}\nquadratic = {}\ncubic = {}\ncross_talk = {}\n",
                    exact(curve.half_range), exact(curve.gain), exact(curve.quadratic), exact(curve.cubic),
                    exact(curve.cross_talk));
  }
  return text;
}

// What the id stands for.
std::string numbers_text(const Solution& solution, const std::optional<RoomTie>& room) {
  std::string text = fmt::format("repeatability_rad = {}\n", exact(solution.repeatability_rad));
  for (const calib::model::Device& camera : solution.cameras.devices) {
    text += device_text(camera);
  }
  text += device_text({.name = "projector",
                       .kind = calib::model::DeviceKind::kProjector,
                       .camera = solution.projector.lens,
                       .T_device_rig = solution.projector.T_projector_rig});
  text += mirror_text(solution.projector);
  if (room) {
    text += fmt::format("\n[room]\n{}datums = {}\nscale = {}\n", pose_text(room->T_rig_room), room->datums,
                        exact(room->scale));
  }
  const Eigen::Index kept = solution.camera_parameters() + solution.projector_parameters();
  std::vector<std::string> parameters(solution.parameters.begin(), solution.parameters.begin() + kept);
  if (room) {
    parameters.insert(parameters.end(), kRoomParameters.begin(), kRoomParameters.end());
    text += covariance_text(parameters, room->covariance);
  } else {
    text += covariance_text(parameters, solution.covariance.topLeftCorner(kept, kept));
  }
  return text;
}

}  // namespace

RoomTie room_tie(const calib::steer::InRoom& rig, int datums, double scale) {
  const Eigen::Index kept = rig.solution.camera_parameters() + rig.solution.projector_parameters();
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < kept; ++i) {
    rows.push_back(i);
  }
  for (Eigen::Index i = 6; i > 0; --i) {
    rows.push_back(rig.covariance.rows() - i);
  }
  return {.T_rig_room = rig.T_rig_room, .covariance = rig.covariance(rows, rows), .datums = datums, .scale = scale};
}

std::string survey_id(std::string_view text) { return text_id(text); }

std::string rig_id(const Solution& solution, const std::optional<RoomTie>& room) {
  return text_id(numbers_text(solution, room));
}

std::string to_toml(const Solution& solution, const std::optional<RoomTie>& room, const RigMeta& meta) {
  const std::string numbers = numbers_text(solution, room);
  std::string origin =
      fmt::format("\n[origin]\nsession = {}\nboard = {}\nverdict = {}\nwhitened_rms = {}\nlooks = {}\n",
                  document::quoted(meta.session), document::quoted(meta.board), document::quoted(meta.verdict),
                  exact(meta.whitened_rms), meta.looks);
  if (!meta.survey.empty()) {
    origin +=
        fmt::format("survey = {}\nsurvey_id = {}\n", document::quoted(meta.survey), document::quoted(meta.survey_id));
  }
  if (meta.held_out_p95_px > 0) {
    origin +=
        fmt::format("held_out_median_px = {}\nheld_out_p95_px = {}\nheld_out_median_mm = {}\nheld_out_p95_mm = {}\n",
                    exact(meta.held_out_median_px), exact(meta.held_out_p95_px), exact(meta.held_out_median_mm),
                    exact(meta.held_out_p95_mm));
  }
  // Keys of the root stand before all tables.
  const std::size_t first_table = numbers.find("\n[[");
  return fmt::format(
             "# A steered rig calibrated by Raysteer; docs/rig-format.md says what every key means.\n"
             "format = \"raysteer-rig\"\n"
             "format_version = 1\n"
             "created_by = \"raysteer {}\"\n"
             "id = \"{}\"\n",
             RAYSTEER_VERSION, text_id(numbers)) +
         numbers.substr(0, first_table) + origin + numbers.substr(first_table);
}

}  // namespace raysteer::host::exchange
