// raysteer bake: a solved rig and stations become the tables that the device shows pictures by.
#include <fmt/core.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "calib/bake/lut_set.hpp"
#include "host/cli/commands.hpp"
#include "host/exchange/write_file.hpp"
#include "host/rig/aimed_rig.hpp"

namespace raysteer::host::cli {
namespace {

class Bake : public Command {
 public:
  Manual manual() const override {
    return {.summary = "Bake a rig's stations into tables for its device",
            .description =
                "Aims at each station, says within how many millimetres its corners will lie (95 %), and bakes the "
                "steering table and a warp map a station (docs/lut-format.md).\n\nWith --out DIR: tables.rlut, "
                "result.json, and looks.toml, a plan that looks at every station, for 'raysteer verify'. Exit code 5 "
                "when a station is less sure than its tolerance.",
            .example = "raysteer bake --rig rig --stations stations.toml --out tables",
            .out = TakesOut::kOptional};
  }

  void declare(Options& options) override {
    options.option("--rig", "FILE", &rig_, "calibration of the rig, or its folder").required();
    options.option("--stations", "FILE", &stations_, "stations file, or an installed one's name").required();
  }

  Result<ExitCode> run(Context& context) override {
    const auto rig = rig::read_aimed_rig(rig_, stations_);
    RAYSTEER_TRY(rig);
    const Tick baking = context.stage("baking");
    const auto set = calib::bake::bake_lut_set(rig->room.solution.projector, request(*rig));
    RAYSTEER_TRY(set);
    const auto bytes = proto::lut::write_lut_set(*set);
    RAYSTEER_TRY(bytes);
    if (context.has_out()) {
      RAYSTEER_TRY(exchange::write_file(context.out() / "tables.rlut", std::string(bytes->begin(), bytes->end())));
      RAYSTEER_TRY(exchange::write_file(context.out() / "looks.toml", plan(*rig)));
    }
    return report(context, rig->aimed, *bytes);
  }

 private:
  static calib::bake::LutSetRequest request(const rig::AimedRig& rig) {
    calib::bake::LutSetRequest request;
    request.calibration_id = rig.calibration.id;
    request.board_id = rig.calibration.meta.board;
    request.steering.frame = proto::lut::Frame::kDatums;
    request.steering.T_rig_plane = rig.room.T_rig_room;
    for (const proto::stations::KeepOut& zone : rig.wanted.keep_out) {
      proto::lut::KeepOut& kept = request.keep_out.emplace_back();
      kept.name = zone.name;
      for (const proto::stations::Vec3& corner : zone.corners_m) {
        kept.corners.push_back({corner[0], corner[1]});
      }
    }
    for (const rig::AimedStation& one : rig.aimed) {
      request.stations.push_back(one.station);
    }
    return request;
  }

  static std::string plan(const rig::AimedRig& rig) {
    std::string text = fmt::format(
        "# A look at every station, planned by 'raysteer bake', for 'raysteer verify'.\nformat = 1\nname = \"{}\"\n",
        rig.wanted.name);
    for (const rig::AimedStation& one : rig.aimed) {
      text += fmt::format("\n[[look]]\nname = \"{}\"\nmirror_mrad = [{:.6f}, {:.6f}]\n", one.station.name,
                          1e3 * one.station.command_rad->x(), 1e3 * one.station.command_rad->y());
    }
    return text;
  }

  static ExitCode report(Context& context, const std::vector<rig::AimedStation>& aimed,
                         const std::vector<std::uint8_t>& bytes) {
    const auto within = std::ranges::count_if(aimed, &rig::AimedStation::within);
    const bool all = within == static_cast<std::ptrdiff_t>(aimed.size());
    Json& json = context.json();
    json["verdict"] = all ? "good" : "redo";
    json["id"] = proto::lut::object_id(bytes);
    json["bytes"] = bytes.size();
    context.print(
        fmt::format("{} of {} stations are sure to lie within their tolerance (95 %)\n", within, aimed.size()));
    for (const rig::AimedStation& one : aimed) {
      json["stations"].push_back({{"name", one.station.name},
                                  {"command_rad", {one.station.command_rad->x(), one.station.command_rad->y()}},
                                  {"bound_95_mm", one.worst_95_mm},
                                  {"tolerance_mm", one.station.tolerance_mm},
                                  {"within", one.within()}});
      context.print(fmt::format("{:<16} {:.2f} mm{}\n", one.station.name, one.worst_95_mm,
                                one.within() ? "" : fmt::format(" (allowed {:.1f})", one.station.tolerance_mm)));
    }
    context.print(
        fmt::format("tables           {} bytes, id {}\n", bytes.size(), json["id"].get<std::string>().substr(0, 16)));
    return all ? ExitCode::kDone : ExitCode::kVerdictRedo;
  }

  std::string rig_;
  std::string stations_;
};

}  // namespace

std::unique_ptr<Command> bake() { return std::make_unique<Bake>(); }

}  // namespace raysteer::host::cli
