// Which pixels mix two surfaces? At a depth edge the lens adds the light of both, and a phase then lies between theirs,
// by up to half a period and with an honest-looking sinusoid.
//
// The pixels around tell: on a surface, coordinates go on nearly straight from pixel to pixel. A pixel at its surface's
// edge still goes on straight towards the surface, over an angle of 90 degrees or more; a mixed one does so at most
// along the edge, where its neighbours are mixed as much.
#pragma once

#include <cstdint>
#include <span>

#include "hal/base/image.hpp"

namespace raysteer::calib::decode {

/// Coordinates along one projector axis and their variances, px^2.
struct Placed {
  const Image<float>* value;
  const Image<float>* variance;
};

/// kEdge for each pixel of `mask` that is valid so far and from which no three adjacent ones of the eight directions go
/// on straight along every axis: to 0.5 px and two sigma. Coordinates stay as they are.
void mark_depth_edges(std::span<const Placed> axes, Image<std::uint8_t>& mask);

}  // namespace raysteer::calib::decode
