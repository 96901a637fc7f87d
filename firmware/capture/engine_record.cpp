// What is written: the session's manifest, and what an earlier capture left of it.
#include <algorithm>
#include <string>
#include <utility>

#include "firmware/capture/engine.hpp"

namespace raysteer::firmware::capture {

namespace {

/// 0.15 s a look and eye, where 280 tiles take 0.7 s (51 patterns, 5 Mpx).
constexpr int kCheckTiles = 60;

}  // namespace

using proto::session::Manifest;
using proto::session::Shot;

Manifest Capture::Engine::blank_manifest() const {
  Manifest manifest;
  manifest.name = plan_.name.empty() ? "capture" : plan_.name;
  manifest.rig = options_.rig;
  manifest.sequence = sequence_;
  for (const std::size_t eye : {0U, 1U}) {
    const hal::CameraInfo& info = infos_[eye];
    const std::string name = eye == 0 ? "left" : "right";
    manifest.cameras.push_back({.name = name,
                                .files = name + "/{look}/{index:03}.rsf",
                                .width = info.width,
                                .height = info.height,
                                .bits = info.bits > 8 ? 16 : 8});
  }
  for (const proto::plan::PlannedLook& look : plan_.looks) {
    manifest.looks.push_back({.name = look.name,
                              .command = std::vector(look.mirror_rad.begin(), look.mirror_rad.end()),
                              .note = look.prepare});
  }
  for (const proto::plan::PlannedTarget& target : plan_.targets) {
    manifest.targets.push_back({.spec = target.spec, .looks = target.looks});
  }
  return manifest;
}

// A look is kept as a whole or not at all: the mirror never comes back to quite the same place.
Status Capture::Engine::adopt_earlier(const Manifest& earlier) {
  for (std::size_t look = 0; look < plan_.looks.size(); ++look) {
    std::vector<Shot> shots;
    std::ranges::copy_if(earlier.shots, std::back_inserter(shots),
                         [&](const Shot& shot) { return shot.look == plan_.looks[look].name; });
    if (static_cast<int>(shots.size()) == frames()) {
      std::ranges::move(shots, std::back_inserter(manifest_->shots));
      look_done_[look] = true;
      shots_done_ += frames();
    }
  }
  shots_at_start_ = shots_done_;
  return ok();
}

Manifest Capture::Engine::manifest() const {
  Manifest manifest = *manifest_;
  for (const std::optional<Shot>& shot : record_.shots) {
    if (shot) {
      manifest.shots.push_back(*shot);
    }
  }
  const auto same = [&](const Shot& shot) { return shot.exposure_us == manifest.shots.front().exposure_us; };
  if (!manifest.shots.empty() && manifest.shots.front().exposure_us && std::ranges::all_of(manifest.shots, same)) {
    manifest.exposure_us = static_cast<double>(*manifest.shots.front().exposure_us);
  }
  return manifest;
}

void Capture::Engine::fresh_look() {
  const auto count = static_cast<std::size_t>(frames());
  shots_done_ -=
      static_cast<int>(std::ranges::count_if(record_.shots, [](const auto& shot) { return shot.has_value(); }));
  record_ = {};
  record_.samples.resize(count);
  record_.shots.resize(count);
  record_.retakes.resize(count);
}

void Capture::Engine::begin_record(References references) {
  fresh_look();
  for (std::size_t eye = 0; eye < infos_.size(); ++eye) {
    record_.checks.push_back(std::make_unique<calib::decode::SequenceCheck>(
        sequence_, grids_[eye].around(references.eyes[eye].lit), infos_[eye].bits > 8 ? 16 : 8, kCheckTiles));
  }
  record_.references = std::move(references);
}

}  // namespace raysteer::firmware::capture
