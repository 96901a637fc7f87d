// value: a place no light may go: a polygon in the steering table's plane, and all that stands over it.
#pragma once

#include <string>
#include <vector>

#include "hal/base/result.hpp"
#include "proto/lut/steering_table.hpp"

namespace raysteer::proto::lut {

struct KeepOut {
  std::string name;                 ///< 1 to 64 bytes
  std::vector<PlanePoint> corners;  ///< 3 to 1024, either way round; sides may cross (even-odd rule)

  bool contains(const PlanePoint& place) const;
  bool operator==(const KeepOut&) const = default;
};

/// Errors: kTableDamaged.
Status check(const KeepOut& zone);

}  // namespace raysteer::proto::lut
