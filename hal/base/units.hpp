// value: numbers that know their unit. A bare double, or camera pixels where projector pixels belong, does not compile.
//
// `.raw()` unwraps; it belongs in solver cost functions and chip encoders, in the first lines, once.
#pragma once

#include <compare>
#include <cstdint>

namespace raysteer {

/// One number with a unit. `Tag` is the unit; two tags do not mix.
template <class Tag, class Rep = double>
class Quantity {
 public:
  constexpr Quantity() = default;
  constexpr explicit Quantity(Rep raw) : raw_(raw) {}
  constexpr Rep raw() const { return raw_; }

  constexpr auto operator<=>(const Quantity&) const = default;
  constexpr Quantity operator-() const { return Quantity(-raw_); }
  constexpr Quantity& operator+=(Quantity other) {
    raw_ += other.raw_;
    return *this;
  }
  constexpr Quantity& operator-=(Quantity other) {
    raw_ -= other.raw_;
    return *this;
  }
  friend constexpr Quantity operator+(Quantity a, Quantity b) { return a += b; }
  friend constexpr Quantity operator-(Quantity a, Quantity b) { return a -= b; }
  friend constexpr Quantity operator*(Quantity a, Rep factor) { return Quantity(a.raw_ * factor); }
  friend constexpr Quantity operator*(Rep factor, Quantity a) { return a * factor; }
  friend constexpr Rep operator/(Quantity a, Quantity b) { return a.raw_ / b.raw_; }

 private:
  Rep raw_{};
};

using Radians = Quantity<struct RadiansTag>;
using Meters = Quantity<struct MetersTag>;
using Volts = Quantity<struct VoltsTag>;

/// A digital-to-analogue converter's code. Codes compare; they do not add.
class DacCode {
 public:
  constexpr DacCode() = default;
  constexpr explicit DacCode(std::int32_t raw) : raw_(raw) {}
  constexpr std::int32_t raw() const { return raw_; }
  constexpr auto operator<=>(const DacCode&) const = default;

 private:
  std::int32_t raw_ = 0;
};

struct CameraFrame;
struct ProjectorFrame;

/// A pixel position in the named device's image. (0,0) is the centre of the top-left pixel; x right, y down.
template <class Frame>
struct Px {
  double x = 0;
  double y = 0;
  constexpr Px() = default;
  constexpr Px(double px_x, double px_y) : x(px_x), y(px_y) {}
  constexpr bool operator==(const Px&) const = default;
};

using CameraPx = Px<CameraFrame>;
using ProjectorPx = Px<ProjectorFrame>;

}  // namespace raysteer
