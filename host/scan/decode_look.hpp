// Frames of one look become projector coordinates: read, checked and decoded one after the other.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "calib/decode/decoder.hpp"
#include "hal/base/image.hpp"
#include "hal/base/result.hpp"
#include "host/session/session.hpp"

namespace raysteer::host::scan {

/// Called now and then with the part done (0 to 1), from any thread. False: stop; the work then returns kCancelled.
using Tick = std::function<bool(double done)>;

/// What one camera saw in one look.
struct DecodedLook {
  calib::decode::CodeMap codes;
  Image<std::uint8_t> white;  ///< the frame with all of the projector on, 8 bits; empty without one
};

/// Errors: those of Session::load and of Decoder, naming camera and look; of SequenceCheck; kCancelled.
Result<DecodedLook> decode_look(const session::Session& session, int camera, int look,
                                const calib::decode::Options& options = {}, const Tick& tick = {});

/// The same for all cameras of a session, each on a thread of its own, in the session's order.
Result<std::vector<DecodedLook>> decode_cameras(const session::Session& session, int look,
                                                const calib::decode::Options& options = {}, const Tick& tick = {});

}  // namespace raysteer::host::scan
