#include "host/tour/before_after.hpp"

#include <cmath>

#include "host/report/rgb_png.hpp"
#include "host/tour/canvas.hpp"

namespace raysteer::host::tour {
namespace {

using calib::bake::MetricRectangle;
using calib::model::Pose;
using report::Color;

constexpr int kWidth = 1600;
constexpr int kGap = 16;
constexpr int kHalf = (kWidth - kGap) / 2;
constexpr int kHeight = 540;
constexpr int kCaption = 64;

constexpr Color kPaper{255, 255, 255};
constexpr Color kInk{32, 48, 60};  // the report's
constexpr Color kWanted{255, 176, 32};
constexpr Color kRuler{246, 240, 226};
constexpr Color kMarks{40, 40, 40};
// Light on a floor: deep blue shadows, warm white.
constexpr Color kDark{10, 14, 22};
constexpr Color kLight{255, 250, 240};

/// Draws on the floor: content metres to canvas pixels of one half.
class Floor {
 public:
  Floor(Canvas& canvas, const RoomView& view, const Pose& T_rig_plane, const MetricRectangle& rectangle, int left)
      : canvas_(canvas), view_(view), T_rig_plane_(T_rig_plane), rectangle_(rectangle), left_(left) {}

  Eigen::Vector2d at(double u, double v) const {
    const Eigen::Vector2d p = rectangle_.on_plane({u, v});
    const auto pixel = view_.pixel(T_rig_plane_ * Eigen::Vector3d(p.x(), p.y(), 0));
    return pixel.value_or(Eigen::Vector2d(-1e5, -1e5)) + Eigen::Vector2d(left_, 0);
  }

  void wanted() const {
    const double w = rectangle_.width_m;
    const double h = rectangle_.height_m;
    const std::array<Eigen::Vector2d, 4> corners{at(0, 0), at(w, 0), at(w, h), at(0, h)};
    for (std::size_t i = 0; i < 4; ++i) {
      canvas_.dashes(corners[i], corners[(i + 1) % 4], 1.8, 9, kWanted);
    }
  }

  /// Along the lower edge, 2 cm away from it.
  void ruler_below() const {
    const double h = rectangle_.height_m + kAway;
    const double length = std::ceil(rectangle_.width_m * 100 - 1e-6) / 100;
    canvas_.fill({at(-kSpare, h), at(length + kSpare, h), at(length + kSpare, h + kDepth), at(-kSpare, h + kDepth)},
                 kRuler, 0.94);
    for (int cm = 0; cm <= std::lround(100 * length); ++cm) {
      const double tick = cm % 10 == 0 ? 0.017 : cm % 5 == 0 ? 0.013 : 0.008;
      canvas_.line(at(0.01 * cm, h), at(0.01 * cm, h + tick), cm % 10 == 0 ? 1.6 : 1.0, kMarks);
      if (cm % 10 == 0) {
        canvas_.text(at(0.01 * cm, h + 0.034), std::to_string(cm), 10, 1.3, kMarks, Align::kMiddle);
      }
    }
    canvas_.text(at(length - 0.05, h + 0.034), "cm", 9, 1.2, kMarks, Align::kMiddle);
  }

  void ruler_beside() const {
    const double u = -kAway;
    const double length = std::floor(rectangle_.height_m * 10) / 10;
    const double top = rectangle_.height_m - length;
    canvas_.fill({at(u - kDepth, top - kSpare), at(u, top - kSpare), at(u, top + length + kSpare),
                  at(u - kDepth, top + length + kSpare)},
                 kRuler, 0.94);
    for (int cm = 0; cm <= std::lround(100 * length); ++cm) {
      const double v = rectangle_.height_m - 0.01 * cm;
      const double tick = cm % 10 == 0 ? 0.017 : cm % 5 == 0 ? 0.013 : 0.008;
      canvas_.line(at(u, v), at(u - tick, v), cm % 10 == 0 ? 1.6 : 1.0, kMarks);
      if (cm % 10 == 0) {
        canvas_.text(at(u - 0.020, v) + Eigen::Vector2d(0, 4.5), std::to_string(cm), 9, 1.2, kMarks, Align::kRight);
      }
    }
  }

 private:
  static constexpr double kAway = 0.02;    // metres from the rectangle's edge
  static constexpr double kDepth = 0.04;   // of the ruler
  static constexpr double kSpare = 0.012;  // beyond its ends

  Canvas& canvas_;
  const RoomView& view_;
  const Pose& T_rig_plane_;
  const MetricRectangle& rectangle_;
  int left_;
};

}  // namespace

RoomView view_of(const Pose& T_rig_plane, const MetricRectangle& rectangle) {
  const auto place = [&](double u, double v, double above) {
    const Eigen::Vector2d p = rectangle.on_plane({u * rectangle.width_m, v * rectangle.height_m});
    return T_rig_plane * Eigen::Vector3d(p.x(), p.y(), -above);  // the plane's z points away from the camera
  };
  RoomView view{.width = kHalf, .height = kHeight};
  const double size = rectangle.width_m;
  view.look_at = place(0.46, 0.57, 0);
  view.eye = place(0.52, 0.5, 2.7 * size) + 1.5 * size * (place(0, 1, 0) - place(0, 0, 0)).normalized();
  view.up = place(0, 0, 0) - place(0, 1, 0);
  // The rectangle fills a good half of the picture's width.
  view.focal_px = 0.66 * kHalf * (view.look_at - view.eye).norm() / size;
  return view;
}

std::string before_after_png(const BeforeAfter& pictures, const RoomView& view, const Pose& T_rig_plane,
                             const MetricRectangle& rectangle) {
  Canvas canvas(kWidth, kHeight + kCaption, kPaper);
  const auto half = [&](ImageView<const std::uint8_t> grey, int left, const std::string& words) {
    canvas.clip(left, 0, kHalf, kHeight);
    canvas.picture(grey, left, 0, kDark, kLight);
    const Floor floor(canvas, view, T_rig_plane, rectangle, left);
    floor.ruler_below();
    floor.ruler_beside();
    floor.wanted();
    canvas.clip(left, kHeight, kHalf, kCaption);
    canvas.text({left + 4.0, kHeight + 40.0}, words, 17, 2.0, kInk);
  };
  half(pictures.before, 0, pictures.before_words);
  half(pictures.after, kHalf + kGap, pictures.after_words);
  return report::encode_rgb_png(canvas.rgb(), canvas.width(), canvas.height());
}

}  // namespace raysteer::host::tour
