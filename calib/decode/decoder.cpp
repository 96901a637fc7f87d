#include "calib/decode/decoder.hpp"

#include <string>
#include <utility>
#include <variant>

#include "calib/decode/engine.hpp"

namespace raysteer::calib::decode {
namespace {

constexpr int kLargestSide = 32768;

Status check_size(int width, int height, int bits) {
  if (width < 2 || height < 2 || width > kLargestSide || height > kLargestSide) {
    return fail(RCode::kFrameSize, "frames must have 2 to " + std::to_string(kLargestSide) + " pixels a side, got " +
                                       std::to_string(width) + " x " + std::to_string(height));
  }
  if (bits < 8 || bits > 16) {
    return fail(RCode::kFrameDepth, "8 to 16 bits can be decoded, got " + std::to_string(bits));
  }
  return ok();
}

}  // namespace

struct Decoder::State {
  std::variant<Engine<std::uint8_t>, Engine<std::uint16_t>> engine;
};

Decoder::Decoder(std::unique_ptr<State> state) : state_(std::move(state)) {}
Decoder::Decoder(Decoder&&) noexcept = default;
Decoder& Decoder::operator=(Decoder&&) noexcept = default;
Decoder::~Decoder() = default;

Result<Decoder> Decoder::make(const PatternSequence& sequence, int width, int height, int bits, Options options) {
  RAYSTEER_TRY(check_size(width, height, bits));
  Result<Plan> planned = plan(sequence);
  if (!planned) {
    return std::move(planned).error();
  }
  if (bits == 8) {
    return Decoder(
        std::make_unique<State>(State{Engine<std::uint8_t>(std::move(planned).value(), width, height, bits, options)}));
  }
  return Decoder(
      std::make_unique<State>(State{Engine<std::uint16_t>(std::move(planned).value(), width, height, bits, options)}));
}

Status Decoder::push(ImageView<const std::uint8_t> frame) {
  if (auto* engine = std::get_if<Engine<std::uint8_t>>(&state_->engine)) {
    return engine->push(frame);
  }
  return fail(RCode::kFrameDepth, "an 8-bit frame came, the decoder was made for more bits");
}

Status Decoder::push(ImageView<const std::uint16_t> frame) {
  if (auto* engine = std::get_if<Engine<std::uint16_t>>(&state_->engine)) {
    return engine->push(frame);
  }
  return fail(RCode::kFrameDepth, "a 16-bit frame came, the decoder was made for 8 bits");
}

Result<CodeMap> Decoder::finish(CodeMap reused) {
  return std::visit([&](auto& engine) { return engine.finish(std::move(reused)); }, state_->engine);
}

Result<CodeMap> decode(const PatternSequence& sequence, std::span<const ImageView<const std::uint8_t>> frames,
                       Options options, CodeMap reused) {
  Result<Plan> planned = plan(sequence);
  if (!planned) {
    return std::move(planned).error();
  }
  if (frames.size() != planned->frames.size()) {
    return fail(RCode::kFrameCount, "the sequence has " + std::to_string(planned->frames.size()) + " frames, " +
                                        std::to_string(frames.size()) + " came");
  }
  const int width = frames[0].width();
  const int height = frames[0].height();
  RAYSTEER_TRY(check_size(width, height, 8));
  const auto by_inverse = [](const AxisPlan& axis) {
    return axis.phases.empty() && axis.threshold == Threshold::kInverse;
  };
  const bool banded = by_inverse(planned->x) && by_inverse(planned->y);
  Engine<std::uint8_t> engine(std::move(planned).value(), width, height, 8, options);
  if (banded) {
    return engine.decode(frames, std::move(reused));
  }
  for (const ImageView<const std::uint8_t>& frame : frames) {
    RAYSTEER_TRY(engine.push(frame));
  }
  return engine.finish(std::move(reused));
}

}  // namespace raysteer::calib::decode
