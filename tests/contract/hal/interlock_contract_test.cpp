// What hal/interlock.hpp promises, for every back end.
#include "tests/contract/hal/back_end.hpp"

namespace raysteer::hal {
namespace {

using std::chrono::milliseconds;

class InterlockContract : public Contract {};
INSTANTIATE_TEST_SUITE_P(Every, InterlockContract, testing::ValuesIn(back_ends()), name_of);

TEST_P(InterlockContract, follows_its_switches_and_says_since_when) {
  const auto rig = bench();
  Interlock& interlock = rig->rig().interlock;
  EXPECT_TRUE(interlock.state()->closed);
  rig->run(milliseconds(7));
  const RigTime opened = rig->now();
  rig->open_switch(true);
  rig->run(milliseconds(7));
  EXPECT_FALSE(interlock.state()->closed);
  EXPECT_EQ(interlock.state()->since, opened);
  rig->open_switch(false);
  EXPECT_TRUE(interlock.state()->closed);
}

TEST_P(InterlockContract, stays_open_after_a_trip_until_a_person_resets_it) {
  const auto rig = bench();
  Interlock& interlock = rig->rig().interlock;
  EXPECT_FALSE(interlock.tripped());
  interlock.trip();
  EXPECT_TRUE(interlock.tripped());
  EXPECT_FALSE(interlock.state()->closed);
  rig->run(milliseconds(50));
  EXPECT_FALSE(interlock.state()->closed);
  EXPECT_REFUSED(interlock.feed(), RCode::kInterlockTripped);
  ASSERT_OK(interlock.reset());
  EXPECT_FALSE(interlock.tripped());
  EXPECT_TRUE(interlock.state()->closed);
  EXPECT_OK(interlock.feed());
}

TEST_P(InterlockContract, refuses_a_reset_while_a_switch_is_open) {
  const auto rig = bench();
  Interlock& interlock = rig->rig().interlock;
  interlock.trip();
  rig->open_switch(true);
  EXPECT_REFUSED(interlock.reset(), RCode::kInterlockOpen);
  EXPECT_TRUE(interlock.tripped());
}

TEST_P(InterlockContract, stays_closed_while_it_is_fed) {
  const auto rig = bench();
  for (int i = 0; i < 50; ++i) {
    ASSERT_OK(rig->rig().interlock.feed());
    rig->run(milliseconds(20));
    ASSERT_TRUE(rig->rig().interlock.state()->closed);
  }
}

TEST_P(InterlockContract, says_when_the_loop_cannot_be_read) {
  const auto rig = bench({{.device = "interlock", .what = "unplug"}});
  EXPECT_REFUSED(rig->rig().interlock.state(), RCode::kDeviceUnavailable);
  EXPECT_REFUSED(rig->rig().interlock.feed(), RCode::kDeviceUnavailable);
  EXPECT_REFUSED(rig->rig().interlock.reset(), RCode::kDeviceUnavailable);
}

/// A back end whose loop software cannot open: it says closed whatever happens.
class DeafInterlock final : public Interlock {
 public:
  int fed = 0;

 private:
  Result<InterlockState> do_state() override { return InterlockState{.closed = true, .since = {}}; }
  Status do_feed() override { return ++fed, ok(); }
  void do_trip() override {}
  Status do_reset() override { return ok(); }
};

TEST(InterlockHalf, counts_as_open_after_a_trip_even_when_the_back_end_says_closed) {
  DeafInterlock deaf;
  deaf.trip();
  EXPECT_FALSE(deaf.state()->closed);
  EXPECT_FALSE(deaf.feed());
  EXPECT_EQ(deaf.fed, 0) << "its watchdog starves, which opens the loop";
}

}  // namespace
}  // namespace raysteer::hal
