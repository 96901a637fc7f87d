#include "hal/mock/mock_eye.hpp"

#include <algorithm>
#include <cmath>

#include "hal/base/noise.hpp"
#include "hal/mock/device_number.hpp"
#include "hal/mock/seconds.hpp"

namespace raysteer::hal::mock {
namespace {

std::chrono::microseconds times(std::chrono::microseconds exposure, double factor) {
  return std::chrono::microseconds(std::llround(static_cast<double>(exposure.count()) * factor));
}

/// Zeroes the last `part` of the rows: the bytes that never came.
void lose_rows(Frame& frame, double part) {
  std::visit(
      [&](auto& pixels) {
        const int kept = static_cast<int>(pixels.height() * (1 - std::clamp(part, 0.0, 1.0)));
        std::fill(pixels.row(kept), pixels.row(pixels.height()), 0);
      },
      frame);
}

/// Mean of the `size` pixels around each, along one axis of length `count` with neighbours `stride` apart.
void box_blur(float* first, int count, std::ptrdiff_t stride, int size, std::vector<float>& line) {
  line.resize(static_cast<std::size_t>(count));
  const int half = size / 2;
  for (int i = 0; i < count; ++i) {
    float sum = 0;
    for (int k = -half; k <= half; ++k) {
      sum += first[std::clamp(i + k, 0, count - 1) * stride];
    }
    line[static_cast<std::size_t>(i)] = sum / static_cast<float>(2 * half + 1);
  }
  for (int i = 0; i < count; ++i) {
    first[i * stride] = line[static_cast<std::size_t>(i)];
  }
}

void box_blur(Image<float>& image, int size) {
  std::vector<float> line;
  for (int y = 0; y < image.height(); ++y) {
    box_blur(image.row(y), image.width(), 1, size, line);
  }
  for (int x = 0; x < image.width(); ++x) {
    box_blur(image.data() + x, image.height(), image.width(), size, line);
  }
}

}  // namespace

CameraTime CameraClock::at(RigTime rig) const {
  return CameraTime(duration(offset_s) + rig.time_since_epoch() + duration(drift * seconds(rig)));
}

MockEye::MockEye(Eye eye, const EyeParameters& parameters, const CameraClock& clock, std::uint64_t seed, Faults faults,
                 Light light, SceneFunction scene, int threads)
    : eye_(eye),
      parameters_(parameters),
      clock_(clock),
      seed_(seed),
      faults_(std::move(faults)),
      light_(std::move(light)),
      scene_(std::move(scene)),
      threads_(threads) {
  parameters_.sensor.bits = parameters_.info.bits;
}

CameraSettings MockEye::configure(const CameraSettings& settings, RigTime now) {
  settings_ = settings;
  automatic_ = 0;
  if (const std::optional<double> factor = faults_.take("ignore", now)) {
    settings_.exposure = times(settings.exposure, *factor);
  }
  return settings_;
}

void MockEye::start(RigTime now) {
  streaming_ = true;
  sequence_ = 0;
  pending_.clear();
  ready_ = now;
  if (faults_.take("extra", now)) {
    begin_exposure(now);
  }
}

void MockEye::stop() {
  streaming_ = false;
  pending_.clear();
}

void MockEye::edge(RigTime at) {
  if (!streaming_ || !settings_.triggered || at < ready_ || !plugged(at) || faults_.take("miss", at)) {
    return;
  }
  begin_exposure(at);
}

void MockEye::begin_exposure(RigTime at) {
  if (const std::optional<double> factor = faults_.take("auto", at)) {
    automatic_ = *factor;
  }
  const std::chrono::microseconds exposure =
      automatic_ > 0 ? std::clamp(times(settings_.exposure, automatic_), parameters_.info.least_exposure,
                                  parameters_.info.most_exposure)
                     : settings_.exposure;
  const RigTime begin = at + parameters_.trigger_delay;
  ready_ = at + std::max(parameters_.info.least_period, exposure);

  Pending frame;
  frame.number = exposures_++;
  frame.exposure = {.eye = eye_, .begin = begin, .duration = exposure, .light = {}};
  frame.arrives = begin + exposure + parameters_.arrival + duration(faults_.take("late", at).value_or(0));
  const int device = DeviceNumber::kEyeStamp + (eye_ == Eye::kRight ? 1 : 0);
  const double stamp_error =
      parameters_.stamp_noise_s * Noise(seed_, device, frame.number).normal() + faults_.take("stamp", at).value_or(0);
  frame.frame.sequence = sequence_++;
  frame.frame.stamp = clock_.at(begin) + duration(stamp_error);
  frame.frame.arrived = frame.arrives;
  frame.frame.exposure = exposure;
  frame.frame.gain_db = settings_.gain_db;
  frame.frame.automatic = automatic_ > 0;
  if (faults_.take("black", at)) {
    frame.times = 0;
  }
  frame.times *= faults_.take("bright", at).value_or(1);
  frame.blur = static_cast<int>(faults_.lasting("blur", at).value_or(0));
  frame.damaged = faults_.take("damage", at).value_or(0);
  frame.frame.damaged = frame.damaged > 0;
  if (!faults_.take("drop", at)) {
    pending_.push_back(std::move(frame));
  }
}

void MockEye::advance(RigTime now) {
  while (streaming_ && !settings_.triggered && ready_ <= now && plugged(ready_)) {
    begin_exposure(ready_);
  }
  for (Pending& frame : pending_) {
    const RigTime end = frame.exposure.begin + frame.exposure.duration;
    if (!frame.over && end <= now) {
      frame.exposure.light = light_(frame.exposure.begin, end);
      frame.over = true;
    }
  }
}

std::optional<EyeFrame> MockEye::next_frame(RigTime now) {
  if (pending_.empty() || !pending_.front().over || pending_.front().arrives > now) {
    return std::nullopt;
  }
  Pending next = std::move(pending_.front());
  pending_.pop_front();
  Image<float> electrons = scene_(next.exposure);
  RAYSTEER_CHECK(electrons.width() == parameters_.info.width && electrons.height() == parameters_.info.height);
  if (next.blur > 1) {
    box_blur(electrons, next.blur);
  }
  if (next.times != 1) {
    std::ranges::for_each(electrons.data(), electrons.data() + electrons.size(),
                          [&](float& e) { e *= static_cast<float>(next.times); });
  }
  const int device = DeviceNumber::kEyePixels + (eye_ == Eye::kRight ? 1 : 0);
  next.frame.pixels = expose(electrons.view(), parameters_.sensor, next.frame.gain_db,
                             Noise(seed_, device, next.number).bits(), threads_);
  if (next.frame.damaged) {
    lose_rows(next.frame.pixels, next.damaged);
  }
  return std::move(next.frame);
}

}  // namespace raysteer::hal::mock
