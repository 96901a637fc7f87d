// One picture of two: the floor as it was lit before and after, a ruler drawn in, millimetres below.
#pragma once

#include <string>

#include "calib/bake/metric_rectangle.hpp"
#include "calib/model/pose.hpp"
#include "hal/base/image.hpp"
#include "host/tour/show.hpp"

namespace raysteer::host::tour {

/// A person stands before the rectangle, on the side its lower edge is, and looks down on it.
RoomView view_of(const calib::model::Pose& T_rig_plane, const calib::bake::MetricRectangle& rectangle);

struct BeforeAfter {
  ImageView<const std::uint8_t> before, after;  ///< what RoomView saw
  std::string before_words, after_words;        ///< captions; digits, small letters, 'A', 'B' and . , : ( ) + - / %
};

/// PNG bytes, 1600 px wide. The wanted rectangle is dashed into both halves, and rulers in centimetres lie along its
/// lower and left edges.
std::string before_after_png(const BeforeAfter& pictures, const RoomView& view, const calib::model::Pose& T_rig_plane,
                             const calib::bake::MetricRectangle& rectangle);

}  // namespace raysteer::host::tour
