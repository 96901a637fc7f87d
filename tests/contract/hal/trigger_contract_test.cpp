// What hal/trigger.hpp promises, for every back end.
#include "tests/contract/hal/back_end.hpp"

namespace raysteer::hal {
namespace {

using std::chrono::milliseconds;

class TriggerContract : public Contract {};
INSTANTIATE_TEST_SUITE_P(Every, TriggerContract, testing::ValuesIn(back_ends()), name_of);

TEST_P(TriggerContract, is_disarmed_at_first_and_does_nothing) {
  const auto rig = bench();
  Trigger& trigger = rig->rig().trigger;
  EXPECT_FALSE(trigger.armed());
  EXPECT_REFUSED(trigger.fire(rig->now()), RCode::kNotArmed);
  EXPECT_REFUSED(trigger.count(), RCode::kNotArmed);
  EXPECT_REFUSED(trigger.edges(), RCode::kNotArmed);
  EXPECT_OK(trigger.disarm());
}

TEST_P(TriggerContract, makes_each_edge_it_was_asked_for_when_it_was_asked_for) {
  const auto rig = bench();
  Trigger& trigger = rig->rig().trigger;
  ASSERT_OK(trigger.arm(TriggerSource::kFired));
  const RigTime first = rig->now() + milliseconds(3);
  for (int i = 2; i >= 0; --i) {  // several may be scheduled, in any order
    ASSERT_OK(trigger.fire(first + milliseconds(20 * i)));
  }
  rig->run(milliseconds(2));
  EXPECT_EQ(*trigger.count(), 0U);
  rig->run(milliseconds(60));
  EXPECT_EQ(*trigger.count(), 3U);
  const auto edges = *trigger.edges();
  ASSERT_EQ(edges.size(), 3U);
  for (int i = 0; i < 3; ++i) {
    const TriggerEdge& edge = edges[static_cast<std::size_t>(i)];
    EXPECT_EQ(edge.number, static_cast<std::uint64_t>(i));
    EXPECT_GE(edge.stamp, first + milliseconds(20 * i));
    EXPECT_LE(edge.stamp, first + milliseconds(20 * i) + milliseconds(1));
  }
  EXPECT_TRUE(trigger.edges()->empty()) << "each is read once";
}

TEST_P(TriggerContract, counts_from_zero_and_forgets_when_it_is_armed_again) {
  const auto rig = bench();
  Trigger& trigger = rig->rig().trigger;
  ASSERT_OK(trigger.arm(TriggerSource::kFired));
  ASSERT_OK(trigger.fire(rig->now()));
  rig->run(milliseconds(5));
  ASSERT_OK(trigger.fire(rig->now() + milliseconds(5)));  // scheduled, to be forgotten
  ASSERT_OK(trigger.arm(TriggerSource::kFired));
  rig->run(milliseconds(20));
  EXPECT_EQ(*trigger.count(), 0U);
  EXPECT_TRUE(trigger.edges()->empty());
}

TEST_P(TriggerContract, keeps_at_least_the_newest_1024_edges) {
  const auto rig = bench();
  Trigger& trigger = rig->rig().trigger;
  ASSERT_OK(trigger.arm(TriggerSource::kFired));
  for (int i = 0; i < 1'024; ++i) {
    ASSERT_OK(trigger.fire(rig->now() + std::chrono::microseconds(100 * i)));
  }
  rig->run(milliseconds(200));
  EXPECT_EQ(trigger.edges()->size(), 1'024U);
}

TEST_P(TriggerContract, lets_nothing_through_once_it_is_disarmed) {
  const auto rig = bench();
  hal::Rig devices = rig->rig();
  ASSERT_OK(devices.cameras.configure({.exposure = milliseconds(1)}));
  ASSERT_OK(devices.cameras.start());
  ASSERT_OK(devices.trigger.arm(TriggerSource::kFired));
  ASSERT_OK(devices.trigger.fire(rig->now() + milliseconds(5)));
  ASSERT_OK(devices.trigger.disarm());
  rig->run(milliseconds(200));
  EXPECT_FALSE(devices.cameras.next_pair(rig->now())->has_value());
}

TEST_P(TriggerContract, refuses_to_fire_for_an_external_source) {
  const auto rig = bench();
  ASSERT_OK(rig->rig().trigger.arm(TriggerSource::kExternal));
  EXPECT_REFUSED(rig->rig().trigger.fire(rig->now()), RCode::kNotArmed);
}

TEST_P(TriggerContract, refuses_to_fire_in_the_past_and_says_how_late) {
  const auto rig = bench();
  rig->run(milliseconds(10));
  ASSERT_OK(rig->rig().trigger.arm(TriggerSource::kFired));
  const Status late = rig->rig().trigger.fire(rig->now() - milliseconds(4));
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().rcode, RCode::kTooLate);
  EXPECT_EQ(late.error().detail, 4'000'000);
}

TEST_P(TriggerContract, says_when_the_device_does_not_answer) {
  const auto rig = bench({{.device = "trigger", .what = "unplug", .from = RigTime(milliseconds(10))}});
  Trigger& trigger = rig->rig().trigger;
  ASSERT_OK(trigger.arm(TriggerSource::kFired));
  rig->run(milliseconds(20));
  EXPECT_REFUSED(trigger.fire(rig->now()), RCode::kDeviceUnavailable);
  EXPECT_REFUSED(trigger.count(), RCode::kDeviceUnavailable);
  EXPECT_REFUSED(trigger.edges(), RCode::kDeviceUnavailable);
  EXPECT_REFUSED(trigger.disarm(), RCode::kDeviceUnavailable);
  EXPECT_TRUE(trigger.armed());
  EXPECT_REFUSED(trigger.arm(TriggerSource::kFired), RCode::kDeviceUnavailable);
  EXPECT_FALSE(trigger.armed()) << "what could not be armed is not armed";
}

class SpyTrigger final : public Trigger {
 public:
  using Trigger::Trigger;
  int calls = 0;

 private:
  Status do_arm(TriggerSource) override { return ok(); }
  Status do_disarm() override { return ok(); }
  Status do_fire(RigTime) override { return ++calls, ok(); }
  Result<std::uint64_t> do_count() override { return ++calls, std::uint64_t{0}; }
  Result<std::vector<TriggerEdge>> do_edges() override { return ++calls, std::vector<TriggerEdge>(); }
};

TEST_P(TriggerContract, lets_no_request_reach_a_back_end_that_is_not_armed_or_late) {
  const auto rig = bench();
  rig->run(milliseconds(1));
  SpyTrigger spy(rig->rig().clock);
  EXPECT_FALSE(spy.fire(rig->now()));
  EXPECT_FALSE(spy.count());
  EXPECT_FALSE(spy.edges());
  ASSERT_OK(spy.arm(TriggerSource::kExternal));
  EXPECT_FALSE(spy.fire(rig->now()));
  ASSERT_OK(spy.arm(TriggerSource::kFired));
  EXPECT_FALSE(spy.fire(rig->now() - kEarlier));
  ASSERT_OK(spy.disarm());
  EXPECT_FALSE(spy.fire(rig->now()));
  EXPECT_EQ(spy.calls, 0);
}

}  // namespace
}  // namespace raysteer::hal
