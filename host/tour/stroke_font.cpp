#include "host/tour/stroke_font.hpp"

#include <algorithm>
#include <array>

namespace raysteer::host::tour {
namespace {

// clang-format off: one letter a line
constexpr std::array kGlyphs{
    Glyph{' ', 2, ""},
    Glyph{'%', 6, "6902 ~1928170819 ~5443324354"},
    Glyph{'(', 2, "~29070420"},
    Glyph{')', 2, "~09272400"},
    Glyph{'+', 4, "0545 2327"},
    Glyph{',', 1, "120200"},
    Glyph{'-', 3, "0535"},
    Glyph{'.', 1, "0202"},
    Glyph{'/', 4, "0149"},
    Glyph{'0', 4, "~29474422040729"},
    Glyph{'1', 3, "072922"},
    Glyph{'2', 4, "~071939473502 0242"},
    Glyph{'3', 4, "~081939473616 ~163644321203"},
    Glyph{'4', 4, "390444 3932"},
    Glyph{'5', 4, "490906 ~061737454432 ~321203 ~4432"},
    Glyph{'6', 4, "~48391906041232443616 ~1604"},
    Glyph{'7', 4, "094912"},
    Glyph{'8', 4, "~2947260729 ~2644220426"},
    Glyph{'9', 4, "~03123245473919071535 ~3547"},
    Glyph{':', 1, "0303 0606"},
    Glyph{'A', 4, "022942 1434"},
    Glyph{'B', 4, "0902 0929 ~2939473626 0626 ~2636443222 0222"},
    Glyph{'a', 4, "~462705042243 4742"},
    Glyph{'b', 4, "0902 ~062745442203"},
    Glyph{'c', 4, "~462705042243"},
    Glyph{'d', 4, "~462705042243 4942"},
    Glyph{'e', 4, "0545 ~4537170504123243"},
    Glyph{'f', 3, "~39291812 0737"},
    Glyph{'g', 4, "~462705042243 4741 ~41301001"},
    Glyph{'h', 4, "0902 ~05173745 4542"},
    Glyph{'i', 0, "0702 0909"},
    Glyph{'j', 1, "1711 ~1100 1919"},
    Glyph{'k', 4, "0902 4704 1542"},
    Glyph{'l', 0, "0902"},
    Glyph{'m', 6, "0702 ~05172735 3532 ~35475765 6562"},
    Glyph{'n', 4, "0702 ~05173745 4542"},
    Glyph{'o', 4, "~27454422040527"},
    Glyph{'p', 4, "0700 ~062745442203"},
    Glyph{'q', 4, "~462705042243 4740"},
    Glyph{'r', 3, "0702 ~051737"},
    Glyph{'s', 4, "~46371706153443321203"},
    Glyph{'t', 3, "1913 ~132232 0737"},
    Glyph{'u', 4, "0704 ~04123244 4742"},
    Glyph{'v', 4, "072247"},
    Glyph{'w', 6, "0722364267"},
    Glyph{'x', 4, "0742 4702"},
    Glyph{'y', 4, "0722 4710"},
    Glyph{'z', 4, "07470242"},
};
// clang-format on
static_assert(std::ranges::is_sorted(kGlyphs, {}, &Glyph::letter));

}  // namespace

const Glyph* glyph(char letter) {
  const auto found = std::ranges::lower_bound(kGlyphs, letter, {}, &Glyph::letter);
  return found != kGlyphs.end() && found->letter == letter ? &*found : nullptr;
}

}  // namespace raysteer::host::tour
