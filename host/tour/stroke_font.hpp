// pure: letters as strokes, for captions in pictures. Digits, lower case, a few capitals and signs.
#pragma once

#include <string_view>

namespace raysteer::host::tour {

/// Strokes are separated by blanks; a stroke is a row of points, two digits each: x to the right, y upwards; the
/// baseline is y = 2, capitals reach 9, small letters 7, descenders 0. A stroke that begins with '~' is a smooth curve
/// through its points.
struct Glyph {
  char letter;
  int width;
  std::string_view strokes;
};

/// Nothing (nullptr) for a character the font lacks.
const Glyph* glyph(char letter);

/// Height of capitals and the gap after a letter, in the glyphs' units.
inline constexpr double kCapitalUnits = 7;
inline constexpr double kGapUnits = 1.8;
inline constexpr int kBaseline = 2;

}  // namespace raysteer::host::tour
