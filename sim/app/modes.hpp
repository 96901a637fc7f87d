// pure but for files: what raysteer-sim can do, one function a mode.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "hal/base/result.hpp"
#include "proto/board/board.hpp"
#include "sim/app/say.hpp"
#include "sim/rig/pretend_rig.hpp"

namespace raysteer::sim::app {

/// Which pretend rig.
struct WhichRig {
  std::string board = "mock-galvo";
  std::string scene = "step";
  std::uint64_t seed = 1;
  std::vector<std::string> faults;
  int threads = 0;  ///< 0: as many as there are cores
};

struct LoadedRig {
  proto::board::Board board;
  std::string scene;  ///< its name
  std::unique_ptr<rig::PretendRig> rig;
};

/// Reads the files and builds the rig. Errors: those of find_file(), the
/// readers, and PretendRig::make().
Result<LoadedRig> load_rig(const WhichRig& which);

/// The board's, for those who wait for the mirror.
std::chrono::nanoseconds settle_timeout(const proto::board::Board& board);

struct CaptureRequest {
  WhichRig which;
  std::string patterns = "default";
  std::string looks;  ///< plan file or name; empty: one look, straight ahead
  std::filesystem::path out;
  bool paced = false;
};
Result<Json> capture(const CaptureRequest& request, Say& say);

struct PictureRequest {
  WhichRig which;
  std::filesystem::path picture;
  std::array<double, 2> mirror_mrad{};
  std::string content;  ///< PNG; empty: white
};
Result<Json> picture(const PictureRequest& request, Say& say);

struct ShowRequest {
  WhichRig which;
  std::filesystem::path request;  ///< docs/show-format.md
  std::filesystem::path out;
};
Result<Json> show(const ShowRequest& request, Say& say);

/// The words that --fault knows.
Json faults();

}  // namespace raysteer::sim::app
