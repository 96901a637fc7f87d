// bound to the caller's thread: frames of one look go in one by one, projector coordinates come out.
//
// Keeps sums per pixel, never the frames. Two exceptions: a pattern waits for its inverse, and patterns without
// inverse wait for what they are thresholded by (white and black, or the mean of a phase block) if that comes later.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "calib/decode/code_map.hpp"
#include "hal/base/image.hpp"
#include "hal/base/pattern.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::decode {

/// Grey levels (DN) are those of the frames: 0..255 for 8 bits, 0..65535 for 16.
struct Options {
  /// false: integer codes and masks only (pure Gray sequences; ignored where phase is needed).
  bool sub_pixel = true;

  /// Noise of one frame: variance = read_sigma_dn^2 + signal / electrons_per_dn + 1/12. Both 0: estimated from the
  /// frames themselves (pattern + inverse is constant; a sinusoid's residual), which includes JPEG and flicker.
  double read_sigma_dn = 0;
  double electrons_per_dn = 0;

  /// A difference (pattern - inverse, white - black) or a modulation below this many of its own sigma says nothing.
  double min_sigma = 5;
  /// ... and below this many DN of 255 neither, whatever the noise is said to be. 0 trusts the noise alone.
  double min_difference_dn = 0;
  /// White - black must also reach this (DN of 255).
  double min_contrast_dn = 0;
  /// ... and the amplitude B of a sinusoid (A + B cos) this (DN of 255).
  double min_modulation_dn = 0;
  /// Of full scale; at or above it the sensor no longer tells (algorithms: 250 of 255).
  double saturation = 250.0 / 255.0;
  /// Heterodyne: largest distance of the order from an integer, in periods.
  double max_order_residual = 0.25;
  /// Larger predicted sigma makes a coordinate kLowModulation (algorithms 2.5).
  double max_sigma_px = 0.5;
  /// false: pixels stand for themselves; no test against neighbours (kEdge is never set).
  bool neighbours = true;
};

class Decoder {
 public:
  /// `bits` of the camera: 8, or 9 to 16 for frames of uint16_t. Errors: kBadSequence, kFrameSize (size not positive).
  static Result<Decoder> make(const PatternSequence& sequence, int width, int height, int bits = 8,
                              Options options = {});
  Decoder(Decoder&&) noexcept;
  Decoder& operator=(Decoder&&) noexcept;
  ~Decoder();

  /// The next frame in the order of the sequence. Errors: kFrameCount (all have come), kFrameSize, kFrameDepth.
  Status push(ImageView<const std::uint8_t> frame);
  Status push(ImageView<const std::uint16_t> frame);

  /// Coordinates and masks; the decoder starts anew afterwards and keeps its memory.
  /// Errors: kFrameCount (frames are missing), kNothingDecoded, kFramesBlack, kFramesSaturated.
  /// The memory of `reused`, a map that is no longer needed, serves again.
  Result<CodeMap> finish(CodeMap reused = {});

 private:
  struct State;
  explicit Decoder(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// All frames of a sequence that are in memory already: the same result as pushing them one by one, faster, because
/// sums of a few rows stay in the processor's cache.
Result<CodeMap> decode(const PatternSequence& sequence, std::span<const ImageView<const std::uint8_t>> frames,
                       Options options = {}, CodeMap reused = {});

}  // namespace raysteer::calib::decode
