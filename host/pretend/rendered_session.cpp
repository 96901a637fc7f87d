#include "host/pretend/rendered_session.hpp"

#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "host/exchange/write_file.hpp"
#include "host/pretend/truth_file.hpp"
#include "host/session/image_codec.hpp"
#include "proto/session/manifest.hpp"

namespace raysteer::host::pretend {
namespace {

using calib::synth::Stage;
using calib::synth::StagedLook;

proto::session::Manifest manifest_of(const Stage& stage) {
  proto::session::Manifest manifest;
  manifest.name = stage.name;
  manifest.note = "rendered; truth.json says what is true";
  for (std::size_t i = 0; i < stage.cameras.size(); ++i) {
    const calib::synth::Sensor& sensor = stage.looks.front().sensors[i];
    proto::session::Camera camera;
    camera.name = stage.cameras[i];
    camera.files = "{camera}/{look}_{index:02}.png";
    camera.width = sensor.camera.width;
    camera.height = sensor.camera.height;
    camera.bits = sensor.saturation_dn > 255 ? 16 : 8;
    manifest.cameras.push_back(std::move(camera));
  }
  manifest.sequence = stage.sequence;
  for (const StagedLook& look : stage.looks) {
    manifest.looks.push_back({look.name, {}, {}});
  }
  if (stage.target.columns > 0) {
    manifest.targets.push_back({stage.target, {}});
  }
  return manifest;
}

Status write_frame(const calib::synth::View& view, const Pattern& pattern, const calib::synth::NoiseKey& key,
                   const std::filesystem::path& path) {
  const auto write = [&](auto&& frame) -> Status {
    const auto png = session::encode_png(frame.view());
    return png ? session::write_file(path, *png) : Status(png.error());
  };
  return view.sensor().saturation_dn > 255 ? write(view.frame<std::uint16_t>(pattern, key))
                                           : write(view.frame<std::uint8_t>(pattern, key));
}

}  // namespace

Status write_session(const Stage& stage, const calib::model::Rig& rig, std::uint64_t seed,
                     const std::filesystem::path& folder, const Tick& tick) {
  const proto::session::Manifest manifest = manifest_of(stage);
  for (const std::string& camera : stage.cameras) {
    std::error_code error;
    std::filesystem::create_directories(folder / camera, error);
    if (error) {
      return exchange::write_error(folder / camera, error.value());
    }
  }
  const std::vector<Pattern> patterns = stage.sequence.patterns();
  const std::size_t views = stage.looks.size() * stage.cameras.size();
  for (std::size_t done = 0; done < views; ++done) {
    const std::size_t number = done / stage.cameras.size();
    const std::size_t camera = done % stage.cameras.size();
    const StagedLook& look = stage.looks[number];
    const calib::synth::View view(look.scene, look.sensors[camera], &stage.lamp, stage.ambient);
    for (std::size_t index = 0; index < patterns.size(); ++index) {
      const calib::synth::NoiseKey key{seed, static_cast<std::uint32_t>(camera), static_cast<std::uint32_t>(number),
                                       static_cast<std::uint32_t>(index)};
      const std::string name = proto::session::file_name(manifest, manifest.cameras[camera], manifest.looks[number],
                                                         static_cast<int>(index));
      RAYSTEER_TRY(write_frame(view, patterns[index], key, folder / name));
      const double part = static_cast<double>(index + 1) / static_cast<double>(patterns.size());
      if (tick && !tick((static_cast<double>(done) + part) / static_cast<double>(views))) {
        return fail(RCode::kCancelled);
      }
    }
  }
  RAYSTEER_TRY(exchange::write_file(folder / kTruthFile, to_json({seed, rig, stage.looks.front().scene})));
  return exchange::write_file(folder / "session.toml", proto::session::write_manifest(manifest));
}

}  // namespace raysteer::host::pretend
