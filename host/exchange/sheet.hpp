// pure: a sheet of paper with black rectangles, outlines and text in millimetres, as PDF or SVG. True to scale.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace raysteer::host::exchange {

/// Millimetres from the sheet's top left, x right, y down.
struct Sheet {
  struct Rectangle {
    double x, y, width, height;
  };
  struct Outline {
    std::vector<std::array<double, 2>> corners;
    bool white = false;  ///< over what was drawn before; else black
  };
  struct Text {
    double x, y;     ///< left end of the base line
    double size_mm;  ///< of the font
    std::string words;
  };

  double width_mm = 0;
  double height_mm = 0;
  std::string title;
  std::vector<Rectangle> black;   ///< drawn as one shape, so that touching ones leave no seam
  std::vector<Outline> outlines;  ///< one after the other over the rectangles
  std::vector<Text> texts;        ///< printable ASCII; other letters become '?'
};

/// PDF 1.4 with one page and no compression; asks viewers not to scale when printing.
std::string to_pdf(const Sheet& sheet);

std::string to_svg(const Sheet& sheet);

}  // namespace raysteer::host::exchange
