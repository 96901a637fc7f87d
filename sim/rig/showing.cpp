#include "sim/rig/showing.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <variant>

namespace raysteer::sim::rig {
namespace {

using std::chrono::microseconds;
using std::chrono::nanoseconds;

constexpr nanoseconds kTick{250'000};
constexpr int kLatencyFrames = 15;  // more than any projector's
constexpr int kMostTries = 5;

/// Part of the pixels that read (nearly) the most they can.
double saturated(const Frame& frame, int bits) {
  const double most = std::ldexp(1.0, bits) - 1;
  return std::visit(
      [&](const auto& pixels) {
        const auto bright = static_cast<double>(std::count_if(pixels.data(), pixels.data() + pixels.size(),
                                                              [&](auto value) { return value > 0.97 * most; }));
        return bright / static_cast<double>(std::max<std::size_t>(pixels.size(), 1));
      },
      frame);
}

bool good(const hal::FramePair& pair, microseconds exposure) {
  return std::ranges::all_of(hal::kEyes, [&](hal::Eye eye) {
    const std::optional<hal::EyeFrame>& frame = pair.eye(eye);
    return frame && !frame->damaged && !frame->automatic && frame->exposure == exposure;
  });
}

}  // namespace

Result<bool> Showing::wait(nanoseconds longest, const std::function<Result<bool>()>& done) {
  const RigTime end = rig_.now() + longest;
  while (true) {
    Result<bool> is_done = done();
    if (!is_done || *is_done || rig_.now() >= end) {
      return is_done;
    }
    rig_.advance_to(rig_.now() + kTick);
  }
}

Status Showing::aim(const std::array<double, 2>& mirror_rad) {
  const hal::MirrorAngles target{Radians(mirror_rad[0]), Radians(mirror_rad[1])};
  RAYSTEER_TRY(devices_.mirror.aim(target, rig_.now()));
  RAYSTEER_TRY(devices_.projector.light(true));
  const Result<bool> still = wait(settle_timeout_, [&] { return devices_.mirror.settled(); });
  RAYSTEER_TRY(still);
  return *still ? ok() : Status(fail(RCode::kMirrorNotSettled, "show"));
}

Status Showing::show(ImageView<const std::uint8_t> picture) {
  RAYSTEER_TRY(devices_.projector.store(0, picture));
  // Dark in between, so that what is presented next is this picture and not an
  // earlier one of the same number.
  RAYSTEER_TRY(devices_.projector.show(hal::Dark{}, rig_.now()));
  const nanoseconds frame = devices_.projector.panel().frame_period;
  const auto presents = [&](const hal::Shown& what) {
    return wait(kLatencyFrames * frame, [&]() -> Result<bool> {
      const auto presented = devices_.projector.presented();
      RAYSTEER_TRY(presented);
      return presented->has_value() && (*presented)->what == what;
    });
  };
  RAYSTEER_TRY(presents(hal::Dark{}));
  const hal::Shown content = hal::ContentFrame{0};
  RAYSTEER_TRY(devices_.projector.show(content, rig_.now()));
  const Result<bool> shown = presents(content);
  RAYSTEER_TRY(shown);
  if (!*shown) {
    return fail(RCode::kDeviceUnavailable, "the projector presents no picture");
  }
  rig_.advance_to(rig_.now() + kLatencyFrames * frame);
  return ok();
}

Result<microseconds> Showing::choose_exposure() {
  constexpr double kMostSaturated = 1e-3;
  const nanoseconds frame = devices_.projector.panel().frame_period;
  const auto info = devices_.cameras.info(hal::Eye::kLeft);
  RAYSTEER_TRY(info);
  for (int frames = std::max(1, static_cast<int>(nanoseconds(50'000'001) / frame)); frames > 1; --frames) {
    const auto exposure = std::chrono::duration_cast<microseconds>(frames * frame);
    const Result<hal::FramePair> pair = photograph(exposure);
    RAYSTEER_TRY(pair);
    if (saturated(pair->left->pixels, info->bits) < kMostSaturated &&
        saturated(pair->right->pixels, info->bits) < kMostSaturated) {
      return exposure;
    }
  }
  return std::chrono::duration_cast<microseconds>(frame);
}

Status Showing::configure(microseconds exposure) {
  if (devices_.cameras.settings() && devices_.cameras.settings()->exposure == exposure) {
    return ok();
  }
  RAYSTEER_TRY(devices_.cameras.stop());
  RAYSTEER_TRY(devices_.cameras.configure({.exposure = exposure}));
  RAYSTEER_TRY(devices_.cameras.start());
  return devices_.trigger.arm(hal::TriggerSource::kFired);
}

Result<hal::FramePair> Showing::photograph(microseconds exposure) {
  constexpr nanoseconds kReadOut{400'000'000};
  RAYSTEER_TRY(configure(exposure));
  for (int attempt = 0; attempt < kMostTries; ++attempt) {
    ++shots_;
    RAYSTEER_TRY(devices_.trigger.fire(rig_.now() + kTick));
    std::optional<hal::FramePair> pair;
    const Result<bool> came = wait(exposure + kReadOut, [&]() -> Result<bool> {
      Result<std::optional<hal::FramePair>> next = devices_.cameras.next_pair(rig_.now());
      RAYSTEER_TRY(next);
      pair = *std::move(next);
      return pair.has_value();
    });
    RAYSTEER_TRY(came);
    if (*came && good(*pair, exposure)) {
      return *std::move(pair);
    }
    ++reshot_;
  }
  return fail(RCode::kDeviceUnavailable, "not one good pair of frames in " + std::to_string(kMostTries));
}

}  // namespace raysteer::sim::rig
