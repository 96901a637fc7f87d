// bound to whoever advances it: a board file becomes devices. The only place
// that names back ends.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "hal/base/result.hpp"
#include "hal/mock/mock_rig.hpp"
#include "hal/rig.hpp"
#include "proto/board/board.hpp"

namespace raysteer::firmware::rig {

/// What a pretend rig needs besides its board. A real one has its own truth.
struct Pretend {
  std::uint64_t seed = 1;
  std::array<hal::mock::CommandCurve, 2> curves;  ///< of the mirror's axes, as they truly are
  std::vector<proto::board::Fault> faults;        ///< besides the board's
  hal::mock::SceneFunction scene;                 ///< what the cameras see
  int threads = 1;                                ///< that noise is drawn with
};

/// The devices of one rig, and whatever they need to live.
class Devices {
 public:
  Devices() = default;
  Devices(const Devices&) = delete;
  Devices& operator=(const Devices&) = delete;
  virtual ~Devices() = default;

  virtual hal::Rig rig() = 0;
  /// The pretend rig behind it, whose time must be advanced; nullptr: a real
  /// one.
  virtual hal::mock::MockRig* pretend() { return nullptr; }
};

/// Builds what `board.back_end` names; limits come from the board.
/// kBadValue: no such back end, mirror preset, fault device or word; says which
/// are known.
Result<std::unique_ptr<Devices>> make_devices(const proto::board::Board& board, Pretend pretend);

/// The back ends there are.
std::vector<std::string_view> back_ends();

/// What the mock back end makes of a board. kBadValue as above.
Result<hal::mock::RigParameters> mock_parameters(const proto::board::Board& board, const Pretend& pretend);

}  // namespace raysteer::firmware::rig
