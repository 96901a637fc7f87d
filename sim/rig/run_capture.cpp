#include "sim/rig/run_capture.hpp"

#include <optional>
#include <utility>

#include "sim/rig/pace.hpp"

namespace raysteer::sim::rig {
namespace {

constexpr std::chrono::nanoseconds kTick{500'000};
constexpr int kTicksPerReport = 20;

}  // namespace

Result<firmware::capture::Findings> run_capture(PretendRig& rig, const proto::plan::Plan& plan,
                                                const PatternSequence& sequence, firmware::capture::Options options,
                                                firmware::capture::Sink& sink, const EventLog& log,
                                                const RunOptions& run) {
  using firmware::capture::Capture;
  using firmware::capture::State;
  for (const proto::plan::PlannedLook& look : plan.looks) {
    if (const Result<int> pose = rig.world().scene().target_pose(look.prepare); !pose) {
      return with_context(pose.error(), "look '" + look.name + "'");
    }
  }
  const hal::Rig devices = rig.devices();
  Result<Capture> capture = Capture::make(devices, plan, sequence, std::move(options), sink, log);
  if (!capture) {
    return std::move(capture).error();
  }
  const Pace pace(rig.now());
  for (int tick = 0;; ++tick) {
    const State state = capture->tick(rig.now());
    if (state == State::kDone) {
      return capture->findings();
    }
    if (state == State::kFailed) {
      return *capture->error();
    }
    if (state == State::kWaiting) {
      RAYSTEER_TRY(rig.prepare(capture->prepare()));
      capture->go_on(rig.now());
    }
    if (tick % kTicksPerReport == 0 && run.progress && !run.progress(capture->progress())) {
      return fail(RCode::kCancelled);
    }
    rig.advance_to(rig.now() + kTick);
    if (run.paced) {
      pace.wait(rig.now());
    }
  }
}

}  // namespace raysteer::sim::rig
