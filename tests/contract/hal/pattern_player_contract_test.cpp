// What hal/pattern_player.hpp promises, for every back end that has it.
#include "tests/contract/hal/back_end.hpp"

namespace raysteer::hal {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

class PatternPlayerContract : public Contract {
 protected:
  void SetUp() override { begin({}); }
  void begin(std::vector<mock::Fault> faults) {
    rig_ = bench(std::move(faults));
    player_ = rig_->rig().player;
    ASSERT_NE(player_, nullptr);
  }
  void load() { ASSERT_OK(rig_->rig().projector.load(six_patterns())); }
  static PatternRun run_of(int first, int count) {
    return {.first = first, .count = count, .exposure = milliseconds(8), .period = milliseconds(20)};
  }

  std::unique_ptr<Bench> rig_;
  PatternPlayer* player_ = nullptr;
};
INSTANTIATE_TEST_SUITE_P(Every, PatternPlayerContract, testing::ValuesIn(back_ends_that_play()), name_of);

TEST_P(PatternPlayerContract, does_not_play_at_first) {
  EXPECT_FALSE(player_->state()->playing);
  EXPECT_EQ(player_->state()->done, 0);
}

TEST_P(PatternPlayerContract, plays_each_pattern_once_and_counts_those_that_are_over) {
  load();
  ASSERT_OK(player_->play(run_of(1, 4)));
  EXPECT_TRUE(player_->state()->playing);
  int before = 0;
  for (int i = 0; i < 120 && player_->state()->playing; ++i) {
    rig_->run(milliseconds(1));
    const int done = player_->state()->done;
    EXPECT_GE(done, before);
    EXPECT_LE(done, before + 1);
    before = done;
  }
  EXPECT_FALSE(player_->state()->playing);
  EXPECT_EQ(player_->state()->done, 4);
}

TEST_P(PatternPlayerContract, pulses_once_at_each_exposure_a_period_apart_when_told_to) {
  load();
  Trigger& trigger = rig_->rig().trigger;
  ASSERT_OK(trigger.arm(TriggerSource::kExternal));
  ASSERT_OK(player_->play(run_of(0, 2)));
  rig_->run(milliseconds(100));
  EXPECT_EQ(*trigger.count(), 0U) << "the output is off at first";
  ASSERT_OK(player_->trigger_output(true));
  ASSERT_OK(player_->play(run_of(0, 6)));
  rig_->run(milliseconds(200));
  const auto edges = *trigger.edges();
  ASSERT_EQ(edges.size(), 6U);
  for (std::size_t i = 1; i < edges.size(); ++i) {
    EXPECT_NEAR(static_cast<double>((edges[i].stamp - edges[i - 1].stamp).count()), 20e6, 50e3);
  }
}

TEST_P(PatternPlayerContract, refuses_patterns_that_are_not_loaded) {
  EXPECT_REFUSED(player_->play(run_of(0, 1)), RCode::kNothingStored);
  load();
  for (const auto& [first, count] :
       {std::pair{-1, 2}, std::pair{0, 0}, std::pair{0, 7}, std::pair{5, 2}, std::pair{2'000'000'000, 2'000'000'000}}) {
    EXPECT_REFUSED(player_->play(run_of(first, count)), RCode::kNothingStored);
  }
}

TEST_P(PatternPlayerContract, refuses_exposures_and_gaps_that_are_too_short) {
  load();
  PatternRun run = run_of(0, 1);
  run.exposure = player_->least_exposure() - microseconds(1);
  EXPECT_REFUSED(player_->play(run), RCode::kBadValue);
  run = run_of(0, 1);
  run.period = run.exposure + player_->least_gap() - microseconds(1);
  EXPECT_REFUSED(player_->play(run), RCode::kBadValue);
  run.exposure = player_->least_exposure();
  run.period = run.exposure + player_->least_gap();
  EXPECT_OK(player_->play(run));
}

TEST_P(PatternPlayerContract, refuses_whatever_would_disturb_a_run) {
  load();
  ASSERT_OK(player_->play(run_of(0, 3)));
  rig_->run(milliseconds(5));
  EXPECT_REFUSED(player_->play(run_of(0, 1)), RCode::kProjectorBusy);
  EXPECT_REFUSED(player_->trigger_output(true), RCode::kProjectorBusy);
  EXPECT_REFUSED(rig_->rig().projector.show(Dark{}, rig_->now()), RCode::kProjectorBusy);
  EXPECT_REFUSED(rig_->rig().projector.load(six_patterns()), RCode::kProjectorBusy);
}

TEST_P(PatternPlayerContract, stops_at_once_and_harmlessly_without_a_run) {
  EXPECT_OK(player_->stop());
  load();
  ASSERT_OK(player_->play(run_of(0, 5)));
  rig_->run(milliseconds(30));
  ASSERT_OK(player_->stop());
  EXPECT_FALSE(player_->state()->playing);
  EXPECT_EQ(player_->state()->done, 2);
  EXPECT_OK(rig_->rig().projector.show(Dark{}, rig_->now()));
}

TEST_P(PatternPlayerContract, says_when_the_device_does_not_answer) {
  begin({{.device = "projector", .what = "unplug", .from = RigTime(milliseconds(10))}});
  load();
  rig_->run(milliseconds(20));
  EXPECT_REFUSED(player_->trigger_output(true), RCode::kDeviceUnavailable);
  EXPECT_REFUSED(player_->play(run_of(0, 1)), RCode::kDeviceUnavailable);
  EXPECT_REFUSED(player_->stop(), RCode::kDeviceUnavailable);
  EXPECT_REFUSED(player_->state(), RCode::kDeviceUnavailable);
}

}  // namespace
}  // namespace raysteer::hal
