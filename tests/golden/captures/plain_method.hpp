// What plain OpenCV users do with Gray codes, as the reference that scans are measured against.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <vector>

#include "calib/scene/match.hpp"
#include "host/session/session.hpp"

namespace raysteer::golden {

/// Integer codes where white - black > 20 and every |pattern - inverse| >= 5; a projector pixel lies at the centroid of
/// the camera pixels with its code. For sequences of x bits, y bits (each pattern then inverse), white, black.
inline Image<calib::scene::Sighting> plain_sightings(const host::session::Session& session, int camera) {
  const PatternSequence& sequence = session.manifest().sequence;
  const int bits = sequence.blocks[0].bits;
  const std::size_t pixels =
      static_cast<std::size_t>(session.width(camera)) * static_cast<std::size_t>(session.height(camera));
  const auto load = [&](int index) {
    Image<std::uint8_t> frame;
    const Status loaded = session.load({camera, 0, index}, frame);
    RAYSTEER_CHECK(loaded.has_value());
    return frame;
  };
  std::vector<std::uint8_t> good(pixels, 1);
  std::vector<int> codes[2] = {std::vector<int>(pixels), std::vector<int>(pixels)};
  for (int bit = 0; bit < 2 * bits; ++bit) {
    const Image<std::uint8_t> pattern = load(2 * bit);
    const Image<std::uint8_t> inverse = load(2 * bit + 1);
    std::vector<int>& code = codes[bit / bits];
    for (std::size_t k = 0; k < pixels; ++k) {
      const int difference = pattern.data()[k] - inverse.data()[k];
      good[k] &= std::abs(difference) >= 5 ? 1 : 0;
      code[k] = 2 * code[k] + ((code[k] & 1) ^ (difference > 0 ? 1 : 0));
    }
  }
  const Image<std::uint8_t> white = load(4 * bits);
  const Image<std::uint8_t> black = load(4 * bits + 1);
  Image<calib::scene::Sighting> sightings(sequence.panel_width, sequence.panel_height);
  for (std::size_t k = 0; k < pixels; ++k) {
    const int i = codes[0][k];
    const int j = codes[1][k];
    if (good[k] == 0 || white.data()[k] - black.data()[k] <= 20 || !sightings.view().contains(i, j)) {
      continue;
    }
    const std::size_t width = static_cast<std::size_t>(session.width(camera));
    calib::scene::Sighting& s = sightings(i, j);
    s.q += Eigen::Vector2f(static_cast<float>(k % width), static_cast<float>(k / width));
    ++s.pixels;
    s.support = s.pixels;
  }
  for (std::size_t k = 0; k < sightings.size(); ++k) {
    calib::scene::Sighting& s = sightings.data()[k];
    if (s.seen()) {
      s.q /= static_cast<float>(s.pixels);
      s.cxx = s.cyy = 1.0F / 12;
    }
  }
  return sightings;
}

}  // namespace raysteer::golden
