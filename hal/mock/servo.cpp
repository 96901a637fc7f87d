#include "hal/mock/servo.hpp"

#include <algorithm>
#include <cmath>

namespace raysteer::hal::mock {
namespace {

// Nearer than this an axis counts as arrived: far less than anything here can see, and a world that keeps what it
// traced for a look need not follow the tail of a settling mirror for ever.
constexpr double kStill = 1e-7;

}  // namespace

void Servo::step_reference(double dt, double rate, double acceleration) {
  const double away = target_ - reference_;
  if (away == 0 && reference_speed_ == 0) {
    return;
  }
  // Fastest speed from which the limiter can still stop at the target in whole steps.
  const double slow_down = std::min(acceleration * dt, 1e300);
  const double braking =
      std::sqrt(2 * std::min(acceleration, 1e300) * std::abs(away) + slow_down * slow_down / 4) - slow_down / 2;
  const double wanted = std::copysign(std::min({rate, braking, std::abs(away) / dt}), away);
  reference_speed_ += std::clamp(wanted - reference_speed_, -slow_down, slow_down);
  const double next = reference_ + reference_speed_ * dt;
  const bool arrived = std::abs(target_ - next) <= kStill && std::abs(reference_speed_) <= std::max(slow_down, kStill);
  reference_ = arrived || (std::isinf(rate) && std::isinf(acceleration)) ? target_ : next;
  if (reference_ == target_) {
    reference_speed_ = 0;
  }
}

void Servo::step(double dt, double slower) {
  step_reference(dt, dynamics_.rate / slower, dynamics_.acceleration / slower);
  // Exact solution of the loop over dt about the standing reference.
  const double w = dynamics_.natural;
  const double z = dynamics_.damping;
  const double e = position_ - reference_;
  const double decay = std::exp(-z * w * dt);
  if (z < 1) {
    const double wd = w * std::sqrt(1 - z * z);
    const double c = std::cos(wd * dt);
    const double s = std::sin(wd * dt);
    position_ = reference_ + decay * (e * (c + z * w / wd * s) + speed_ / wd * s);
    speed_ = decay * (speed_ * (c - z * w / wd * s) - e * w * w / wd * s);
  } else if (z == 1) {
    position_ = reference_ + decay * (e * (1 + w * dt) + speed_ * dt);
    speed_ = decay * (speed_ * (1 - w * dt) - e * w * w * dt);
  } else {
    const double root = w * std::sqrt(z * z - 1);
    const double c = std::cosh(root * dt);
    const double s = std::sinh(root * dt);
    position_ = reference_ + decay * (e * (c + z * w / root * s) + speed_ / root * s);
    speed_ = decay * (speed_ * (c - z * w / root * s) - e * w * w / root * s);
  }
  if (std::abs(position_) > travel_) {
    position_ = std::copysign(travel_, position_);
    speed_ = 0;
  }
  if (reference_ == target_ && std::abs(position_ - target_) < kStill && std::abs(speed_) < kStill * w) {
    position_ = target_;
    speed_ = 0;
  }
}

void Servo::freeze() {
  reference_ = position_;
  reference_speed_ = 0;
  speed_ = 0;
}

}  // namespace raysteer::hal::mock
