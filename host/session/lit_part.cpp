#include "host/session/lit_part.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "calib/decode/lit_region.hpp"
#include "hal/base/pattern.hpp"

namespace raysteer::host::session {
namespace {

template <class Pixel>
Result<Region> compare(const Session& session, const FrameId& white_id, const FrameId& black_id) {
  Image<Pixel> white;
  Image<Pixel> black;
  RAYSTEER_TRY(session.load(white_id, white));
  RAYSTEER_TRY(session.load(black_id, black));
  return calib::decode::lit_region(std::as_const(white).view(), std::as_const(black).view());
}

}  // namespace

Result<Region> lit_part(const Session& session, int camera, int look) {
  const std::vector<Pattern> patterns = session.manifest().sequence.patterns();
  const auto index_of = [&](PatternKind kind) {
    return std::ranges::find_if(patterns, [&](const Pattern& pattern) { return pattern.block.kind == kind; });
  };
  const auto white = index_of(PatternKind::kWhite);
  const auto black = index_of(PatternKind::kBlack);
  if (white == patterns.end() || black == patterns.end()) {
    return Region{0, 0, session.width(camera), session.height(camera)};
  }
  const FrameId white_id{camera, look, static_cast<int>(white - patterns.begin())};
  const FrameId black_id{camera, look, static_cast<int>(black - patterns.begin())};
  return session.bits(camera) > 8 ? compare<std::uint16_t>(session, white_id, black_id)
                                  : compare<std::uint8_t>(session, white_id, black_id);
}

}  // namespace raysteer::host::session
