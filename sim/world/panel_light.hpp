// value: what is on the panel, blurred to every width that a look needs, as means over footprints.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "hal/base/image.hpp"
#include "hal/mock/exposure.hpp"
#include "sim/world/blur_levels.hpp"
#include "sim/world/lit.hpp"
#include "sim/world/profile.hpp"

namespace raysteer::sim::world {

/// Where a panel picture stands: light of its pixel x lands where a perfect one's pixel x + drift would, and the mirror
/// may have turned a little since the look was traced.
struct Standing {
  ProjectorPx drift;
  /// From a traced panel position to the present one: x + a + b x + c y for each coordinate.
  std::array<double, 3> move_x{};
  std::array<double, 3> move_y{};

  double x(const Footprint& at) const { return at.x - drift.x + move_x[0] + move_x[1] * at.x + move_x[2] * at.y; }
  double y(const Footprint& at) const { return at.y - drift.y + move_y[0] + move_y[1] * at.x + move_y[2] * at.y; }
};

/// What one axis of the panel shows, at every blur level in use.
class AxisLight {
 public:
  /// Only light in [begin, end) is shown.
  AxisLight(std::vector<float> light, int begin, int end, const std::vector<bool>& levels);

  float mean(double at, float width, std::uint8_t level) const {
    if (plain_ && at - width > inner_begin_[level] && at + width < inner_end_[level]) {
      return level_light_;
    }
    return profiles_[level]->mean(at, width);
  }

 private:
  bool plain_;  ///< all pixels alike
  float level_light_ = 0;
  std::array<double, kBlurLevels> inner_begin_{};  ///< so far from the ends no blur brings the dark
  std::array<double, kBlurLevels> inner_end_{};
  std::vector<std::optional<Profile>> profiles_;
};

/// A picture that changes along both axes.
class FlatLight {
 public:
  FlatLight(const hal::mock::PanelPicture& picture, int first_row, int end_row, const std::vector<bool>& levels,
            int threads);
  /// About (x, y), of the footprint's size and blur.
  float mean(double x, double y, const Footprint& at) const;

 private:
  static constexpr int kEvery = 3;  ///< blurred at every third level: 6 % off at most
  struct Blurred {
    int border = 0;
    Image<float> light;
  };
  std::vector<Blurred> pictures_;
};

/// Rows [first_row, end_row) of a picture; its other rows are dark.
class PanelLight {
 public:
  PanelLight(const hal::mock::PanelPicture& picture, int first_row, int end_row, const Standing& standing,
             const std::vector<bool>& levels, int threads);

  /// Adds weight x gain x mean light to each pixel of a row.
  void add(std::span<const Footprint> row, float weight, float* out) const;
  void add(std::span<const PartFootprint> parts, float weight, float* row) const;

 private:
  float mean(const Footprint& at) const {
    const double x = standing_.x(at);
    const double y = standing_.y(at);
    return flat_ ? flat_->mean(x, y, at)
                 : along_x_->mean(x, at.wide, at.blur_x) * along_y_->mean(y, at.high, at.blur_y);
  }

  Standing standing_;
  std::optional<AxisLight> along_x_;
  std::optional<AxisLight> along_y_;
  std::optional<FlatLight> flat_;
};

}  // namespace raysteer::sim::world
