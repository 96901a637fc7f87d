#include "tests/contract/hal/back_end.hpp"

#include "hal/mock/mock_rig.hpp"

namespace raysteer::hal {
namespace {

constexpr int kPanelWidth = 64;
constexpr int kPanelHeight = 40;

class MockBench final : public Bench {
 public:
  explicit MockBench(const mock::RigParameters& parameters) {
    const CameraInfo info = parameters.cameras.eyes[0].info;
    auto rig = mock::MockRig::make(parameters, [info](const mock::Exposure&) {
      Image<float> grey(info.width, info.height);
      grey.fill(1'000);
      return grey;
    });
    RAYSTEER_CHECK(rig.has_value());
    rig_ = std::move(*rig);
  }
  Rig rig() override { return rig_->rig(); }
  void run(std::chrono::nanoseconds time) override { rig_->advance_to(rig_->now() + time); }
  void open_switch(bool open) override { open ? rig_->interlock().open() : rig_->interlock().close(); }

 private:
  std::unique_ptr<mock::MockRig> rig_;
};

mock::RigParameters mock_rig(const char* mirror, bool plays, int bits, std::vector<mock::Fault> faults) {
  mock::RigParameters rig;
  rig.mirror = *mock::mirror_preset(mirror);
  rig.projector.panel = {
      .width = kPanelWidth, .height = kPanelHeight, .frame_period = std::chrono::nanoseconds(16'666'667)};
  rig.projector.pictures = 8;
  if (plays) {
    rig.player = mock::PlayerParameters{};
  }
  rig.interlock.watchdog = std::chrono::milliseconds(plays ? 200 : 0);
  const char* serials[] = {"L1", "R1"};
  for (std::size_t i = 0; i < 2; ++i) {
    rig.cameras.eyes[i].info.serial = serials[i];
    rig.cameras.eyes[i].info.width = 24;
    rig.cameras.eyes[i].info.height = 16;
    rig.cameras.eyes[i].info.bits = bits;
    rig.cameras.bound[i] = serials[i];
  }
  rig.store = {.capacity = 16 * 4'096, .page = 4'096};
  rig.faults = std::move(faults);
  return rig;
}

BackEnd mock_back_end(const std::string& name, const char* mirror, bool plays, int bits) {
  return {.name = name, .plays = plays, .make = [=](std::vector<mock::Fault> faults) {
            return std::make_unique<MockBench>(mock_rig(mirror, plays, bits, std::move(faults)));
          }};
}

}  // namespace

const std::vector<BackEnd>& back_ends() {
  static const std::vector<BackEnd> all{mock_back_end("mock_galvo_display", "galvo", false, 8),
                                        mock_back_end("mock_head_master", "head", true, 8),
                                        mock_back_end("mock_cheap_head_12_bit", "cheap-head", false, 12)};
  return all;
}

std::vector<BackEnd> back_ends_that_play() {
  std::vector<BackEnd> some;
  for (const BackEnd& back_end : back_ends()) {
    if (back_end.plays) {
      some.push_back(back_end);
    }
  }
  return some;
}

PatternSequence six_patterns() {
  return {.panel_width = kPanelWidth,
          .panel_height = kPanelHeight,
          .blocks = {{.kind = PatternKind::kWhite},
                     {.kind = PatternKind::kBlack},
                     {.kind = PatternKind::kPhase, .axis = Axis::kX, .steps = 4, .period_px = 16}}};
}

}  // namespace raysteer::hal
