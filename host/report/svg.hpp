// A small writer of inline SVG: shapes and text, styled by the page's style sheet.
#pragma once

#include <string>
#include <string_view>

namespace raysteer::host::report {

enum class Anchor { kStart, kMiddle, kEnd };

class Svg {
 public:
  /// `label` is read aloud by screen readers.
  Svg(double width, double height, std::string_view label);

  void rect(double x, double y, double width, double height, std::string_view fill, std::string_view title = {});
  void line(double x1, double y1, double x2, double y2, std::string_view style_class);
  void circle(double x, double y, double radius, std::string_view fill);
  void filled_path(std::string_view d, std::string_view fill, std::string_view title = {});
  /// `d` as SVG's path data.
  void path(std::string_view d, std::string_view style_class);
  void text(double x, double y, std::string_view words, Anchor anchor = Anchor::kStart,
            std::string_view style_class = {}, std::string_view fill = {});
  /// Text that reads upwards.
  void text_upwards(double x, double y, std::string_view words);

  /// The whole element. Nothing may be added afterwards.
  std::string take();

 private:
  std::string text_;
};

/// A step of 1, 2 or 5 times a power of ten that cuts `range` in at most `most` pieces.
double nice_step(double range, int most);

/// A tick's label, with the decimals that its step needs: "0.05", "0.10".
std::string tick_label(double value, double step);

/// Three significant digits without noise: "0.162", "12.4", "1430", "0".
std::string brief(double value);

}  // namespace raysteer::host::report
