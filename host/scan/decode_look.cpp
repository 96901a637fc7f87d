#include "host/scan/decode_look.hpp"

#include <algorithm>
#include <atomic>
#include <optional>
#include <thread>
#include <utility>

#include "calib/decode/sequence_check.hpp"
#include "hal/base/pattern.hpp"
#include "host/session/lit_part.hpp"

namespace raysteer::host::scan {
namespace {

using calib::decode::Decoder;
using session::Session;

void keep_white(const Image<std::uint8_t>& frame, int, Image<std::uint8_t>& white) { white = frame.clone(); }

void keep_white(const Image<std::uint16_t>& frame, int bits, Image<std::uint8_t>& white) {
  white = Image<std::uint8_t>::uninitialised(frame.width(), frame.height());
  std::transform(frame.data(), frame.data() + frame.size(), white.data(),
                 [bits](std::uint16_t value) { return static_cast<std::uint8_t>(std::min(255, value >> (bits - 8))); });
}

template <class Pixel>
Result<DecodedLook> decode(const Session& session, int camera, int look, const calib::decode::Options& options,
                           const Tick& tick) {
  const PatternSequence& sequence = session.manifest().sequence;
  const std::string who = "camera '" + session.manifest().cameras[static_cast<std::size_t>(camera)].name + "', look '" +
                          session.manifest().looks[static_cast<std::size_t>(look)].name + "'";
  Result<Decoder> decoder =
      Decoder::make(sequence, session.width(camera), session.height(camera), session.bits(camera), options);
  if (!decoder) {
    return with_context(std::move(decoder).error(), who);
  }
  const Result<Region> lit = session::lit_part(session, camera, look);
  if (!lit) {
    return lit.error();
  }
  calib::decode::SequenceCheck check(sequence, *lit, session.bits(camera));
  DecodedLook decoded;
  Image<Pixel> frame;
  const std::vector<Pattern> patterns = sequence.patterns();
  const int frames = session.frames_per_look();
  for (int index = 0; index < frames; ++index) {
    if (tick && !tick(static_cast<double>(index) / frames)) {
      return fail(RCode::kCancelled);
    }
    RAYSTEER_TRY(session.load({camera, look, index}, frame));
    check.add(index, std::as_const(frame).view());
    if (Status pushed = decoder->push(std::as_const(frame).view()); !pushed) {
      return with_context(std::move(pushed).error(), session.describe({camera, look, index}));
    }
    if (patterns[static_cast<std::size_t>(index)].block.kind == PatternKind::kWhite) {
      keep_white(frame, session.bits(camera), decoded.white);
    }
  }
  // Frames that do not show the sequence decode to nonsense without an error: what is wrong with them comes first.
  if (Status verdict = check.verdict(); !verdict) {
    return with_context(std::move(verdict).error(), who);
  }
  Result<calib::decode::CodeMap> codes = decoder->finish();
  if (!codes) {
    return with_context(std::move(codes).error(), who);
  }
  decoded.codes = *std::move(codes);
  return decoded;
}

}  // namespace

Result<DecodedLook> decode_look(const Session& session, int camera, int look, const calib::decode::Options& options,
                                const Tick& tick) {
  return session.bits(camera) > 8 ? decode<std::uint16_t>(session, camera, look, options, tick)
                                  : decode<std::uint8_t>(session, camera, look, options, tick);
}

Result<std::vector<DecodedLook>> decode_cameras(const Session& session, int look, const calib::decode::Options& options,
                                                const Tick& tick) {
  const auto cameras = static_cast<std::size_t>(session.cameras());
  std::vector<std::optional<Result<DecodedLook>>> results(cameras);
  std::atomic<bool> failed = false;
  {
    std::vector<std::jthread> threads;
    for (std::size_t camera = 0; camera < cameras; ++camera) {
      // The first camera's progress stands for all: they run side by side. A failure stops the others.
      threads.emplace_back([&, camera] {
        const Tick own = [&, camera](double done) {
          return !failed.load(std::memory_order_relaxed) && (camera > 0 || !tick || tick(done));
        };
        results[camera] = decode_look(session, static_cast<int>(camera), look, options, own);
        if (!results[camera]->has_value()) {
          failed = true;
        }
      });
    }
  }
  std::vector<DecodedLook> decoded;
  std::optional<Error> error;
  for (std::optional<Result<DecodedLook>>& result : results) {
    if (result->has_value()) {
      decoded.push_back(std::move(**result));
    } else if (!error || error->rcode == RCode::kCancelled) {
      error = std::move(*result).error();  // the fault, not the cancellation it caused
    }
  }
  if (error) {
    return *std::move(error);
  }
  return decoded;
}

}  // namespace raysteer::host::scan
