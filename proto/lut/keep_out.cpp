#include "proto/lut/keep_out.hpp"

#include <algorithm>
#include <cmath>

#include "proto/lut/warp_map.hpp"

namespace raysteer::proto::lut {

bool KeepOut::contains(const PlanePoint& place) const {
  bool inside = false;
  for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
    const PlanePoint& a = corners[i];
    const PlanePoint& b = corners[j];
    if ((a.y > place.y) != (b.y > place.y) && place.x < (b.x - a.x) * (place.y - a.y) / (b.y - a.y) + a.x) {
      inside = !inside;
    }
  }
  return inside;
}

Status check(const KeepOut& zone) {
  constexpr std::size_t kMostCorners = 1024;
  constexpr double kFarthest = 1e6;
  if (zone.name.empty() || zone.name.size() > kLongestName) {
    return fail(RCode::kTableDamaged,
                "a keep-out zone's name has 1 to 64 bytes, got " + std::to_string(zone.name.size()));
  }
  if (zone.corners.size() < 3 || zone.corners.size() > kMostCorners) {
    return fail(RCode::kTableDamaged, "keep-out zone '" + zone.name + "' has " + std::to_string(zone.corners.size()) +
                                          " corners; expected 3 to 1024");
  }
  const auto near = [](double value) { return std::abs(value) <= kFarthest; };  // false for NaN
  if (!std::ranges::all_of(zone.corners, [&](const PlanePoint& p) { return near(p.x) && near(p.y); })) {
    return fail(RCode::kTableDamaged, "a corner of keep-out zone '" + zone.name + "' is no place on a floor");
  }
  return ok();
}

}  // namespace raysteer::proto::lut
