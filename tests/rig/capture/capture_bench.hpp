// bound to one test: a capture on a pretend rig in virtual time, and what it said.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "firmware/capture/capture.hpp"
#include "hal/mock/mock_rig.hpp"
#include "tests/rig/capture/pretend_plane.hpp"
#include "tests/support/seed.hpp"

namespace raysteer::support {

/// Keeps everything in memory.
class MemorySink : public firmware::capture::Sink {
 public:
  Result<std::optional<proto::session::Manifest>> open(const proto::session::Manifest&) override {
    return std::optional<proto::session::Manifest>();
  }
  Status put(const proto::session::Manifest&, const proto::session::Shot& shot, hal::FramePair pair) override {
    ++puts;
    shots.insert_or_assign({shot.look, shot.index}, std::move(pair));
    return ok();
  }
  Status keep(const proto::session::Manifest& manifest) override {
    kept = manifest;
    return ok();
  }
  Status finish(const proto::session::Manifest& manifest) override {
    finished = manifest;
    return ok();
  }

  std::map<std::pair<std::string, int>, hal::FramePair> shots;
  std::optional<proto::session::Manifest> kept;
  std::optional<proto::session::Manifest> finished;
  int puts = 0;
};

enum class Kind { kDisplay, kTriggerMaster };

struct CaptureBench {
  hal::mock::RigParameters parameters;
  PretendPlane plane;
  proto::plan::Plan plan;
  PatternSequence sequence;
  firmware::capture::Options options;
  firmware::capture::Sink* sink = &memory;

  MemorySink memory;
  std::vector<std::string> events;
  EventLog log{[this](LogLevel, std::string_view line) { events.emplace_back(line); }};
  std::unique_ptr<hal::mock::MockRig> rig;
  std::optional<firmware::capture::Capture> capture;
  RigTime now{};

  explicit CaptureBench(Kind kind, std::uint64_t rig_seed = seed());
  CaptureBench(const CaptureBench&) = delete;
  CaptureBench& operator=(const CaptureBench&) = delete;

  /// One more look.
  void add_look(const std::string& name, double axis1, double axis2);
  /// "device", "what", from, how often (0: for ever), how much (0: the word's own).
  void fault(const std::string& device, const std::string& what, double at_s, int times = 1, double amount = 0);
  /// Builds rig and capture; a test fails on an error.
  Status make();
  /// Ticks until the capture does not run any more, at most so long.
  firmware::capture::State run(double most_s = 60);
  /// As far as the first event that begins so; the instant in seconds, negative when it never came.
  double run_to(const std::string& event, double most_s = 60);
  bool said(const std::string& part) const;
  double seconds() const { return static_cast<double>(now.time_since_epoch().count()) * 1e-9; }
  std::string story() const;
};

}  // namespace raysteer::support
